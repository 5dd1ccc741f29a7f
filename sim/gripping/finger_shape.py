"""The shape of a gripper's fingers: two boxes that move along x of the tool."""

import numpy as np
from numpy.typing import NDArray

from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy
from sim.arm.scenario import Fingers, ToolModel

FINGERS = ("shape/finger/0", "shape/finger/1")
"""Names of the fingers' shapes, where x of the tool is negative and where it is positive."""

THICKNESS = 0.012
"""Of a finger, along the way that it moves [m]."""


def palm_length(tool: ToolModel) -> float:
    """Length of a tool's shape without its fingers [m]."""
    return tool.length - tool.gripper.finger if isinstance(tool.gripper, Fingers) else tool.length


def finger_size(fingers: Fingers) -> NDArray[np.float64]:
    """Full lengths of a finger along x, y, z of the tool (3,) [m]."""
    return np.array([THICKNESS, fingers.pad, fingers.finger])


def tip_height(tool: ToolModel) -> float:
    """How far the fingertips are beyond the tool centre point, along z of the tool [m]: the fingers end where the tool does."""
    return tool.length - float(np.dot(tool.tcp, rotation_from_rpy(tool.rpy)[:, 2]))


def finger_poses(tool: ToolModel, fingers: Fingers, opening: float) -> NDArray[np.float64]:
    """Poses (2, 7) of the middles of both fingers in F: position [m], quaternion wxyz.

    They end where the tool does, and their pads lie on both sides of the tool centre point.
    """
    R = rotation_from_rpy(tool.rpy)
    middle = tip_height(tool) - fingers.finger / 2.0
    ways = np.array([-1.0, 1.0]) * (opening + THICKNESS) / 2.0
    places = np.array(tool.tcp) + np.outer(ways, R[:, 0]) + middle * R[:, 2]
    return np.hstack([places, np.tile(quaternion_from_matrix(R), (2, 1))])
