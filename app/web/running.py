"""What the page needs of the loop, sim.run.loop.Loop."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Protocol, TypeVar

from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.equipment.tools import Tool
from pendant.events.event import Event, Kind, Values
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Desk
from sim.exchange.snapshot import Snapshot
from sim.run.beginnings import Script
from sim.run.event_log import EventLog
from sim.run.troubles import Troubles
from sim.simulation import Simulation

T = TypeVar("T")


class Running(Protocol):
    """The running simulation."""

    desk: Desk
    speed: float
    paused: bool
    watch: Callable[[Simulation, Decision], None] | None  # shown each tick
    dropped: float  # time that it was too late for, so far [s]
    failure: str  # why nothing is simulated; empty while something is
    log: EventLog
    troubles: Troubles  # what around it does not work

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        ...

    @property
    def actual_rate(self) -> float:
        """Simulated over real time, as it was lately."""
        ...

    @property
    def seed(self) -> int:
        """Seed of the scenario."""
        ...

    @property
    def scenario(self) -> Scenario:
        """What the running simulation started from."""
        ...

    @property
    def settings(self) -> Settings:
        """The pendant's settings as they are now."""
        ...

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The pendant's table of tools as it is now."""
        ...

    @property
    def payload_true(self) -> Load:
        """What is truly attached beyond the tool, without what a gripper holds."""
        ...

    @property
    def walls(self) -> tuple[AnyBorder, ...]:
        """The pendant's walls and areas as they are now."""
        ...

    def latest(self) -> Snapshot:
        """The newest snapshot."""
        ...

    def events(self, since: int) -> list[Event]:
        """Events from index `since` on."""
        ...

    def step_once(self) -> None:
        """While paused: one tick."""
        ...

    def between_ticks(self, work: Callable[[], T]) -> "Future[T]":
        """Have `work` done on the loop's thread."""
        ...

    def tell(self, kind: Kind, values: Values) -> None:
        """Log an event that no tick decides."""
        ...

    def reset(self) -> "Future[None]":
        """Back to the scenario's start."""
        ...

    def begin(self, make: Callable[[], Simulation], write: Callable[[], Script] | None = None) -> "Future[None]":
        """Go over to another simulation at the next tick, with a script that acts in it."""
        ...
