"""Texts in the picture that keep apart."""

from collections.abc import Callable, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDE, HIGH = 0.25, 0.05
"""Two texts whose places are nearer than this, sideways and in height, lie over each other: 16 letters, seen from 2 m [m]."""


class Labels:
    """Of texts that would lie over each other the later ones stand higher. Lives in the painter.

    Args:
        labels: gives those that there are now, by precedence; each has its place in W, and whoever made it may move it at any
            time.
    """

    def __init__(self, labels: Callable[[], Sequence[viser.LabelHandle]]) -> None:
        self._labels = labels
        self._put: dict[str, tuple[Array, Array]] = {}  # of each by its name, where whoever made it wants it, and where it stands

    def show(self) -> bool:
        """Move the visible ones apart; True if anything changed."""
        taken: list[Array] = []
        changed, put = False, self._put
        self._put = {}
        for label in self._labels():
            here = np.array(label.position, dtype=np.float64)  # a copy: viser changes its own
            meant, stood = put.get(label.name, (here, here))
            if not np.array_equal(here, stood):
                meant = here
            place = meant.copy()
            if label.visible and label.text:
                while any(_over(place, other) for other in taken):
                    place[2] = max(other[2] for other in taken if _over(place, other)) + HIGH
                taken.append(place)
                if not np.array_equal(place, here):
                    label.position = place
                    changed = True
            else:
                place = here
            self._put[label.name] = meant, place
        return changed


def _over(one: Array, other: Array) -> bool:
    dx, dy, dz = (one - other).tolist()
    return dx * dx + dy * dy < WIDE * WIDE and abs(dz) < HIGH - 1e-9
