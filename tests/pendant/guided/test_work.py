"""The work on the free arm: a hand pays for the friction that the law leaves, a free arm pays with its speed (FD-19)."""

import math

import pytest

from pendant.guided.unintended_motion import LEFT, Work
from pendant.sensor.hand_model import HALF
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate

FRICTION = (0.0, 10.0, 0.0, 2.0, 0.0, 0.0)
SPEED = 0.2  # of shoulder and wrist 1 [rad/s]
NOTHING_SURE = (0.0, 0.0)  # all may be drift
PAYS = HALF * LEFT * (FRICTION[1] + FRICTION[3])  # [N·m] on either, as both turn alike


def moving(
    shoulder: float = 0.0, wrist: float = 0.0, way: float = 1.0, energy: float = 0.0, speed: float = SPEED, sure: float = 0.0
) -> Estimate:
    """Both turn; torques of a hand on a link [N·m], `sure` is what of the shoulder's is certain."""
    qd = [0.0, way * speed, 0.0, way * speed, 0.0, 0.0]
    friction = [way * torque for torque in FRICTION]
    felt = [0.0, shoulder, 0.0, wrist, 0.0, 0.0]
    certain = [0.0, sure, 0.0, 0.0, 0.0, 0.0]
    return estimate(qd=qd, tau_hand=felt, tau_certain=certain, friction=friction, energy=energy)


def scaled(size: float, way: Vector) -> Vector:
    x, y, z = way
    return size * x, size * y, size * z


def done(*values: tuple[int, Estimate]) -> Work:
    work = Work()
    work.begin(values[0][1])
    for count, value in values:
        for _ in range(count):
            work.step(value)
    return work


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("shoulder", "wrist"), [(1.0, 0.0), (0.0, 1.0), (3.0, -2.0)])
@pytest.mark.parametrize(("share", "paid"), [(0.99, False), (1.01, True)])
def test_who_leads_the_arm_pays_for_what_the_law_leaves(
    share: float, paid: bool, shoulder: float, wrist: float, way: float
) -> None:
    torque = way * share * PAYS
    assert done((100, moving(shoulder * torque, wrist * torque, way))).paid is paid


def test_half_of_the_friction_that_is_left_is_asked_for() -> None:
    """The analytic case: 0.2 rad/s against 12 N·m for a second costs 2.4 J, of which a hand pays at least 0.18 J."""
    work = done((500, moving()))
    assert work.unpaid == pytest.approx(0.5 * 0.15 * 2.4)


def test_a_torque_against_the_turn_pays_for_nothing_and_is_not_owed_twice() -> None:
    work = done((100, moving(-5.0)))
    assert not work.paid
    assert work.unpaid == pytest.approx(100 * TICK * SPEED * PAYS)


@pytest.mark.parametrize(("share", "paid"), [(0.99, False), (1.01, True), (-1.01, False)])
@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8)])
def test_a_hand_at_the_flange_pays_with_its_force_along_the_way(way: Vector, share: float, paid: bool) -> None:
    """0.05 m/s along it."""
    value = moving().copy()
    value.v_F[:3] = [0.05 * part for part in way]
    needed = PAYS * SPEED / 0.05
    work = Work()
    work.begin(value)
    for _ in range(100):
        work.step(value, (scaled(share * needed, way), ORIGIN))
    assert work.paid is paid
    assert work.settled is paid


@pytest.mark.parametrize(("share", "paid"), [(0.99, False), (1.01, True), (-1.01, False)])
@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8)])
def test_a_hand_at_the_flange_pays_with_its_torque_about_the_turn(way: Vector, share: float, paid: bool) -> None:
    """A tool that is led at its end turns the flange, at 0.5 rad/s."""
    value = moving().copy()
    value.v_F[3:] = [0.5 * part for part in way]
    needed = PAYS * SPEED / 0.5
    work = Work()
    work.begin(value)
    for _ in range(100):
        work.step(value, (ORIGIN, scaled(share * needed, way)))
    assert (work.paid, work.settled) == (paid, paid)


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8)])
@pytest.mark.parametrize(("share", "owed"), [(-0.25, 0.75), (-0.5, 1.0), (-9.0, 1.0), (0.0, 0.5), (9.0, 0.5)])
def test_what_may_be_drift_against_the_motion_is_taken_off_what_the_joints_feel(
    share: float, owed: float, way: Vector, turns: bool
) -> None:
    """They feel a drift as a hand that does the opposite. It takes no more than they feel, and adds nothing."""
    value = moving(0.5 * PAYS).copy()
    value.v_F[3 * turns : 3 * turns + 3] = [0.05 * part for part in way]
    drift = scaled(share * PAYS * SPEED / 0.05, way)
    work = Work()
    work.begin(value)
    for _ in range(100):
        work.step(value, (ORIGIN, drift) if turns else (drift, ORIGIN), NOTHING_SURE)
    assert work.unpaid == pytest.approx(owed * 100 * TICK * PAYS * SPEED)


@pytest.mark.parametrize(("sure", "owed"), [(0.0, 1.0), (0.2, 0.8), (0.5, 0.5), (2.0, 0.5), (-1.0, 1.0)])
def test_no_drift_is_taken_off_what_the_joints_feel_for_certain(sure: float, owed: float) -> None:
    """A hand of 4 N·m leads a joint, and the sensor's error may be worth as much: what no error explains pays nevertheless."""
    value = moving(0.5 * PAYS, sure=sure * PAYS).copy()
    value.v_F[0] = 0.05
    work = Work()
    work.begin(value)
    for _ in range(100):
        work.step(value, ((-9.0 * PAYS * SPEED / 0.05, 0.0, 0.0), ORIGIN), NOTHING_SURE)
    assert work.unpaid == pytest.approx(owed * 100 * TICK * PAYS * SPEED)


def test_what_is_not_a_number_is_not_certain() -> None:
    value = moving(0.5 * PAYS, sure=math.nan).copy()
    value.v_F[0] = 0.05
    work = Work()
    work.begin(value)
    work.step(value, ((-9.0 * PAYS * SPEED / 0.05, 0.0, 0.0), ORIGIN), NOTHING_SURE)
    assert work.unpaid == pytest.approx(TICK * PAYS * SPEED)


def test_no_drift_makes_what_the_joints_feel_against_the_motion_worse() -> None:
    value = moving(-PAYS).copy()
    value.v_F[0] = 0.05
    one, other = Work(), Work()
    for _ in range(100):
        one.step(value)
        other.step(value, ((-5.0, 0.0, 0.0), ORIGIN), NOTHING_SURE)
    assert state_of(one) == state_of(other)


@pytest.mark.parametrize(("share", "lasts"), [(-1.0, True), (0.0, True), (0.9, True), (1.1, False)])
def test_an_arm_that_slows_down_pays_with_its_speed(share: float, lasts: bool) -> None:
    """Of what 101 ticks cost, which is a tick more than what may be owed. One that gets faster owes no less."""
    cost = 100 * TICK * SPEED * PAYS
    work = Work()
    work.begin(moving(energy=1.0))
    for tick in range(1, 202):
        work.step(moving(energy=1.0 - share * cost * tick / 201))
    assert work.lasts(100) is lasts
    assert not work.settled


@pytest.mark.parametrize("wrong", ["friction", "energy"])
def test_what_is_not_a_number_pays_for_nothing(wrong: str) -> None:
    value = moving(20.0)
    if wrong == "friction":
        value.whose = value.whose._replace(powers=(*value.whose.powers[:2], math.nan))
    else:
        value.whose = value.whose._replace(energy=math.nan)
    work = done((101, value))
    assert wrong == "energy" or work.lasts(100)
    assert wrong == "energy" or not (work.settled or work.paid)


def test_work_in_advance_does_not_count() -> None:
    work = done((500, moving(20.0)), (100, moving()))
    assert work.unpaid == pytest.approx(100 * TICK * SPEED * PAYS)
    assert work.paid, "over the whole stretch it is"


@pytest.mark.parametrize(("ticks", "lasts"), [(99, True), (100, False), (101, False)])
def test_an_arm_that_nobody_pays_for_lasts_as_long_as_it_moves(ticks: int, lasts: bool) -> None:
    assert done((100, moving())).lasts(ticks) is lasts


def test_a_push_against_it_does_not_shorten_the_time() -> None:
    assert not done((50, moving(-20.0))).lasts(50)
    assert done((51, moving(-20.0))).lasts(50)


def test_what_does_not_count_pays_for_nothing() -> None:
    work = Work()
    work.begin(moving())
    work.step(moving(20.0), counts=False)
    assert work.unpaid == pytest.approx(TICK * SPEED * PAYS)


def test_half_paid_it_lasts_twice_as_long() -> None:
    assert not done((199, moving(0.5 * PAYS))).lasts(100)
    assert done((201, moving(0.5 * PAYS))).lasts(100)


def test_an_arm_that_does_not_move_is_not_paid_for() -> None:
    assert not Work().paid
    assert not done((10, moving(5.0, speed=0.0))).paid


def test_a_stretch_begins_afresh() -> None:
    value = moving(1.0, energy=0.5)
    work = Work()
    work.begin(value)
    fresh = state_of(work)
    work.step(value)
    assert state_of(work) != fresh
    work.begin(value)
    assert state_of(work) == fresh


def test_before_it_moves_nothing_is_owed() -> None:
    work = Work()
    assert work.unpaid == 0.0
    assert not work.settled, "nor is it known what the motion costs"
    work.begin(moving(energy=3.0))
    assert work.unpaid == 0.0


@pytest.mark.parametrize(("energy", "lasts"), [(0.0, True), (-1.0, False)])
def test_an_arm_that_was_at_rest_in_the_beginning_had_no_speed_to_pay_with(energy: float, lasts: bool) -> None:
    """One J less than at rest there cannot be; it would pay for all."""
    work = Work()
    for _ in range(101):
        work.step(moving(energy=energy))
    assert 101 * TICK * SPEED * PAYS < 1.0
    assert work.lasts(100) is lasts


def test_a_hand_on_a_link_and_one_at_the_flange_pay_together() -> None:
    value = moving(0.6 * PAYS).copy()
    value.v_F[:3] = [0.05, 0.0, 0.0]
    work = Work()
    work.begin(value)
    for _ in range(100):
        work.step(value, ((0.41 * PAYS * SPEED / 0.05, 0.0, 0.0), ORIGIN))
    assert work.settled
    assert work.paid
