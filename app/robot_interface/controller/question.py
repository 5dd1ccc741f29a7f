"""A question that a program asks people, and how their answer is read."""

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(slots=True, eq=False)
class Question:
    """What a program asks people for."""

    kind: str  # "boolean", "integer", "float" or "string"
    text: str
    answer: bool | int | float | str | None = None

    def take(self, text: str) -> None:
        """Answer it. Raises ValueError: this is no value of the kind that is asked for."""
        read, expected = ANSWERS[self.kind]
        try:
            self.answer = read(text)
        except (ValueError, KeyError):
            raise ValueError(f"expected {expected}") from None


def _whole(text: str) -> int:
    value = int(text)
    if not -(1 << 31) <= value < 1 << 31:
        raise ValueError
    return value


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError
    return value


def _short(text: str) -> str:
    if len(text) > LONGEST_ANSWER:
        raise ValueError
    return text


LONGEST_ANSWER = 1023
"""Characters of a text, as of a string in a program."""

ANSWERS: dict[str, tuple[Callable[[str], bool | int | float | str], str]] = {
    "boolean": (lambda text: {"true": True, "false": False}[text.lower()], "true or false"),
    "integer": (_whole, "a whole number of 32 bits"),
    "float": (_finite, "a finite number"),
    "string": (_short, f"a text of {LONGEST_ANSWER} characters at most"),
}
"""How an answer to a question of each kind is read, and what is expected."""
