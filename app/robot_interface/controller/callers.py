"""Who uses the cabinet: what they ask of the robot, and how they are told of its ticks."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol, TypeVar

from app.session.actions import Action
from pendant.events.event import Event
from pendant.inputs import Command
from pendant.program.steps import Program
from sim.arm.scenario import Load

T = TypeVar("T")


class Between(Protocol):
    """Has work done on the loop's thread between two ticks (sim.run.loop.Loop)."""

    def __call__(self, work: Callable[[], T]) -> "Future[T]":
        """Hand it over; the result is what it gives."""
        ...


def at_once(work: Callable[[], T]) -> "Future[T]":
    """For a robot that is ticked by whoever asks: there is no other thread."""
    future: Future[T] = Future()
    future.set_result(work())
    return future


class Listener(Protocol):
    """Who is told of every tick, on the loop's thread."""

    def tick(self, number: int) -> None:
        """A tick is done; `number` counts all of them, through resets too."""
        ...

    def told(self, event: Event) -> None:
        """Something happened in it."""
        ...

    def repeat(self) -> None:
        """No tick has been done for a while: say how it stands."""
        ...

    def again(self) -> None:
        """The loop is busy: send what was sent last once more; from any thread."""
        ...


@dataclass(slots=True)
class Ask:
    """What a client asks the robot for, for one tick: the next, or the first in which the arm stands still."""

    commands: tuple[Command, ...] = ()
    settings: dict[str, float | bool | str] = field(default_factory=dict)
    program: Program | None = None
    load: Load | None = None
    idle: bool | None = None  # drives on with closed brakes, or no more; None: as it is
    standing: bool = False  # a robot takes it only where the arm stands
    waited: int = 0  # ticks for that
    done: "Future[tuple[Event, ...]]" = field(default_factory=Future)  # the events of that tick


class Act(NamedTuple):
    """Actions that wait for the next tick."""

    actions: Sequence[Action]
    begun: "Future[int]"  # the tick from which their times count
