"""Safety mode REDUCED: slower limits for tool, elbow and joints, kept by the control law and watched here (FD-1)."""

from typing import NamedTuple

from pendant.freedrive.settings import ReducedLimits
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.limit_engine import Excess


class SpeedLimits(NamedTuple):
    """What the control law keeps the arm within."""

    tcp: float  # [m/s]
    elbow: float  # [m/s]
    joint: float  # [rad/s]


class Reduced:
    """The input, its time of grace, and the watch."""

    __slots__ = ("_grace", "on")

    def __init__(self) -> None:
        self.on = False
        self._grace = 0  # ticks left in which the arm may still be faster

    def switch(self, on: bool, settings: ReducedLimits) -> bool:
        """Take the input's level; returns whether it changed."""
        changed = on is not self.on
        if changed:
            self.on = on
            self._grace = ticks(settings.transition)
        return changed

    def limits(self, settings: ReducedLimits) -> SpeedLimits | None:
        """What holds now, None outside of REDUCED."""
        if not (self.on and settings.on):
            return None
        return SpeedLimits(settings.tcp_speed, settings.elbow_speed, settings.joint_speed)

    def step(self, estimate: Estimate, settings: ReducedLimits, joints: tuple[str, ...]) -> Excess | None:
        """One tick; what is too fast, the joint values being valid. What is not a number is too fast."""
        limits = self.limits(settings)
        if limits is None:
            return None
        if self._grace > 0:
            self._grace -= 1
            return None
        if not estimate.v_tcp <= limits.tcp:
            return Excess("tcp speed", "tcp", estimate.v_tcp, limits.tcp, "m/s")
        if not estimate.v_elbow <= limits.elbow:
            return Excess("elbow speed", "elbow", estimate.v_elbow, limits.elbow, "m/s")
        for joint, speed in zip(joints, estimate.qd.tolist(), strict=True):
            if not abs(speed) <= limits.joint:
                return Excess("joint speed", joint, abs(speed), limits.joint, "rad/s")
        return None
