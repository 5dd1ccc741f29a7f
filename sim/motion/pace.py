"""How fast a planned motion runs: so slowly that it keeps all of the robot's limits (RL-4)."""

import copy

from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import TICK
from sim.braking.motion_meter import MotionMeter
from sim.motion.blend import Blended, Planned

RAMP = 0.25
"""Time in which the rate would go from full speed to none, or back [s]."""

LOOKS = 60
"""Places of a motion that are looked at, about."""


class Pace:
    """The rate at which a motion's own time passes: 1, or less so that all of its rest keeps the limits.

    The rest of the motion is looked at once, when it begins or when the limits change; its path stays what it is.

    Args:
        meter: of the arm.

    Attributes:
        meter: as given.
        rate: of this tick.
    """

    def __init__(self, meter: MotionMeter) -> None:
        self.meter = meter
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
        self._target = 1.0 if limits is None else 1.0 / max(self._worst(motion, limits), 1.0)

    def _worst(self, motion: Planned | Blended, limits: SpeedLimits) -> float:
        """By what the speed of the motion must be divided so that all of its rest keeps the limits."""
        probe = copy.copy(motion)
        stride = max(1.0, motion.remaining / TICK / LOOKS)
        worst = 0.0
        while not probe.done:
            q, qd, _ = probe.step(stride)
            worst = max(worst, self.meter.over(q, qd / stride, limits))
        return worst
