"""The shape of the fingers: they end where the tool does, with the tool centre point between them."""

import math

import numpy as np
import pytest

from sim.arm.scenario import Fingers, ToolModel
from sim.gripping.finger_shape import THICKNESS, finger_poses, tip_height

OWN = Fingers(finger=0.06)


def tool(tcp: list[float], rpy: list[float] | None = None) -> ToolModel:
    return ToolModel(
        name="t", mass=1.0, com=[0.0, 0.0, 0.05], tcp=tcp, rpy=rpy or [0.0, 0.0, 0.0], length=0.17, radius=0.03, gripper=OWN
    )


@pytest.mark.parametrize(
    ("tcp", "rpy", "height"),
    [
        ([0.0, 0.0, 0.16], [0.0, 0.0, 0.0], 0.01),
        ([0.09, 0.0, 0.16], [0.0, 0.0, 1.0], 0.01),
        ([0.0, -0.16, 0.02], [math.pi / 2.0, 0.0, 0.0], 0.01),  # z of the tool is -y of F
    ],
)
def test_fingers_end_at_the_tools_length_along_its_z(tcp: list[float], rpy: list[float], height: float) -> None:
    made = tool(tcp, rpy)
    assert tip_height(made) == pytest.approx(height)
    places = finger_poses(made, OWN, 0.04)[:, :3]
    (a, b), middle = places, places.mean(axis=0) - np.array(tcp)
    assert np.linalg.norm(a - b) == pytest.approx(0.04 + THICKNESS)
    assert np.linalg.norm(middle) == pytest.approx(abs(height - 0.03)), "half a finger from its tip"
