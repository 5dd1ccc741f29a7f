"""Which of the directions x y z and the turns rx ry rz of the tool are free in free-drive, and in which frame (FD-4)."""

from typing import NamedTuple

from pendant.limits.settings import AxisSettings, LockFrame
from pendant.tick.pose import Rotation, from_rpy

AXES = ("x", "y", "z", "rx", "ry", "rz")

PRESETS: dict[str, frozenset[str]] = {
    "all": frozenset(AXES),
    "plane": frozenset({"x", "y", "rz"}),
    "translation": frozenset({"x", "y", "z"}),
    "rotation": frozenset({"rx", "ry", "rz"}),
}
"""What is free, by the preset's name."""


class AxisLocks(NamedTuple):
    """What the control law keeps of the tool's pose, as it is when these locks begin. Equal locks go on, others start again."""

    locked: tuple[bool, ...]  # of AXES
    tool: bool  # the frame is the tool's when they begin, else `R_BU`
    R_BU: Rotation  # the frame, in B
    near: float  # smallest singular value below which motion further towards a singularity is resisted; 0: never [m]
    too_near: float  # and below which with all of the resistance [m]


def axis_locks(axes: AxisSettings) -> AxisLocks | None:
    """The locks that the settings ask for, None where everything is free."""
    locked = tuple([not getattr(axes, axis) for axis in AXES])
    if not (axes.on and any(locked)):
        return None
    near = axes.near if axes.resistance else 0.0
    return AxisLocks(locked, axes.frame is LockFrame.TOOL, from_rpy(axes.roll, axes.pitch, axes.yaw), near, axes.too_near)


def locks_of(free: tuple[bool, ...], R_BU: Rotation, axes: AxisSettings) -> AxisLocks:
    """Locks of all but these axes of a frame; what the settings say of singularities holds."""
    near = axes.near if axes.resistance else 0.0
    return AxisLocks(tuple([not each for each in free]), False, R_BU, near, axes.too_near)


def freeing(free: frozenset[str]) -> dict[str, float | bool | str]:
    """The changes of settings, by dotted name, that free these axes and lock the others."""
    return {f"axes.{axis}": axis in free for axis in AXES}
