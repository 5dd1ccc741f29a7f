"""How fast a planned motion runs: slower in REDUCED, so that tool, elbow and joints stay below its limits (FD-1)."""

import copy

import numpy as np
from numpy.typing import NDArray

from pendant.robot.reduced import SpeedLimits
from pendant.tick.modes import TICK
from sim.motion.blend import Blended, Planned
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

SHARE = 0.85
"""Of the limits: what the measurement adds, and the arm's swinging, stays below them as well."""

RAMP = 0.25
"""Time in which the rate would go from full speed to none, or back [s]."""

LOOKS = 60
"""Places of a motion that are looked at, about."""

ASIDE = 1e-3
"""Way of the motion over which a speed is measured [s]."""


class Pace:
    """The rate at which a motion's own time passes: 1, or in REDUCED the one that keeps all of its rest below the limits.

    The rest of the motion is looked at once, when it begins or when the limits change; its path stays what it is.

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].

    Attributes:
        rate: of this tick.
    """

    def __init__(self, dynamics: Dynamics, tcp: Array) -> None:
        self._dynamics, self._tcp = dynamics, tcp
        self._limits: SpeedLimits | None = None
        self._target = 1.0
        self.rate = 1.0

    def begin(self, motion: Planned | Blended, limits: SpeedLimits | None, share: float, *, moving: bool = False) -> None:
        """A motion begins, at rest, or from a `moving` arm, whose rate it then takes over; `share` as for `step`."""
        self._look(motion, limits)
        if not moving:
            self.rate = self._target * share

    def step(self, motion: Planned | Blended, limits: SpeedLimits | None, share: float) -> float:
        """The rate of the next tick; `share`: of the rate that the limits allow (program.speed)."""
        if limits != self._limits:
            self._look(motion, limits)
        most = TICK / RAMP
        self.rate += min(max(self._target * share - self.rate, -most), most)
        return self.rate

    def _look(self, motion: Planned | Blended, limits: SpeedLimits | None) -> None:
        self._limits = limits
        self._target = 1.0 if limits is None else min(SHARE / max(self._worst(motion, limits), 1e-9), 1.0)

    def _worst(self, motion: Planned | Blended, limits: SpeedLimits) -> float:
        """The largest speed of the rest of the motion at full rate, over its limit."""
        probe = copy.copy(motion)
        stride = max(1.0, motion.remaining / TICK / LOOKS)
        worst = 0.0
        while not probe.done:
            q, qd, _ = probe.step(stride)
            worst = max(worst, self.over(q, qd / stride, limits))
        return worst

    def over(self, q: Array, qd: Array, limits: SpeedLimits) -> float:
        """The largest speed of tool, elbow and joints at angles and speeds (n,), over its limit."""
        tcp, elbow = self._places(q)
        next_tcp, next_elbow = self._places(q + ASIDE * qd)
        return max(
            float(np.linalg.norm(next_tcp - tcp)) / ASIDE / limits.tcp,
            float(np.linalg.norm(next_elbow - elbow)) / ASIDE / limits.elbow,
            float(np.abs(qd).max()) / limits.joint,
        )

    def _places(self, q: Array) -> tuple[Array, Array]:
        """Tool centre point and elbow (3,) in B [m]."""
        p, R, elbow = self._dynamics.places(q)
        return p + R @ self._tcp, elbow
