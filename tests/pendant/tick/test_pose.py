"""Poses as plain floats, against numpy."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pendant.tick.pose import HERE, Pose, finite, from_rpy, product, rotation, seen_from, turned, turned_back

numbers = st.floats(-2.0, 2.0)
vectors = st.tuples(numbers, numbers, numbers)
quaternions = st.tuples(numbers, numbers, numbers, numbers).filter(lambda q: math.hypot(*q) > 0.1)


def matrix(q: tuple[float, float, float, float]) -> np.ndarray:
    # R v = v + 2 w (u x v) + 2 u x (u x v) for a unit quaternion (w, u)
    w, x, y, z = np.array(q) / np.linalg.norm(q)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross


@given(quaternions, vectors, vectors)
def test_agrees_with_matrices(q: tuple[float, float, float, float], p: tuple[float, float, float], v: tuple) -> None:
    R = matrix(q)
    flat = rotation(q)
    assert np.allclose(np.reshape(flat, (3, 3)), R, atol=1e-12)
    assert np.allclose(turned(flat, v), R @ v, atol=1e-12)
    assert np.allclose(turned_back(flat, v), R.T @ v, atol=1e-12)
    assert np.allclose(seen_from(Pose(p, flat), v), R.T @ (np.array(v) - p), atol=1e-12)


@given(quaternions, quaternions)
def test_rotations_multiply_as_matrices(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> None:
    assert np.allclose(np.reshape(product(rotation(a), rotation(b)), (3, 3)), matrix(a) @ matrix(b), atol=1e-12)


@given(vectors)
def test_roll_pitch_and_yaw_are_turns_about_fixed_axes_in_this_order(rpy: tuple[float, float, float]) -> None:
    roll, pitch, yaw = (
        matrix((math.cos(angle / 2.0), *(math.sin(angle / 2.0) * np.eye(3)[axis]))) for axis, angle in enumerate(rpy)
    )
    assert np.allclose(np.reshape(from_rpy(*rpy), (3, 3)), yaw @ pitch @ roll, atol=1e-12)


def test_a_quarter_turn_about_z_takes_x_to_y() -> None:
    assert np.allclose(turned(rotation((1.0, 0.0, 0.0, 1.0)), (1.0, 0.0, 0.0)), (0.0, 1.0, 0.0))


def test_a_frame_sees_itself_at_its_origin() -> None:
    assert seen_from(HERE, (0.1, 0.2, 0.3)) == (0.1, 0.2, 0.3)
    assert seen_from(Pose((0.1, 0.2, 0.3)), (0.1, 0.2, 0.3)) == (0.0, 0.0, 0.0)


def test_every_number_must_be_finite() -> None:
    assert finite(HERE)
    for bad in (math.nan, math.inf):
        for k in range(12):
            values = [0.0] * 12
            values[k] = bad
            assert not finite(Pose(tuple(values[:3]), tuple(values[3:])))  # type: ignore[arg-type]
