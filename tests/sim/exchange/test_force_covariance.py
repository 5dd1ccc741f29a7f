"""How far off the user's force may be: each of its causes alone, against what it makes by hand (FD-19)."""

import math

import numpy as np
import pytest

from pendant.guided.user_force import JOINTS_SWING, SWING, Doubts, TakenForce, UserForce, upward_in_flange
from pendant.limits.validity import WINDOW
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import GRAVITY, Estimate, JointsFeel
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector
from sim.exchange.told_force import WITHIN_95, UncertainForce, covariance
from tests.pendant.estimates import MOVES, SENSOR, estimate

UP = (0.0, 0.0, 1.0)
KILOGRAM = 0.4  # of doubt about the payload
QUIET = SensorSpec(noise_force=0.0, noise_acceleration=0.0, gain=0.0)
ONCE = 1.0 - math.exp(-TICK / SWING)
FILTERED = ONCE / (2.0 - ONCE) + 1.0 / WINDOW


def told(force: Vector = ORIGIN, rest: Vector = ORIGIN, fluctuation: float = 0.0, slack: float = 0.0) -> TakenForce:
    (x, y, z), (a, b, c) = force, rest
    return TakenForce(force, Doubts((x + a, y + b, z + c), fluctuation, slack, UP))


def ellipsoid(seen: UncertainForce) -> tuple[np.ndarray, np.ndarray]:
    found = seen.ellipsoid()
    assert found is not None
    return found


def tipped(load_mass: float = 0.0) -> Estimate:
    """What was upward in the flange at entry lies along x of B now."""
    value = estimate(load_mass=load_mass)
    value.R_BF = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    return value


def test_on_an_arm_at_rest_the_noise_alone_is_left() -> None:
    sensor, load = QUIET._replace(noise_force=0.15, noise_acceleration=0.1), 2.0
    sigma = math.sqrt(FILTERED * (0.15**2 + (0.1 * load) ** 2))
    seen = UncertainForce(ORIGIN, covariance(told(), estimate(load_mass=load), sensor, KILOGRAM))
    assert ellipsoid(seen)[0] == pytest.approx(math.sqrt(WITHIN_95) * sigma)


def test_the_filter_leaves_so_much_of_the_noise() -> None:
    rng, hand, forces = np.random.default_rng(3), UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force), []
    for _ in range(20_000):
        hand.step(estimate(force=rng.normal(size=3).tolist()), True, MOVES)
        forces.append(hand.user[:2])
    assert np.var(forces) == pytest.approx(FILTERED - 1.0 / WINDOW, rel=0.1)


def test_a_payload_cannot_be_told_from_a_steady_hand_along_gravity() -> None:
    """It explains as much of the force there as it can weigh, and nothing across."""
    for force, variance in ((3.0, 3.0), (-3.0, 3.0), (40.0, (KILOGRAM * GRAVITY) ** 2)):
        seen = covariance(told((7.0, 0.0, force)), estimate(), QUIET, KILOGRAM)
        np.testing.assert_allclose(seen, np.diag([0.0, 0.0, variance]))


def test_a_payloads_error_is_known_at_entry_and_comes_back_as_the_wrist_turns() -> None:
    np.testing.assert_allclose(covariance(told(), estimate(), QUIET, KILOGRAM), 0.0)
    moved = np.array([-1.0, 0.0, 1.0])  # of the weight: from x, where the flange has taken it, to z
    found = covariance(told(), tipped(), QUIET, KILOGRAM)
    np.testing.assert_allclose(found, (KILOGRAM * GRAVITY) ** 2 * np.outer(moved, moved), atol=1e-12)


def test_a_payloads_error_swings_with_it() -> None:
    value = estimate()
    value.a_felt = np.array([0.0, 2.0, 0.0])
    np.testing.assert_allclose(covariance(told(), value, QUIET, KILOGRAM), np.diag([0.0, (2.0 * KILOGRAM) ** 2, 0.0]), atol=1e-12)


def test_the_gain_is_a_share_of_the_force_and_of_what_the_load_needs_to_be_accelerated() -> None:
    """What it makes of the weight of a load that has turned is in the slack already."""
    sensor = QUIET._replace(gain=0.014)
    pulled = covariance(told((30.0, 0.0, 0.0)), estimate(load_mass=5.0), sensor, 0.0)
    np.testing.assert_allclose(pulled, (0.014 * 30.0) ** 2 / 3.0 * np.eye(3), atol=1e-12)
    np.testing.assert_allclose(covariance(told(), tipped(load_mass=5.0), sensor, 0.0), 0.0)
    swings = estimate(load_mass=5.0)
    swings.a_felt = np.array([0.0, 2.0, 0.0])
    np.testing.assert_allclose(covariance(told(), swings, sensor, 0.0), (0.014 * 5.0 * 2.0) ** 2 / 3.0 * np.eye(3), atol=1e-12)


def test_the_sensor_may_have_drifted_the_same_in_each_axis() -> None:
    np.testing.assert_allclose(covariance(told(slack=0.6), estimate(), QUIET, KILOGRAM), 0.12 * np.eye(3))


def test_of_what_is_not_taken_for_the_users_any_part_may_be() -> None:
    """But for noise, which is nobody's."""
    rest = (1.0, 0.0, -2.0)
    found = covariance(told(rest=rest), estimate(), QUIET, KILOGRAM)
    np.testing.assert_allclose(found, np.outer(rest, rest) / 3.0)
    loud = QUIET._replace(noise_force=1.0)
    less = covariance(told(rest=rest), estimate(), loud, KILOGRAM) - FILTERED * np.eye(3)
    np.testing.assert_allclose(less, np.outer(rest, rest) / 3.0 * (5.0 - 3.0) / 5.0, atol=1e-12)
    noise = covariance(told(rest=(1.0, 1.0, 0.5)), estimate(), loud, KILOGRAM)
    np.testing.assert_allclose(noise, FILTERED * np.eye(3))


def test_a_swing_may_be_the_users_as_far_as_it_is_more_than_noise() -> None:
    loud = QUIET._replace(noise_force=0.5)
    for fluctuation, swing in ((0.7, 0.0), (6.75, 2.0)):
        found = covariance(told(fluctuation=fluctuation), estimate(), loud, KILOGRAM)
        np.testing.assert_allclose(found, (FILTERED * 0.25 + swing / 3.0) * np.eye(3))


def test_gravity_is_the_mountings() -> None:
    """On a wall it goes along the base's x."""
    value = estimate()
    value.g_B = np.array([-GRAVITY, 0.0, 0.0])
    assert upward_in_flange(value) == (1.0, 0.0, 0.0)
    hung = TakenForce((3.0, 0.0, 4.0), Doubts((3.0, 0.0, 4.0), 0.0, 0.0, (1.0, 0.0, 0.0)))
    np.testing.assert_allclose(covariance(hung, value, QUIET, KILOGRAM), np.diag([3.0, 0.0, 0.0]), atol=1e-12)


def test_upward_at_entry_is_kept_in_the_flange() -> None:
    assert upward_in_flange(tipped()) == (-1.0, 0.0, 0.0)


@pytest.mark.parametrize("seed", range(20))
def test_the_ellipsoid_is_that_of_the_covariance(seed: int) -> None:
    root = np.random.default_rng(seed).normal(size=(3, 3))
    axes, R = ellipsoid(UncertainForce(ORIGIN, root @ root.T))
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert axes.tolist() == sorted(axes)
    np.testing.assert_allclose(R @ np.diag(axes**2 / WITHIN_95) @ R.T, root @ root.T, atol=1e-9)


def test_so_many_of_three_gaussian_numbers_are_within() -> None:
    numbers = np.random.default_rng(1).normal(size=(200_000, 3))
    assert np.mean((numbers**2).sum(axis=1) <= WITHIN_95) == pytest.approx(0.95, abs=0.002)


def test_what_the_flange_sensor_tells_comes_with_all_that_it_feels() -> None:
    hand, slack = UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force), 0.3
    assert hand.taken(slack, UP, use_wrench=True) == TakenForce(ORIGIN, Doubts(ORIGIN, 0.0, 0.3, UP))
    hand.step(estimate(force=20.0), True, MOVES)
    force, found = hand.taken(slack, UP, use_wrench=True)
    assert found is not None
    assert force == hand.user == pytest.approx((20.0 * ONCE, 0.0, 0.0))
    assert found.change == (20.0, 0.0, 0.0)
    assert found.fluctuation == hand.fluctuation > 0.0
    assert hand.fluctuation == pytest.approx((1.0 - math.exp(-TICK / JOINTS_SWING)) * 20.0**2)


@pytest.mark.parametrize(("used", "at_flange"), [(True, 0.0), (True, 2.5), (False, 0.0)])
def test_of_what_the_joints_tell_there_is_none(used: bool, at_flange: float) -> None:
    hand = UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
    value = estimate(force=[0.0, at_flange, 0.0])
    value.F_joints = link = np.array([30.0, 0.0, 0.0])
    value.whose = value.whose._replace(F_link=link, joints_feel=JointsFeel.NOTHING if used else JointsFeel.HAND)
    for _ in range(50):
        hand.step(value, used, MOVES)
    assert hand.user[0] > 15.0
    found = hand.taken(0.0, UP, use_wrench=used)
    assert found == TakenForce(hand.user, None)
    assert covariance(found, value, QUIET, KILOGRAM) is None
    assert UncertainForce(found.force, None).ellipsoid() is None
