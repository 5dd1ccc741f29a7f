"""What is free in free-drive: directions x y z and turns rx ry rz of the tool, in which frame, and joints (FD-4)."""

from typing import NamedTuple

from pendant.limits.settings import AxisSettings, JointSettings, LockFrame
from pendant.settings.bounds import MOST_JOINTS
from pendant.tick.pose import UNTURNED, Rotation, from_rpy

AXES = ("x", "y", "z", "rx", "ry", "rz")

JOINTS = tuple([f"j{number}" for number in range(1, MOST_JOINTS + 1)])
"""Names of the settings that free a joint, base to flange."""

PRESETS: dict[str, frozenset[str]] = {
    "all": frozenset(AXES),
    "plane": frozenset({"x", "y", "rz"}),
    "translation": frozenset({"x", "y", "z"}),
    "rotation": frozenset({"rx", "ry", "rz"}),
}
"""What is free, by the preset's name."""


class AxisLocks(NamedTuple):
    """What the control law keeps of the tool's pose, and of the joints' angles, as they are when these locks begin.

    Equal locks go on, others start again.
    """

    locked: tuple[bool, ...]  # of AXES
    tool: bool  # the frame is the tool's when they begin, else `R_BU`
    R_BU: Rotation  # the frame, in B
    near: float  # smallest singular value below which motion further towards a singularity is resisted; 0: never [m]
    too_near: float  # and below which with all of the resistance [m]
    joints: tuple[bool, ...] = ()  # of JOINTS, which are locked; empty: none


def axis_locks(axes: AxisSettings) -> AxisLocks | None:
    """The locks of axes that the settings ask for, None where every axis is free."""
    locked = tuple([not getattr(axes, axis) for axis in AXES])
    if not (axes.on and any(locked)):
        return None
    near = axes.near if axes.resistance else 0.0
    return AxisLocks(locked, axes.frame is LockFrame.TOOL, from_rpy(axes.roll, axes.pitch, axes.yaw), near, axes.too_near)


def locks_of(free: tuple[bool, ...], R_BU: Rotation, axes: AxisSettings) -> AxisLocks:
    """Locks of all but these axes of a frame; what the settings say of singularities holds."""
    near = axes.near if axes.resistance else 0.0
    return AxisLocks(tuple([not each for each in free]), False, R_BU, near, axes.too_near)


def with_joints(locks: AxisLocks | None, joints: JointSettings) -> AxisLocks | None:
    """The locks of axes, and those of joints that the settings ask for; None where all is free."""
    locked = tuple([not getattr(joints, joint) for joint in JOINTS])
    if not (joints.on and any(locked)):
        return locks
    if locks is None:  # a locked joint makes no singularity: nothing is resisted before one
        locks = AxisLocks((False,) * len(AXES), False, UNTURNED, 0.0, 0.0)
    return locks._replace(joints=locked)


def freeing(free: frozenset[str]) -> dict[str, float | bool | str]:
    """The changes of settings, by dotted name, that free these axes and lock the others."""
    return {f"axes.{axis}": axis in free for axis in AXES}


def freeing_joints(free: frozenset[int], count: int) -> dict[str, float | bool | str]:
    """The changes of settings, by dotted name, that free these joints of an arm and lock its others.

    Args:
        free: counted from 0 at the base.
        count: of the arm's joints.
    """
    return {f"joints.{name}": place in free for place, name in enumerate(JOINTS[:count])}
