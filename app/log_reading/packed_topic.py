"""A topic whose messages are rows of numbers: /state or /truth, read as numpy tables with a column a name."""

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.log.foxglove import NANOSECONDS
from app.log.layout import LATER, WORDS, Field, record
from app.mcap_file.chunk_table import ChunkTable
from app.mcap_file.runs import Runs
from app.mcap_file.topic_messages import Messages

Table = NDArray[Any]
"""Whole message records, one a row."""


class PackedTopic:
    """Of one file.

    Args:
        table: of the file.
        topic: its name.
        fields: that it has.
        n: joints.
        codes: bytes that follow the numbers.

    Raises:
        ValueError: the file's topic is not like that.
        BadInput: the file is damaged.
        KeyError: it has no such topic.
    """

    def __init__(self, table: ChunkTable, topic: str, fields: tuple[Field, ...], n: int, *, codes: tuple[str, ...] = ()) -> None:
        self.topic = topic
        self._codes = codes
        written = _written(table, topic)
        known = {name for name, _ in written}
        self._sizes = {each.name: each.size or n for each in fields}
        wanted = {name: size for name, size in self._sizes.items() if name not in LATER or name.lower() in known}
        if written != [(name.lower(), size) for name, size in wanted.items()]:
            raise ValueError(f"{topic} has other columns")
        self._kind = record(sum(wanted.values()), len(codes))
        self._at: dict[str, int] = {}  # of each name that the file has: where its numbers begin
        for name in wanted:
            self._at[name] = sum(self._sizes[before] for before in self._at)
        self._messages = Messages(table, topic, NANOSECONDS)
        self.ticks = self._messages.times
        must_rise(self.ticks, topic)

    @property
    def names(self) -> tuple[str, ...]:
        """Of its columns."""
        return (*self._sizes, *self._codes)

    @property
    def row_bytes(self) -> int:
        """Of a row in memory [bytes]."""
        return self._kind.itemsize

    def rows(self, begin: int, end: int) -> Table:
        """Rows `begin` to before `end`. Raises BadInput: they are damaged; ValueError: they are not as they should be."""
        found = self._messages.rows(begin, end, self._kind)
        if not bool(np.all(found["tick"] * np.uint64(NANOSECONDS) == found["log_time"])):
            raise ValueError(f"{self.topic} has ticks at other times")
        for i, code in enumerate(self._codes):
            words = WORDS.get(code, ())
            if words and len(found) and int(found["codes"][:, i].max()) >= len(words):
                raise ValueError(f"{self.topic} has a {code} that does not exist")
        return found

    def column(self, table: Table, name: str) -> NDArray[Any]:
        """A column of rows: (k,) or (k, size); not a number in all where the file is older than the column.

        Raises:
            KeyError: there is none of this name.
        """
        if name in self._codes:
            return table["codes"][:, self._codes.index(name)]
        size = self._sizes[name]
        if name not in self._at:
            return np.full((len(table), size)[: 1 if size == 1 else 2], np.nan)
        at = self._at[name]
        return table["numbers"][:, at] if size == 1 else table["numbers"][:, at : at + size]


def must_rise(ticks: Runs, topic: str) -> None:
    """Raise ValueError where the ticks of a topic do not rise."""
    found = ticks.all()
    if len(found) and (found[0] < 1 or not bool(np.all(np.diff(found) > 0))):
        raise ValueError(f"the ticks of {topic} do not rise")


def _written(table: ChunkTable, topic: str) -> list[tuple[str, int]]:
    """Names and sizes, as the file's own schema has them."""
    schema = table.schemas.get(table.channels[table.channel_of(topic)].schema_id)
    if schema is None:
        raise ValueError(f"{topic} has no schema")
    text = schema.data.decode()
    return [(name, int(size or 1)) for size, name in re.findall(r"^float64(?:\[(\d{1,3})\])? (\w+)", text, re.MULTILINE)]
