"""The switch for recordings on the page."""

from collections.abc import Callable
from pathlib import Path

import pytest
import viser

from app.log.events_file import line_of
from app.log_reading.reader import read
from app.web.server import Served
from pendant.events.event import Event, Kind
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
    path = served.recording.path
    assert path is not None
    until(lambda: read(tmp_path / path).whole, "it is whole")


def test_who_only_watches_cannot(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.lab.wear._impl.uuid, value=1.5)
    watcher.set(served.docks.recording.switch._impl.uuid, value=True)
    operator.set(served.lab.wear._impl.uuid, value=2.0)
    until(lambda: served.lab.wear.value == 2.0, "later messages have come")
    assert not served.recording.on


def test_the_last_recording_is_exported_on_a_click(
    served: Served, join: Join, loop: FakeLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.learning.exporting.COMMAND", "import sys; print('2 demonstrations of', sys.argv[2])")
    client, tab = join(), served.docks.recording
    assert tab.export.disabled
    client.set(tab.switch._impl.uuid, value=True)
    until(lambda: loop.watch is not None, "it is on")
    simulation = loop.simulation
    loop.watch(simulation, simulation.tick(loop.desk.take()))
    until(lambda: served.recording.path is not None, "there is a file")
    assert tab.export.disabled  # it is still written
    client.set(tab.switch._impl.uuid, value=False)
    until(lambda: not tab.export.disabled, "it can be exported")
    client.set(tab.export._impl.uuid, value=True)
    assert served.recording.path is not None
    name = served.recording.path.name
    until(lambda: f"2 demonstrations of {name}" in tab.exported.shown, "what became of it is told", seconds=60.0)


def test_an_export_that_fails_says_why(served: Served, join: Join, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.learning.exporting.COMMAND", "import sys; sys.exit('pendant: export: nobody led the arm')")
    client, tab = join(), served.docks.recording
    served.recording.path = tmp_path / "recording-1.mcap"
    until(lambda: not tab.export.disabled, "it can be exported")
    client.set(tab.export._impl.uuid, value=True)
    until(
        lambda: "Not exported" in tab.exported.shown and "nobody led the arm" in tab.exported.shown, "it says why", seconds=60.0
    )


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


def recorded(client: RawClient, served: Served, loop: FakeLoop) -> str:
    """A file of some ticks."""
    switch, simulation = served.docks.recording.switch, loop.simulation
    client.set(switch._impl.uuid, value=True)
    until(lambda: loop.watch is not None, "it is on")
    for _ in range(300):
        loop.watch(simulation, simulation.tick(loop.desk.take()))
    client.set(switch._impl.uuid, value=False)
    until(lambda: served.recording.path is not None and not served.recording.writing, "it is whole")
    assert served.recording.path is not None
    return served.recording.path.name


def test_a_recording_is_replayed_beside_the_running_arm(served: Served, join: Join, loop: FakeLoop) -> None:
    client, replay = join(), served.docks.recording.replay
    assert replay.play.disabled
    assert replay.download.disabled
    name = recorded(client, served, loop)
    until(lambda: replay.choice.value == name and not replay.play.disabled, "it is offered")
    assert not replay.line.visible
    client.set(replay.play._impl.uuid, value=True)
    until(lambda: replay.ghost.posture is not None, "it is shown", seconds=20.0)
    until(lambda: replay.line.visible and replay.line.max == pytest.approx(0.6, abs=0.01), "with its time line")
    until(lambda: "Replay: the violet arm" in replay.said.shown, "said")
    until(lambda: replay.play.label == "Replay" and replay.line.value == replay.line.max, "to its end")
    client.set(replay.line._impl.uuid, value=0.2)
    until(lambda: replay.play.label == "Go on", "a place in time")
    client.set(replay.speed._impl.uuid, value="0.1 ×")
    client.set(replay.play._impl.uuid, value=True)
    until(lambda: replay.play.label == "Pause" and 0.2 < replay.line.value < 0.6, "slowly on")
    until(lambda: replay.play.icon == viser.Icon.PLAYER_PAUSE, "its sign")
    player = replay._shelf.player
    assert player is not None
    assert not replay.marks.choice.visible  # nothing has happened
    player.log.events.append(line_of(Event(Kind.RESET, 200, {})))
    for tick, time in ((200, 0.4), (100, 0.4), (None, 0.4)):  # of the others it has no event
        replay.look_at(tick)
        assert not player.playing or tick != 200
        assert player.time == pytest.approx(time, abs=0.01)
    client.set(replay.leave._impl.uuid, value=True)
    until(lambda: replay.ghost.posture is None and not replay.line.visible, "over")


def test_what_cannot_be_replayed_says_why(served: Served, join: Join, tmp_path: Path) -> None:
    client, replay = join(), served.docks.recording.replay
    (tmp_path / "broken.mcap").write_bytes(b"no recording")
    until(lambda: replay.choice.value == "broken.mcap" and not replay.play.disabled, "it is offered", seconds=10.0)
    client.set(replay.play._impl.uuid, value=True)
    until(lambda: "Not opened" in replay.said.shown and "broken.mcap" in replay.said.shown, "why not")
    (tmp_path / "broken.mcap").unlink()
    client.set(replay.download._impl.uuid, value=True)
    until(lambda: "cannot be read" in replay.said.shown, "gone")
