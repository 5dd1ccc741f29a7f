"""Enumerations of words that are looked up in every tick; the changes of a list, in words."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Protocol


class Word(StrEnum):
    """A StrEnum whose members are found in sets and tables as fast as the text that they are."""

    __hash__ = str.__hash__


class Named(Protocol):
    """A value whose name is unique in its list."""

    @property
    def name(self) -> str:
        """Its name."""
        ...


def difference(before: Sequence[Named], after: Sequence[Named]) -> str:
    """The changes of a list, in words. A single changed value is named, several are counted."""
    old, new = ({each.name: each for each in values} for values in (before, after))
    done = {
        "added": [name for name in new if name not in old],
        "changed": [name for name in new if name in old and new[name] != old[name]],
        "deleted": [name for name in old if name not in new],
    }
    count = sum(map(len, done.values()))
    if count == 0:
        return "in another order"
    return ", ".join(f"{names[0] if count == 1 else len(names)} {what}" for what, names in done.items() if names)
