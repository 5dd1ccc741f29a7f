"""The flange sensor's zero: drifts and steps are taken off, hands are not (FD-19)."""

import math

import numpy as np
import pytest

from pendant.events import Kind
from pendant.hand import Hand
from pendant.inputs import NOTHING
from pendant.modes import Phase
from pendant.pose import Vector
from pendant.watch import WrenchMean
from pendant.zeroing import (
    ANSWER,
    BEGINS,
    FAR,
    FAR_TURN,
    JUMP,
    LATER,
    LEAST,
    MOVED,
    NOISE,
    QUIET,
    SLOW,
    SLOW_TURN,
    SOON,
    STRAY,
    Drift,
    Steps,
    Zero,
)
from tests.pendant.estimates import estimate
from tests.pendant.test_freedrive import Bench

PUSHED = (0.0, 0.0, -5.0)  # by the help, felt by the joints against the step
WINDOW = 0.1  # [s]
TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # R_BF after 90° about z


def seen(steps: Steps, forces: list[Vector], felt: list[float] | None = None) -> list[Vector]:
    """What is taken off, for these forces; from the fourth tick on the joints feel `felt`."""
    joints = [[0.0] * 3] * 3 + [felt or [0.0] * 3] * (len(forces) - 3)
    found = [steps.step(estimate(felt=by_joints), force) for force, by_joints in zip(forces, joints, strict=True)]
    return [step for step in found if step is not None]


def stepping(size: float, count: int = 20, before: float = 0.0) -> list[Vector]:
    return [(0.0, 0.0, before)] * 2 + [(0.0, 0.0, before + size)] * count


def against(steps: list[Vector], share: float) -> list[float]:
    return [share * (now - then) for now, then in zip(steps[-1], steps[0], strict=True)]


@pytest.mark.parametrize(("size", "before"), [(JUMP, 0.0), (5.0, 0.0), (-20.0, 0.0), (60.0, 0.0), (20.0, QUIET)])
def test_a_step_that_the_joints_feel_the_other_way_is_the_sensors(size: float, before: float) -> None:
    forces = stepping(size, before=before)
    assert seen(Steps(), forces, against(forces, 2.0 * ANSWER)) == [(0.0, 0.0, pytest.approx(size))]


@pytest.mark.parametrize("share", [ANSWER, 0.99 * ANSWER, 0.0, 0.5, 1.0])
def test_a_step_that_the_joints_feel_or_do_not_is_a_hands(share: float) -> None:
    forces = stepping(20.0)
    assert seen(Steps(), forces, against(forces, share)) == []


def test_it_is_judged_in_its_tick() -> None:
    forces = stepping(20.0, LATER)
    assert seen(Steps(), forces, against(forces, -0.5)) == []
    forces = stepping(20.0, LATER + 1)
    assert len(seen(Steps(), forces, against(forces, -0.5))) == 1


@pytest.mark.parametrize(("before", "size"), [(0.0, 0.99 * JUMP), (1.01 * QUIET, 20.0), (20.0, -20.0)])
def test_small_ones_and_those_of_a_hand_that_is_there_are_none(before: float, size: float) -> None:
    steps = Steps()
    assert seen(steps, [(0.0, 0.0, 0.01 * k * before) for k in range(101)]) == []
    forces = stepping(size, before=before)
    assert seen(steps, forces, against(forces, -0.5)) == []


def test_a_knock_and_a_hand_that_comes_are_none() -> None:
    knock = [(0.0, 0.0, 20.0 * math.sin(math.pi * k / 10)) for k in range(11)]
    assert seen(Steps(), knock, [0.0, 0.0, -10.0]) == []
    grab = [(0.0, 0.0, 2.0 * k) for k in range(11)] + [(0.0, 0.0, 20.0)] * 20
    assert seen(Steps(), grab, [0.0, 0.0, -10.0]) == []


def test_its_size_is_the_mean_of_what_was_seen() -> None:
    stray = 0.9 * STRAY * 10.0
    forces = [(0.0, 0.0, 0.0)] * 2 + [(0.0, 0.0, 10.0)] * 2 + [(0.0, 0.0, 10.0 + stray), (0.0, 0.0, 10.0 - stray)] * 3
    found = seen(Steps(), forces, [0.0, 0.0, -5.0])
    assert len(found) == 1
    assert found[0][2] == pytest.approx(10.0, abs=stray / LATER + 1e-9)


def test_after_a_step_the_next_one_is_found() -> None:
    steps = Steps()
    forces = stepping(10.0, LATER + 1)
    assert len(seen(steps, forces, [0.0, 0.0, -5.0])) == 1
    assert len(seen(steps, forces, [0.0, 0.0, -5.0])) == 1


@pytest.mark.parametrize(
    ("change", "gone"),
    [
        ((0.1, -0.2, 0.05, 0.01, 0.0, -0.02), (0.1, -0.2, 0.05, 0.01, 0.0, -0.02)),
        ((0.0, 10.0, 0.0, 0.0, 0.0, 5.0), (0.0, SLOW * WINDOW, 0.0, 0.0, 0.0, SLOW_TURN * WINDOW)),
        ((-3.0, 0.0, 4.0, 0.0, 0.0, 0.0), (-0.6 * SLOW * WINDOW, 0.0, 0.8 * SLOW * WINDOW, 0.0, 0.0, 0.0)),
    ],
)
def test_so_much_of_a_change_is_drift(change: tuple[float, ...], gone: tuple[float, ...]) -> None:
    drift = Drift()
    start = (5.0, 1.0, -2.0, 0.1, 0.2, 0.3)
    assert drift.step(start) is None
    assert drift.step(tuple(np.add(start, change).tolist())) == pytest.approx(gone)
    drift.restart()
    assert drift.step(start) is None


def test_a_mean_is_wanted_once_a_window() -> None:
    drift = Drift()
    wanted = [drift.due() for _ in range(151)]
    assert [k for k, due in enumerate(wanted) if due] == [0, 50, 100, 150]
    assert drift.memory != Drift().memory


def drifting(seconds: float, rate: float = 2.0, start: float = 0.0, **changes: float | bool) -> Bench:
    bench = Bench(free_drive__period=30.0, **changes).in_period()
    for tick in range(round(500 * seconds)):
        bench.step(NOTHING, estimate(force=[start, 0.0, rate * 0.002 * tick]))
    return bench


def test_a_drift_in_the_period_goes_into_the_baseline() -> None:
    bench = drifting(3.0)
    assert bench.last.phase is Phase.PERIOD
    assert bench.last.baseline[2] == pytest.approx(6.0, abs=0.5)
    assert bench.last.baseline[:2] == pytest.approx((0.0, 0.0), abs=1e-9)


def test_only_the_last_windows_are_given_back() -> None:
    drift = Drift()
    assert drift.give_back() == []
    gone = [(0.1 * k, 0.0, 0.0, 0.0, 0.0, 0.01) for k in range(BEGINS + 3)]
    for each in gone:
        drift.keep(each)
    assert drift.memory != Drift().memory
    drift.restart()
    assert drift.give_back() == gone[-BEGINS:]
    assert drift.give_back() == []


@pytest.mark.parametrize("torque", [0.0, 0.5])
def test_a_drift_never_counts_as_guiding_and_is_told_once_when_it_has_gone_far(torque: float) -> None:
    """FD-13, FD-19: by 20 N, and by more of a torque than its limit; the arm is left to its period."""
    bench = Bench(free_drive__period=10.0).in_period()
    force = 1.0 if torque else 2.0
    for tick in range(5000):
        bench.step(NOTHING, estimate(force=[0.002 * force * tick, 0.0, 0.0], torque=[0.0, 0.0, 0.002 * torque * tick]))
    assert [event.kind for event in bench.events] == [Kind.SENSOR_DRIFTED, Kind.LEFT_PERIOD]
    told = bench.events[0].values
    expected = {"force": 2.0, "torque": FAR_TURN} if torque else {"force": FAR, "torque": 0.0}
    assert told == {name: pytest.approx(value, abs=0.21) for name, value in expected.items()}
    assert told["torque" if torque else "force"] >= (FAR_TURN if torque else FAR)


@pytest.mark.parametrize("turned", [False, True])
def test_a_drift_turns_with_the_flange(turned: bool) -> None:
    R_BF = TURNED if turned else np.eye(3)
    before, after = estimate(), estimate(force=[0.1, -0.2, 0.05], torque=[0.01, -0.02, 0.03])
    zero, mean, hand = Zero(), WrenchMean(), Hand(before, (0.0,) * 6)
    zero.begin(before, True, mean)
    for value in [before] * 50 + [after] * 51:
        mean.step(value)
        zero.step(value, hand, mean, True)
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
    drift, gone = Drift(), np.zeros(6)
    for window in range(300):
        taken = drift.step(tuple((window * rate + noise * rng.normal(size=6)).tolist()))
        gone += taken or (0.0,) * 6
    assert gone == pytest.approx(299 * rate, abs=1.0)


@pytest.mark.parametrize(("size", "next_one"), [(0.3, 0.0), (0.5, 0.2), (0.8, 0.3), (1.1, 0.3), (20.0, 0.3)])
def test_what_of_a_push_waits_for_the_next_windows_is_little(size: float, next_one: float) -> None:
    """Of a force that comes at once and stays, 0.3 N in its window, and 0.5 N in the two after it; of a torque 0.06 and 0.1."""
    drift = Drift()
    drift.step((0.0,) * 6)
    taken = [drift.step((0.0, size, 0.0, 0.0, 0.0, -0.2 * size)) for _ in range(4)]
    force = [min(size, 0.3), next_one, min(max(size - 0.6, 0.0), 0.2), 0.0]
    assert [step[1] for step in taken if step] == pytest.approx(force)
    assert [-5.0 * step[5] for step in taken if step] == pytest.approx(force)


@pytest.mark.parametrize("anew", [False, True], ids=["guided", "period anew"])
def test_pushes_leave_no_offset_behind(anew: bool) -> None:
    """Each grows by 10 N/s for 0.3 s before the arm moves; 3 N/s would pass for drift. It is gone before the arm rests."""
    bench = Bench(free_drive__period=30.0, free_drive__restart_at_manipulation=anew).in_period()
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


def test_a_step_is_told_and_taken_off_in_the_robot() -> None:
    bench = Bench().in_period()
    bench.run(50)
    bench.step(NOTHING, estimate(force=[0.0, 0.0, 15.0]))
    for _ in range(LATER):
        bench.step(NOTHING, estimate(force=[0.0, 0.0, 15.0], felt=list(PUSHED)))
    assert [event.kind for event in bench.events] == [Kind.MANIPULATION, Kind.SENSOR_STEPPED]
    assert bench.events[-1].values == {"force": pytest.approx(15.0, abs=SLOW * WINDOW)}
    assert (bench.last.baseline, bench.last.gain) == ((0.0,) * 6, 0.0)


@pytest.mark.parametrize("how", [{"acceleration": 2.0}, {"acceleration_valid": False}])
def test_a_step_that_shakes_the_flange_or_that_nobody_can_tell_from_one_that_does_is_a_hands(how: dict[str, float]) -> None:
    steps = Steps()
    forces = stepping(20.0)
    found = [
        steps.step(estimate(felt=[0.0, 0.0, -10.0 * (k > 2)], **(how if k > 2 else {})), force)  # type: ignore[arg-type]
        for k, force in enumerate(forces)
    ]
    assert found == [None] * len(forces)


@pytest.mark.parametrize(("quiet", "told"), [(SOON - 1, True), (SOON - 2, False)])
def test_help_that_comes_soon_shakes_the_flange_later_than_a_hand_does(quiet: int, told: bool) -> None:
    """A step of 20 N moves a light wrist within four ticks, as the help that it calls for does."""
    steps, first = Steps(), 2  # the step's first tick
    found = [
        steps.step(estimate(felt=[0.0, 0.0, -10.0 * (k > first)], acceleration=2.0 * (k > first + quiet)), force)
        for k, force in enumerate(stepping(20.0))
    ]
    assert any(step is not None for step in found) is told


@pytest.mark.parametrize(("share", "told"), [(0.99, True), (1.0, True), (1.01, False)])
@pytest.mark.parametrize("strays", [1, 2, 3])
@pytest.mark.parametrize("axis", range(3))
def test_the_sensors_noise_does_not_hide_a_small_step(strays: int, share: float, told: bool, axis: int) -> None:
    """A stray tick counts by half, two in a row count whole."""
    stray = share * (STRAY * 5.0 + NOISE) * (2.0 if strays == 1 else 1.0)
    turned = [[0.0] * axis + [value] + [0.0] * (2 - axis) for value in (0.0, 5.0)]
    beside = [value + stray * (k == (axis + 1) % 3) for k, value in enumerate(turned[1])]
    forces = [tuple(value) for value in (turned[0],) * 2 + (turned[1],) * 2 + (beside,) * strays + (turned[1],) * 6]
    assert bool(seen(Steps(), [(x, y, z) for x, y, z in forces], [-0.4 * value for value in turned[1]])) is told


@pytest.mark.parametrize(("last", "told"), [(2.51, True), (2.5, True), (2.49, False)])
def test_a_step_that_fades_is_noise_upon_a_hands_first_touch(last: float, told: bool) -> None:
    """Its mean over six ticks is LEAST with a last one of 2.5 N."""
    forces: list[Vector] = [(0.0, 0.0, z) for z in (0.0, 0.0, JUMP, JUMP, 3.0, 3.0, 3.0, 3.0, last)]
    assert sum([JUMP, 3.0, 3.0, 3.0, 3.0, 2.5]) == LATER * LEAST
    assert bool(seen(Steps(), forces, [0.0, 0.0, -2.0])) is told


def test_the_baseline_is_in_the_axes_of_the_flange_at_entry() -> None:
    bench = Bench(free_drive__period=30.0).in_period()
    for tick in range(1000):
        value = estimate(force=[0.004 * tick, 0.0, 0.0])
        value.R_BF = TURNED
        bench.step(NOTHING, value)
    assert bench.last.baseline[:3] == pytest.approx((0.0, -4.0, 0.0), abs=0.5)


@pytest.mark.parametrize(("speed", "given_back"), [(MOVED, False), (1.001 * MOVED, True), (-1.001 * MOVED, True)])
def test_what_is_taken_off_in_every_axis_is_given_back_to_who_moves_the_arm(speed: float, given_back: bool) -> None:
    force, torque = [0.1, -0.2, 0.05], [0.01, -0.02, 0.03]  # less than what may be drift in a window
    before, after = estimate(), estimate(force=force, torque=torque, qd=speed)
    after.R_BF = TURNED  # since entry
    zero, mean, hand = Zero(), WrenchMean(), Hand(before, (0.0,) * 6)
    zero.begin(before, True, mean)
    for value in [before] * 50 + [after] * 51:
        mean.step(value)
        assert zero.step(value, hand, mean, True) is None
    gone = (-0.2, -0.1, 0.05, -0.02, -0.01, 0.03)  # axes of the flange, and of B at entry
    assert zero.baseline == pytest.approx(gone)
    hand.step(after, True)
    assert hand.change == pytest.approx((0.0,) * 3)
    assert zero.step(after, hand, mean, False) is None
    hand.step(after, True)
    assert zero.baseline == pytest.approx((0.0,) * 6 if given_back else gone)
    assert hand.change == pytest.approx(force if given_back else (0.0,) * 3)


def test_a_zero_that_was_left_is_as_one_that_never_began() -> None:
    zero, mean = Zero(), WrenchMean()
    mean.step(estimate(force=3.0))
    zero.begin(estimate(), True, mean)
    assert (zero.used, zero.baseline) == (True, (3.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    zero.leave()
    assert zero.memory == Zero().memory


def test_a_step_in_space_is_taken_off_as_the_mean_of_what_was_felt() -> None:
    rng = np.random.default_rng(1)
    step = np.array([6.0, -8.0, 4.0])
    felt = [(x, y, z) for x, y, z in (step + rng.uniform(-0.5, 0.5, (20, 3))).tolist()]
    forces: list[Vector] = [(0.0, 0.0, 0.0)] * 2 + felt
    assert seen(Steps(), forces, (-0.5 * step).tolist()) == [pytest.approx(np.mean(felt[1 : LATER + 1], axis=0))]


@pytest.mark.parametrize(
    ("acceleration", "when", "found"), [(1.51, 1, False), (1.51, SOON - 1, False), (1.51, SOON, True), (1.5, 1, True)]
)
def test_an_arm_that_is_shaken_just_then_was_knocked(acceleration: float, when: int, found: bool) -> None:
    """Beyond 1.5 m/s² within the first ticks, `when` after the step, even in one of them."""
    steps, forces = Steps(), stepping(20.0)
    joints = against(forces, -0.5)
    said = []
    for tick, force in enumerate(forces):
        shaken = acceleration if tick == 2 + when else 0.0
        said.append(steps.step(estimate(felt=joints if tick > 2 else 0.0, acceleration=shaken), force))
    assert any(step is not None for step in said) is found
