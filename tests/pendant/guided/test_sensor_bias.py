"""The flange sensor's zero: drifts and steps are taken off, hands are not (FD-19)."""

import math

import numpy as np
import pytest

from pendant.events.event import Kind
from pendant.guided.bias_follower import BEGINS, OFTEN, STILL, BiasFollower, Slack
from pendant.guided.sensor_bias import SensorBias
from pendant.guided.user_force import UserForce
from pendant.inputs import NOTHING
from pendant.limits.parameters import ZEROS
from pendant.limits.validity import WrenchMean
from pendant.sensor.hand_model import HALF, KNOWN, SLOWEST, STEADY, TREMOR
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER, window_noise
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import TICK, Mode, Phase
from pendant.tick.pose import ORIGIN, Vector
from pendant.tick.state import state_of
from tests.pendant.estimates import HAND, MOVES, SENSOR, estimate
from tests.pendant.freedrive.test_state_machine import Bench

WINDOW = 0.1  # [s]
TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # R_BF after 90° about z


@pytest.mark.parametrize(
    ("change", "gone"),
    [
        ((0.1, -0.2, 0.05, 0.01, 0.0, -0.02), (0.1, -0.2, 0.05, 0.01, 0.0, -0.02)),
        ((0.0, 10.0, 0.0, 0.0, 0.0, 5.0), (0.0, SLOWEST * WINDOW, 0.0, 0.0, 0.0, LEVER * SLOWEST * WINDOW)),
        ((-3.0, 0.0, 4.0, 0.0, 0.0, 0.0), (-0.6 * SLOWEST * WINDOW, 0.0, 0.8 * SLOWEST * WINDOW, 0.0, 0.0, 0.0)),
    ],
)
def test_so_much_of_a_change_is_drift(change: tuple[float, ...], gone: tuple[float, ...]) -> None:
    drift = BiasFollower(SENSOR)
    start = (5.0, 1.0, -2.0, 0.1, 0.2, 0.3)
    assert drift.step(start, ORIGIN, HAND) is None
    assert drift.step(tuple(np.add(start, change).tolist()), ORIGIN, HAND) == pytest.approx(gone)
    drift.restart()
    assert drift.step(start, ORIGIN, HAND) is None


def test_a_mean_is_wanted_once_a_window() -> None:
    drift = BiasFollower(SENSOR)
    wanted = [drift.due() for _ in range(151)]
    assert [k for k, due in enumerate(wanted) if due] == [0, 50, 100, 150]
    assert state_of(drift) != state_of(BiasFollower(SENSOR))


def drifting(seconds: float, rate: float = 2.0, start: float = 0.0, **changes: float | bool) -> Bench:
    bench = Bench(free_drive__period=30.0, **changes).in_period()
    for tick in range(round(500 * seconds)):
        bench.step(NOTHING, estimate(force=[start, 0.0, rate * 0.002 * tick]))
    return bench


def test_a_drift_in_the_period_goes_into_the_baseline() -> None:
    bench = drifting(1.5)
    assert bench.last.phase is Phase.PERIOD
    assert bench.last.baseline[2] == pytest.approx(3.0, abs=0.4)
    assert bench.last.baseline[:2] == pytest.approx((0.0, 0.0), abs=1e-9)


def test_only_the_last_windows_are_given_back() -> None:
    drift = BiasFollower(SENSOR)
    assert drift.give_back() == []
    gone = [(0.1 * k, 0.0, 0.0, 0.0, 0.0, 0.01) for k in range(BEGINS + 3)]
    for each in gone:
        drift.keep(each)
    assert state_of(drift) != state_of(BiasFollower(SENSOR))
    drift.restart()
    assert drift.give_back() == gone[-BEGINS:]
    assert drift.give_back() == []


@pytest.mark.parametrize("torque", [0.0, 0.5])
def test_a_drift_never_counts_as_guiding_and_ends_free_drive_when_it_has_gone_far(torque: float) -> None:
    """FD-13, FD-19: by 20 N, and by more of a torque than its limit."""
    bench = Bench(free_drive__period=10.0).in_period()
    force = 1.0 if torque else 2.0
    for tick in range(5000):
        bench.step(NOTHING, estimate(force=[0.002 * force * tick, 0.0, 0.0], torque=[0.0, 0.0, 0.002 * torque * tick]))
        assert bench.last.gain == (0.0 if bench.events else 1.0)
    assert [event.kind for event in bench.events] == [Kind.SENSOR_DRIFTED]
    assert bench.last.mode is Mode.STOP
    told = bench.events[0].values
    expected = {"force": 2.0, "torque": LEVER * SENSOR.offset_force} if torque else {"force": SENSOR.offset_force, "torque": 0.0}
    assert told == {name: pytest.approx(value, abs=0.21) for name, value in expected.items()}
    assert told["torque" if torque else "force"] >= (LEVER * SENSOR.offset_force if torque else SENSOR.offset_force)


@pytest.mark.parametrize("turned", [False, True])
def test_a_drift_turns_with_the_flange(turned: bool) -> None:
    R_BF = TURNED if turned else np.eye(3)
    before, after = estimate(), estimate(force=[0.1, -0.2, 0.05], torque=[0.01, -0.02, 0.03])
    zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(before, (0.0,) * 6, SENSOR.offset_force)
    zero.begin(before, True, mean)
    for value in [before] * 50 + [after] * 51:
        mean.step(value)
        zero.step(value, hand, mean, waits=True, still=True, force=HAND)
    assert zero.felt(after) == pytest.approx((0.0,) * 6)
    drifted = np.concatenate([R_BF @ zero.drifted[:3], R_BF @ zero.drifted[3:]])
    after.R_BF = R_BF
    after.F_user[:] = drifted + np.arange(1.0, 7.0)
    assert zero.felt(after) == pytest.approx((1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    zero.leave()
    assert zero.felt(after) is None


def test_a_drift_is_followed_through_the_sensors_noise() -> None:
    """2 N/s and 0.4 N·m/s with noise of their size upon the means: what of a mean is beyond the limits waits for the next."""
    rng = np.random.default_rng(3)
    rate = np.array([0.0, 0.16, -0.12, 0.04, 0.0, 0.0])
    noise = np.array([0.15] * 3 + [0.015] * 3)
    drift, gone = BiasFollower(SENSOR), np.zeros(6)
    for window in range(300):
        taken = drift.step(tuple((window * rate + noise * rng.normal(size=6)).tolist()), ORIGIN, HAND)
        gone += taken or (0.0,) * 6
    assert gone == pytest.approx(299 * rate, abs=1.0)


@pytest.mark.parametrize(("size", "next_one"), [(0.3, 0.0), (0.5, 0.2), (0.8, 0.3), (1.1, 0.3), (20.0, 0.3)])
def test_what_of_a_push_waits_for_the_next_windows_is_little(size: float, next_one: float) -> None:
    """Of a force that comes at once and stays, 0.3 N in its window, and 0.5 N in the two after it; of a torque a fifth."""
    drift = BiasFollower(SENSOR)
    drift.step((0.0,) * 6, ORIGIN, HAND)
    taken = [drift.step((0.0, size, 0.0, 0.0, 0.0, -LEVER * size), ORIGIN, HAND) for _ in range(4)]
    force = [min(size, 0.3), next_one, min(max(size - 0.6, 0.0), 0.2), 0.0]
    assert [step[1] for step in taken if step] == pytest.approx(force, abs=1e-12)
    assert [-step[5] / LEVER for step in taken if step] == pytest.approx(force, abs=1e-12)


@pytest.mark.parametrize("anew", [False, True], ids=["guided", "period anew"])
def test_pushes_leave_no_offset_behind(anew: bool) -> None:
    """Each grows by 10 N/s for 0.3 s before the arm moves; 3 N/s would pass for drift. It is gone before the arm rests."""
    bench = Bench(free_drive__period=30.0, free_drive__restart_begins="manipulation" if anew else "standstill").in_period()
    for _ in range(6):
        for tick in range(300):
            bench.step(NOTHING, estimate(force=[min(0.02 * tick, 6.0), 0.0, 0.0], qd=0.3 if tick > 150 else 0.0))
        for tick in range(400):
            bench.step(NOTHING, estimate(qd=0.3 if tick < 60 else 0.0))
    assert bench.last.phase in (Phase.PERIOD, Phase.RESTART)
    assert bench.last.baseline == pytest.approx((0.0,) * 6, abs=1e-9)


def test_switched_off_nothing_is_taken_off() -> None:
    assert drifting(3.0, unexplained__sensor=False).last.baseline == pytest.approx((0.0,) * 6)


def test_where_the_arm_is_guided_nothing_is_taken_off() -> None:
    bench = Bench().in_period()
    for tick in range(1000):
        bench.step(NOTHING, estimate(force=[20.0 + 0.002 * tick, 0.0, 0.0], qd=0.3))
    assert bench.last.phase is Phase.GUIDED
    assert bench.last.baseline == pytest.approx((0.0,) * 6, abs=0.5)


def stepped(odds: float, force: float) -> Estimate:
    """The sensor feels so much more, and has stepped with these odds."""
    value = estimate(force=[0.0, 0.0, force])
    value.whose = value.whose._replace(step_odds=odds, step_force=force)
    return value


@pytest.mark.parametrize(
    ("odds", "force", "told"), [(KNOWN, HAND + 0.01, True), (KNOWN - 1e-9, 15.0, False), (KNOWN, HAND, False), (1e3, 15.0, True)]
)
def test_a_step_that_is_known_and_as_large_as_a_hands_force_ends_free_drive(odds: float, force: float, told: bool) -> None:
    """FD-19."""
    bench = Bench().in_period()
    bench.run(50)  # in which a sensor may have drifted by a millinewton
    bench.step(NOTHING, stepped(odds, force))
    steps = [event for event in bench.events if event.kind is Kind.SENSOR_STEPPED]
    assert [event.values for event in steps] == [{"force": force}] * told
    assert bench.last.gain == 0.0, "nothing helps as long as it may be one"
    assert (bench.last.mode is Mode.STOP) is told
    bench.step(NOTHING, estimate())
    assert (bench.last.gain == 0.0) is told


def test_a_sensor_that_has_drifted_for_long_may_seem_to_step_by_more() -> None:
    """What it may have drifted by while a hand moved the arm cannot be told from a hand's force either."""
    zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
    zero.begin(estimate(), True, mean)
    for force, told in ((2.0, False), (2.5, True)):
        event = zero.step(stepped(KNOWN, force), hand, mean, waits=False, still=True, force=2.3)
        assert (event is not None) is told


def test_the_baseline_is_in_the_axes_of_the_flange() -> None:
    """As it was held in the beginning, and as it is turned when the sensor drifts."""
    zero, mean, start = SensorBias(SENSOR), WrenchMean(), estimate(force=[1.0, 2.0, 3.0], torque=[0.1, 0.2, 0.3])
    start.R_BF = TURNED
    mean.step(start)
    zero.begin(start, True, mean)
    assert zero.baseline == pytest.approx((2.0, -1.0, 3.0, 0.2, -0.1, 0.3))
    bench = Bench(free_drive__period=30.0).in_period()
    for tick in range(600):
        value = estimate(force=[0.004 * tick, 0.0, 0.0])
        value.R_BF = TURNED
        bench.step(NOTHING, value)
    assert bench.last.baseline[:3] == pytest.approx((0.0, -2.4, 0.0), abs=0.3)


@pytest.mark.parametrize("still", [True, False])
def test_what_is_taken_off_in_every_axis_is_given_back_to_who_moves_the_arm(still: bool) -> None:
    force, torque = [0.1, -0.2, 0.05], [0.01, -0.02, 0.03]  # less than what may be drift in a window
    before, after = estimate(), estimate(force=force, torque=torque)
    after.R_BF = TURNED  # since entry
    zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(before, (0.0,) * 6, SENSOR.offset_force)
    zero.begin(before, True, mean)
    for value in [before] * 50 + [after] * 51:
        mean.step(value)
        assert zero.step(value, hand, mean, waits=True, still=True, force=HAND) is None
    gone = (-0.2, -0.1, 0.05, -0.02, -0.01, 0.03)  # axes of the flange, and of B at entry
    assert zero.baseline == pytest.approx(gone)
    hand.step(after, True, MOVES)
    assert hand.change == pytest.approx((0.0,) * 3)
    assert zero.step(after, hand, mean, waits=False, still=still, force=HAND) is None
    hand.step(after, True, MOVES)
    assert zero.baseline == pytest.approx(gone if still else (0.0,) * 6)
    assert hand.change == pytest.approx((0.0,) * 3 if still else force)


def test_a_zero_that_was_left_is_as_one_that_never_began() -> None:
    zero, mean = SensorBias(SENSOR), WrenchMean()
    mean.step(estimate(force=3.0))
    zero.begin(estimate(), True, mean)
    assert (zero.used, zero.baseline) == (True, (3.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    zero.leave()
    assert state_of(zero) == state_of(SensorBias(SENSOR))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("answer", "follows"), [(0.99 * HALF, True), (1.01 * HALF, False), (1.0, False), (-1.0, True)])
@pytest.mark.parametrize(("size", "asked"), [(0.99 * HAND, False), (1.01 * HAND, True), (3.0, True)])
def test_what_the_joints_feel_as_well_is_no_drift(size: float, asked: bool, answer: float, follows: bool, axis: int) -> None:
    drift = BiasFollower(SENSOR)
    force, felt = [0.0] * 6, [2.0, 3.0, 4.0]
    drift.step(tuple(force), (2.0, 3.0, 4.0), HAND)
    force[axis] += size
    felt[axis] += answer * size
    taken = drift.step(tuple(force), (felt[0], felt[1], felt[2]), HAND)
    assert (taken is not None) is (follows or not asked)


def went(seconds: float) -> tuple[float, float]:
    """How far a good sensor goes at most: all axes from nothing to their largest bias, with a time constant of 300 s."""
    return tuple(
        [math.sqrt(3.0) * most * (1.0 - math.exp(-seconds / 300.0)) for most in (SENSOR.offset_force, SENSOR.offset_torque)]
    )


def told(drift: BiasFollower, tick: int = OFTEN) -> Slack:
    return drift.slack(estimate(tick))


QUIET = FALSE_ALARM * window_noise(SENSOR, estimate())
"""What noise alone may make of a window's mean [N]."""


@pytest.mark.parametrize(("force", "held"), [(0.99 * QUIET, False), (1.01 * QUIET, True), (3.0, True)])
def test_an_arm_that_comes_to_rest_with_a_force_is_held_by_a_hand(force: float, held: bool) -> None:
    assert BiasFollower(SENSOR).held((0.0, force, 0.0, 0.0, 0.0, 0.0), estimate()) is held


@pytest.mark.parametrize(("seconds", "held"), [(99.0, True), (101.0, False)])
def test_the_longer_it_is_not_known_the_more_a_sensor_may_have_drifted(seconds: float, held: bool) -> None:
    drift, tick = BiasFollower(SENSOR, 1000), 1000 + round(500 * seconds)
    assert told(drift, tick) == pytest.approx(went(seconds))
    assert drift.drifted(tick) == pytest.approx(went(seconds))
    assert drift.held((QUIET + went(100.0)[0], 0.0, 0.0, 0.0, 0.0, 0.0), estimate(tick)) is held
    drift.know(estimate(tick))
    assert drift.drifted(tick) == (0.0, 0.0)


@pytest.mark.parametrize(("force", "held"), [((0.0, 0.6), False), ((0.0, 0.0), True), ((0.0, -0.6), True), ((0.6, 0.6), True)])
def test_what_was_subtracted_may_come_back_and_nothing_beside_it(force: tuple[float, float], held: bool) -> None:
    """A hand that let go slowly, 0.6 N, was taken for drift."""
    drift = BiasFollower(SENSOR)
    for _ in range(6):
        drift.keep((0.0, -0.1, 0.0, 0.0, 0.0, 0.0))
    assert drift.held((*force, 0.0, 0.0, 0.0, 0.0), estimate()) is held


def test_what_is_added_again_was_not_subtracted() -> None:
    drift = BiasFollower(SENSOR)
    for _ in range(2):
        drift.keep((0.0, 0.1, 0.0, 0.0, 0.0, 0.01))
    assert told(drift) == pytest.approx((0.2, 0.02), abs=0.002)
    drift.give_back()
    assert told(drift, 2 * OFTEN) == pytest.approx((0.0, 0.0), abs=0.002)


@pytest.mark.parametrize("seconds", [1.0, 100.0])
def test_drift_and_what_was_subtracted_are_unsure_until_the_bias_is_known(seconds: float) -> None:
    drift, tick = BiasFollower(SENSOR), round(500 * seconds)
    drift.keep((0.2, 0.0, 0.0, 0.0, 0.0, -0.02))
    force, torque = went(seconds)
    assert told(drift, tick) == pytest.approx((0.2 + force, 0.02 + torque))
    drift.know(estimate(tick))
    assert told(drift, tick + OFTEN) == pytest.approx((0.0, 0.0), abs=0.002)


def test_the_deviation_of_an_axis_is_that_of_a_rectangle() -> None:
    """Three axes that are 1.5 N off at most make 2.6 N; each has a third of its square as variance."""
    assert Slack(math.sqrt(3.0) * 1.5, 0.0).axis == pytest.approx(1.5 / math.sqrt(3.0))


def test_nobody_holds_an_arm_that_feels_the_same_for_as_long_as_no_hand_holds_still() -> None:
    """5 s; then the same again."""
    drift, force = BiasFollower(SENSOR), (0.0, 0.4, 0.0, 0.0, 0.0, 0.0)
    assert pytest.approx(5.0) == STILL * WINDOW
    assert [drift.rested(force) for _ in range(STILL + 1)] == [False] * STILL + [True]
    drift.know(estimate())
    assert [drift.rested(force) for _ in range(STILL + 1)] == [False] * STILL + [True]


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("share", "rests"), [(-1.01, False), (-0.99, True), (0.99, True), (1.01, False)])
def test_a_hand_is_known_by_its_tremor(share: float, rests: bool, axis: int) -> None:
    drift = BiasFollower(SENSOR)
    for _ in range(STILL):
        drift.rested(ZEROS)
    trembles = tuple([share * TREMOR * (k == axis) for k in range(6)])
    assert drift.rested(trembles) is rests
    assert rests or [drift.rested(trembles) for _ in range(STILL)] == [False] * (STILL - 1) + [True]


@pytest.mark.parametrize("how", ["restart", "pause"])
def test_an_arm_that_may_be_moved_rests_afresh(how: str) -> None:
    drift = BiasFollower(SENSOR)
    for _ in range(STILL):
        drift.rested(ZEROS)
    getattr(drift, how)()
    assert [drift.rested(ZEROS) for _ in range(STILL + 1)] == [False] * STILL + [True]


@pytest.mark.parametrize("axis", range(3))
def test_where_the_load_has_turned_gain_and_centre_are_unsure_as_well(axis: int) -> None:
    """4 kg that lay along an axis of the flange hang along z: 1.4 % of the change in force, and 10 mm of it in torque."""
    weight: Vector = (39.24 * (axis == 0), 39.24 * (axis == 1), -39.24 * (axis == 2))
    drift = BiasFollower(SENSOR, weight=weight)
    turned = math.dist((0.0, 0.0, -39.24), weight)
    force, torque = drift.slack(estimate(5000, load_mass=4.0))
    most = went(10.0)
    assert force == pytest.approx(most[0] + 0.014 * turned)
    assert torque == pytest.approx(most[1] + 0.2 * 0.014 * turned + 0.01 * turned)


@pytest.mark.parametrize(("later", "known"), [(OFTEN - 1, False), (OFTEN, True)])
def test_what_changes_slowly_is_looked_at_every_so_many_ticks(later: int, known: bool) -> None:
    drift = BiasFollower(SENSOR)
    before = told(drift, 5000)
    assert (told(drift, 5000 + later) != before) is known


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("share", "held"), [(0.99, False), (1.01, True)])
def test_the_farther_a_load_was_turned_the_more_the_sensors_gain_may_add(share: float, held: bool, axis: int) -> None:
    """From lying to hanging; and once that is known, it counts from there."""
    load = estimate(load_mass=5.0)
    drift = BiasFollower(SENSOR, weight=(5.0 * GRAVITY, 0.0, 0.0))
    most = SENSOR.gain * math.sqrt(2.0) * 5.0 * GRAVITY + FALSE_ALARM * window_noise(SENSOR, load)
    apart = tuple([share * most * (k == axis) for k in range(6)])
    assert drift.held(apart, load) is held
    drift.know(load)
    assert drift.held(apart, load)


def test_what_the_sensor_drifted_by_while_the_arm_was_moved_goes_into_the_zero_once_it_is_known() -> None:
    """After 100 s, and 5 s at rest: as much as it can have drifted by in that time, 2.5 N and 0.18 N·m."""

    def rests(force: float, torque: float) -> SensorBias:
        zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
        zero.begin(estimate(), True, mean)
        value = estimate(50000, force=[force, 0.0, 0.0], torque=[0.0, 0.0, torque])
        for _ in range(round((STILL + 2) * WINDOW / TICK)):
            mean.step(value)
            value.tick += 1
            assert zero.step(value, hand, mean, waits=True, still=True, force=HAND) is None
        return zero

    assert rests(0.5, 0.05).baseline == pytest.approx((0.5, 0.0, 0.0, 0.0, 0.0, 0.05))
    assert rests(0.5, 0.05).slack(estimate(53000)).force < 0.03
    assert rests(2.0, 0.3).baseline == pytest.approx((2.0, 0.0, 0.0, 0.0, 0.0, went(105.0)[1]), rel=1e-3)
    assert rests(2.8, 0.0).baseline == pytest.approx((0.0,) * 6), "a hand holds it"


def test_rest_for_rest_the_bias_is_what_is_felt_as_far_as_a_good_sensor_drifts_since_the_beginning() -> None:
    """It began after 80 s; the arm rests for 6 s after 40 s, 100 s and 160 s more. The last torque is too large for a drift."""
    zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
    zero.begin(estimate(40_000), True, mean)
    rests = [
        (60_000, (0.3, 0.2, -0.1), (0.02, -0.03, 0.04)),
        (90_000, (0.5, -0.4, 0.3), (-0.05, 0.06, 0.07)),
        (120_000, (-0.4, 0.5, 0.6), (0.3, -0.3, 0.3)),
    ]
    for begins, force, torque in rests:
        zero.step(estimate(begins - 1), hand, mean, waits=False, still=False, force=HAND)
        value = estimate(begins, force=list(force), torque=list(torque))
        for _ in range(50):
            mean.step(value)
        for _ in range(3000):
            mean.step(value)
            value.tick += 1
            assert zero.step(value, hand, mean, waits=True, still=True, force=HAND) is None
        most = went((value.tick - 40_000) * TICK)[1]
        share = min(most / math.hypot(*torque), 1.0)
        assert zero.baseline[:3] == pytest.approx(force)
        assert zero.baseline[3:] == pytest.approx([share * part for part in torque], rel=0.02)
        assert (share < 1.0) == (begins == 120_000)


def test_a_sensor_that_drifts_while_a_hand_leads_the_arm_is_known_when_it_has_gone_for_long() -> None:
    bench = Bench(free_drive__period=30.0, free_drive__restart_period=30.0).in_period()
    for tick in range(18000):
        moves = tick < 15000 and tick % 3000 < 2000
        drift = 0.01 * 0.002 * min(tick, 15000)
        hand = 20.0 * moves
        bench.step(NOTHING, estimate(force=[hand + drift, 0.0, 0.0], felt=[hand, 0.0, 0.0], qd=0.3 if moves else 0.0))
    assert bench.last.phase is Phase.RESTART
    assert bench.last.baseline[0] == pytest.approx(0.3, abs=0.01)


def test_a_hand_that_rests_on_the_arm_leaves_no_offset_behind() -> None:
    """It holds the arm with 3 N where it came to rest, for 2 s, and becomes lighter; then it is gone."""
    bench = Bench(free_drive__period=30.0).in_period()
    for tick in range(200):
        bench.step(NOTHING, estimate(force=[6.0, 0.0, 0.0], qd=0.3 if tick < 150 else 0.0))
    for tick in range(1000):
        bench.step(NOTHING, estimate(force=[3.0 - 0.002 * tick, 0.0, 0.0]))
    for _ in range(400):
        bench.step(NOTHING, estimate())
    assert bench.last.phase is Phase.RESTART
    assert bench.last.baseline == pytest.approx((0.0,) * 6, abs=1e-9)


def test_a_hand_that_presses_on_an_arm_at_rest_is_felt_by_the_joints() -> None:
    bench = Bench(free_drive__period=30.0).in_period()
    for tick in range(1000):
        force = min(0.004 * tick, 3.0)
        bench.step(NOTHING, estimate(force=[force, 0.0, 0.0], felt=[force, 0.0, 0.0]))
    assert bench.last.baseline[0] <= HAND
    for _ in range(1000):
        bench.step(NOTHING, estimate())
    assert bench.last.baseline == pytest.approx((0.0,) * 6, abs=0.15), "of the first newton, which nobody can tell"


def test_no_short_rest_takes_a_hand_for_drift() -> None:
    """One that turns round rests with a force again and again; it may be drift, and is not known to be."""
    zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
    zero.begin(estimate(), True, mean)
    for count in range(1, 13):
        value = estimate(tick=5000 * count, force=[0.2, 0.0, 0.0], torque=[0.0, 0.0, 0.02])
        for _ in range(round(STILL * WINDOW / TICK)):
            mean.step(value)
            assert zero.step(value, hand, mean, waits=True, still=True, force=HAND) is None
        zero.step(value, hand, mean, waits=False, still=True, force=HAND)
        assert zero.baseline == pytest.approx((0.0,) * 6)
        assert zero.slack(value) == pytest.approx(went(10.0 * count))


@pytest.mark.parametrize("seconds", [30.0, 60.0])
def test_the_bias_is_wrong_by_what_was_subtracted_and_by_the_drift_in_all_axes_at_most(seconds: float) -> None:
    zero, mean, hand = SensorBias(SENSOR), WrenchMean(), UserForce(estimate(), (0.0,) * 6, SENSOR.offset_force)
    zero.begin(estimate(tick=7), True, mean)
    tick = 7 + round(500 * seconds)
    force, torque = went(seconds)
    assert zero.wrong(tick) == pytest.approx((force, torque))
    rests = estimate(tick=tick, force=[0.1, -0.2, 0.2], torque=[0.01, 0.02, -0.02])
    for _ in range(round((STEADY + 1.0) / TICK)):
        rests.tick += 1
        mean.step(rests)
        assert zero.step(rests, hand, mean, waits=True, still=True, force=HAND) is None
    assert zero.wrong(tick) == pytest.approx((0.3 + force, 0.03 + torque))
