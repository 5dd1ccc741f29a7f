"""The columns of a recording by their names, read when they are asked for."""

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.log_reading.log_file import LogFile
from app.log_reading.packed_topic import PackedTopic, Table

WHOLE = 64_000_000
"""A table of this size or less is read at once, with all of its columns [bytes]."""

KEPT = 96_000_000
"""Columns of a longer one are kept up to this size in all, and the last one in any case [bytes]."""

BLOCK = 20_000
"""Rows of a long table that are in memory at a time while a column is read."""


class Stretch(NamedTuple):
    """Rows of one file."""

    file: LogFile
    begin: int
    end: int

    @property
    def length(self) -> int:
        """How many they are."""
        return self.end - self.begin


class Columns(Mapping[str, NDArray[Any]]):
    """Arrays by name with a row a tick: (k,) or (k, size).

    A long recording is gone through anew for each column; `Log.stretches` goes through it once for all.

    Args:
        stretches: of the files, in order.
        topic: which one of theirs.

    Raises:
        BadInput: what is asked for is damaged.
    """

    def __init__(self, stretches: Sequence[Stretch], topic: Literal["state", "truth"]) -> None:
        self._stretches, self._topic = tuple(stretches), topic
        self._length = sum(each.length for each in stretches)
        self._first = self._packed(self._stretches[0])
        self._table: Table | None = None
        self._kept: OrderedDict[str, NDArray[Any]] = OrderedDict()

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._first.names:
            raise KeyError(name)
        if self._length * self._first.row_bytes <= WHOLE:
            return self._first.column(self._whole(), name)
        found = self._kept.pop(name, None)
        if found is None:
            found = self._read(name)
        self._kept[name] = found
        while len(self._kept) > 1 and sum(each.nbytes for each in self._kept.values()) > KEPT:
            self._kept.popitem(last=False)
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._first.names)

    def __len__(self) -> int:
        return len(self._first.names)

    def row(self, k: int) -> dict[str, Any]:
        """All columns in one row, and its `tick`; little is read for that."""
        for stretch in self._stretches:
            if k < stretch.length:
                table = self._table[k : k + 1] if self._table is not None else self._rows(stretch, k, k + 1)
                packed = self._packed(stretch)
                return {"tick": int(table["tick"][0]), **{name: packed.column(table, name)[0] for name in packed.names}}
            k -= stretch.length
        raise IndexError(k)

    def sampled(self, every: int) -> dict[str, NDArray[Any]]:
        """All columns in each `every`th row; little is read for that where these are few."""
        if self._table is not None or self._length * self._first.row_bytes <= WHOLE:
            table = self._whole()[::every]
        else:
            found, at = list[Table](), 0
            for stretch in self._stretches:
                found += [self._rows(stretch, k, k + 1) for k in range(-at % every, stretch.length, every)]
                at += stretch.length
            table = np.concatenate(found)
        return {name: self._first.column(table, name) for name in self._first.names}

    def _whole(self) -> Table:
        if self._table is None:
            tables = [self._rows(each, 0, each.length) for each in self._stretches]
            self._table = tables[0] if len(tables) == 1 else np.concatenate(tables)
        return self._table

    def _read(self, name: str) -> NDArray[Any]:
        out: NDArray[Any] | None = None
        at = 0
        for stretch in self._stretches:
            for begin in range(0, stretch.length, BLOCK):
                end = min(begin + BLOCK, stretch.length)
                found = self._packed(stretch).column(self._rows(stretch, begin, end), name)
                if out is None:
                    out = np.empty((self._length, *found.shape[1:]), dtype=found.dtype)
                out[at : at + len(found)] = found
                at += len(found)
        assert out is not None
        return out

    def _rows(self, stretch: Stretch, begin: int, end: int) -> Table:
        read = stretch.file.state_rows if self._topic == "state" else stretch.file.truth_rows
        return read(stretch.begin + begin, stretch.begin + end)

    def _packed(self, stretch: Stretch) -> PackedTopic:
        return stretch.file.state if self._topic == "state" else stretch.file.truth
