"""The ghost that moves is where the arm would be."""

import numpy as np

from app.web.scene.moving_ghost import MovingGhost
from app.web.server import Served
from sim.arm.frames import joint_frames, matrix_from_quaternion
from tests.app.web.fake_loop import ARM, HOME, FakeLoop


def test_each_limb_leads_from_one_joint_to_the_next(served: Served, loop: FakeLoop) -> None:
    ghost = MovingGhost(served.server, ARM, "/ghost/test", (1, 2, 3))
    snapshot = loop.latest()
    assert ghost.posture is None
    assert not ghost.show(None, snapshot)
    posture = (HOME + 0.3).tolist()
    assert ghost.show(posture, snapshot)
    assert ghost.posture == tuple(posture)
    assert not ghost.show(posture, snapshot)
    frames = joint_frames(ARM, np.array(posture))
    assert len(ghost._limbs) == 6
    for k, node in ghost._limbs:
        R = matrix_from_quaternion(np.array(node.wxyz))
        corners = np.array(node.vertices) @ R.T + np.array(node.position)
        np.testing.assert_allclose(corners.mean(axis=0), (frames[k][:3, 3] + frames[k + 1][:3, 3]) / 2.0, atol=0.005)
    assert ghost.show(None, snapshot)
    assert not ghost._root.visible
