"""A row of the event table: effect on the mode, severity, texts, and what clears it."""

from collections.abc import Mapping
from enum import IntEnum, StrEnum
from types import MappingProxyType
from typing import NamedTuple

from pendant.tick.limit_engine import Excess


class Effect(StrEnum):
    """What an event does to the mode; all that state machines ask of an event."""

    INFO = "INFO"  # nothing
    TO_TEACH = "TO_TEACH"  # the mode is TEACH; a program is given up
    TRY = "TRY"  # the arm is freed for the activation sequence; a running program pauses
    ENTER = "ENTER"  # free-drive begins
    NO_ENTRY = "NO_ENTRY"  # free-drive is refused, the mode stays
    LEAVE = "LEAVE"  # free-drive ends, back to the remembered mode
    LEAVE_TO_STOP = "LEAVE_TO_STOP"  # free-drive ends in STOP
    SAFEGUARD_STOP = "SAFEGUARD_STOP"  # STOP, safety SAFEGUARD_STOP
    PROTECTIVE_STOP = "PROTECTIVE_STOP"  # STOP, safety PROTECTIVE_STOP
    EMERGENCY_STOP = "EMERGENCY_STOP"  # STOP, safety EMERGENCY_STOP


LEAVING = frozenset({Effect.LEAVE, Effect.LEAVE_TO_STOP, Effect.SAFEGUARD_STOP, Effect.PROTECTIVE_STOP, Effect.EMERGENCY_STOP})
"""Effects that end free-drive."""


class Severity(IntEnum):
    """How loud an interface shows it."""

    INFO = 0
    NOTICE = 1
    WARNING = 2
    STOP = 3


class Clears(StrEnum):
    """What takes a shown event away."""

    NEXT = "next"  # the next event
    COOL_DOWN = "cool-down"  # the end of the cool-down
    RESET = "reset"  # a reset, and nothing else


class EventRow(NamedTuple):
    """What an event of one kind does and says. Texts name the event's values in braces."""

    effect: Effect
    severity: Severity
    headline: str
    guidance: str
    keys: tuple[str, ...] = ()  # the values that the event carries
    clears: Clears = Clears.NEXT
    cool_down: bool = False  # starts the cool-down (FD-12c)
    variant: tuple[str, str] | None = None  # a value of the event, and the guidance instead of the other where it is true
    category: int = 2  # of the stop, where it stops: 0 power off at once, 1 off at standstill, 2 stays on
    words: Mapping[str, str] = MappingProxyType({})  # what the texts call a value that is a name of the program's own
    reaction: str = ""  # what it does besides its effect on the mode, in sentences
    way_out: str = ""  # how its cause goes away, in sentences, where the guidance alone does not say it


WALL = ("wall", "part", "distance", "way", "x", "y", "z", "px", "py", "pz")
"""Values of an event of a wall: its name, the part, how far out [mm], the way back in words and as a direction of length 1 (zeros
where it cannot be told), the part's place [m]; both in B."""


EXCESS = Excess._fields
"""Values of an event of a limit."""


def info(headline: str, guidance: str = "", keys: tuple[str, ...] = (), *, reaction: str = "", way_out: str = "") -> EventRow:
    """Told, and without an effect on the mode."""
    return EventRow(Effect.INFO, Severity.INFO, headline, guidance, keys, reaction=reaction, way_out=way_out)


def refused(headline: str, guidance: str, keys: tuple[str, ...], *, way_out: str = "") -> EventRow:
    """Free-drive is refused; its cool-down begins."""
    return EventRow(
        Effect.NO_ENTRY, Severity.WARNING, headline, guidance, keys, Clears.COOL_DOWN, cool_down=True, way_out=way_out
    )


def left(headline: str, guidance: str, keys: tuple[str, ...] = (), severity: Severity = Severity.NOTICE) -> EventRow:
    """Free-drive is left; its cool-down begins."""
    return EventRow(Effect.LEAVE, severity, headline, guidance, keys, Clears.COOL_DOWN, cool_down=True)


def stopped(headline: str, guidance: str, keys: tuple[str, ...] = ()) -> EventRow:
    """Free-drive ends in STOP."""
    return EventRow(Effect.LEAVE_TO_STOP, Severity.STOP, headline, guidance, keys, Clears.RESET, cool_down=True)


def protected(
    headline: str, guidance: str, keys: tuple[str, ...], *, category: int = 2, variant: tuple[str, str] | None = None
) -> EventRow:
    """A protective stop of this category."""
    return EventRow(
        Effect.PROTECTIVE_STOP,
        Severity.STOP,
        headline,
        guidance,
        keys,
        Clears.RESET,
        cool_down=True,
        variant=variant,
        category=category,
    )


def denied(headline: str, guidance: str, keys: tuple[str, ...] = (), *, reaction: str = "", way_out: str = "") -> EventRow:
    """Something is not possible, or not as it should be."""
    return EventRow(Effect.INFO, Severity.WARNING, headline, guidance, keys, reaction=reaction, way_out=way_out)
