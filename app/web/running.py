"""What the page needs of the loop, sim.run.loop.Loop."""

from collections.abc import Callable
from typing import Protocol

from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.equipment.tools import Tool
from pendant.events.event import Event
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import Scenario
from sim.exchange.desk import Desk
from sim.exchange.snapshot import Snapshot
from sim.run.loop import Script
from sim.simulation import Simulation


class Running(Protocol):
    """The running simulation."""

    desk: Desk
    speed: float
    paused: bool
    watch: Callable[[Simulation, Decision], None] | None  # shown each tick
    dropped: float  # time that it was too late for, so far [s]
    failure: str  # why nothing is simulated; empty while something is
    ended: Callable[[Event], None] | None  # told why no tick follows

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

    def reset(self) -> None:
        """Back to the scenario's start."""
        ...

    def begin(self, make: Callable[[], Simulation], write: Callable[[], Script] | None = None) -> None:
        """Go over to another simulation at the next tick, with a script that acts in it."""
        ...
