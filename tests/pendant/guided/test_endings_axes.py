"""What a hand at the flange does on the way to an ending: its torque in every posture, its work, its drift (FD-12b, FD-19)."""

import math

import numpy as np
import pytest

from pendant.all_settings import Settings
from pendant.events.event import Kind
from pendant.guided.endings import CALM, STAYS, EndingWatch, _torque, way_back
from pendant.guided.sensor_bias import Slack
from pendant.guided.user_force import UserForce
from pendant.tick.pose import from_rpy
from tests.pendant.estimates import estimate
from tests.pendant.guided.test_endings import FRICTION, JOINTS, PAYS, RATED, TWO, ZEROS, Free, elbow, loaded


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


@pytest.mark.parametrize(("before", "suspected"), [(0.2, False), (0.17, True)])
def test_in_free_fall_a_step_is_a_share_of_the_little_that_a_load_needs(before: float, suspected: bool) -> None:
    """It needs 0.5 N; 0.45 N are missing now. Of that the step must be 0.6, so that at most 0.18 N were missing before."""
    assert before < (1.0 - STAYS) * 0.45 or not suspected
    operation = EndingWatch(estimate(), Settings(), joints=JOINTS, rated=RATED, held=0.0)
    hand = UserForce(estimate(), ZEROS)  # of a force that does not fluctuate
    for missing in (before, before, 0.45):
        operation.step(loaded(force=[0.0, 0.0, missing], needed=[0.0, 0.0, 0.5]), hand, baseline=ZEROS, driven=False)
        assert operation.suspect is (suspected and missing == 0.45)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize(("spread", "suspected"), [(3.3, True), (3.4, False)])
def test_a_step_of_a_load_must_stand_out_by_its_own_size(axis: int, spread: float, suspected: bool) -> None:
    """A steady 5 N across is no part of a step of 10 N, which is three times 3.33 N."""
    operation = EndingWatch(estimate(), Settings(), joints=JOINTS, rated=RATED, held=0.0)
    hand = UserForce(estimate(), ZEROS)
    hand._spread = spread * spread
    across = [5.0 if k == axis else 0.0 for k in range(2)]
    for along in (0.0, 0.0, 0.0, 10.0):
        operation.step(loaded(force=[*across, along], needed=TWO), hand, baseline=ZEROS, driven=False)
    assert operation.suspect is suspected


def test_an_arm_that_swings_by_just_so_much_is_calm() -> None:
    """Of 4 N², squares of 5.2 N² are 0.3 beyond; a bit more swings. A small step after ten such ticks is one, or is none."""
    assert pytest.approx(0.3) == CALM
    found = []
    for more in (-1e-6, 1e-6):
        free = Free()
        needed = [0.0, 0.0, TWO[2] * math.sqrt(1.0 + CALM + more)]
        assert free.until([loaded(needed=needed)] * 20) is None
        free.see(loaded(force=[0.0, 0.0, 0.3 * needed[2]], needed=needed))
        found.append(free.operation.suspect)
    assert found == [True, False]


def test_the_way_back_needs_an_angle_of_every_joint() -> None:
    for then, now in ((5, 6), (6, 5), (6, 7)):
        with pytest.raises(ValueError, match="zip"):
            way_back((0.0,) * then, (0.1,) * now, JOINTS)
