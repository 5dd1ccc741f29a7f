"""The paced loop: ticks a simulation in a thread of its own, in step with the clock, and never chases a debt."""

import gc
import logging
import os
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from typing import TypeVar

from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.equipment.tools import Tool
from pendant.events.event import Event, Kind, Values
from pendant.tick.modes import TICK, TICK_RATE
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Desk
from sim.exchange.snapshot import Snapshot
from sim.run.beginnings import Beginnings, Origin, Script
from sim.run.between_ticks import BetweenTicks
from sim.run.event_log import EventLog
from sim.run.lateness import Lateness
from sim.run.troubles import Troubles, reason_of
from sim.simulation import Simulation

SNAPSHOT_TICKS = 8
"""A snapshot every 16 ms: one for each frame of a 60 Hz picture."""

DEBT = 0.05
"""Lateness up to which the loop catches up [s]; what is beyond is dropped, and told once a spell (sim.run.lateness)."""

RATE_TICKS = TICK_RATE // 2  # the actual rate is a mean over this many ticks
SWITCH_INTERVAL = 5e-4  # [s] Python's default of 5 ms would let a busy web thread hold up two ticks
DEBT_NAP = 1e-3  # after a dropped debt [s]: a loop that cannot keep up must leave the others some of the processor
PAUSE_NAP = 0.01  # between looks at the desk while paused [s]

T = TypeVar("T")


class Loop:
    """Runs `make()`'s simulation in real time, or slower.

    Its thread is the one writer of what it ticks. Other threads read values that it replaces whole, and hand over what they want:
    wishes by the desk, other work by `between_ticks`, another simulation by `begin` (docs/explanation/threads.md).

    Args:
        make: builds the simulation; called again by `reset`, so that a reset leads back to the scenario's very start.
    """

    def __init__(self, make: Callable[[], Simulation]) -> None:
        self._origin = Origin(make)
        self._beginnings, self._between = Beginnings(), BetweenTicks()
        self._script: Script | None = None
        self.simulation = make()
        self.desk = Desk()
        self.watch: Callable[[Simulation, Decision], None] | None = None  # shown each tick done, on the loop's thread
        self.companion: Script | None = None  # acts beside desk and script, and stays through a reset: the network interfaces
        self.speed = 1.0
        self.paused = False
        self.actual_rate = 0.0
        self.lateness: deque[float] = deque(maxlen=60 * TICK_RATE)  # of each tick's start [s], for measurements
        self.dropped = 0.0  # debt dropped so far [s]
        self._spell = Lateness()
        self._steps = threading.Semaphore(0)  # single steps asked for and not done yet
        self._stop = threading.Event()
        self.log = EventLog()
        self.troubles = Troubles(self.tell)
        self._snapshot: Snapshot | None = None
        self._thread = threading.Thread(target=self._run, name="simulation", daemon=True)
        self.failure = ""  # why the arm stands and nothing is simulated, until the next start

    @property
    def seed(self) -> int:
        """Seed of the running scenario."""
        return self.simulation.scenario.seed

    @property
    def scenario(self) -> Scenario:
        """What the running simulation started from."""
        return self.simulation.scenario

    @property
    def settings(self) -> Settings:
        """The pendant's settings as they are now."""
        return self.simulation.settings

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The pendant's table of tools as it is now."""
        return self.simulation.tools

    @property
    def payload_true(self) -> Load:
        """What is truly attached beyond the tool, without what a gripper holds."""
        return self.simulation.plant.payload.own

    @property
    def walls(self) -> tuple[AnyBorder, ...]:
        """The pendant's walls and areas as they are now."""
        return self.simulation.walls

    def start(self) -> None:
        """Start the thread; returns once the first tick is done."""
        sys.setswitchinterval(SWITCH_INTERVAL)
        self._do_tick()
        gc.collect()
        gc.freeze()  # the model and the modules never become garbage: collections stay short
        self._thread.start()

    def stop(self, patience: float | None = None) -> None:
        """Stop the thread and wait for it, for so long at most [s]; what waits for a tick is given up."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(patience)
        self._between.close()
        self._beginnings.close()

    def latest(self) -> Snapshot:
        """The newest snapshot.

        Raises:
            RuntimeError: the loop has not been started.
        """
        if self._snapshot is None:
            raise RuntimeError("the loop has not been started")
        return self._snapshot

    def events(self, since: int) -> list[Event]:
        """Events from index `since` on, in order; a reset keeps those that were."""
        return self.log.since(since)

    def between_ticks(self, work: Callable[[], T]) -> "Future[T]":
        """Have `work` done on the loop's thread between two ticks, also while it is paused or has broken down."""
        return self._between.ask(work)

    def tell(self, kind: Kind, values: Values) -> None:
        """Log an event that no tick decides, such as a disk that is full; from any thread."""
        self._between.ask(lambda: self.log.note(Event(kind, self.simulation.plant.tick, values)))

    def step_once(self) -> None:
        """While paused: do one tick. Otherwise nothing."""
        if self.paused:
            self._steps.release()

    def reset(self) -> "Future[None]":
        """Go back to the scenario's start at the next tick; after a failure to that of the last simulation that began.

        Walls and areas stay as they are: a reset takes no protection away. Returns as `begin`.
        """
        return self._beginnings.ask(self._origin)

    def begin(self, make: Callable[[], Simulation], write: Callable[[], Script] | None = None) -> "Future[None]":
        """Go over to another simulation at the next tick; a later `reset` leads back to its start.

        Args:
            make: builds it.
            write: gives the script that is to act in it, beside whoever is at the desk; called anew at each start.

        Returns:
            See `Beginnings.ask`.
        """
        return self._beginnings.ask(Origin(make, write))

    def _start_over(self, origin: Origin) -> None:
        walls = self.simulation.walls if origin is self._origin else None  # what was made meanwhile stays through a reset
        self.simulation = origin.make()
        self._origin = origin
        self.failure = ""
        gc.collect()  # the one before holds megabytes that are not Python's, and would wait long to be found
        self._script = origin.write() if origin.write is not None else None
        self.desk.clear()
        if walls is not None and walls != self.simulation.walls:
            self.desk.fence(walls)
        self._do_tick()

    def _do_tick(self) -> None:
        wishes = self.desk.take()
        script, tick = self._script, self.simulation.tick_count + 1
        if script is not None:
            wishes = wishes.joined(script.wishes(tick, self.simulation.snapshot))
        if (companion := self.companion) is not None:
            wishes = wishes.joined(companion.wishes(tick, self.simulation.snapshot))
        decision = self.simulation.tick(wishes)
        if script is not None:
            script.see(tick, decision)
        if companion is not None:
            companion.see(tick, decision)
        if (watch := self.watch) is not None:
            watch(self.simulation, decision)
        if decision.events:
            self.log.extend(decision.events)
        if self.simulation.plant.tick % SNAPSHOT_TICKS == 1:
            self._snapshot = self.simulation.snapshot()

    def _stand(self) -> None:
        """Paused: do a step that was asked for, else show where the arm stands, else wait."""
        self.actual_rate = 0.0
        if self._steps.acquire(blocking=False):
            self._do_tick()
        elif self._snapshot is None or self._snapshot.tick != self.simulation.plant.tick:
            self._snapshot = self.simulation.snapshot()
        else:
            time.sleep(PAUSE_NAP)

    def _run(self) -> None:
        _ask_for_real_time()
        while not self._stop.is_set():
            try:
                self._pace()
            except Exception as error:  # noqa: BLE001 - whatever it is, the page must say so
                self._break_down(error)

    def _break_down(self, error: Exception) -> None:
        """The last line of defence: the arm stays where it is, and why is told, until somebody starts over."""
        logging.getLogger(__name__).error("the simulation broke down", exc_info=error)
        self.actual_rate = 0.0
        self.failure = reason_of(error)
        event = Event(Kind.BROKEN_DOWN, self.simulation.plant.tick, {"reason": self.failure})
        self.log.note(event)
        while not self._beginnings.waiting and not self._stop.is_set():
            self.desk.clear()
            self._between.do()
            time.sleep(PAUSE_NAP)

    def _pace(self) -> None:
        due = time.perf_counter()
        since, ticks, spell = due, 0, self._spell
        while not self._stop.is_set():
            if spell.times and spell.over(time.perf_counter()):
                self._tell_spell()
            if self._between.waiting:
                self._between.do()
            if self._beginnings.waiting and self._beginnings.begin(self._start_over):
                due = time.perf_counter()
            if self.paused:
                self._stand()
                due = since = time.perf_counter()
                ticks = 0
                continue
            length = TICK / self.speed
            now = time.perf_counter()
            if now < due:
                time.sleep(due - now)
                now = time.perf_counter()
            late = now - due
            self.lateness.append(late)
            due += length
            if late > DEBT:
                self.dropped += late
                due = now + length
                spell.drop(late, now)
                time.sleep(DEBT_NAP)
            self._do_tick()
            ticks += 1
            if ticks == RATE_TICKS:
                now = time.perf_counter()
                self.actual_rate = ticks * TICK / (now - since)
                since, ticks = now, 0
        if spell.times:
            self._tell_spell()

    def _tell_spell(self) -> None:
        self.log.extend((self._spell.tell(self.simulation.plant.tick),))


def _ask_for_real_time() -> None:
    """Let this thread run before others as soon as its tick is due, where the system allows that; elsewhere it takes its turn."""
    if hasattr(os, "sched_setscheduler"):
        with suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(1))
