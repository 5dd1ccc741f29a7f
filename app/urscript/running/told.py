"""What a script tells: people, clients, the page."""

from enum import StrEnum
from typing import NamedTuple

from app.urscript.language.trouble import NOWHERE, Spot


class Telling(StrEnum):
    """Kind of what is told."""

    STARTED = "started"
    ENDED = "ended"
    TEXT = "text"
    POPUP = "popup"
    QUESTION = "question"  # a program waits for a value; `level` is its kind
    TROUBLE = "trouble"  # it cannot be read, or cannot go on
    ASIDE = "trouble beside"  # a secondary program cannot go on


class Told(NamedTuple):
    """One message."""

    kind: Telling
    text: str
    name: str = ""  # of the program
    place: Spot = NOWHERE  # in its text
    title: str = ""  # of a popup
    level: str = ""  # of a popup: "", "warning", "error"
    words: str = ""  # of trouble: how a robot says it, where clients compare that; "" for `text`


def printable(text: str) -> str:
    """A script's text without what terminals and pages could take for more than text."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text)
