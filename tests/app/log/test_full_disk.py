"""A disk that is full: looked at before, told at once, and what was written can be read.

The file's size is limited for a process of its own, which to whoever writes is a disk that is full.
"""

import errno
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from app.files import disk_room
from app.files.checked import BadInput
from app.log.live import LiveRecording
from app.log.recorder import Recorder
from app.log_reading.reader import read
from app.mcap_file.mending import repair
from pendant.all_settings import Settings
from pendant.events.event import Kind
from sim.arm.scenario import Scenario
from sim.simulation import Simulation
from tests.app.log.test_live import ARM, IDLE, SteppedLoop, start
from tests.app.web.raw_client import until


@pytest.fixture
def loop() -> SteppedLoop:
    return SteppedLoop()


def room(monkeypatch: pytest.MonkeyPatch, left: int) -> None:
    monkeypatch.setattr(disk_room, "free", lambda folder: left)


def test_a_recording_on_a_full_disk_is_refused(loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    room(monkeypatch, disk_room.TO_BEGIN - 1)
    recording = LiveRecording(loop, tmp_path / "new")
    with pytest.raises(BadInput, match=r"room = '50.0 MB': a disk with 50 MB of room"):
        recording.start().result(10.0)
    assert (recording.on, recording.path, loop.watch) == (False, None, None)
    assert "room" in recording.failure
    assert list(tmp_path.iterdir()) == []
    loop.tick(1)
    assert [event.kind for event in loop.log.since(0)] == [Kind.RECORDING_BROKEN]
    room(monkeypatch, disk_room.TO_BEGIN)
    assert recording.start().result(10.0).exists()
    assert recording.failure == ""
    recording.close()


def test_a_disk_that_fills_up_ends_it_in_order_with_an_event(
    loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    loop.tick(200)
    room(monkeypatch, disk_room.TO_GO_ON // 2)
    until(lambda: (loop.tick(1), not recording.on)[1], "it ends")
    loop.tick(1)
    recording.close()
    (event,) = [event for event in loop.log.since(0) if event.kind is Kind.RECORDING_BROKEN]
    assert "the disk is full, but for 5.0 MB" in str(event.values["reason"])
    assert "the disk is full, but for 5.0 MB" in recording.failure
    (path,) = tmp_path.glob("*.mcap")
    assert event.values["file"] == path.name
    log = read(path)
    assert (log.whole, log.missing) == (True, ""), "there was room for its end"
    assert len(log) > 200


def test_it_is_told_while_no_tick_comes_too(loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Paused: nothing is recorded that would meet the failure."""
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    room(monkeypatch, 0)
    loop.tick(1)  # goes to the disk by itself
    until(lambda: (loop.tick(0), not recording.on)[1], "it ends")
    loop.tick(0)
    assert [event.kind for event in loop.log.since(0)] == [Kind.RECORDING_BROKEN]
    recording.close()


def test_whatever_fails_in_the_recorders_thread_ends_it(
    loop: SteppedLoop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An error other than the disk's ended the thread without a word, and the recording seemed to go on."""
    recording = LiveRecording(loop, tmp_path)
    start(recording, loop)
    loop.tick(1)
    recorder = recording._recorder
    assert isinstance(recorder, Recorder)

    def broken(block: object) -> None:
        raise ZeroDivisionError("no such number")

    monkeypatch.setattr(recorder._writer, "pack", broken)
    loop.tick(130)
    until(lambda: (loop.tick(1), not recording.on)[1], "it ends")
    assert "ZeroDivisionError: no such number" in recording.failure
    recording.close()


LIMITED = """
import json, resource, sys, time
from pathlib import Path
from app.files.checked import BadInput
from app.log.live import LiveRecording
from tests.app.log.test_live import SteppedLoop
loop = SteppedLoop()
loop.tick(10)  # all modules and kernels are there: what is kept of them would be cut, too
sys.dont_write_bytecode = True
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), int(sys.argv[2])))
recording = LiveRecording(loop, Path(sys.argv[1]))
try:
    recording.start().result(20.0)
except BadInput as refusal:
    print(json.dumps({"refused": str(refusal)}))
    sys.exit()
while recording.on and recording.seconds < 10.0:
    loop.tick(10)
    time.sleep(0.002)
loop.tick(1)
recording.close()
events = [event for event in loop.log.since(0) if event.kind == "recording_broken"]
print(json.dumps({"seconds": recording.seconds, "failure": recording.failure, "events": [e.values for e in events]}))
"""


def limited(folder: Path, size: int) -> dict[str, Any]:
    """What becomes of a recording whose file may have so many bytes."""
    command = [sys.executable, "-c", LIMITED, str(folder), str(size)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    return dict(json.loads(done.stdout.strip().splitlines()[-1]))


@pytest.mark.parametrize("size", [0, 5, 3_000, 1_000_003, 1_400_000, 2_000_001])
def test_full_at_any_byte_it_says_so_and_can_be_read(tmp_path: Path, size: int) -> None:
    """0.5 MB a second: before its channels are there, within its first block, and later."""
    told = limited(tmp_path, size)
    found = list(tmp_path.glob("*.mcap"))
    if "refused" in told:
        assert "cannot be written (File too large)" in told["refused"]
        assert size < 20_000
        assert found == []
        return
    assert "File too large" in told["failure"]
    assert [event["file"] for event in told["events"]] == [found[0].name]
    log = read(found[0])
    assert log.ticks.tolist() == list(range(1, len(log) + 1))
    assert log.whole or "it is cut after" in log.missing or len(log) == 0
    assert len(log.state["q"]) == len(log)
    assert repair(found[0]) == (not log.whole)
    assert len(read(found[0])) == len(log)


def test_a_session_that_cannot_be_recorded_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = Simulation(ARM, Scenario(), Settings())
    recorder = Recorder(tmp_path / "log.mcap", simulation, "t")
    room(monkeypatch, 0)
    recorder.see(simulation, simulation.tick(IDLE))
    end = time.monotonic() + 10.0
    while recorder.failure is None and time.monotonic() < end:
        time.sleep(0.01)
    with pytest.raises(BadInput, match="could not be written to its end"):
        recorder.close()
    assert isinstance(recorder.failure, OSError)
    assert recorder.failure.errno == errno.ENOSPC
