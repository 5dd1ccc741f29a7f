"""A wrench that does not change while the arm moves may be the flange sensor's own error (FD-19)."""

import math

import numpy as np
import pytest

from pendant.guided.bias_follower import Slack
from pendant.guided.steady_wrench import OFTEN, SteadyWrench
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER, window_noise
from pendant.tick.estimate import GRAVITY
from pendant.tick.pose import Wrench
from tests.pendant.estimates import SENSOR, estimate

NEEDED = 3 * OFTEN
FORCE = 1.0  # of a hand at least [N]
WRENCH: Wrench = (1.0, -2.0, 2.0, 0.1, 0.2, -0.2)  # 3 N, 0.3 N·m
WRONG = Slack(3.5, 0.4)
NOISE = FALSE_ALARM * window_noise(SENSOR, estimate())  # [N]
FAR = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # R_BF after 90° about x


def seen(*wrenches: Wrench, moves: bool = True, wrong: Slack = WRONG, load: float = 0.0) -> SteadyWrench:
    watch = SteadyWrench(SENSOR, NEEDED, FORCE)
    for wrench in wrenches:
        watch.step(wrench, estimate(load_mass=load), moves=moves, wrong=wrong)
    return watch


def changed(axis: int, by: float) -> Wrench:
    return tuple(value + (by if k == axis else 0.0) for k, value in enumerate(WRENCH))


@pytest.mark.parametrize(("windows", "steady"), [(1, False), (3, False), (4, True), (9, True)])
def test_it_takes_as_long_as_an_arm_may_move_alone(windows: int, steady: bool) -> None:
    assert seen(*[WRENCH] * windows).steady is steady


@pytest.mark.parametrize(("needed", "windows"), [(1, 2), (OFTEN, 2), (OFTEN + 1, 3), (2 * OFTEN, 3), (2 * OFTEN + 1, 4)])
def test_a_window_that_has_begun_counts(needed: int, windows: int) -> None:
    watch = SteadyWrench(SENSOR, needed, FORCE)
    count = 0
    while not watch.steady:
        watch.step(WRENCH, estimate(), moves=True, wrong=WRONG)
        count += 1
    assert count == windows


def test_a_window_ends_every_so_many_ticks() -> None:
    watch = SteadyWrench(SENSOR, NEEDED, FORCE)
    assert [tick for tick in range(1, 3 * OFTEN + 1) if watch.due()] == [OFTEN, 2 * OFTEN, 3 * OFTEN]


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("share", "steady"), [(-1.01, False), (-0.99, True), (0.99, True), (1.01, False)])
def test_in_every_axis_it_changes_by_no_more_than_noise(axis: int, share: float, steady: bool) -> None:
    by = share * NOISE * (LEVER if axis >= 3 else 1.0)
    assert seen(WRENCH, changed(axis, by), changed(axis, by), WRENCH).steady is steady


def test_it_is_compared_with_the_first_of_them() -> None:
    """What creeps by half its noise from window to window does not stay."""
    assert not seen(*[changed(0, -0.6 * NOISE * k) for k in range(8)]).steady


@pytest.mark.parametrize(("share", "steady"), [(0.99, True), (1.01, False)])
@pytest.mark.parametrize("axis", [0, 3])
def test_a_load_that_turns_adds_what_the_gain_makes_of_it(share: float, steady: bool, axis: int) -> None:
    load = 2.0
    noise = FALSE_ALARM * window_noise(SENSOR, estimate(load_mass=load))
    by = share * (noise + SENSOR.gain * load * GRAVITY * math.sqrt(2.0)) * (LEVER if axis >= 3 else 1.0)
    watch, wide = SteadyWrench(SENSOR, OFTEN, FORCE), Slack(9.0, 9.0)
    watch.step(WRENCH, estimate(load_mass=load), moves=True, wrong=wide)
    after = estimate(load_mass=load)
    after.R_BF = FAR
    watch.step(changed(axis, by), after, moves=True, wrong=wide)
    assert watch.steady is steady


@pytest.mark.parametrize(
    ("wrong", "steady"),
    [(Slack(3.0001, 0.3001), True), (Slack(2.9999, 9.0), False), (Slack(9.0, 0.2999), False)],
)
def test_more_than_the_bias_may_be_wrong_by_is_a_hands(wrong: Slack, steady: bool) -> None:
    """Beside noise."""
    wrong = Slack(wrong.force - NOISE, wrong.torque - LEVER * NOISE)
    assert seen(*[WRENCH] * 5, wrong=wrong).steady is steady


def test_of_an_arm_at_rest_a_hand_may_hold_still() -> None:
    assert not seen(*[WRENCH] * 9, moves=False).steady


def test_until_it_changes_it_stays_also_while_the_arm_rests() -> None:
    watch = seen(*[WRENCH] * 4)
    for _ in range(5):
        watch.step(WRENCH, estimate(), moves=False, wrong=WRONG)
        assert watch.steady
    watch.step(changed(1, 0.99 * (FORCE + NOISE)), estimate(), moves=False, wrong=WRONG)
    assert watch.steady, "by less than a hand's force, as the arm brakes"
    watch.step(changed(1, 1.01 * (FORCE + NOISE)), estimate(), moves=False, wrong=WRONG)
    assert not watch.steady
    watch.step(WRENCH, estimate(), moves=True, wrong=WRONG)
    assert not watch.steady


def test_what_is_forgotten_begins_with_the_next_window() -> None:
    watch = seen(*[WRENCH] * 4)
    watch.forget()
    assert not watch.steady
    for count in range(1, 5):
        watch.step(WRENCH, estimate(), moves=True, wrong=WRONG)
        assert watch.steady is (count == 4)


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("moves", [False, True])
@pytest.mark.parametrize(("share", "changes"), [(-1.01, True), (-0.99, False), (0.99, False), (1.01, True)])
def test_one_of_two_wrenches_is_a_hands_where_half_their_difference_is(
    axis: int, moves: bool, share: float, changes: bool
) -> None:
    """However far the sensor may have drifted meanwhile, and beside noise."""
    by = share * (2.0 * FORCE + NOISE) * (LEVER if axis >= 3 else 1.0)
    assert seen(WRENCH, changed(axis, by), moves=moves, wrong=Slack(99.0, 99.0)).changes is changes


@pytest.mark.parametrize(("between", "changes"), [(0, True), (2, True), (3, False)])
def test_a_change_counts_for_as_long_as_an_arm_may_move_alone(between: int, changes: bool) -> None:
    far = changed(1, 9.0)
    assert seen(*[WRENCH] * 9, far, *[far] * between).changes is changes


@pytest.mark.parametrize(("share", "changes"), [(0.99, False), (1.01, True)])
def test_what_the_gain_makes_of_a_load_that_turns_is_no_hands(share: float, changes: bool) -> None:
    load = 2.0
    noise = FALSE_ALARM * window_noise(SENSOR, estimate(load_mass=load))
    by = share * (2.0 * FORCE + noise + SENSOR.gain * load * GRAVITY * math.sqrt(2.0))
    watch = SteadyWrench(SENSOR, NEEDED, FORCE)
    watch.step(WRENCH, estimate(load_mass=load), moves=True, wrong=WRONG)
    after = estimate(load_mass=load)
    after.R_BF = FAR
    watch.step(changed(0, by), after, moves=True, wrong=WRONG)
    assert watch.changes is changes


def test_with_what_is_forgotten_nothing_is_compared() -> None:
    watch = seen(WRENCH, changed(1, 9.0))
    assert watch.changes
    watch.forget()
    assert not watch.changes
    watch.step(WRENCH, estimate(), moves=True, wrong=WRONG)
    assert not watch.changes


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("share", "turned"), [(-1.01, True), (-0.99, False), (0.99, False), (1.01, True)])
@pytest.mark.parametrize("between", [0, 50])
def test_since_the_way_began_a_hands_change_is_known_however_slow_it_is(
    axis: int, share: float, turned: bool, between: int
) -> None:
    by = share * (2.0 * FORCE + NOISE) * (LEVER if axis >= 3 else 1.0)
    steps = [changed(axis, by * k / 51) for k in range(1, 51)][:between]
    watch = seen(WRENCH, *steps, changed(axis, by), *[WRENCH] * 9, wrong=Slack(99.0, 99.0))
    assert watch.turned is turned


def test_it_is_compared_with_all_windows_since() -> None:
    """Of two that are each too little off the first one."""
    by = 0.6 * (2.0 * FORCE + NOISE)
    assert not seen(WRENCH, changed(1, by)).turned
    assert seen(WRENCH, changed(1, by), changed(1, -by)).turned


@pytest.mark.parametrize("how", ["begin_way", "forget"])
def test_where_a_way_begins_nothing_has_turned(how: str) -> None:
    watch = seen(WRENCH, changed(1, 9.0))
    assert watch.turned
    getattr(watch, how)()
    assert not watch.turned
    watch.step(WRENCH, estimate(), moves=True, wrong=WRONG)
    assert not watch.turned


@pytest.mark.parametrize(("share", "turned"), [(0.99, False), (1.01, True)])
def test_nor_does_the_gain_turn_it_where_the_load_weighs(share: float, turned: bool) -> None:
    """The load lay across the sensor as the way began."""
    load = 2.0
    noise = FALSE_ALARM * window_noise(SENSOR, estimate(load_mass=load))
    by = share * (2.0 * FORCE + noise + SENSOR.gain * load * GRAVITY * math.sqrt(2.0))
    watch, after = SteadyWrench(SENSOR, NEEDED, FORCE), estimate(load_mass=load)
    after.R_BF = FAR
    watch.step(WRENCH, estimate(load_mass=load), moves=True, wrong=WRONG)
    watch.step(changed(0, by), after, moves=True, wrong=WRONG)
    assert watch.turned is turned
