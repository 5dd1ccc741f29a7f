"""The shadow on the floor."""

import numpy as np
import pytest

from app.web.scene.stage import CAP, SHADE_LIFT, SHADE_RADIUS, Shadow, strips
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
