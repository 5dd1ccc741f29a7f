"""Records a run: copies a tick's numbers on the simulation's thread, and has them packed and written on one of its own."""

import errno
import math
import queue
import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

import numpy as np

from app.files.checked import ABSENT, BadInput
from app.files.disk_room import must_go_on
from app.log import layout
from app.log.layout import STATE, TRUTH
from app.log.recording_plan import ALL, RecordingPlan
from app.log.writer import Block, Picture, TickRows, Writer
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.limits.parameters import PARAMETERS
from pendant.program.steps import ProgramState
from pendant.tick.modes import Mode, Phase, Safety
from sim.exchange.recorded_rows import fill_rows
from sim.exchange.told_force import told_force
from sim.run.loop import SNAPSHOT_TICKS
from sim.run.troubles import reason_of
from sim.simulation import Simulation

BLOCK = 125
"""Ticks that are written at a time: a quarter of a second."""

THIN_BLOCK = 500
"""The same of a recording that is thinned: a second."""

AHEAD = 40
"""Blocks that may wait for a slow disk."""

MODES = {mode: number for number, mode in enumerate(Mode)}
SAFETIES = {safety: number for number, safety in enumerate(Safety)}
PHASES = {phase: number for number, phase in enumerate(Phase)}
PROGRAMS = {state: number for number, state in enumerate(ProgramState)}
AT = {row.text: number for number, row in enumerate(PARAMETERS.values())}
SLOW = OSError(errno.ETIMEDOUT, "the disk is too slow")


class Recorder:
    """Writes log.mcap of one simulation. Call `see` after each tick, on the simulation's thread, and `close` at the end.

    The first tick that it sees is the log's tick 1, or follows the last one of the file before it.

    Args:
        path: of the file; one that is there is replaced.
        simulation: what is to be recorded; it may have run already.
        title: of the session.
        waits: for a disk that is too slow; otherwise that ends the recording.
        planned: how long the run is to last [s]; None: nobody knows.
        failed: called once, on any thread, when the recording ends before its time.
        plan: how often what is recorded.
        part: of which recording the file is which part, counted from 1; None: it is all of it.

    Attributes:
        failure: what ended the recording before its time.

    Raises:
        BadInput: the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        simulation: Simulation,
        title: str,
        *,
        waits: bool = True,
        planned: float | None = None,
        failed: Callable[[], object] = lambda: None,
        plan: RecordingPlan = ALL,
        part: tuple[str, int] | None = None,
    ) -> None:
        self.path = path
        self.failure: Exception | None = None
        self._waits, self._failed, self._plan = waits, failed, plan
        self._n = n = simulation.arm.n
        notes: dict[str, str] = {} if planned is None else {"planned": f"{planned:g}"}
        if part is not None:
            notes |= {"recording": part[0], "part": str(part[1])}
        self._writer = Writer(path, simulation, title, notes=notes, thinned=plan.thinned)
        self._watched = path.is_file()  # a device has no room that could be looked at
        self._vectors = layout.width(STATE, n) - 2 * len(AT)  # numbers before those of monitored parameters
        self._offset, self._last, self._before = 0, 0, 0  # of the log's ticks over the simulation's; last one; of the file before
        self._thin = plan.state > 1 or plan.truth > 1
        self._length = THIN_BLOCK if self._thin else BLOCK
        self._one = (np.zeros((1, layout.width(STATE, n))), np.zeros((1, layout.width(TRUTH, n))))  # rows on their way
        self._drawn = 0
        self._full = 1  # the first tick goes by itself, so that a log can be shown as soon as it is there
        self._begin()
        self._settings.append((0, simulation.settings))
        self._queue: queue.Queue[Block | None] = queue.Queue(AHEAD)
        self._thread = threading.Thread(target=self._write, name="recorder", daemon=True)
        self._thread.start()

    @property
    def ticks(self) -> int:
        """Ticks seen."""
        return self._last - self._before

    @property
    def last(self) -> int:
        """The last tick, counted from the beginning of the recording."""
        return self._last

    def follow(self, last: int) -> None:
        """Go on where the file before ended, with that tick; before the first one is seen."""
        self._last = self._before = last
        self._settings = [(last, settings) for _, settings in self._settings]

    def problem(self, error: Exception) -> BadInput:
        """What is said of a failure."""
        reason = error.strerror if isinstance(error, OSError) and error.strerror else reason_of(error)
        return BadInput(str(self.path), "", ABSENT, f"could not be written to its end ({reason})")

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def see(self, simulation: Simulation, decision: Decision) -> None:
        """Record the tick that `simulation` has just done; after a reset its ticks count on."""
        tick = self._offset + simulation.tick_count
        if tick <= self._last or self._last == self._before:
            tick = self._last + 1
            self._offset = tick - simulation.tick_count
        self._last = tick
        if self._thin:
            self._take_some(simulation, decision, tick)
        else:
            self._take(simulation, decision, tick, known=self._numbers, truth=self._truth, k=len(self._codes))
            self._truth_ticks = self._ticks
        if simulation.tick_count % SNAPSHOT_TICKS == 1:
            if self._drawn % (self._plan.pictures // SNAPSHOT_TICKS) == 0:
                self._draw(simulation, decision, tick)
            self._drawn += 1
        for event in decision.events:
            self._events.append((tick, event))
            if event.kind is Kind.SETTING_CHANGED:
                self._settings.append((tick, simulation.settings))
        self._count += 1
        if self._count == self._full:
            self._hand_over()
            self._full = self._length

    def _draw(self, simulation: Simulation, decision: Decision, tick: int) -> None:
        plant = simulation.plant
        user = told_force(simulation.arm, simulation.estimate, decision)
        gripper = None if simulation.gripper is None else simulation.gripper.state
        poses = (plant.poses(), plant.object_poses(), plant.payload.pose())
        self._pictures.append(Picture(tick, decision, *poses, plant.payload.load.mass, plant.hands.touched, user, gripper))

    def note(self, event: Event) -> None:
        """Record what no tick told, as of the last tick seen."""
        self._events.append((self._last, event))

    def close(self) -> None:
        """Write what is left and the end of the file.

        Raises:
            BadInput: the file could not be written; what was written before is whole.
        """
        self._hand_over()
        self._queue.put(None)
        self._thread.join()
        if self.failure is not None:
            raise self.problem(self.failure)

    def _begin(self) -> None:
        n, length, plan = self._n, self._length, self._plan
        rows = length // plan.state + 1, length // plan.truth + 1
        self._count = 0  # ticks
        self._ticks: list[int] = []
        self._truth_ticks: list[int] = []
        self._numbers = np.full((rows[0], layout.width(STATE, n)), math.nan)
        self._codes: list[tuple[int, ...]] = []
        self._truth = np.zeros((rows[1], layout.width(TRUTH, n)))
        self._pictures: list[Picture] = []
        self._events: list[tuple[int, Event]] = []
        self._settings: list[tuple[int, Settings]] = []

    def _hand_over(self) -> None:
        known, true = len(self._ticks), len(self._truth_ticks)
        block = Block(
            TickRows(np.array(self._ticks, dtype=np.uint64), self._numbers[:known]),
            self._codes,
            TickRows(np.array(self._truth_ticks, dtype=np.uint64), self._truth[:true]),
            self._pictures,
            self._events,
            self._settings,
        )
        if self.failure is None and not self._waits and self._queue.full():
            self._fail(SLOW)
        if self.failure is None:
            self._queue.put(block)
        self._begin()

    def _take(
        self, simulation: Simulation, decision: Decision, tick: int, *, known: np.ndarray, truth: np.ndarray, k: int
    ) -> None:
        """Write a tick into row k of both."""
        e = simulation.estimate
        fill_rows(
            e,
            simulation.plant,
            gain=decision.gain,
            configured=simulation.fitting.mass,
            pull=decision.pull,
            known=known,
            truth=truth,
            k=k,
        )
        if decision.monitored:
            row, at = known[k], self._vectors
            for monitored in decision.monitored:
                number = AT.get(monitored.name)
                if number is not None:
                    row[at + number] = monitored.value
                    row[at + len(AT) + number] = monitored.limit
        valid = e.joints_valid + 2 * e.wrench_valid + 4 * e.acceleration_valid
        states = (MODES[decision.mode], SAFETIES[decision.safety], PHASES[decision.phase], PROGRAMS[decision.program])
        self._codes.append((*states, min(decision.step, 255), valid))
        self._ticks.append(tick)

    def _take_some(self, simulation: Simulation, decision: Decision, tick: int) -> None:
        """Write a tick where it is one of those that are kept."""
        known, true = (tick - 1) % self._plan.state == 0, (tick - 1) % self._plan.truth == 0
        if not known and not true:
            return
        row, truth = self._one
        row[:] = math.nan
        kept = len(self._ticks)
        self._take(simulation, decision, tick, known=row, truth=truth, k=0)
        if known:
            self._numbers[kept] = row[0]
        else:
            self._codes.pop()
            self._ticks.pop()
        if true:
            self._truth[len(self._truth_ticks)] = truth[0]
            self._truth_ticks.append(tick)

    def _fail(self, error: Exception) -> None:
        self.failure = error
        self._failed()

    def _write(self) -> None:
        """The recorder's own thread."""
        while (block := self._queue.get()) is not None:
            if self.failure is not None:
                continue
            try:
                self._writer.pack(block)
                if self._watched:
                    must_go_on(self.path.parent, self._writer.end)
            except Exception as error:  # noqa: BLE001 - whatever it is, nothing of it may go without a word
                self._writer.abandon()
                self._fail(error)
        if self.failure is None:
            try:
                self._writer.close()
            except Exception as error:  # noqa: BLE001
                self._writer.abandon()
                self._fail(error)
