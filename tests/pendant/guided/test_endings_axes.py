"""What a hand at the flange does on the way to an ending: its torque in every posture, its work, its drift (FD-12b, FD-19)."""

import math

import numpy as np
import pytest

from pendant.events.event import Kind
from pendant.guided.bias_follower import Slack
from pendant.guided.endings import _torque, way_back
from pendant.tick.pose import from_rpy
from tests.pendant.estimates import estimate
from tests.pendant.guided.test_endings import FRICTION, JOINTS, PAYS, ZEROS, Free, elbow


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("turn", [(0.3, -0.5, 0.8), (math.pi / 2.0, 0.0, 0.0), (0.0, -math.pi / 2.0, 0.0), (-1.0, 1.2, 2.0)])
def test_the_hands_torque_is_without_a_bias_that_turns_with_the_flange(turn: tuple[float, float, float], axis: int) -> None:
    """Whatever the bias was about one axis of the flange, it is gone; and the force's is none of it."""
    R_BF = np.array(from_rpy(*turn)).reshape(3, 3)
    bias = np.eye(3)[axis] * 0.7
    hand = np.array([0.2, -0.4, 0.6])
    value = estimate(torque=(hand + R_BF @ bias).tolist())
    value.R_BF = R_BF
    assert _torque(value, (9.0, 9.0, 9.0, *bias.tolist())) == pytest.approx(hand)


@pytest.mark.parametrize(("force", "stopped"), [(2.9, True), (3.1, False)])
def test_a_force_that_may_be_the_sensors_drift_does_not_move_the_arm(force: float, stopped: bool) -> None:
    """Two newtons may be drift, and one is the least of a hand."""
    free = Free()
    free.slack = Slack(2.0, 0.2)
    free.hand.user = (0.0, -force, 0.0)
    endings = [
        free.operation.step(estimate(speed=0.03), free.hand, baseline=ZEROS, driven=False, slack=free.slack) for _ in range(151)
    ]
    assert [ending.kind for ending in endings if ending] == [Kind.STOPPED_MOTION] * stopped


@pytest.mark.parametrize(("share", "stopped"), [(1.01, False), (0.3, True), (-1.01, True)])
def test_a_torque_of_the_hand_at_the_flange_pays_for_the_motion(share: float, stopped: bool) -> None:
    """The elbow's friction costs PAYS at 0.2 rad/s; the flange turns by 1 rad/s about x."""
    free, value = Free(), elbow(0.0)
    value.v_F[3] = 1.0
    value.F_user[3] = share * PAYS * 0.2
    assert (free.until([value] * 400) is not None) is stopped
    assert PAYS < FRICTION


def test_the_way_back_needs_an_angle_of_every_joint() -> None:
    for then, now in ((5, 6), (6, 5), (6, 7)):
        with pytest.raises(ValueError, match="zip"):
            way_back((0.0,) * then, (0.1,) * now, JOINTS)
