"""Records a running loop, on a switch: a file each time that it is switched on, and for each scenario."""

import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from app.files.checked import BadInput
from app.log.recorder import Recorder
from pendant.decision import Decision
from pendant.events.event import Event
from pendant.tick.modes import TICK
from sim.arm.scenario import Scenario
from sim.simulation import Simulation


class Watched(Protocol):
    """What it needs of the loop, sim.run.loop.Loop."""

    watch: Callable[[Simulation, Decision], None] | None
    ended: Callable[[Event], None] | None

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        ...


class LiveRecording:
    """The switch. `start` and `stop` may be called from any thread; they wait for no file.

    A recording must never hold up the arm: files are opened and ended on threads of their own, but for another scenario's,
    and a disk that is full or too slow ends the recording; `failure` says so.

    Args:
        loop: what is recorded.
        folder: for the files; made when missing.
    """

    def __init__(self, loop: Watched, folder: Path) -> None:
        self._loop = loop
        self.folder = folder
        self._lock = threading.Lock()  # between the loop's thread and whoever switches; never held while a file is waited for
        self._recorder: Recorder | None = None
        self._scenario: Scenario | None = None  # of the file
        self._helpers: list[threading.Thread] = []  # that open or end files
        self.on = False
        self.path: Path | None = None  # of the last file
        self.failure = ""  # why the last recording ended by itself
        loop.ended = self._see_end

    @property
    def seconds(self) -> float:
        """Recorded so far [s]."""
        recorder = self._recorder
        return 0.0 if recorder is None else recorder.ticks * TICK

    @property
    def writing(self) -> str:
        """Name of the file that is not whole yet, or "" where all are."""
        busy = self.on or any(helper.is_alive() for helper in self._helpers)
        return self.path.name if busy and self.path is not None else ""

    def start(self) -> None:
        """Record, as soon as the file is open."""
        with self._lock:
            if not self.on:
                self.on, self.failure = True, ""
                self._help(self._begin)

    def stop(self) -> None:
        """Record no more, and let the file be ended."""
        with self._lock:
            self._stop()

    def close(self) -> None:
        """Record no more, and wait until the files are whole."""
        self.stop()
        while self._helpers:
            self._helpers.pop().join()

    def _help(self, work: Callable[..., None], *what: object) -> None:
        self._helpers = [helper for helper in self._helpers if helper.is_alive()]
        self._helpers.append(threading.Thread(target=work, args=what, name="recording"))
        self._helpers[-1].start()

    def _begin(self) -> None:
        simulation = self._loop.simulation
        recorder = self._opened(simulation)
        with self._lock:
            if recorder is None:
                self._stop()
            elif self.on and self._recorder is None:
                self._recorder, self._scenario = recorder, simulation.scenario
                self._loop.watch = self._see
            else:
                self._help(self._end, recorder)

    def _stop(self) -> None:
        self.on = False
        self._loop.watch = None
        self._end_file()

    def _end_file(self) -> None:
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            self._help(self._end, recorder)

    def _end(self, recorder: Recorder) -> None:
        try:
            recorder.close()
        except BadInput as error:
            self.failure = str(error)
        if recorder.ticks == 0:
            recorder.path.unlink(missing_ok=True)

    def _see(self, simulation: Simulation, decision: Decision) -> None:
        """On the loop's thread."""
        with self._lock:
            recorder = self._recorder
            if recorder is None:  # it was about to show this tick when the switch was thrown
                return
            if simulation.scenario is not self._scenario:
                self._end_file()
                self._recorder, self._scenario = self._opened(simulation), simulation.scenario
                recorder = self._recorder
            if recorder is None or recorder.failure is not None:
                self._stop()
            else:
                recorder.see(simulation, decision)

    def _see_end(self, event: Event) -> None:
        """On the loop's thread: nothing is simulated any more, so the file is ended with the cause."""
        with self._lock:
            if self._recorder is not None:
                self._recorder.note(event)
            self._stop()

    def _opened(self, simulation: Simulation) -> Recorder | None:
        path = self._free_path()
        try:
            recorder = Recorder(path, simulation, f"recorded on the page, {simulation.arm.title}", waits=False)
        except BadInput as error:
            self.failure = str(error)
            return None
        self.path = path
        return recorder

    def _free_path(self) -> Path:
        stem = time.strftime("recording-%Y-%m-%d-%H%M%S")
        path, number = self.folder / f"{stem}.mcap", 1
        while path.exists():
            number += 1
            path = self.folder / f"{stem}-{number}.mcap"
        return path


def must_be_writable(folder: Path) -> None:
    """Make a folder for recordings; BadInput when it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise BadInput("serve", "--record", folder, f"a folder that can be written ({error.strerror})") from None
