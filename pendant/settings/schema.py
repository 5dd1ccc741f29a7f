"""What settings are made of: numbers with a range, counts, switches, choices and limits, each with unit and a line of text."""

from enum import Enum
from typing import Annotated, ClassVar, NamedTuple

import msgspec
from msgspec import Meta

from pendant.tick.modes import TICK_RATE

Value = float | bool | str


class SettingError(ValueError):
    """A setting that does not exist, or a value that it does not allow."""

    def __init__(self, name: str, value: object, allowed: str) -> None:
        super().__init__(f"{name}: {value!r} is not allowed; allowed: {allowed}")
        self.name = name
        self.value = value
        self.allowed = allowed


class SettingRow(NamedTuple):
    """What a page or a document shows of a setting."""

    name: str  # dotted
    default: Value
    low: float | None  # range; None for switches and choices
    high: float | None
    unit: str
    id: str  # requirement
    text: str
    locked: bool  # a limit: not changed in FREE_DRIVE and RUN
    basic: bool  # shown to everybody; the others are for experts

    @property
    def choices(self) -> tuple[str, ...]:
        """What a choice may be; empty for the others."""
        return tuple(word.value for word in type(self.default)) if isinstance(self.default, Enum) else ()

    @property
    def is_switch(self) -> bool:
        """It is on or off."""
        return isinstance(self.default, bool)

    @property
    def is_count(self) -> bool:
        """It is a whole number."""
        return isinstance(self.default, int) and not self.is_switch


def number(low: float, high: float, unit: str, ident: str, *, text: str, locked: bool = True) -> Meta:
    """A number from `low` to `high`."""
    return Meta(ge=low, le=high, description=text, extra={"unit": unit, "id": ident, "locked": locked})


def count(low: int, high: int, ident: str, *, text: str) -> Meta:
    """A whole number from `low` to `high`."""
    return Meta(ge=low, le=high, description=text, extra={"unit": "", "id": ident, "locked": True})


def switch(ident: str, text: str, locked: bool = True) -> Meta:
    """On or off."""
    return Meta(description=text, extra={"unit": "", "id": ident, "locked": locked})


def choice(ident: str, text: str, *, locked: bool = True) -> Meta:
    """One word of an enumeration."""
    return switch(ident, text, locked)


def limit(low: float, high: float, unit: str, ident: str, *, text: str) -> Meta:
    """Of a `Limit`: the range of its `max`."""
    return Meta(description=text, extra={"unit": unit, "id": ident, "low": low, "high": high})


class Section(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all sections."""

    BASIC: ClassVar[tuple[str, ...]] = ()
    """The fields that everybody is shown; the others are for experts."""


class Limit(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One cell of the table of limits (FD-25)."""

    max: float
    time: Annotated[float, number(0.0, 2.0, "s", "FD-12a", text="allowed time beyond")] = 0.0
    on: Annotated[bool, switch("FD-25", "checked")] = True


def ticks(seconds: float) -> int:
    """Whole control ticks of a period, rounded to the nearest."""
    return round(seconds * TICK_RATE)
