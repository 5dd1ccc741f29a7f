"""Manipulation (FD-13): is the user changing, or trying to change, the posture?"""

import math
from typing import NamedTuple

from pendant.estimate import Estimate
from pendant.settings import Maintain

ZEROS = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Excess(NamedTuple):
    """A parameter beyond its limit."""

    parameter: str
    value: float
    limit: float
    unit: str


class Reference(NamedTuple):
    """What the user already did when a maintain period began; force limits are changes since then."""

    wrench: tuple[float, ...]  # F_user [N, N·m]
    torques: tuple[float, ...]  # tau_ext [N·m]


def reference(estimate: Estimate, use_wrench: bool) -> Reference:
    """What is stored at the beginning of a period."""
    return Reference(tuple(estimate.F_user.tolist()) if use_wrench else ZEROS, tuple(estimate.tau_ext.tolist()))


def manipulation(estimate: Estimate, since: Reference, limits: Maintain, use_wrench: bool) -> Excess | None:
    """The first parameter that exceeds its maintain limit, or None.

    Args:
        estimate: of this tick; its joint values are finite.
        since: what was stored when the period began.
        limits: each parameter's limit; a value equal to it does not exceed it.
        use_wrench: False: judged by the joints alone (FD-3a).
    """
    if use_wrench:
        x, y, z, rx, ry, rz = estimate.F_user.tolist()
        x0, y0, z0, rx0, ry0, rz0 = since.wrench
        x, y, z = x - x0, y - y0, z - z0
        force = math.sqrt(x * x + y * y + z * z)
        if force > limits.force:
            return Excess("user force", force, limits.force, "N")
        x, y, z = rx - rx0, ry - ry0, rz - rz0
        torque = math.sqrt(x * x + y * y + z * z)
        if torque > limits.torque:
            return Excess("user torque", torque, limits.torque, "N·m")
    limit = limits.joint_torque
    for value, start in zip(estimate.tau_ext.tolist(), since.torques, strict=True):
        if abs(value - start) > limit:
            return Excess("joint external torque", abs(value - start), limit, "N·m")
    limit = limits.joint_speed
    for value in estimate.qd.tolist():
        if abs(value) > limit:
            return Excess("joint speed", abs(value), limit, "rad/s")
    vx, vy, vz = estimate.v_F.tolist()[:3]
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    if speed > limits.flange_speed:
        return Excess("flange speed", speed, limits.flange_speed, "m/s")
    return None
