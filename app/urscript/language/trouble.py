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
        words: how a robot says it, where clients compare its words; "" for the sentence.
    """

    def __init__(self, place: Spot, text: str, words: str = "") -> None:
        super().__init__(f"line {place.line}, column {place.column}: {text}")
        self.place, self.text, self.words = place, text, words


def not_found(place: Spot, name: str, text: str) -> ScriptTrouble:
    """A name that is not known, in the words of a robot (UR client library, test_primary_client.cpp)."""
    return ScriptTrouble(place, text, f"compile_error_name_not_found:{name}:")


class Misuse(ValueError):
    """A function that comes with the language cannot do what it was called for; whoever called it knows the place."""
