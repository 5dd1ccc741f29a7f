"""Where a random motion says that it ends."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.motion.drawn import Drawn, arm_of, tool_pose
from pendant.motion.script_requests import ScriptedArc, ScriptedJoints, ServoJoints
from pendant.program.jog_move import TURNS, JogMove
from pendant.program.steps import JointMove, LinearMove, Move
from sim.arm.frames import matrix_from_quaternion, rotation_by, rotation_vector

Array = NDArray[np.float64]

Pose = tuple[Array, Array]
"""Tool centre point (3,) [m] and orientation of the flange (3, 3), in B."""


class Begin(NamedTuple):
    """Where a motion begins."""

    row: int  # number of its first reference
    q: Array  # (n,) [rad]
    pose: Pose


def says(move: Move, drawn: Drawn, begin: Begin) -> Pose | None:
    """Where a motion from there says that it ends; None: it does not."""
    arm, tcp, R_FT, (p, R) = arm_of(drawn.arm), drawn.tcp, drawn.R_FT, begin.pose
    if isinstance(move, JointMove | ScriptedJoints | ServoJoints):
        return tool_pose(arm, np.array(move.q), tcp)
    if isinstance(move, LinearMove):
        end, turned = np.array(move.position), matrix_from_quaternion(move.quaternion) @ R_FT.T
        if isinstance(move, ScriptedArc) and move.fixed:
            turned = _round(p, np.array(move.via), end) @ R
        return end, turned
    if not isinstance(move, JogMove) or move.length == 0.0:
        return None
    if move.frame == "joint":
        goal = begin.q.copy()
        goal[move.axis] += move.sign * move.length
        return tool_pose(arm, goal, tcp)
    axis = move.sign * np.eye(3)[move.axis % TURNS]
    along = move.length * (R @ R_FT @ axis if move.frame == "tool" else axis)
    return (p + along, R) if move.axis < TURNS else (p, rotation_by(along) @ R)


def _round(p: Array, via: Array, end: Array) -> Array:
    """The rotation (3, 3) about the axis of the circle through three points, from the first to the last."""
    a, b = via - p, end - p
    normal = np.cross(a, b)
    if not normal.any():  # no circle: it is refused
        return np.eye(3)
    centre = p + (np.dot(a, a) * np.cross(b, normal) + np.dot(b, b) * np.cross(normal, a)) / (2.0 * np.dot(normal, normal))
    x, y, axis = p - centre, end - centre, normal / np.linalg.norm(normal)
    angle = math.atan2(float(np.cross(x, y) @ axis), float(x @ y)) % (2.0 * math.pi)
    return rotation_by(angle * axis)


def apart(one: Pose, other: Pose) -> tuple[float, float]:
    """How far two poses are from each other [m], and turned [rad]."""
    return float(np.linalg.norm(one[0] - other[0])), float(np.linalg.norm(rotation_vector(other[1].T @ one[1])))
