"""A loop without physics: joints that circle on command, phases that can be set, and the calls of sim.run.loop.Loop."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.files.library import load_arm
from app.robot_interface.controller.callers import at_once
from pendant.all_settings import Settings
from pendant.decision import Decision, EstimatorCommand
from pendant.equipment.tools import Tool
from pendant.events.event import Event, Kind, Values
from pendant.freedrive.periods import Remaining
from pendant.guided.pull import PullCauses
from pendant.limits.axis_locks import AxisLocks
from pendant.limits.nearness import Nearness
from pendant.program.steps import ProgramState
from pendant.tick.estimate import Estimate
from pendant.tick.limit_engine import Monitored
from pendant.tick.modes import TICK_RATE, Law, Mode, Phase, Safety
from pendant.tooling.payload_wizard import IDLE
from pendant.tooling.tool_in_use import Fitting
from pendant.walls.barrier import Place
from pendant.walls.containment import WallState
from pendant.walls.definitions import AnyBorder
from sim.arm.frames import joint_frames, quaternion_from_matrix
from sim.arm.scenario import Load, Scenario, table
from sim.exchange.desk import Desk
from sim.exchange.snapshot import Snapshot
from sim.exchange.told_force import UncertainForce
from sim.run.between_ticks import BetweenTicks
from sim.run.event_log import EventLog
from sim.run.troubles import Troubles
from sim.simulation import Simulation

T = TypeVar("T")

ARM = load_arm("ur5e")
HOME = np.array(ARM.chain.home)


def links(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """(8, 7) foot, the six joint frames, the flange."""
    frames = [np.eye(4), *joint_frames(ARM, q)]
    return np.array([[*frame[:3, 3], *quaternion_from_matrix(frame[:3, :3])] for frame in frames])


def estimate(q: NDArray[np.float64]) -> Estimate:
    """An estimate at rest."""
    zero = np.zeros(6)
    return Estimate(
        0,
        True,
        True,
        True,
        q,
        zero,
        zero,
        q,
        zero,
        zero,
        zero,
        zero,
        zero,
        zero,
        np.zeros(3),
        np.zeros(3),
        np.eye(3),
        zero,
        0.0,
        0.0,
        0,
    )


class FakeLoop:
    """Same calls as sim.run.loop.Loop; `advance` instead of a thread."""

    def __init__(self) -> None:
        self.desk = Desk()
        self.watch: Any = None
        self.failure = ""
        self.speed = 1.0
        self.paused = False
        self.actual_rate = 1.0
        self.dropped = 0.0
        self.seed = 7
        self.settings = Settings()
        self.scenario = Scenario()
        self.begun: list[Any] = []
        self.tick = 0
        self.mode = Mode.TEACH
        self.safety = Safety.NORMAL
        self.law = Law.HOLD
        self.phase = Phase.OFF
        self.periods: tuple[Remaining, ...] = ()
        self.monitored: tuple[Monitored, ...] = ()
        self.configured = 0.0
        self.fitting: Fitting | None = None
        self.wizard = IDLE
        self.zero: tuple[float, ...] = (0.0,) * 6
        self.zero_due = False
        self.table: tuple[Tool, ...] = ()
        self.locks: AxisLocks | None = None
        self.singularity: Nearness | None = None
        self.payload = 0.0
        self.q = HOME.copy()
        self.program = ProgramState.NONE
        self.step = 0  # of the program
        self.outputs: frozenset[int] = frozenset()
        self.states: tuple[WallState, ...] = ()
        self.borders: tuple[AnyBorder, ...] | None = None
        self.places: tuple[tuple[AnyBorder, Place], ...] = ()
        self.touches: tuple[Any, ...] = ()
        self.pull: PullCauses | None = None
        self.user: UncertainForce | None = None
        self.log = EventLog()
        self.between = BetweenTicks()
        self.troubles = Troubles(self.tell)
        self.wishes: list[Any] = []
        self.resets = 0
        self.steps = 0

    @property
    def simulation(self) -> Simulation:
        """One of the scenario, at its start."""
        return Simulation(ARM, self.scenario, self.settings)

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The table: the scenario's until the test gives another."""
        return self.table or tuple(table(self.scenario))

    @property
    def payload_true(self) -> Load:
        """What the test says that is attached."""
        return Load(mass=self.payload)

    @property
    def walls(self) -> tuple[AnyBorder, ...]:
        """The list: the scenario's until the test gives another."""
        return tuple(self.scenario.walls) if self.borders is None else self.borders

    def advance(self, seconds: float = 0.002) -> None:
        """Let simulated time pass and read the desk once."""
        self.between.do()
        self.tick += max(1, round(seconds * TICK_RATE))
        self.wishes.append(self.desk.take())

    def note(self, kind: Kind, **values: float | int | str | bool) -> None:
        """Log an event."""
        self.log.extend([Event(kind, self.tick, dict(values))])

    def refuse(self) -> None:
        """Refuse a changed setting."""
        self.note(Kind.SETTING_REFUSED, name="x", value=0.0, reason="locked")

    def latest(self) -> Snapshot:
        """The newest snapshot."""
        decision = Decision(
            self.mode,
            self.safety,
            self.phase,
            self.law,
            None,
            1.0,
            50.0,
            (0.0,) * 6,
            self.periods,
            (),
            monitored=self.monitored,
            estimator=EstimatorCommand(self.fitting, self.zero),
            wizard=self.wizard,
            zero_due=self.zero_due,
            locks=self.locks,
            singularity=self.singularity,
            walls=self.states,
            program=self.program,
            step=self.step,
            outputs=self.outputs,
        )
        seen = estimate(self.q)
        poses, nothing = links(self.q), np.zeros((0, 7))
        return Snapshot(
            self.tick,
            decision,
            seen,
            poses,
            nothing,
            None,
            self.payload,
            self.configured,
            self.touches,
            scenario=self.scenario,
            places=self.places,
            pull=self.pull,
            user=self.user,
        )

    def events(self, since: int) -> list[Event]:
        """Events from index `since` on."""
        return self.log.since(since)

    def between_ticks(self, work: Callable[[], T]) -> "Future[T]":
        """Keep it until `advance`."""
        return self.between.ask(work)

    def tell(self, kind: Kind, values: Values) -> None:
        """Log an event that no tick decides."""
        self.log.extend([Event(kind, self.tick, values)])

    def start(self) -> None:
        """Nothing runs."""

    def stop(self) -> None:
        """Nothing runs."""

    def step_once(self) -> None:
        """Count the steps asked for."""
        self.steps += 1

    def reset(self) -> "Future[None]":
        """Count the resets asked for."""
        self.resets += 1
        return at_once(lambda: None)

    def begin(self, make: Any, write: Any = None) -> "Future[None]":
        """Keep what was to begin."""
        self.begun.append((make, write))
        return at_once(lambda: None)
