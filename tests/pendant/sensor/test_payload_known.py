"""What is known of the payload's error and the sensor's bias: from which postures, and who must not spoil it."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from pendant.limits.residual import PayloadError
from pendant.limits.validity import WINDOW
from pendant.sensor.payload_known import STILL, STOOD, PayloadKnown
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate

SPEC = SensorSpec()
BIAS = np.array([3.0, -2.0, 3.5])
LEAST = 0.3
"""What is known better than this is told [kg]."""

NONE = np.zeros(3)


class Arm:
    """Stands in one posture after the other; the sensor has a bias and no noise."""

    def __init__(self, wrong: float = 0.0, load: float = 0.0) -> None:
        self.known, self.tick = PayloadKnown(SPEC), 0
        self.R: NDArray[np.float64] = np.eye(3)
        self.wrong, self.load, self.bias = wrong, load, BIAS

    def turn(self, degrees: float) -> "Arm":
        """Gravity turns by so much in the flange, about its x axis; ten seconds pass."""
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        self.R = self.R @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
        self.known.move()
        self.tick += round(10.0 / TICK)
        return self

    def felt(self, hand: NDArray[np.float64] = NONE) -> tuple[Estimate, tuple[float, float, float]]:
        value = estimate(self.tick, load_mass=self.load)
        value.R_BF = self.R
        weight = self.wrong * -value.g_B @ self.R
        x, y, z = (hand - self.bias - weight).tolist()
        return value, (x, y, z)

    def stand(self, windows: int = 2 * STOOD, hand: NDArray[np.float64] = NONE) -> "Arm":
        for _ in range(windows):
            self.tick += WINDOW
            self.known.learn(*self.felt(hand))
        return self

    def told(self, hand: NDArray[np.float64] = NONE) -> PayloadError | None:
        return self.known.told(*self.felt(hand))

    @property
    def mass(self) -> float:
        told = self.told()
        return math.nan if told is None else told.mass

    @property
    def margin(self) -> float:
        told = self.told()
        return math.inf if told is None else told.margin

    @property
    def sure(self) -> bool:
        return self.margin <= LEAST

    def down(self, force: float) -> NDArray[np.float64]:
        """A hand that pulls along gravity, axes of F [N]."""
        return np.array([0.0, 0.0, -force]) @ self.R


def across(force: float) -> NDArray[np.float64]:
    """A hand that pulls across gravity in every posture here, axes of F [N]."""
    return np.array([force, 0.0, 0.0])


@pytest.mark.parametrize("wrong", [0.0, 0.5])
def test_in_one_posture_the_bias_may_be_the_payload(wrong: float) -> None:
    arm = Arm(wrong)
    assert arm.told() is None
    assert arm.stand().told() is None


@pytest.mark.parametrize("wrong", [-1.0, -0.5, 0.0, 0.5])
@pytest.mark.parametrize("degrees", [30.0, 60.0, 90.0, 150.0])
def test_in_two_they_are_told_apart(wrong: float, degrees: float) -> None:
    arm = Arm(wrong).stand().turn(degrees)
    for _ in range(2):
        assert arm.mass == pytest.approx(wrong, abs=0.05)
        assert arm.sure
        arm.stand()


@pytest.mark.parametrize(("windows", "teaches"), [(STOOD - 1, True), (STOOD, False)])
def test_of_a_posture_that_is_known_well_one_window_in_so_many_is_looked_at(windows: int, teaches: bool) -> None:
    """A hand that has gone again by then was not seen; one that is there then spoils the posture."""
    arm = Arm(0.5).stand(STOOD).stand(windows, across(9.0)).turn(60.0)
    assert arm.sure is teaches


def test_upside_down_a_bias_along_gravity_may_still_be_another_payload() -> None:
    assert not Arm().stand().turn(180.0).sure


def test_the_less_gravity_turns_and_the_heavier_the_load_the_less_is_known() -> None:
    told = [Arm(load=load).stand().turn(degrees).margin for load, degrees in ((0.0, 60.0), (5.0, 60.0), (0.0, 5.0))]
    assert told == sorted(told)
    assert told[1] > 1.1 * told[0]
    assert told[2] > LEAST


def test_the_longer_the_sensor_was_not_seen_the_less_is_known() -> None:
    arm, margins = Arm().stand().turn(60.0).stand().turn(60.0), list[float]()
    for seconds in (0.0, 60.0, 600.0):
        arm.tick += round(seconds / TICK)
        margins.append(arm.margin)
    assert margins == sorted(margins)
    assert margins[0] < 0.2 < margins[-1]


def test_a_sensor_that_was_out_is_learned_again() -> None:
    arm = Arm().stand().turn(60.0)
    assert arm.sure
    arm.known.forget()
    assert not arm.sure
    assert state_of(arm.known) == state_of(PayloadKnown(SPEC))


def test_another_load_leaves_what_is_known_of_the_bias() -> None:
    arm = Arm().stand().turn(60.0).stand().turn(60.0).stand()
    arm.known.change()
    arm.wrong = 0.5
    assert arm.mass == pytest.approx(0.5, abs=0.05)
    assert arm.stand().mass == pytest.approx(0.5, abs=0.05)
    assert arm.sure


def test_with_another_load_one_other_posture_tells_nothing() -> None:
    arm = Arm().stand().turn(60.0)
    arm.known.change()
    assert not arm.sure


@pytest.mark.parametrize(("postures", "sure"), [(1, False), (2, True)])
def test_a_payload_that_was_gripped_on_the_way_is_told_from_two_other_postures(postures: int, sure: bool) -> None:
    arm = Arm()
    for _ in range(postures):
        arm.stand().turn(60.0)
    arm.wrong = 0.7
    assert arm.sure is sure
    if sure:
        assert arm.mass == pytest.approx(0.7, abs=0.05)
    arm.stand()
    assert arm.sure is sure


def test_postures_that_differ_in_what_is_not_felt_are_one() -> None:
    """Turned about the vertical."""
    arm = Arm().stand().turn(60.0)
    for _ in range(3):
        arm.R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ arm.R
        arm.stand(STOOD).turn(0.0)
    arm.turn(30.0).wrong = 0.7
    assert arm.sure, "of the two before, one is another"
    lone = Arm().stand().turn(0.0).stand().turn(60.0)
    lone.wrong = 0.7
    assert not lone.sure


@pytest.mark.parametrize(("windows", "sure"), [(STOOD - 1, False), (STOOD, True)])
def test_where_it_stood_for_less_than_a_second_nothing_is_learned(windows: int, sure: bool) -> None:
    arm = Arm().stand(windows).turn(60.0)
    assert arm.sure is sure


@pytest.mark.parametrize("force", [-5.0, 5.0])
def test_a_hand_along_gravity_in_another_posture_is_no_bias(force: float) -> None:
    arm = Arm()
    arm.stand(hand=arm.down(force)).turn(60.0)
    assert not arm.sure, "it was there all the time: today's limits decide"
    for _ in range(3):
        arm.stand().turn(60.0)
    assert arm.sure
    assert arm.mass == pytest.approx(0.0, abs=0.05)


def test_a_payload_may_come_while_the_arm_stands() -> None:
    arm = Arm().stand().turn(60.0).stand().turn(60.0).stand()
    arm.wrong = 1.0
    assert arm.stand(1).mass == pytest.approx(1.0, abs=0.05)
    assert arm.sure


def test_where_a_hand_comes_or_goes_nothing_is_learned() -> None:
    arm, twin = Arm().stand().turn(60.0), Arm().stand().turn(60.0)
    arm.stand().stand(hand=across(3.0)).stand()
    twin.tick = arm.tick
    assert arm.told() == twin.told()
    assert arm.turn(60.0).told() == twin.turn(60.0).told()
    assert arm.stand().told() == twin.stand().told(), "and the next posture teaches as any"
    assert not Arm().stand(hand=across(3.0)).stand().turn(60.0).sure, "it may have been there from the beginning"


def test_a_hand_is_waited_for_to_let_go() -> None:
    arm = Arm().stand().turn(60.0).stand().turn(60.0).stand(STOOD, across(3.0))
    assert arm.told(across(3.0)) is None, "it contradicts: the force alone counts"
    assert arm.stand(1).sure, "nothing was given up"


@pytest.mark.parametrize(("windows", "kept"), [(STILL - 1, True), (STILL, False)])
def test_what_contradicts_for_five_seconds_is_the_sensor(windows: int, kept: bool) -> None:
    arm = Arm().stand().turn(60.0).stand().turn(60.0)
    stepped = BIAS + across(3.0)
    arm.bias = stepped
    arm.stand(windows)
    arm.bias = BIAS
    assert arm.sure is kept
    arm.bias = stepped
    assert arm.stand(STILL + STOOD).turn(60.0).mass == pytest.approx(0.0, abs=0.05)


def test_contradictions_are_counted_over_several_postures() -> None:
    arm = Arm().stand().turn(60.0).stand().turn(60.0)
    arm.bias = BIAS + across(3.0)
    arm.stand(STILL // 2).turn(60.0).stand(STILL // 2)
    arm.bias = BIAS
    assert not arm.sure


@pytest.mark.parametrize("force", [50.0, 1e6])
def test_a_strong_pull_across_is_no_payload_that_is_known(force: float) -> None:
    assert Arm().stand().turn(60.0).stand().turn(60.0).told(across(force)) is None


def test_a_drift_as_the_maker_says_it_is_followed() -> None:
    arm = Arm().stand().turn(60.0).stand().turn(60.0)
    for _ in range(600):
        arm.bias = arm.bias + 0.5 * SPEC.drift_force * np.array([1.0, 1.0, -1.0]) * WINDOW * TICK
        arm.stand(1)
    assert arm.sure
    assert arm.mass == pytest.approx(0.0, abs=0.05)
