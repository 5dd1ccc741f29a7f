"""The switch that records a running loop."""

import re
import threading
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

import pytest

from app.files.checked import BadInput
from app.files.library import load_arm
from app.log import live
from app.log.live import LiveRecording
from app.log.recorder import SLOW, Recorder
from app.log_reading.reader import read
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.events.event import Event, Kind, Values
from pendant.inputs import NOTHING
from sim.arm.scenario import BoxObject, Load, Scenario
from sim.exchange.desk import Wishes
from sim.run.between_ticks import BetweenTicks
from sim.run.event_log import EventLog
from sim.run.troubles import Troubles
from sim.simulation import Simulation
from tests.app.web.raw_client import until

T = TypeVar("T")
ARM = load_arm("ur5e")
IDLE = Wishes(NOTHING, (), ())


class SteppedLoop:
    """A loop whose ticks the test does."""

    def __init__(self) -> None:
        self.watch: Callable[[Simulation, Decision], None] | None = None
        self.log = EventLog()
        self._between = BetweenTicks()
        self.troubles = Troubles(self.tell)
        self.simulation = Simulation(ARM, Scenario(), Settings())

    def between_ticks(self, work: Callable[[], T]) -> "Future[T]":
        return self._between.ask(work)

    def tell(self, kind: Kind, values: Values) -> None:
        self._between.ask(lambda: self.log.note(Event(kind, self.simulation.tick_count, values)))

    def tick(self, times: int) -> None:
        self._between.do()
        for _ in range(times):
            decision = self.simulation.tick(IDLE)
            if self.watch is not None:
                self.watch(self.simulation, decision)


@pytest.fixture
def loop() -> SteppedLoop:
    return SteppedLoop()


def start(recording: LiveRecording, loop: SteppedLoop) -> None:
    recording.start()
    until(lambda: loop.watch is not None, "it records")


def files(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.mcap"), key=lambda path: path.stat().st_ctime_ns)


def test_what_is_done_while_it_is_on_is_recorded(loop: SteppedLoop, tmp_path: Path) -> None:
    recording = LiveRecording(loop, tmp_path / "new")
    loop.tick(10)
    assert not (tmp_path / "new").exists()
    start(recording, loop)
    assert recording.on
    loop.tick(40)
    assert recording.seconds == pytest.approx(0.08)
    recording.stop()
    assert not recording.on
    assert loop.watch is None
    loop.tick(10)
    recording.close()
    (path,) = files(tmp_path / "new")
    assert recording.path == path
    assert re.fullmatch(r"recording-\d{4}-\d\d-\d\d-\d{6}\.mcap", path.name)
    log = read(path)
    assert log.whole
    assert log.ticks.tolist() == list(range(1, 41))
    assert log.run["title"] == f"recorded on the page, {ARM.title}"


def test_each_time_it_is_switched_on_makes_a_file(loop: SteppedLoop, tmp_path: Path) -> None:
    recording = LiveRecording(loop, tmp_path)
    for length in (5, 6, 7):
        start(recording, loop)
        loop.tick(length)
        recording.stop()
    recording.close()
    assert sorted(len(read(path).ticks) for path in files(tmp_path)) == [5, 6, 7]


def test_a_reset_goes_on_in_the_file_and_another_scenario_in_its_own(loop: SteppedLoop, tmp_path: Path) -> None:
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    loop.tick(20)
    loop.simulation = Simulation(ARM, loop.simulation.scenario, Settings())
    loop.tick(10)
    other = Scenario(
        payload_true=Load(mass=1.0), world=[BoxObject(name="block", position=[0.0, 0.5, 0.1], size=[0.1, 0.1, 0.1])], seed=5
    )
    loop.simulation = Simulation(ARM, other, Settings())
    loop.tick(15)
    recording.close()
    logs = {read(path).scenario.seed: read(path) for path in files(tmp_path)}
    assert logs[0].ticks.tolist() == list(range(1, 31))
    assert logs[5].ticks.tolist() == list(range(1, 16))
    assert logs[5].scenario.world[0].name == "block"


def test_a_disk_that_fails_ends_the_recording_and_the_loop_goes_on(
    loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    loop.tick(5)
    recorder = recording._recorder
    assert isinstance(recorder, Recorder)
    recorder.failure = SLOW
    loop.tick(5)
    assert not recording.on
    recording.close()
    until(lambda: "could not be written to its end (the disk is too slow)" in recording.failure, "it says so")
    recording.start()
    assert recording.failure == ""
    recording.close()


def test_a_folder_that_is_none_is_told(loop: SteppedLoop, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    recording = LiveRecording(loop, tmp_path / "file")
    recording.start()
    until(lambda: not recording.on, "it ended")
    assert "cannot be written" in recording.failure
    with pytest.raises(BadInput, match="cannot be written"):
        recording.start().result(10.0)


def test_a_tick_after_the_switch_was_thrown_is_let_go(loop: SteppedLoop, tmp_path: Path) -> None:
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    watch: Any = loop.watch
    recording.stop()
    watch(loop.simulation, loop.simulation.tick(IDLE))  # the loop was about to show it
    recording.close()
    assert files(tmp_path) == []  # one that holds nothing is not kept


def test_switched_off_before_the_file_is_open_it_stays_off(
    loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gate = threading.Event()
    monkeypatch.setattr(live, "Recorder", lambda *args, **named: gate.wait() and Recorder(*args, **named))
    recording = LiveRecording(loop, tmp_path)
    recording.start()
    recording.stop()
    gate.set()
    recording.close()
    assert not recording.on
    assert loop.watch is None
    assert files(tmp_path) == []


def test_another_scenario_that_cannot_be_written_ends_it(
    loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    loop.tick(5)
    monkeypatch.setattr(live, "free_path", lambda folder, *, parts: folder)
    loop.simulation = Simulation(ARM, Scenario(seed=5), Settings())
    loop.tick(2)
    assert not recording.on
    assert "cannot be written" in recording.failure
    recording.close()
    assert [len(read(path).ticks) for path in files(tmp_path)] == [5]
