"""The shadow on floor and tables."""

import math

import numpy as np
import pytest

from app.web.scene.stage import CAP, SHADE_LIFT, SHADE_RADIUS, Shadow, Top, strips, strips_on, top_of
from app.web.server import Served


def test_the_rim_of_a_shadow_is_at_its_width_from_the_link_seen_from_above() -> None:
    joints = np.array([[0.0, 0.0, 0.2], [0.3, 0.4, 0.9], [0.3, 0.4, 0.1]])  # the last link stands upright
    rims = strips(joints, -0.1).reshape(2, 2 * len(CAP), 3)
    for (begin, end), rim in zip(((0, 1), (1, 2)), rims, strict=True):
        way = joints[end, :2] - joints[begin, :2]
        for point in rim[:, :2]:
            share = 0.0 if not way.any() else np.clip((point - joints[begin, :2]) @ way / (way @ way), 0.0, 1.0)
            assert np.linalg.norm(point - joints[begin, :2] - share * way) == pytest.approx(SHADE_RADIUS)
    assert rims[0, :, 2] == pytest.approx(-0.1 + SHADE_LIFT)
    assert (rims[1, :, 2] < rims[0, :, 2]).all()


def test_a_shadow_follows_the_arm_and_stays_while_it_stands(still: Served) -> None:
    shadow, joints = Shadow(still.server.scene), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.5, 0.0, 0.5]])
    assert shadow.show(joints, 0.0)
    assert not shadow.show(joints + 0.0005, 0.0)
    assert shadow.show(joints + 0.1, 0.0)
    mesh = shadow._mesh
    assert mesh is not None
    assert mesh.vertices[:, :2].max() == pytest.approx(0.6 + SHADE_RADIUS)
    assert shadow.show(joints[:2], 0.0), "another arm"
    assert len(shadow._mesh.vertices) == 2 * len(CAP)  # type: ignore[union-attr]


def square(x: float, z: float, yaw: float = 0.0) -> Top:
    turn = np.array([math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0)])
    top = top_of(np.array([0.4, 0.4, 0.1]), np.concatenate([[x, 0.0, z - 0.05], turn]))
    assert top is not None
    return top


def area(rim: np.ndarray) -> float:
    x, y = rim[:, 0], rim[:, 1]
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


@pytest.mark.parametrize("yaw", [0.0, 0.5 * np.pi])
def test_a_table_has_the_part_of_the_shadow_that_is_over_it(yaw: float) -> None:
    """Of a link that leaves the table through its edge: up to the edge the whole strip, whose begin is round."""
    joints = np.array([[0.0, 0.0, 0.5], [1.0, 0.0, 0.7]])
    rim = strips_on(square(0.0, 0.2, yaw), joints)
    assert rim[:, 0].max() == pytest.approx(0.2)
    assert rim[:, 2] == pytest.approx(0.2 + SHADE_LIFT)
    whole = strips(joints, 0.0)
    half_disc = area(whole) - 2.0 * SHADE_RADIUS * 1.0  # both rounded ends together
    assert area(rim) == pytest.approx(2.0 * SHADE_RADIUS * 0.2 + half_disc / 2.0, rel=1e-6)


def test_a_turned_table_cuts_along_its_own_edges() -> None:
    """By 45°: its corner points along x, and lies half of its diagonal from its centre."""
    joints = np.array([[0.0, 0.0, 0.5], [1.0, 0.0, 0.5]])
    assert strips_on(square(0.0, 0.2, np.pi / 4.0), joints)[:, 0].max() == pytest.approx(0.2 * np.sqrt(2.0))


def test_what_is_below_or_beside_a_table_puts_no_shadow_on_it() -> None:
    below = np.array([[0.0, 0.0, 0.05], [0.1, 0.0, 0.1]])
    beside = np.array([[1.0, 0.0, 0.5], [1.5, 0.0, 0.5]])
    for joints in (below, beside):
        assert area(strips_on(square(0.0, 0.2), joints)) == 0.0
    tilted = np.array([0.0, 0.0, 0.0, math.cos(0.2), math.sin(0.2), 0.0, 0.0])
    assert top_of(np.array([1.0, 1.0, 0.1]), tilted) is None


def test_a_shadow_on_a_table_goes_when_the_table_does(still: Served) -> None:
    shadow, joints = Shadow(still.server.scene), np.array([[0.0, 0.0, 0.4], [0.3, 0.0, 0.5]])
    assert shadow.show(joints, 0.0, [square(0.0, 0.2)])
    assert not shadow.show(joints, 0.0, [square(0.0, 0.2)])
    assert shadow.show(joints, 0.0, [square(0.1, 0.2)]), "the table was moved"
    mesh = shadow._mesh
    assert mesh is not None
    assert sorted(set(np.round(mesh.vertices[:, 2], 3))) == [SHADE_LIFT, 0.2 + SHADE_LIFT]
    assert mesh.faces.max() == len(mesh.vertices) - 1
    floor = mesh.vertices[: 2 * len(CAP)]
    assert (floor == floor[0]).all(), "the table keeps the light from the floor"
    assert shadow.show(joints, 0.0)
    assert len(shadow._mesh.vertices) == 2 * len(CAP)  # type: ignore[union-attr]
