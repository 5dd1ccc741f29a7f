"""What the steps of a script leave for the machine that runs them, and ask of it."""

from typing import Any, Protocol

from app.urscript.language.trouble import Spot
from app.urscript.machine.analysis import Routine
from app.urscript.machine.expressions import Frame
from app.urscript.machine.values import Value


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
