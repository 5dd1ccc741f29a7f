"""How far and for how long an arm goes on its own (FD-19): at the limits and beside them, and what is told of it."""

import pytest

from pendant.all_settings import Settings
from pendant.events.event import Values
from pendant.guided.bias_follower import Slack
from pendant.guided.unintended_motion import UnintendedMotion
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import reference
from pendant.sensor.hand_model import HALF, LIGHT
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import Vector
from tests.pendant.estimates import SENSOR
from tests.pendant.guided.test_unintended_motion import AWAY, PAYS, Bench, at, creep

ALLOWED = ticks(Settings().unexplained.time)


class Felt:
    """An arm that was at rest; the hand's force at its flange lately is told as it is [N]."""

    def __init__(self) -> None:
        start = at(0.0, 0.0)
        self.alone = UnintendedMotion(Settings().unexplained, reference(start, None))
        self.hand = UserForce(start, (0.0,) * 6, SENSOR.offset_force)

    def see(self, value: Estimate, usual: Vector = (0.0, 0.0, 0.0), slack: Slack | None = None) -> Values | None:
        self.hand.usual = usual
        slack = slack or Slack(0.0, 0.0)
        return self.alone.step(value, self.hand, use_wrench=True, driven=False, slack=slack)


def test_before_the_first_tick_nobody_leads_and_nothing_is_doubtful() -> None:
    alone = Felt().alone
    assert (alone.led, alone.doubtful) == (False, False)


def test_in_the_first_tick_already_the_arm_may_be_too_far() -> None:
    """From where it was at entry."""
    assert Bench().see(at(1.01 * AWAY, 0.0)) is not None
    assert Bench().see(at(0.99 * AWAY, 0.0)) is None


@pytest.mark.parametrize(("usual", "led"), [(0.99 * (LIGHT + 2.0), True), (1.01 * (LIGHT + 2.0), False)])
@pytest.mark.parametrize("axis", range(3))
def test_what_hangs_at_the_flange_is_known_beyond_what_may_be_drift(axis: int, usual: float, led: bool) -> None:
    """5 N, and 2 N that may be the sensor's: up to there a light hand leads the arm, with what is beyond the drift."""
    felt, force = Felt(), [usual if k == axis else 0.0 for k in range(3)]
    value = at(0.0, 0.0, turns=1.0).copy()
    value.v_F[axis] = 0.1
    felt.see(value, (force[0], force[1], force[2]), Slack(2.0, 0.2))
    assert felt.alone.led is led


def test_what_hangs_at_the_flange_pays_for_nothing_later_either() -> None:
    """100 N along the way at 0.019 m/s would pay for both ticks, of 0.12 W; when they are gone half of the way is doubtful."""
    felt = Felt()
    felt.see(at(0.0, 0.019, turns=1.0), (100.0, 0.0, 0.0))
    felt.see(at(1.01 * HALF * AWAY, 0.019, turns=1.0))
    assert felt.alone.doubtful


@pytest.mark.parametrize(("share", "stopped"), [(0.99, True), (1.01, False), (-1.01, True)])
def test_a_light_hand_at_the_flange_pays_for_a_way_from_rest(share: float, stopped: bool) -> None:
    """At 0.02 rad/s against a tenth of the friction; the force does its work along the way, at 1 mm/s."""
    turns, speed = 0.1, 0.001
    needed = PAYS * turns * 0.2 * turns / speed  # 1.2 N
    felt = Felt()
    told = [felt.see(at(k * 0.0001, speed, turns=turns), (share * needed, 0.0, 0.0)) for k in range(400)]
    assert any(values is not None for values in told) is stopped


@pytest.mark.parametrize(("sensor", "begins"), [(True, 0.0), (False, 0.008)])
def test_the_way_is_told_from_rest_and_without_the_sensor_from_where_it_moved(sensor: bool, begins: float) -> None:
    """It creeps to 8 mm, moves on there, and is at 30 mm in the next tick."""
    bench = Bench(sensor)
    assert bench.until([at(0.004, 0.01), at(0.008, 0.1)]) is None
    told = bench.see(at(0.03, 0.1))
    assert told is not None
    assert told["distance"] == pytest.approx(1000.0 * (0.03 - begins))
    assert told["time"] == pytest.approx(2 * TICK)
    assert 0.03 - begins > AWAY


@pytest.mark.parametrize(("way", "stopped"), [(AWAY, True), (1.001 * AWAY, False)])
def test_beyond_the_way_that_anybody_may_go_who_pays_has_left_its_rest(way: float, stopped: bool) -> None:
    """A hand that led it farther, and goes, lets it begin anew from there; one that led it just so far does not."""
    bench = Bench()
    bench.see(at(way, 0.01, turns=1.0, felt=2.0 * PAYS))
    assert (bench.see(at(way + AWAY, 0.01, turns=1.0, felt=-20.0)) is not None) is stopped


@pytest.mark.parametrize(("share", "doubtful"), [(1.0, False), (1.001, True)])
def test_half_of_the_way_is_not_yet_doubtful(share: float, doubtful: bool) -> None:
    bench = Bench()
    bench.see(at(share * HALF * AWAY, 0.01))
    assert bench.alone.doubtful is doubtful


def test_who_paid_in_advance_and_has_gone_does_not_lead() -> None:
    bench = Bench()
    assert bench.until(creep(20, turns=1.0, felt=10.0 * PAYS)) is None
    assert bench.alone.led
    assert bench.until(creep(5, begins=20 * 0.0001, turns=1.0)) is None
    assert not bench.alone.led
    assert not bench.alone.doubtful, "all of the way is paid for"


def test_a_doubt_lasts_for_half_of_the_time_before_the_arm_is_stopped() -> None:
    """A hand owes a twentieth for a thousand ticks, 50 ticks' worth; then all, ten times as fast against ten times the friction.

    Each such tick costs a hundred slow ones: after one half of the time, 75, is owed, and after two all of it, 150.
    """
    bench, slow, fast = Bench(), at(0.0, 0.1, turns=1.0, felt=0.95 * PAYS), at(0.0, 0.1, turns=10.0)
    bench.held(at(0.0, 0.1))
    assert bench.until([slow] * 1000) is None
    assert not bench.alone.doubtful
    doubts = []
    while bench.see(fast) is None:
        doubts.append(bench.alone.doubtful)
    assert sum(doubts) == HALF * ALLOWED - 1, "it is stopped in the tick that completes it"


def test_who_pays_for_a_part_has_longer() -> None:
    """With 0.41 paid, 150 ticks' worth are owed after 150 / 0.59 = 254.2 ticks."""
    bench = Bench()
    bench.let_go(at(0.0, 0.1))
    value = at(0.0, 0.1, turns=1.0, felt=0.41 * PAYS)
    assert bench.until([value] * 254) is None
    told = bench.see(value)
    assert told is not None
    assert told["time"] == pytest.approx(255 * TICK)
