"""A circle of the tool centre point through three points, as a line that bends."""

import math

import numpy as np
from numpy.typing import NDArray

from sim.motion.line import Line
from sim.motion.moves import MoveRefused
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

NEAREST = 1e-4
"""Two of the three points are one, or all are on a line, within this [m]."""


class Arc(Line):
    """From where the tool centre point is at joint angles q through `via` to `end`; its share `s` goes from 0 to 1.

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        q: joint angles at the begin (n,) [rad].
        via: on the way (3,) in B [m].
        end: of it (3,) [m].

    Attributes:
        angle: of the arc [rad].
        axis: that it goes round, right-handed (3,).
        radius: of the circle [m].

    Raises:
        MoveRefused: there is no circle through the three.
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, q: Array, *, via: Array, end: Array) -> None:
        super().__init__(dynamics, tcp, q)
        a, b = via - self.start, end - self.start
        normal = np.cross(a, b)
        size = float(np.linalg.norm(normal))
        if min(float(np.linalg.norm(a)), float(np.linalg.norm(b)), float(np.linalg.norm(b - a))) < NEAREST:
            raise MoveRefused("circular move: two of its three points are the same")
        if size < NEAREST * max(float(np.linalg.norm(a)), float(np.linalg.norm(b))):
            raise MoveRefused("circular move: its three points are on a line; use a linear move")
        self._origin = self.start
        # Centre of the circle through the origin, a and b, from the origin.
        across = (np.dot(a, a) * np.cross(b, normal) + np.dot(b, b) * np.cross(normal, a)) / (2.0 * size * size)
        self._centre, self.axis = self.start + across, normal / size
        self.radius = float(np.linalg.norm(across))
        self._out = -across  # from the centre to the begin
        self._aside = np.cross(self.axis, self._out)
        x, y = float(np.dot(end - self._centre, self._out)), float(np.dot(end - self._centre, self._aside))
        self.angle = math.atan2(y, x) % (2.0 * math.pi)

    def solve(self, q: Array, s: float, rate: float) -> Array:
        """Joint speeds (n,) at q, for the share `s` of the arc and its rate [1/s]."""
        c, d = math.cos(s * self.angle), math.sin(s * self.angle)
        self.way = self.angle * (c * self._aside - d * self._out)  # the tangent, which the line has at this share
        self.start = self._centre + c * self._out + d * self._aside - s * self.way
        return super().solve(q, s, rate)
