"""The switch for recordings on the page."""

from collections.abc import Callable
from pathlib import Path

import pytest

from app.log.reader import read
from app.web.server import Served
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Recordings go into the working folder."""
    monkeypatch.chdir(tmp_path)


def test_the_operator_switches_it_and_sees_what_is_written(served: Served, join: Join, loop: FakeLoop, tmp_path: Path) -> None:
    client, switch = join(), served.docks.recording
    assert "none yet" in switch.status.shown
    client.set(switch.switch._impl.uuid, value=True)
    until(lambda: loop.watch is not None, "it is on")
    simulation = loop.simulation
    loop.watch(simulation, simulation.tick(loop.desk.take()))
    until(lambda: "recording-2" in switch.status.shown and "0.0 s" in switch.status.shown, "the file is told")
    client.set(switch.switch._impl.uuid, value=False)
    until(lambda: not served.recording.on and loop.watch is None, "it is off")
    until(lambda: "saved" in switch.status.shown, "the file is saved")
    assert served.recording.path is not None
    until(lambda: read(tmp_path / served.recording.path).whole, "it is whole")


def test_who_only_watches_cannot(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.lab.wear._impl.uuid, value=1.5)
    watcher.set(served.docks.recording.switch._impl.uuid, value=True)
    operator.set(served.lab.wear._impl.uuid, value=2.0)
    until(lambda: served.lab.wear.value == 2.0, "later messages have come")
    assert not served.recording.on


def test_a_recording_that_ends_by_itself_says_why_and_switches_off(served: Served, join: Join) -> None:
    client, switch = join(), served.docks.recording
    client.set(switch.switch._impl.uuid, value=True)
    until(lambda: served.recording.path is not None, "it is on")
    served.recording.failure = "recording-1.mcap: could not be written to its end (the disk is full)"
    served.recording.stop()
    until(lambda: not switch.switch.value and "the disk is full" in switch.status.shown, "it says why")


@pytest.mark.parametrize("name", ["a", "b/c"])
def test_recording_from_the_start_needs_a_folder(loop: FakeLoop, tmp_path: Path, name: str) -> None:
    from app.web.server import serve
    from sim.arm.scenario import Scenario
    from tests.app.web.fake_loop import ARM

    app = serve(loop, ARM, Scenario(), record=tmp_path / name)
    try:
        assert app.recording.on
        assert app.docks.recording.switch.value
        assert (tmp_path / name).is_dir()
    finally:
        app.close()
    assert loop.watch is None
