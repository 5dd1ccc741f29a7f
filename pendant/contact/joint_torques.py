"""The torques that joints feel of contacts, with what they may be wrong by, over the last ticks (CD-8)."""

import numpy as np
from numpy.typing import NDArray

from pendant.contact.history import MASK, SIZE

Array = NDArray[np.float64]


class Torques:
    """The last rows of m numbers, and means over any part of them from running sums; age 0 is the newest."""

    __slots__ = ("_at", "_sums", "count")

    def __init__(self) -> None:
        self._sums: Array = np.zeros((SIZE, 0))
        self._at = 0
        self.count = 0  # since the last gap, at most SIZE - 1

    def push(self, torques: Array) -> None:
        """Take one tick (m,)."""
        if self._sums.shape[1] != torques.size:
            self._sums, self.count = np.zeros((SIZE, torques.size)), 0
        before, self._at = self._at, (self._at + 1) & MASK
        self._sums[self._at] = self._sums[before] + torques
        self.count = min(self.count + 1, MASK)

    def gap(self) -> None:
        """A tick is missing: what was before it counts no more."""
        self._sums[self._at] = 0.0
        self.count = 0

    def mean(self, age: int, length: int) -> Array:
        """Mean (m,) of `length` ticks, the newest of them `age` ticks old; age + length <= count."""
        sums = self._sums
        return (sums[(self._at - age) & MASK] - sums[(self._at - age - length) & MASK]) / length
