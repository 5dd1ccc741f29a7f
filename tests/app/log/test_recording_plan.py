"""How often what is recorded, and in files of which length."""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.files.checked import BadInput
from app.log import live
from app.log.live import LiveRecording
from app.log.recorder import Recorder
from app.log.recording_plan import ALL, RecordingPlan, recording_plan
from app.log_reading.playback import Player, snapshot_at
from app.log_reading.reader import Log, read
from app.report.gathering import Gathered
from app.report.summary import summarise
from pendant.all_settings import Settings
from pendant.tick.modes import TICK
from sim.arm.scenario import Scenario
from sim.simulation import Simulation
from tests.app.log.test_live import ARM, IDLE, SteppedLoop, start


@pytest.fixture
def loop() -> SteppedLoop:
    return SteppedLoop()


def test_options_say_how_much_is_recorded() -> None:
    assert recording_plan(None, None) == ALL
    assert recording_plan("state=50, truth=10,pictures=5", 60.0) == RecordingPlan(10, 50, 96, 1_800_000)
    assert recording_plan("pictures=62.5", None) == ALL
    assert recording_plan("state=0.01", None).state == 50_000
    assert RecordingPlan(10, 1, 16).thinned == {"state": 10, "pictures": 16}


@pytest.mark.parametrize(
    ("rates", "split", "said"),
    [
        ("state", None, r"--record-rates: state: state=RATE, truth=RATE or pictures=RATE"),
        ("force=3", None, "--record-rates: force=3"),
        ("state=501", None, r"state = .*0.01 to 500 a second"),
        ("pictures=100", None, "0.01 to 62.5"),
        ("truth=0", None, "0.01 to 500"),
        ("truth=nan", None, "0.01 to 500"),
        (None, 0.0, "--record-split"),
        (None, 1441.0, "up to 1440"),
    ],
)
def test_what_cannot_be_is_one_line(rates: str | None, split: float | None, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        recording_plan(rates, split)


def recorded(path: Path, plan: RecordingPlan, count: int = 1300) -> Log:
    simulation = Simulation(ARM, Scenario(), Settings())
    with Recorder(path, simulation, "t", plan=plan) as recorder:
        for _ in range(count):
            recorder.see(simulation, simulation.tick(IDLE))
    return read(path)


def test_a_thinned_recording_has_what_it_says_and_nothing_else_is_missing(tmp_path: Path) -> None:
    whole = recorded(tmp_path / "whole.mcap", ALL)
    thin = recorded(tmp_path / "thin.mcap", RecordingPlan(state=10, truth=100, pictures=80))
    assert (whole.thinned, whole.missing, thin.missing) == ("", "", "")
    assert thin.thinned == "as was asked for, a second is in it /state 50 times, /truth 5 times, /pictures 6.25 times"
    assert thin.ticks.tolist() == list(range(1, 1301, 10))
    for name in ("q", "F_user", "mode", "limit_flange_speed"):
        np.testing.assert_array_equal(thin.state[name], whole.state[name][::10], err_msg=name)
    held = (thin.ticks - 1) // 100 * 100
    np.testing.assert_array_equal(thin.truth["flange"], whole.truth["flange"][held], err_msg="the last that was recorded")
    assert thin.picture_ticks.tolist() == list(range(1, 1301, 80))
    assert thin.events == whole.events
    assert summarise(Gathered(thin)).thinned == thin.thinned
    player = Player(thin)
    player.jump(1.0)
    assert snapshot_at(thin, player.picture, player.row).estimate.tick == 501
    assert (tmp_path / "thin.mcap").stat().st_size < 0.5 * (tmp_path / "whole.mcap").stat().st_size


def test_what_a_thinned_recording_lacks_beyond_that_is_said(tmp_path: Path) -> None:
    recorded(tmp_path / "thin.mcap", RecordingPlan(state=10, truth=10, pictures=80))
    data = (tmp_path / "thin.mcap").read_bytes()
    (tmp_path / "thin.mcap").write_bytes(data[: len(data) * 2 // 3])
    assert "it is cut after" in read(tmp_path / "thin.mcap").missing


def until(done: Callable[[], bool], loop: SteppedLoop) -> None:
    """Tick slowly, as a loop does, until something has come about."""
    end = time.monotonic() + 20.0
    while not done():
        loop.tick(1)
        assert time.monotonic() < end
        time.sleep(0.001)


def test_a_recording_in_parts_is_one_recording(loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "READY", 50)
    recording = LiveRecording(loop, tmp_path, RecordingPlan(split=200))
    start(recording, loop)
    assert recording.path is not None
    folder = recording.path
    assert (folder.is_dir(), recording.writing) == (True, folder.name)
    until(lambda: (folder / "003.mcap").exists() and recording.seconds > 1.0, loop)
    loop.tick(40)
    done = round(recording.seconds / TICK)
    recording.close()
    log = read(folder)
    assert (log.whole, log.missing) == (True, "")
    assert log.ticks.tolist() == list(range(1, done + 1)), "none is lost between two files, and none is twice"
    assert [read(path).ticks[0] for path in sorted(folder.iterdir())][1] > 200
    assert np.all(np.diff(log.picture_ticks) > 0)
    assert len(log.pictures) == len(log.frames) == len(log.picture_ticks)
    assert log.pictures[-1].tick == log.picture_ticks[-1]
    assert log.settings[0][0] == 0
    player = Player(log)
    for time_ in (0.1, 0.41, 0.9, player.end):
        player.jump(time_)
        shown = snapshot_at(log, player.picture, player.row)
        assert abs(shown.estimate.tick * TICK - player.time) < 0.003
    part = log.between(0.39, 0.41)
    assert part.ticks.tolist() == list(range(195, 205))
    one = [np.concatenate([read(path).state["q"] for path in sorted(folder.iterdir())]), log.state["q"]]
    np.testing.assert_array_equal(one[0], one[1])
    assert summarise(Gathered(log)).duration == pytest.approx(done * TICK)


def test_parts_that_are_not_of_one_recording_are_refused_and_one_that_is_gone_is_said(
    loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "READY", 50)
    recording = LiveRecording(loop, tmp_path, RecordingPlan(split=100))
    start(recording, loop)
    assert recording.path is not None
    folder = recording.path
    until((folder / "004.mcap").exists, loop)
    recording.close()
    (folder / "002.mcap").unlink()
    assert "s between 001.mcap and 003.mcap are not" in read(folder).missing
    assert read(folder / "003.mcap").missing == "", "a part alone is whole"
    recorded(folder / "002.mcap", ALL, 300)
    with pytest.raises(BadInput, match=r"'002.mcap': another part of the recording that 001.mcap begins"):
        read(folder)
    (tmp_path / "empty").mkdir()
    with pytest.raises(BadInput, match="a folder with the files of one"):
        read(tmp_path / "empty")


def test_another_scenario_begins_a_folder_of_its_own(loop: SteppedLoop, tmp_path: Path) -> None:
    recording = LiveRecording(loop, tmp_path, RecordingPlan(split=1000))
    start(recording, loop)
    loop.tick(20)
    loop.simulation = Simulation(ARM, Scenario(seed=5), Settings())
    loop.tick(10)
    recording.close()
    logs = {read(path).scenario.seed: len(read(path)) for path in tmp_path.iterdir()}
    assert logs == {0: 20, 5: 10}
