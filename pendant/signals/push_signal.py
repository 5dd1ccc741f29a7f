"""A push or a twist at the flange as a signal: how large, which way, where, with how much torque (FD-5c, FD-5d, FD-6)."""

import math
from collections.abc import Sequence

from pendant.settings.schema import ticks
from pendant.signals.settings import PushDirection, PushFrame, PushSettings, Twist
from pendant.tick.pose import Rotation, Vector, turned

STAYS = 0.75
"""A signal that is present stays so down to this share of its threshold: a hand trembles."""


class PushSignal:
    """Whether the user's wrench is a push as FD-6 says."""

    __slots__ = ("_calm", "present")

    def __init__(self) -> None:
        self.present = False
        self._calm = 0  # ticks for which the torque has been within its limit

    def step(self, change: Sequence[float], R_BF: Rotation, use: PushSettings) -> bool:
        """One tick.

        Args:
            change: of the user's wrench from the untouched state: force [N], torque about the flange's origin [N·m], axes of B.
            R_BF: of the flange.
            use: settings.
        """
        fx, fy, fz, tx, ty, tz = change
        torque = math.hypot(tx, ty, tz)
        self._calm = self._calm + 1 if torque <= use.torque_limit else 0
        force = math.hypot(fx, fy, fz)
        needed = use.threshold * STAYS if self.present else use.threshold
        self.present = (
            needed < force <= use.force_limit
            and self._calm > ticks(use.torque_period)
            and _right_way((fx, fy, fz), force, R_BF, use)
            and (use.radius == 0.0 or _at_place(change, force, R_BF, use))
        )
        return self.present


def _right_way(f: Vector, force: float, R_BF: Rotation, use: PushSettings) -> bool:
    """Within the cone around the axis or, for pushes across it, near the plane across it; not too much force off the axis."""
    length = math.hypot(use.x, use.y, use.z)
    if length == 0.0:
        return True
    axis = (use.x / length, use.y / length, use.z / length)
    if use.frame is PushFrame.FLANGE:
        axis = turned(R_BF, axis)
    along = f[0] * axis[0] + f[1] * axis[1] + f[2] * axis[2]
    across = math.sqrt(max(force * force - along * along, 0.0))
    if use.direction is PushDirection.ACROSS:
        return math.atan2(abs(along), across) <= math.radians(use.angle)
    return across <= use.off_axis and math.atan2(across, along) <= math.radians(use.angle)


def _at_place(change: Sequence[float], force: float, R_BF: Rotation, use: PushSettings) -> bool:
    """The wrench's line of action passes the place: the torque about it is the force times its distance from the line."""
    fx, fy, fz, tx, ty, tz = change
    px, py, pz = turned(R_BF, (use.place_x, use.place_y, use.place_z))
    return math.hypot(tx - (py * fz - pz * fy), ty - (pz * fx - px * fz), tz - (px * fy - py * fx)) <= use.radius * force


class TwistSignal:
    """Whether the user's wrench is a twist: torque, and almost no force."""

    __slots__ = ("present",)

    def __init__(self) -> None:
        self.present = False

    def step(self, change: Sequence[float], use: Twist) -> bool:
        """One tick of the change of the user's wrench, as `PushSignal.step` takes it."""
        fx, fy, fz, tx, ty, tz = change
        needed = use.threshold * STAYS if self.present else use.threshold
        self.present = math.hypot(fx, fy, fz) < use.force_limit and math.hypot(tx, ty, tz) > needed
        return self.present
