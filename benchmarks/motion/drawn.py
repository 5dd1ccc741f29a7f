"""What a random motion is."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.files.library import load_arm
from pendant.program.steps import Move
from pendant.safety.robot_limits import SpeedLimits
from sim.arm.arm_file import Arm
from sim.arm.frames import joint_frames

Array = NDArray[np.float64]

KINDS = (
    "program joint step",
    "to a posture (Home)",
    "wizard's turn",
    "program linear step",
    "straight to a pose",
    "movej",
    "movej in a time",
    "movel",
    "movel in a time",
    "movec",
    "movep",
    "movep blends",
    "blend",
    "jog a joint",
    "jog the tool",
    "servoj",
    "servoc",
    "speedj",
    "speedl",
    "stop",
)
JOGGED = frozenset({"to a posture (Home)", "straight to a pose", "jog a joint", "jog the tool"})
"""A button is held for these: they begin at rest."""

STARTS = ("home", "anywhere", "joint limit", "singular", "moving")


class Drawn(NamedTuple):
    """One case."""

    arm: str
    kind: str
    start: str
    q: Array  # where the arm stands (n,) [rad]
    tcp: Array  # (3,) [m]
    R_FT: Array  # (3, 3)
    first: Move | None  # that is on its way when the motion is asked for
    after: int  # so many ticks later
    moves: tuple[Move, ...]  # one after the other, each as soon as the one before may go over into it
    share: float  # of speed (program.speed)
    limits: SpeedLimits | None  # of REDUCED
    held: float  # share of the longest time for which a jog button is held


@cache
def arm_of(name: str) -> Arm:
    """An arm that is shipped."""
    return load_arm(name)


def tool_pose(arm: Arm, q: Array, tcp: Array) -> tuple[Array, Array]:
    """Tool centre point (3,) [m] and orientation of the flange (3, 3), from the frames alone."""
    flange = joint_frames(arm, q)[-1]
    return flange[:3, :3] @ tcp + flange[:3, 3], flange[:3, :3]
