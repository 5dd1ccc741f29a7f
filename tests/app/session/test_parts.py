import math

import pytest

from app.session.parts import point_of
from sim.arm.frames import matrix_from_quaternion
from tests.app.fakes import JOINTS, snapshot


def test_a_point_turns_with_its_part() -> None:
    half = math.sqrt(0.5)  # a quarter turn about z takes x to y
    seen = snapshot(1, (1.0, 2.0, 3.0), (half, 0.0, 0.0, half))
    assert point_of(seen, JOINTS, "flange", (0.1, 0.0, 0.0)) == pytest.approx((1.0, 2.1, 3.0))


def test_any_turn_agrees_with_the_rotation_matrix() -> None:
    quaternion = (0.5, -0.1, 0.7, math.sqrt(1 - 0.25 - 0.01 - 0.49))
    expected = matrix_from_quaternion(quaternion) @ [0.3, -0.2, 0.5] + [1.0, 2.0, 3.0]
    assert point_of(snapshot(1, (1.0, 2.0, 3.0), quaternion), JOINTS, "tool", (0.3, -0.2, 0.5)) == pytest.approx(tuple(expected))


def test_links_are_named_by_their_joints() -> None:
    assert point_of(snapshot(1), JOINTS, "elbow") == (7.0, 8.0, 9.0)
    assert point_of(snapshot(1, (1.0, 0.0, 0.0)), JOINTS, "foot") == (0.0, 0.0, 0.0)
