"""Stores whole numbers in little memory, as runs of equal steps. The times of a topic are mostly a single run."""

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.int64]

LONGEST_STEP = 1 << 14
"""Largest step that is looked for."""


class Runs:
    """Numbers, kept as runs of equal steps.

    Args:
        numbers: (n,).
    """

    def __init__(self, numbers: Numbers) -> None:
        self._length = len(numbers)
        steps = np.diff(numbers)
        self._step = max(1, int(np.bincount(np.clip(steps, 0, LONGEST_STEP)).argmax())) if len(steps) else 1
        begins = np.flatnonzero(np.concatenate(([True], steps != self._step))) if self._length else np.zeros(0, dtype=np.int64)
        self._rows = begins  # place of each run's first number
        self._first: Numbers = numbers[begins].astype(np.int64)
        self._counts = np.diff(np.append(begins, self._length))

    def __len__(self) -> int:
        return self._length

    def between(self, begin: int, end: int) -> Numbers:
        """The numbers from place `begin` to before `end`."""
        places = np.arange(begin, max(begin, end), dtype=np.int64)
        run = np.searchsorted(self._rows, places, side="right") - 1
        return self._first[run] + (places - self._rows[run]) * self._step

    def all(self) -> Numbers:
        """All numbers."""
        return self.between(0, self._length)

    def at_or_before(self, numbers: Numbers) -> NDArray[np.int64]:
        """If the stored numbers rise: for each of `numbers` the place of the last stored one that is not larger; -1: all are
        larger."""
        if not self._length:
            return np.full(len(numbers), -1, dtype=np.int64)
        run = np.searchsorted(self._first, numbers, side="right") - 1
        within = np.minimum((numbers - self._first[run]) // self._step, self._counts[run] - 1)
        return np.where(run < 0, -1, self._rows[run] + within)
