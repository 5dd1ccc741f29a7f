"""What the control channel needs of the loop, sim.run.loop.Loop."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Protocol

from pendant.all_settings import Settings
from pendant.events.event import Event
from sim.arm.scenario import Scenario
from sim.run.beginnings import Script
from sim.run.troubles import Troubles
from sim.simulation import Simulation


class ServedLoop(Protocol):
    """The running simulation."""

    speed: float
    paused: bool
    failure: str  # why nothing is simulated; empty while something is
    troubles: Troubles  # what around it does not work

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        ...

    @property
    def scenario(self) -> Scenario:
        """What it started from."""
        ...

    @property
    def settings(self) -> Settings:
        """The pendant's settings as they are now."""
        ...

    def events(self, since: int) -> list[Event]:
        """Events from index `since` on."""
        ...

    def step_once(self) -> None:
        """While paused: one tick."""
        ...

    def reset(self) -> "Future[None]":
        """Back to the scenario's start."""
        ...

    def begin(self, make: Callable[[], Simulation], write: Callable[[], Script] | None = None) -> "Future[None]":
        """Go over to another simulation at the next tick."""
        ...
