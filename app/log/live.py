"""Records a running loop, on a switch: a file each time that it is switched on, and for each scenario."""

import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Protocol

from app.files.checked import ABSENT, BadInput
from app.files.disk_room import must_have_room
from app.log.recorder import Recorder
from app.log.recording_paths import discard, free_path, part
from app.log.recording_plan import ALL, RecordingPlan
from pendant.decision import Decision
from pendant.events.event import Event, Kind, Values
from pendant.tick.modes import TICK, TICK_RATE
from sim.arm.scenario import Scenario
from sim.run.event_log import EventLog
from sim.run.troubles import Troubles, reason_of
from sim.simulation import Simulation

READY = 5 * TICK_RATE
"""Ticks before the end of a file in which the next one is opened."""


class Watched(Protocol):
    """What it needs of the loop, sim.run.loop.Loop."""

    watch: Callable[[Simulation, Decision], None] | None
    log: EventLog
    troubles: Troubles

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        ...

    def between_ticks(self, work: Callable[[], None]) -> "Future[None]":
        """Have `work` done on the loop's thread."""
        ...

    def tell(self, kind: Kind, values: Values) -> None:
        """Log an event that no tick decides."""
        ...


class LiveRecording:
    """The switch. `start` and `stop` may be called from any thread; they wait for no file.

    A recording must never hold up the arm: files are opened and ended on threads of their own, but for another scenario's.
    One that cannot be written ends with an event, and `failure` says why.

    Args:
        loop: what is recorded.
        folder: for the files; made when missing.
        plan: how often what is recorded, and how long a file is.

    Attributes:
        on: it records, or is about to.
        path: of the last recording: a file, or the folder of its parts.
        failure: why the last recording ended by itself, or "".
    """

    def __init__(self, loop: Watched, folder: Path, plan: RecordingPlan = ALL) -> None:
        self._loop = loop
        self.folder, self.plan = folder, plan
        self._lock = threading.Lock()  # of all that follows; never held while a file is waited for, but for another scenario's
        self._recorder: Recorder | None = None
        self._scenario: Scenario | None = None  # of the file
        self._next: Recorder | None = None  # the file that follows, ready
        self._asked = False  # for it
        self._opening: Future[Path] = Future()  # of the file of the last start
        self._helpers: list[threading.Thread] = []  # that open or end files
        self.on = False
        self.path: Path | None = None
        self.failure = ""
        loop.log.listen(self._note)

    @property
    def seconds(self) -> float:
        """Recorded so far [s]."""
        recorder = self._recorder
        return 0.0 if recorder is None else recorder.last * TICK

    @property
    def writing(self) -> str:
        """Name of the recording that is not whole yet, or "" where all are."""
        with self._lock:
            busy = self.on or any(helper.is_alive() for helper in self._helpers)
            return self.path.name if busy and self.path is not None else ""

    def start(self) -> "Future[Path]":
        """Record, as soon as the file is open.

        Returns:
            The recording's path, when it is; BadInput where it cannot be written, or the disk has no room.
        """
        with self._lock:
            if not self.on:
                self.on, self.failure, self._opening = True, "", Future()
                self._help(self._begin, self._opening)
            return self._opening

    def stop(self) -> None:
        """Record no more, and let the file be ended."""
        with self._lock:
            self._stop()

    def close(self, patience: float | None = None) -> None:
        """Record no more, and wait until the files are whole; `patience`: for so long at most [s]."""
        self.stop()
        until = None if patience is None else time.monotonic() + patience
        while until is None or time.monotonic() < until:
            with self._lock:
                helper = next((each for each in self._helpers if each.is_alive()), None)  # one may start another
            if helper is None:
                return
            helper.join(None if until is None else max(0.0, until - time.monotonic()))

    def _help(self, work: Callable[..., None], *what: object) -> None:
        self._helpers = [helper for helper in self._helpers if helper.is_alive()]
        self._helpers.append(threading.Thread(target=work, args=what, name="recording", daemon=True))
        self._helpers[-1].start()

    def _begin(self, opening: "Future[Path]") -> None:
        simulation = self._loop.simulation
        try:
            must_have_room(self.folder)
            recorder = self._opened(simulation)
        except Exception as error:  # noqa: BLE001 - whoever asked has to know
            with self._lock:
                if self._opening is opening:
                    self._fail(error)
            opening.set_exception(error)
            return
        with self._lock:
            if self.on and self._opening is opening:
                self._recorder, self._scenario = recorder, simulation.scenario
                self._loop.watch = self._see
            else:
                self._help(self._end, recorder)
        opening.set_result(recorder.path if self.path is None else self.path)

    def _fail(self, error: Exception) -> None:
        """It cannot go on."""
        why = error if isinstance(error, BadInput) else BadInput(str(self.folder), "", ABSENT, reason_of(error))
        self.failure = str(why)
        self._loop.tell(Kind.RECORDING_BROKEN, {"file": Path(why.where).name, "reason": why.allowed})
        self._stop()

    def _stop(self) -> None:
        self.on = False
        self._loop.watch = None
        self._end_file()

    def _end_file(self) -> None:
        ended = (self._recorder, self._next)
        self._recorder = self._next = None
        for recorder in ended:
            if recorder is not None:
                self._help(self._end, recorder)

    def _end(self, recorder: Recorder) -> None:
        try:
            recorder.close()
        except BadInput as error:
            with self._lock:
                if not self.failure:
                    self._fail(error)
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
                try:
                    recorder = self._recorder = self._opened(simulation)
                except BadInput as error:
                    self._fail(error)
                    return
                self._scenario = simulation.scenario
            if recorder.failure is not None:
                self._fail(recorder.problem(recorder.failure))
                return
            recorder.see(simulation, decision)
            if self.plan.split and recorder.ticks >= self.plan.split - READY:
                self._follow(recorder)

    def _follow(self, recorder: Recorder) -> None:
        """Have the next file opened in time, and go over to it when this one is as long as it should be."""
        if not self._asked:
            self._asked = True
            self._help(self._open_next, recorder)
        if self._next is not None and recorder.ticks >= self.plan.split:
            self._next.follow(recorder.last)
            self._recorder, self._next, self._asked = self._next, None, False
            self._help(self._end, recorder)

    def _open_next(self, before: Recorder) -> None:
        try:
            recorder = self._part_of(self._loop.simulation, before.path.parent, int(before.path.stem) + 1)
        except Exception as error:  # noqa: BLE001
            with self._lock:
                self._fail(error)
            return
        with self._lock:
            if self._recorder is before:
                self._next = recorder
            else:
                self._help(self._end, recorder)

    def _look(self) -> None:
        """On the loop's thread: a file failed, also while no tick comes that would see it."""
        with self._lock:
            recorder = self._recorder
            if recorder is not None and recorder.failure is not None:
                self._fail(recorder.problem(recorder.failure))

    def _note(self, event: Event) -> None:
        """On the loop's thread: what no tick told stands in the file, too; one that ends the simulation ends the file with it."""
        with self._lock:
            if self._recorder is not None:
                self._recorder.note(event)
            if event.kind is Kind.BROKEN_DOWN:
                self._stop()

    def _opened(self, simulation: Simulation) -> Recorder:
        """The file of a new recording. Raises BadInput: it cannot be written."""
        path = free_path(self.folder, parts=bool(self.plan.split))
        self._asked = False
        try:
            recorder = self._part_of(simulation, path, 1) if self.plan.split else self._file(simulation, path, None)
        except BadInput:
            discard(path, parts=bool(self.plan.split))
            raise
        self.path = path
        return recorder

    def _part_of(self, simulation: Simulation, folder: Path, number: int) -> Recorder:
        return self._file(simulation, part(folder, number), (folder.name, number))

    def _file(self, simulation: Simulation, path: Path, of: tuple[str, int] | None) -> Recorder:
        return Recorder(
            path,
            simulation,
            f"recorded on the page, {simulation.arm.title}",
            waits=False,
            failed=lambda: self._loop.between_ticks(self._look),
            plan=self.plan,
            part=of,
        )
