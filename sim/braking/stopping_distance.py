"""How far an arm goes on when it brakes now, and how fast it may be so that this leads to no border (VW-9).

It brakes along the way that its joints are on, its speed falling as half a cosine (`sim.motion.moves.Stop`):

    s(v) = v (max(T_0, v T) / 2 + r)

with v the share of the present speed, T the time in which the joints can brake from all of it, T_0 the shortest stop and r the
time until they begin. Along that way the arm's posture is known, and with it each part's distance to each border.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LOOKS = (0.25, 0.5, 0.75, 1.0)
"""Shares of the way that are looked at: whatever lies ahead comes past each of them."""

REFINED = 5
"""Times that the place of a border on the way is refined (regula falsi, the Illinois way)."""


class StoppingDistance:
    """What it takes to come to rest.

    Args:
        seconds: the time in which the joints can brake, by angles and speeds (n,) [s]; it grows with the speeds as they do.
        shortest: no stop is shorter [s].
        reaction: until it begins, where it is one of what was measured [s].
    """

    def __init__(self, seconds: Callable[[Array, Array], float], shortest: float, reaction: float) -> None:
        self._seconds, self.shortest, self.reaction = seconds, shortest, reaction

    def seconds(self, q: Array, qd: Array) -> float:
        """Time in which the joints can brake [s]; the shortest stop may be longer."""
        return self._seconds(q, qd)

    def way(self, seconds: float, delay: float) -> float:
        """Of a stop that takes so long and begins after `delay` [s], as a time at the present speed [s]."""
        return 0.5 * max(seconds, self.shortest) + delay

    def share(self, way: float, seconds: float, delay: float) -> float:
        """The share of the present speed, 1 at most, from which the arm comes to rest within a way, as above.

        Args:
            way: as a time at the present speed [s].
            seconds: in which the joints can brake from all of that speed [s].
            delay: before they begin [s].
        """
        slow = max(way, 0.0) / (0.5 * self.shortest + delay)
        if slow * seconds > self.shortest:  # s = v² T / 2 + v r
            slow = (math.sqrt(delay * delay + 2.0 * seconds * way) - delay) / seconds
        return min(slow, 1.0)


def free_way(out: Callable[[Array], float], q: Array, qd: Array, way: float) -> float:
    """How far the arm may go on as it goes now, as a time at its speed, at most `way` [s].

    Args:
        out: how far the part that is furthest out is beyond what it may, by angles (n,) [m]; negative where none is.
        q: angles (n,) [rad].
        qd: speeds (n,) [rad/s].
        way: that is looked at [s].
    """
    inside, at = out(q), 0.0
    if inside > 0.0:
        # Outside already: back is free, further out is not.
        return way if out(q + LOOKS[0] * way * qd) <= inside and out(q + way * qd) <= inside else 0.0
    for look in LOOKS:
        value = out(q + look * way * qd)
        if not value <= 0.0:
            return _crossing(out, (q, qd), (at, inside), (look * way, value)) if value > 0.0 else at
        at, inside = look * way, value
    return way


def _crossing(
    out: Callable[[Array], float], course: tuple[Array, Array], before: tuple[float, float], after: tuple[float, float]
) -> float:
    """Where `out` becomes positive between two places of a course, a place before it: time [s] and value [m] of each."""
    q, qd = course
    (a, at_a), (b, at_b) = before, after
    for _ in range(REFINED):
        middle = a + (b - a) * at_a / (at_a - at_b)
        value = out(q + middle * qd)
        if not value <= 0.0:
            b, at_b, at_a = middle, value, 0.5 * at_a
        else:
            a, at_a, at_b = middle, value, 0.5 * at_b
    return a
