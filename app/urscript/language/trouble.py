"""What is wrong with a script, and where."""

from typing import NamedTuple


class Spot(NamedTuple):
    """A place in a script's text; both count from 1."""

    line: int
    column: int


NOWHERE = Spot(1, 1)


class ScriptTrouble(Exception):
    """A script cannot be read, or cannot go on.

    Args:
        place: in its text.
        text: one sentence, without the place.
    """

    def __init__(self, place: Spot, text: str) -> None:
        super().__init__(f"line {place.line}, column {place.column}: {text}")
        self.place, self.text = place, text


class Misuse(ValueError):
    """A function that comes with the language cannot do what it was called for; whoever called it knows the place."""
