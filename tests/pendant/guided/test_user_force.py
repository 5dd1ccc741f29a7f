"""The user's force: apart from what was there before, from a payload, from noise; by the sensor or by the joints alone."""

import math

import numpy as np
import pytest

from pendant.guided.user_force import JOINTS_SWING, SWING, UserForce
from pendant.sensor.hand_model import HALF, KEEPS, STEADY
from pendant.tick.estimate import Estimate, JointsFeel
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector
from pendant.tick.state import state_of
from tests.pendant.estimates import MOVES, SENSOR, estimate

ZEROS = (0.0,) * 6


def after(hand: UserForce, seconds: float, value: Estimate, use_wrench: bool = True) -> Vector:
    for _ in range(round(seconds / TICK)):
        hand.step(value, use_wrench, MOVES)
    return hand.user


def test_what_the_sensor_felt_before_is_nobody_and_turns_with_the_flange() -> None:
    baseline = (3.0, -1.0, 2.0, 0.0, 0.0, 0.0)
    hand = UserForce(estimate(), baseline, SENSOR.offset_force)
    assert after(hand, 1.0, estimate(force=[3.0, -1.0, 2.0])) == pytest.approx((0.0, 0.0, 0.0))
    assert hand.payload == pytest.approx((0.0, 0.0, 2.0))
    turned = estimate(force=[1.0, 3.0, 2.0])  # a quarter about z
    turned.R_BF = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert after(hand, 1.0, turned) == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_what_is_too_much_for_an_offset_is_a_payloads_and_does_not_turn(sign: float) -> None:
    hand = UserForce(estimate(), (0.0, 0.0, sign * 30.0, 0.0, 0.0, 0.0), SENSOR.offset_force)
    tipped = estimate(force=[sign * SENSOR.offset_force, 0.0, sign * (30.0 - SENSOR.offset_force)])
    tipped.R_BF = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # z of F along x of B
    assert after(hand, 1.0, tipped) == pytest.approx((0.0, 0.0, 0.0))


def test_a_push_across_gravity_stays_the_users() -> None:
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    assert after(hand, SWING, estimate(force=20.0))[0] == pytest.approx(20.0 * (1.0 - math.exp(-1.0)), rel=1e-6)
    assert hand.change == (20.0, 0.0, 0.0)
    assert after(hand, 10.0, estimate(force=20.0)) == pytest.approx((20.0, 0.0, 0.0))


def test_a_change_along_gravity_becomes_payload_like() -> None:
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    down = estimate(force=[0.0, 0.0, -20.0])
    assert after(hand, 0.1, down)[2] < -15.0
    after(hand, KEEPS - 0.1, down)
    assert hand.payload[2] == pytest.approx(-20.0 * (1.0 - math.exp(-1.0)), rel=1e-3)
    assert after(hand, 12.0, down) == pytest.approx((0.0, 0.0, 0.0), abs=0.05)


def test_while_the_arm_is_led_that_takes_longer() -> None:
    down = {"force": [0.0, 0.0, -2.0]}
    slow, led = UserForce(estimate(), ZEROS, SENSOR.offset_force), UserForce(estimate(), ZEROS, SENSOR.offset_force)
    after(slow, 2.0, estimate(speed=MOVES, **down))  # type: ignore[arg-type]
    after(led, 2.0, estimate(speed=1.01 * MOVES, **down))  # type: ignore[arg-type]
    assert slow.payload[2] == pytest.approx(-2.0 * (1.0 - math.exp(-2.0 / KEEPS)), rel=1e-3)
    assert led.payload[2] == pytest.approx(-2.0 * (1.0 - math.exp(-2.0 / STEADY)), rel=1e-3)


def by_joints(felt: list[float], feel: JointsFeel = JointsFeel.HAND) -> Estimate:
    """The joints feel this force at the flange, and take it for this; a sensor that is not used feels 50 N."""
    value = estimate(felt=felt, force=50.0)
    value.whose = value.whose._replace(joints_feel=feel)
    return value


def test_without_a_sensor_the_joints_tell_a_hand() -> None:
    hand = UserForce(estimate(felt=[5.0, 0.0, 0.0]), ZEROS, SENSOR.offset_force)
    assert after(hand, 2.0, by_joints([25.0, 0.0, 0.0]), use_wrench=False) == pytest.approx((20.0, 0.0, 0.0), abs=1e-3)
    assert hand.by_joints
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    found = after(hand, JOINTS_SWING, by_joints([100.0, 0.0, 0.0]), use_wrench=False)
    assert found[0] == pytest.approx(100.0 * (1 - math.exp(-1)))


@pytest.mark.parametrize("feel", [JointsFeel.NOTHING, JointsFeel.FALL])
def test_without_a_sensor_errors_and_a_fall_are_nobodys(feel: JointsFeel) -> None:
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    assert after(hand, 2.0, by_joints([40.0, 0.0, 0.0], feel), use_wrench=False) == (0.0, 0.0, 0.0)
    assert not hand.by_joints


@pytest.mark.parametrize("link", [(0.0, 20.0, 0.0), (0.0, 0.0, -0.5), (-3.0, 0.0, 0.0)])
@pytest.mark.parametrize("force", [0.0, 3.0, 30.0])
def test_a_hand_on_a_link_is_felt_beside_one_at_the_flange(force: float, link: tuple[float, float, float]) -> None:
    """VW-5: the tether follows who leads the arm by its elbow, at once, as the estimator has told errors from it."""
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    after(hand, 2.0, estimate(force=force))
    assert hand.user == pytest.approx((force, 0.0, 0.0))
    assert not hand.by_joints
    both = after(hand, TICK, estimate(force=force, link=list(link), felt=[50.0, 0.0, 0.0]))
    assert both == pytest.approx((force + link[0], link[1], link[2]))
    assert hand.by_joints


def test_a_payload_that_the_joints_feel_is_payload_like() -> None:
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    after(hand, 20.0, estimate(felt=[0.0, 0.0, -18.0]), use_wrench=False)
    assert hand.payload == pytest.approx((0.0, 0.0, -18.0), abs=1e-3)
    assert hand.user == (0.0, 0.0, 0.0)


def share(time: float) -> float:
    """Of a change that a filter follows in one tick."""
    return 1.0 - math.exp(-TICK / time)


@pytest.mark.parametrize(("felt", "force"), [(0.0, 3.0), (0.0, 40.0), (20.0, 3.9), (20.0, 60.0), (60.0, 8.0)])
@pytest.mark.parametrize("use_wrench", [True, False])
@pytest.mark.parametrize("beforehand", [2.0, 30.0])
def test_it_is_told_alike_however_base_flange_and_forces_lie(
    felt: float, force: float, use_wrench: bool, beforehand: float
) -> None:
    """Against numpy: the base is tilted, the flange turns, the speed is now below `MOVES` and now above; 0.15 s."""
    rng = np.random.default_rng(round(felt + force))

    def unit() -> np.ndarray:
        return rng.dirichlet([9.0] * 3) ** 0.5 * rng.choice([-1.0, 1.0], 3)  # no component is near 0

    def attitude() -> np.ndarray:
        return np.linalg.qr(rng.normal(size=(3, 3)))[0]

    up, by_joints, by_sensor, slow, slow_joints = unit(), np.zeros(3), np.zeros(3), 0.0, 0.0
    first = estimate(felt=(5.0 * unit()).tolist())
    first.g_B, first.R_BF = -9.81 * up, attitude()
    before = beforehand * up + 2.0 * unit()
    hand = UserForce(first, (*before.tolist(), 0.0, 0.0, 0.0), SENSOR.offset_force)
    assert (hand.user, hand.change, hand.payload) == (ORIGIN,) * 3
    residual = before @ up
    payload = residual - np.clip(residual, -SENSOR.offset_force, SENSOR.offset_force)
    offset = first.R_BF.T @ (before - payload * up)
    joints_feel, sensor_feels = felt * unit(), force * unit()
    for tick in range(75):
        now = estimate().copy()
        now.R_BF, now.v_F[:3] = attitude(), (0.9 if tick % 3 else 1.1) * MOVES * unit()
        now.F_joints = first.F_joints + joints_feel
        change = sensor_feels + 0.2 * unit()
        now.F_user[:3] = change + payload * up + now.R_BF @ offset
        settle = share(KEEPS if tick % 3 else STEADY)
        slow_joints += settle * (joints_feel @ up - slow_joints)
        by_joints += share(JOINTS_SWING) * (joints_feel - slow_joints * up - by_joints)
        feels = tick % 2 == 0
        now.whose = now.whose._replace(joints_feel=JointsFeel.HAND if feels else JointsFeel.NOTHING)
        now.whose = now.whose._replace(F_link=joints_feel if feels else np.zeros(3))
        user, gone = by_joints if feels else np.zeros(3), slow_joints
        if use_wrench:
            slow += settle * (change @ up - slow)
            by_sensor += share(SWING) * (change - slow * up - by_sensor)
            user = by_sensor + now.whose.F_link
            gone = residual + slow
            change_seen = change
        else:
            change_seen = np.zeros(3)
        counts = np.linalg.norm(user) >= HALF * abs(payload)
        hand.step(now, use_wrench, MOVES)
        assert hand.user == pytest.approx(user if counts else np.zeros(3))
        assert hand.change == pytest.approx(change_seen)
        assert hand.payload == pytest.approx(gone * up)


def test_a_force_counts_from_its_limit_on() -> None:
    """In one tick, from rest, which lets the limit be reached: half of a payload that was wrong at entry."""
    hand = UserForce(estimate(), (0.0, 0.0, SENSOR.offset_force + 20.0, 0.0, 0.0, 0.0), SENSOR.offset_force)
    force = HALF * 20.0 / share(SWING)
    hand.step(estimate(force=[force, 0.0, SENSOR.offset_force + 20.0]), True, MOVES)
    assert hand.user == (share(SWING) * force, 0.0, 0.0)


def test_equal_histories_are_equal() -> None:
    one, two = UserForce(estimate(), ZEROS, SENSOR.offset_force), UserForce(estimate(), ZEROS, SENSOR.offset_force)
    assert state_of(one) == state_of(two)
    one.step(estimate(force=1.0), True, MOVES)
    assert state_of(one) != state_of(two)


def test_a_small_change_beside_a_wrong_payload_is_nobodys() -> None:
    hand = UserForce(estimate(), (0.0, 0.0, -SENSOR.offset_force - 20.0, 0.0, 0.0, 0.0), SENSOR.offset_force)
    assert after(hand, 1.0, estimate(force=[9.0, 0.0, -SENSOR.offset_force - 20.0])) == (0.0, 0.0, 0.0)
    assert after(hand, 1.0, estimate(force=[11.0, 0.0, -SENSOR.offset_force - 20.0])) == pytest.approx((11.0, 0.0, 0.0))


@pytest.mark.parametrize("up", [1.0, -1.0])
@pytest.mark.parametrize(
    ("across", "along", "slow", "least"),
    [
        (3.0, 4.0, 0.0, 5.0),
        (3.0, 4.0, 9.0, 5.0),  # more of it were a payload's: then the force is larger
        (3.0, 4.0, -1.0, math.hypot(3.0, 3.0)),
        (3.0, 4.0, -9.0, 3.0),  # all along gravity may be that
        (0.0, 4.0, -1.0, 3.0),
        (3.0, 0.0, -9.0, 3.0),
    ],
)
def test_what_was_steady_along_gravity_may_have_been_a_hands(
    across: float, along: float, slow: float, least: float, up: float
) -> None:
    """So much of the force is certain, whatever of that was a payload's."""
    hand = UserForce(estimate(), ZEROS, SENSOR.offset_force)
    hand.user, hand._slow = (across, 0.0, up * along), up * slow
    assert hand.surely(least - 1e-9)
    assert not hand.surely(least + 1e-9)
