import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from sim.arm.frames import (
    cross,
    inertia_matrix,
    inertia_numbers,
    matrix_from_quaternion,
    quaternion_from_matrix,
    rotation,
    rotation_from_rpy,
    rpy_from_matrix,
    skew,
    transform,
)

angle = st.floats(-10.0, 10.0)


@pytest.mark.parametrize(("axis", "turned"), [(0, [1, -3, 2]), (1, [3, 2, -1]), (2, [-2, 1, 3])])
def test_a_quarter_turn_is_right_handed(axis: int, turned: list[int]) -> None:
    np.testing.assert_allclose(rotation(axis, np.pi / 2) @ [1, 2, 3], turned, atol=1e-15)


def test_roll_pitch_yaw_turn_about_fixed_axes_in_this_order() -> None:
    # x rolls to x, pitches down to -z, which yaw leaves alone.
    np.testing.assert_allclose(rotation_from_rpy([np.pi / 2, np.pi / 2, np.pi / 2]) @ [1, 0, 0], [0, 0, -1], atol=1e-15)
    # y rolls to z, pitches to x, yaws to y.
    np.testing.assert_allclose(rotation_from_rpy([np.pi / 2, np.pi / 2, np.pi / 2]) @ [0, 1, 0], [0, 1, 0], atol=1e-15)


@given(st.tuples(angle, angle, angle))
@example((0.4, np.pi / 2, 0.0))
@example((0.4, -np.pi / 2, 0.3))
def test_roll_pitch_yaw_of_a_turn_give_the_turn_again(rpy: tuple[float, float, float]) -> None:
    matrix = rotation_from_rpy(rpy)
    found = rpy_from_matrix(matrix)
    np.testing.assert_allclose(rotation_from_rpy(found), matrix, atol=1e-7)
    assert abs(found[1]) <= np.pi / 2


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
def test_at_a_pitch_of_a_quarter_turn_there_is_no_yaw(pitch: float) -> None:
    assert rpy_from_matrix(rotation_from_rpy((0.4, pitch, 0.0))) == pytest.approx((0.4, pitch, 0.0), abs=1e-7)


def test_a_quaternion_has_its_scalar_first() -> None:
    np.testing.assert_allclose(quaternion_from_matrix(rotation(2, np.pi / 2)), np.sqrt([0.5, 0, 0, 0.5]), atol=1e-15)


@given(st.tuples(angle, angle, angle))
def test_quaternions_and_matrices_say_the_same(rpy: tuple[float, float, float]) -> None:
    matrix = rotation_from_rpy(rpy)
    quaternion = quaternion_from_matrix(matrix)
    assert quaternion[0] >= 0
    np.testing.assert_allclose(matrix_from_quaternion(quaternion), matrix, atol=1e-12)
    np.testing.assert_allclose(matrix_from_quaternion(-3 * quaternion), matrix, atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_half_turns_have_a_quaternion(axis: int) -> None:
    expected = np.zeros(4)
    expected[1 + axis] = 1.0
    np.testing.assert_allclose(np.abs(quaternion_from_matrix(rotation(axis, np.pi))), expected, atol=1e-12)


def test_six_numbers_make_a_tensor() -> None:
    np.testing.assert_array_equal(inertia_matrix([1, 2, 3, 4, 5, 6]), [[1, 4, 5], [4, 2, 6], [5, 6, 3]])
    assert inertia_numbers(inertia_matrix([1, 2, 3, 4, 5, 6])) == [1, 2, 3, 4, 5, 6]


def test_a_skew_matrix_is_the_cross_product() -> None:
    np.testing.assert_allclose(skew([1, 2, 3]) @ [4, 5, 6], [-3, 6, -3])
    np.testing.assert_array_equal(cross(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])), [-3, 6, -3])


def test_a_transform_turns_then_moves() -> None:
    np.testing.assert_allclose(transform(rotation(2, np.pi / 2), [10, 0, 0]) @ [1, 0, 0, 1], [10, 1, 0, 1], atol=1e-15)
