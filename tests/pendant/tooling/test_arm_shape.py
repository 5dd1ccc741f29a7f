"""Where the links are, and how near they come."""

import math

import numpy as np
import pytest

from pendant.tooling.arm_shape import Rod, apart
from tests.pendant.tooling.wrists import HOME, wrist_arm

SHARES = np.linspace(0.0, 1.0, 201)


def test_a_stretched_arm_reaches_as_far_as_its_links_are_long() -> None:
    """At q = 0 the links lie along -x, the last three joints stand beside them."""
    origins, turns = wrist_arm().places(np.zeros((1, 6)))
    assert origins.shape == (1, 7, 3)
    np.testing.assert_allclose(origins[0, 0], [0.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(origins[0, 1], [0.0, 0.0, 0.16], atol=1e-12)
    np.testing.assert_allclose(origins[0, 3], [-0.817, 0.0, 0.16], atol=1e-12)
    np.testing.assert_allclose(origins[0, 6], [-0.817, -0.23, 0.06], atol=1e-12)
    np.testing.assert_allclose(turns[0] @ np.swapaxes(turns[0], 1, 2), np.broadcast_to(np.eye(3), (7, 3, 3)), atol=1e-12)


def test_postures_are_placed_each_by_itself() -> None:
    """A turn of the base turns everything; one of the last joint turns the flange alone."""
    shape = wrist_arm()
    turned = np.array([HOME, (0.7, *HOME[1:]), (*HOME[:5], 0.9)])
    origins, turns = shape.places(turned)
    c, s = math.cos(0.7), math.sin(0.7)
    about = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(origins[1], origins[0] @ about.T, atol=1e-12)
    np.testing.assert_allclose(turns[1, 1:], about @ turns[0, 1:], atol=1e-12)
    np.testing.assert_allclose(origins[2], origins[0], atol=1e-12)
    np.testing.assert_allclose(turns[2, :5], turns[0, :5], atol=1e-12)
    assert math.isclose(float(np.trace(turns[0, 6].T @ turns[2, 6])), 1.0 + 2.0 * math.cos(0.9))


def test_rods_move_with_their_links_and_the_foot_with_none() -> None:
    shape = wrist_arm()
    rods = (Rod(-1, (0.0, 0.0, 0.1), (0.1, 0.0, 0.1), 0.01), Rod(6, (0.0, 0.0, 0.0), (0.0, 0.0, 0.2), 0.01))
    origins, turns = shape.places(np.array([HOME, (1.0, *HOME[1:])]))
    start, end = shape.ends(rods, origins, turns)
    np.testing.assert_allclose(start[:, 0], [[0.0, 0.0, 0.1]] * 2, atol=1e-12)
    np.testing.assert_allclose(end[:, 0], [[0.1, 0.0, 0.1]] * 2, atol=1e-12)
    np.testing.assert_allclose(start[:, 1], origins[:, 6], atol=1e-12)
    np.testing.assert_allclose(end[:, 1] - start[:, 1], 0.2 * turns[:, 6, :, 2], atol=1e-12)


@pytest.mark.parametrize(
    ("lines", "distance"),
    [
        ([(0, 0, 0), (1, 0, 0), (0, 0, 1), (1, 0, 1)], 1.0),  # parallel, side by side
        ([(0, 0, 0), (1, 0, 0), (3, 0, 0), (5, 0, 0)], 2.0),  # one behind the other
        ([(0, 0, 0), (1, 0, 0), (0.5, -1, 0.5), (0.5, 1, 0.5)], 0.5),  # crossing
        ([(0, 0, 0), (1, 0, 0), (0.5, 2, 0), (0.5, 1, 0)], 1.0),  # an end beside a middle
        ([(0, 0, 0), (0, 0, 0), (3, 4, 0), (3, 4, 0)], 5.0),  # two points
        ([(0, 0, 0), (0, 0, 0), (-1, 2, 0), (1, 2, 0)], 2.0),  # a point beside a line
        ([(-1, 2, 0), (1, 2, 0), (0, 0, 0), (0, 0, 0)], 2.0),
        ([(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)], 0.0),  # they meet
    ],
)
def test_lines_are_apart(lines: list[tuple[float, float, float]], distance: float) -> None:
    assert float(apart(*(np.array(point, dtype=float) for point in lines))) == pytest.approx(distance, abs=1e-9)


def test_they_are_as_far_apart_as_their_nearest_points() -> None:
    """Against points laid closely on both lines."""
    rng = np.random.default_rng(5)
    for _ in range(100):
        a, b, c, d = rng.uniform(-1.0, 1.0, (4, 3))
        first, second = a + SHARES[:, None] * (b - a), c + SHARES[:, None] * (d - c)
        laid = np.linalg.norm(first[:, None] - second[None], axis=-1).min()
        found = float(apart(a, b, c, d))
        assert laid - 0.02 < found <= laid + 1e-12
