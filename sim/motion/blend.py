"""One motion going over into the next: the first runs to its end while the second leaves that already."""

import copy

import numpy as np
from numpy.typing import NDArray

from sim.motion.moves import Reference, Stop
from sim.motion.planned import JointTrajectory, LinearTrajectory

Array = NDArray[np.float64]

Planned = JointTrajectory | LinearTrajectory

LOOKS = 20
"""Places at which the speeds of both together are looked at."""


class Blended:
    """The sum of two motions in joint angles: what the first has still to go is taken off the second's way.

    Where the first one only slows down and the second only speeds up, no joint gets faster than in one of them at equal
    accelerations. Where it would get faster than it may, the second waits for the end of the first.

    Args:
        first: on its way to its end, or to a stop.
        second: planned from there.
        corner: where that is (n,) [rad].
        most: speeds of the joints (n,) [rad/s].

    Attributes:
        goal: where the second ends (n,) [rad].
        done: both are.
        slowing: the second comes to its end.
    """

    def __init__(self, first: "Planned | Stop | Blended", second: Planned, corner: Array, most: Array) -> None:
        self.first, self.second, self._corner = first, second, corner
        self.done = self._waits = False
        self._waits = self._fastest(most) > 1.0

    def __copy__(self) -> "Blended":
        twin = object.__new__(Blended)
        twin.__dict__.update(self.__dict__)
        twin.first, twin.second = copy.copy(self.first), copy.copy(self.second)
        return twin

    @property
    def goal(self) -> Array:
        """Where it ends (n,) [rad]."""
        return self.second.goal

    @property
    def slowing(self) -> bool:
        """It comes to its end."""
        return self.first.done and self.second.slowing

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate, at most [s]."""
        return self.second.remaining + (0.0 if self.first.done else self.first.remaining)

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; `rate`: how fast the motion's own time passes."""
        first = self.first.step(rate)
        if self._waits and not self.first.done:
            return first
        second = self.second.step(rate)
        self.done = self.first.done and self.second.done
        return Reference(first.q + second.q - self._corner, first.qd + second.qd, first.qdd + second.qdd)

    def _fastest(self, most: Array) -> float:
        """The largest speed of a joint while both run, over what it may have."""
        probe, worst = copy.copy(self), 0.0
        stride = max(1.0, self.first.remaining * 500.0 / LOOKS)
        while not probe.first.done and not probe.done:
            worst = max(worst, float((np.abs(probe.step(stride).qd) / stride / most).max()))
        return worst
