"""Texts in the picture that keep apart."""

from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDE, HIGH = 0.25, 0.05
"""Two texts whose places are nearer than this, sideways and in height, lie over each other: 16 letters, seen from 2 m [m]."""


class Labels:
    """Of texts that would lie over each other the later ones stand higher. Lives on viser's event loop.

    Args:
        labels: by precedence; each has its place in W, and whoever made it may move it at any time.
    """

    def __init__(self, labels: Sequence[viser.LabelHandle]) -> None:
        self._labels = labels
        self._meant: list[Array] = [np.full(3, np.nan) for _ in labels]  # where whoever made it wants it
        self._put: list[Array] = [np.full(3, np.nan) for _ in labels]  # where it stands

    def show(self) -> bool:
        """Move the visible ones apart; True if anything changed."""
        taken: list[Array] = []
        changed = False
        for k, label in enumerate(self._labels):
            if not label.visible or not label.text:
                continue
            here = np.array(label.position, dtype=np.float64)  # a copy: viser changes its own
            if not np.array_equal(here, self._put[k]):
                self._meant[k] = here
            place = self._meant[k].copy()
            while any(_over(place, other) for other in taken):
                place[2] = max(other[2] for other in taken if _over(place, other)) + HIGH
            if not np.array_equal(place, here):
                label.position = place
                changed = True
            self._put[k] = place
            taken.append(place)
        return changed


def _over(one: Array, other: Array) -> bool:
    dx, dy, dz = (one - other).tolist()
    return dx * dx + dy * dy < WIDE * WIDE and abs(dz) < HIGH - 1e-9
