"""The user's force: apart from what was there before, from a payload, from noise; by the sensor or by the joints alone."""

import math

import numpy as np
import pytest

from pendant.estimate import Estimate
from pendant.hand import CARRIED, FELT_BY_JOINTS, JOINTS_SWING, LED, LED_SETTLING, OFFSET, ON_A_LINK, SETTLING, SWING, Hand
from pendant.modes import TICK
from pendant.pose import Vector
from tests.pendant.estimates import estimate

ZEROS = (0.0,) * 6


def after(hand: Hand, seconds: float, value: Estimate, use_wrench: bool = True) -> Vector:
    for _ in range(round(seconds / TICK)):
        hand.step(value, use_wrench)
    return hand.user


def test_what_the_sensor_felt_before_is_nobody_and_turns_with_the_flange() -> None:
    baseline = (3.0, -1.0, 2.0, 0.0, 0.0, 0.0)
    hand = Hand(estimate(), baseline)
    assert after(hand, 1.0, estimate(force=[3.0, -1.0, 2.0])) == pytest.approx((0.0, 0.0, 0.0))
    assert hand.payload == pytest.approx((0.0, 0.0, 2.0))
    turned = estimate(force=[1.0, 3.0, 2.0])  # a quarter about z
    turned.R_BF = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert after(hand, 1.0, turned) == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_what_is_too_much_for_an_offset_is_a_payloads_and_does_not_turn(sign: float) -> None:
    hand = Hand(estimate(), (0.0, 0.0, sign * 30.0, 0.0, 0.0, 0.0))
    tipped = estimate(force=[sign * OFFSET, 0.0, sign * (30.0 - OFFSET)])
    tipped.R_BF = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # z of F along x of B
    assert after(hand, 1.0, tipped) == pytest.approx((0.0, 0.0, 0.0))


def test_a_push_across_gravity_stays_the_users() -> None:
    hand = Hand(estimate(), ZEROS)
    assert after(hand, SWING, estimate(force=20.0))[0] == pytest.approx(20.0 * (1.0 - math.exp(-1.0)), rel=1e-6)
    assert hand.change == (20.0, 0.0, 0.0)
    assert after(hand, 10.0, estimate(force=20.0)) == pytest.approx((20.0, 0.0, 0.0))


def test_a_change_along_gravity_becomes_payload_like() -> None:
    hand = Hand(estimate(), ZEROS)
    down = estimate(force=[0.0, 0.0, -20.0])
    assert after(hand, 0.1, down)[2] < -15.0
    after(hand, SETTLING - 0.1, down)
    assert hand.payload[2] == pytest.approx(-20.0 * (1.0 - math.exp(-1.0)), rel=1e-3)
    assert after(hand, 12.0, down) == pytest.approx((0.0, 0.0, 0.0), abs=0.05)


def test_while_the_arm_is_led_that_takes_longer() -> None:
    down = {"force": [0.0, 0.0, -2.0]}
    slow, led = Hand(estimate(), ZEROS), Hand(estimate(), ZEROS)
    after(slow, 2.0, estimate(speed=0.99 * LED, **down))  # type: ignore[arg-type]
    after(led, 2.0, estimate(speed=1.01 * LED, **down))  # type: ignore[arg-type]
    assert slow.payload[2] == pytest.approx(-2.0 * (1.0 - math.exp(-2.0 / SETTLING)), rel=1e-3)
    assert led.payload[2] == pytest.approx(-2.0 * (1.0 - math.exp(-2.0 / LED_SETTLING)), rel=1e-3)


def test_without_a_sensor_the_joints_tell_from_a_size_on() -> None:
    hand = Hand(estimate(felt=[5.0, 0.0, 0.0]), ZEROS)
    assert after(hand, 2.0, estimate(felt=[4.0 + FELT_BY_JOINTS, 0.0, 0.0], force=50.0), use_wrench=False) == (0.0, 0.0, 0.0)
    assert after(hand, 2.0, estimate(felt=[25.0, 0.0, 0.0]), use_wrench=False) == pytest.approx((20.0, 0.0, 0.0), abs=1e-3)
    hand = Hand(estimate(), ZEROS)
    assert after(hand, JOINTS_SWING, estimate(felt=100.0), use_wrench=False)[0] == pytest.approx(100.0 * (1 - math.exp(-1)))


def test_a_push_on_a_link_is_felt_by_the_joints_alone() -> None:
    hand = Hand(estimate(), ZEROS)
    assert after(hand, 2.0, estimate(felt=[0.0, 20.0, 0.0], force=3.0)) == pytest.approx((0.0, 20.0, 0.0), abs=1e-3)
    assert after(hand, 2.0, estimate(felt=[0.0, 20.0, 0.0], force=16.0)) == pytest.approx((16.0, 0.0, 0.0), abs=1e-3)


@pytest.mark.parametrize(
    ("felt", "force", "user"),
    [
        (1.001 * ON_A_LINK, 0.0, "joints"),
        (0.999 * ON_A_LINK, 0.0, "sensor"),
        (1.001 * ON_A_LINK, 0.999 * CARRIED, "joints"),
        (1.001 * ON_A_LINK, CARRIED, "sensor"),
        (1.001 * FELT_BY_JOINTS, CARRIED, "joints"),
    ],
)
def test_a_gentle_push_on_a_link_counts_while_the_sensor_feels_nothing(felt: float, force: float, user: str) -> None:
    """VW-5: the tether follows who leads the arm by its elbow; what falls from the flange, the sensor would feel."""
    hand = Hand(estimate(), ZEROS)
    found = after(hand, 2.0, estimate(felt=[0.0, felt, 0.0], force=force))
    assert found == pytest.approx((0.0, felt, 0.0) if user == "joints" else (force, 0.0, 0.0), abs=1e-3)


def test_without_a_sensor_a_gentle_push_on_a_link_does_not_count() -> None:
    hand = Hand(estimate(), ZEROS)
    assert after(hand, 2.0, estimate(felt=[0.0, 0.9 * FELT_BY_JOINTS, 0.0]), use_wrench=False) == (0.0, 0.0, 0.0)


def test_a_payload_that_the_joints_feel_is_payload_like() -> None:
    hand = Hand(estimate(), ZEROS)
    after(hand, 20.0, estimate(felt=[0.0, 0.0, -18.0]), use_wrench=False)
    assert hand.payload == pytest.approx((0.0, 0.0, -18.0), abs=1e-3)
    assert hand.user == (0.0, 0.0, 0.0)


def test_equal_histories_are_equal() -> None:
    one, two = Hand(estimate(), ZEROS), Hand(estimate(), ZEROS)
    assert one.memory == two.memory
    one.step(estimate(force=1.0), True)
    assert one.memory != two.memory


def test_a_small_change_beside_a_wrong_payload_is_nobodys() -> None:
    hand = Hand(estimate(), (0.0, 0.0, -OFFSET - 20.0, 0.0, 0.0, 0.0))
    assert after(hand, 1.0, estimate(force=[9.0, 0.0, -OFFSET - 20.0])) == (0.0, 0.0, 0.0)
    assert after(hand, 1.0, estimate(force=[11.0, 0.0, -OFFSET - 20.0])) == pytest.approx((11.0, 0.0, 0.0))
