"""Records a running loop, on a switch: a file each time that it is switched on, and for each scenario."""

import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from app.checked import BadInput
from app.log.recorder import Recorder
from pendant.decision import Decision
from pendant.modes import TICK
from sim.scenario import Scenario
from sim.simulation import Simulation


class Watched(Protocol):
    """What it needs of the loop, sim.loop.Loop."""

    watch: Callable[[Simulation, Decision], None] | None


class LiveRecording:
    """The switch. `start` and `stop` may be called from any thread; they wait for no file.

    A recording must never hold up the arm: a disk that is full or too slow ends the recording, and `failure` says so.

    Args:
        loop: what is recorded.
        folder: for the files; made when missing.
    """

    def __init__(self, loop: Watched, folder: Path) -> None:
        self._loop = loop
        self._folder = folder
        self._lock = threading.Lock()  # between the loop's thread and whoever switches; never held while a file is waited for
        self._recorder: Recorder | None = None
        self._scenario: Scenario | None = None  # of the file
        self._closers: list[threading.Thread] = []
        self.on = False
        self.path: Path | None = None  # of the last file
        self.failure = ""  # why the last recording ended by itself

    @property
    def seconds(self) -> float:
        """Recorded so far [s]."""
        recorder = self._recorder
        return 0.0 if recorder is None else recorder.ticks * TICK

    def start(self) -> None:
        """Record from the next tick on."""
        with self._lock:
            self.on, self.failure = True, ""
            self._loop.watch = self._see

    def stop(self) -> None:
        """Record no more, and let the file be ended."""
        with self._lock:
            self._stop()

    def close(self) -> None:
        """Record no more, and wait until the files are whole."""
        self.stop()
        for closer in self._closers:
            closer.join()

    def _stop(self) -> None:
        self.on = False
        self._loop.watch = None
        self._end_file()

    def _end_file(self) -> None:
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            self._closers = [closer for closer in self._closers if closer.is_alive()]
            self._closers.append(threading.Thread(target=self._close, args=(recorder,), name="recording-end"))
            self._closers[-1].start()

    def _close(self, recorder: Recorder) -> None:
        try:
            recorder.close()
        except BadInput as error:
            self.failure = str(error)

    def _see(self, simulation: Simulation, decision: Decision) -> None:
        """On the loop's thread."""
        with self._lock:
            if not self.on:
                return
            if simulation.scenario is not self._scenario:
                self._end_file()
            recorder = self._recorder or self._begin_file(simulation)
            if recorder is None or recorder.failure is not None:
                self._stop()
            else:
                recorder.see(simulation, decision)

    def _begin_file(self, simulation: Simulation) -> Recorder | None:
        self.path = self._free_path()
        self._scenario = simulation.scenario
        try:
            self._recorder = Recorder(self.path, simulation, f"recorded on the page, {simulation.arm.title}", waits=False)
        except BadInput as error:
            self.failure = str(error)
        return self._recorder

    def _free_path(self) -> Path:
        stem = time.strftime("recording-%Y-%m-%d-%H%M%S")
        path, number = self._folder / f"{stem}.mcap", 1
        while path.exists():
            number += 1
            path = self._folder / f"{stem}-{number}.mcap"
        return path


def must_be_writable(folder: Path) -> None:
    """Make a folder for recordings; BadInput when it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise BadInput("serve", "--record", folder, f"a folder that can be written ({error.strerror})") from None
