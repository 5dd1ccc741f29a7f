"""What settings are made of: numbers with a range, switches and limits, each with unit, requirement and a line of text."""

from typing import Annotated, NamedTuple

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
    low: float | None  # range, None for switches
    high: float | None
    unit: str
    id: str  # requirement
    text: str
    locked: bool  # a limit: not changed in FREE_DRIVE and RUN


def number(low: float, high: float, unit: str, ident: str, *, text: str, locked: bool = True) -> Meta:
    """A number from `low` to `high`."""
    return Meta(ge=low, le=high, description=text, extra={"unit": unit, "id": ident, "locked": locked})


def switch(ident: str, text: str, locked: bool = True) -> Meta:
    """On or off."""
    return Meta(description=text, extra={"unit": "", "id": ident, "locked": locked})


def limit(low: float, high: float, unit: str, ident: str, *, text: str) -> Meta:
    """Of a `Limit`: the range of its `max`."""
    return Meta(description=text, extra={"unit": unit, "id": ident, "low": low, "high": high})


class Section(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all sections."""


class Limit(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One cell of the table of limits (FD-25)."""

    max: float
    time: Annotated[float, number(0.0, 2.0, "s", "FD-12a", text="allowed time beyond")] = 0.0
    on: Annotated[bool, switch("FD-25", "checked")] = True


def ticks(seconds: float) -> int:
    """Whole control ticks of a period, rounded to the nearest."""
    return round(seconds * TICK_RATE)
