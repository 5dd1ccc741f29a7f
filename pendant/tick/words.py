"""Enumerations of words that are looked up in every tick."""

from enum import StrEnum


class Word(StrEnum):
    """A StrEnum whose members are found in sets and tables as fast as the text that they are."""

    __hash__ = str.__hash__
