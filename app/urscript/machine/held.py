"""A thread of a script, and what its steps leave for the machine that runs them, and ask of it."""

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any, Protocol

from app.urscript.language.trouble import NOWHERE, Spot
from app.urscript.machine.analysis import Routine
from app.urscript.machine.expressions import Frame
from app.urscript.machine.values import Value

RETURN, CALL, WAIT, SYNC, JOIN, HALT = -1, -2, -3, -4, -5, -6
"""What a step gives in place of the number of the next one."""

Step = Callable[[Frame], int]


class Halted(Exception):
    """The script has come to `halt`."""


@dataclass(slots=True, eq=False)
class Strand:
    """A thread of a script."""

    number: int
    routine: Routine
    frame: Frame
    pc: int = 0
    callers: list[tuple[Routine, int, Frame, int]] = field(default_factory=list)
    wait: Generator[None, None, Value] | None = None
    slot: int = 0  # for the result of what it waits for
    where: Spot = NOWHERE  # of what it waits for
    function: str = ""  # that it waits in
    joins: int = 0  # the thread that it waits for
    ran: int = 0  # the tick in which it ran last
    parent: int = 0  # the thread that started it
    spent: int = 0  # steps since time passed for it


class Held(Protocol):
    """What steps leave for the machine, and ask of it."""

    globals: list[Value]
    called: tuple[Routine, Frame, int]
    waiting: tuple[Any, int, Spot, str]
    joined: int

    def start(self, routine: Routine, frame: Frame, place: Spot) -> int:
        """Start a thread; its number."""
        ...

    def kill(self, thread: Value, place: Spot) -> None:
        """End a thread."""
        ...

    def critical(self, inside: bool) -> None:
        """A part begins or ends in which no other thread runs unless this one waits."""
        ...

    def made(self, value: Value, place: Spot) -> None:
        """A list or a text is kept."""
        ...
