"""A wrench that changes as only a hand changes it, however wrong the flange sensor's bias is (FD-19)."""

import math

import numpy as np
import pytest

from pendant.guided.bias_follower import OFTEN
from pendant.guided.changing_wrench import ChangingWrench
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER, window_noise
from pendant.tick.estimate import GRAVITY
from pendant.tick.pose import Wrench
from tests.pendant.estimates import SENSOR, estimate

NEEDED = 3 * OFTEN
FORCE = 1.0  # of a hand at least [N]
WRENCH: Wrench = (1.0, -2.0, 2.0, 0.1, 0.2, -0.2)  # 3 N, 0.3 N·m
NOISE = FALSE_ALARM * window_noise(SENSOR, estimate())  # [N]
FAR = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # R_BF after 90° about x


def seen(*wrenches: Wrench) -> ChangingWrench:
    watch = ChangingWrench(SENSOR, NEEDED, FORCE)
    for wrench in wrenches:
        watch.step(wrench, estimate())
    return watch


def changed(axis: int, by: float) -> Wrench:
    return tuple(value + (by if k == axis else 0.0) for k, value in enumerate(WRENCH))


def test_a_window_ends_every_so_many_ticks() -> None:
    watch = ChangingWrench(SENSOR, NEEDED, FORCE)
    assert [tick for tick in range(1, 3 * OFTEN + 1) if watch.due()] == [OFTEN, 2 * OFTEN, 3 * OFTEN]


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("share", "changes"), [(-1.01, True), (-0.99, False), (0.99, False), (1.01, True)])
def test_one_of_two_wrenches_is_a_hands_where_half_their_difference_is(axis: int, share: float, changes: bool) -> None:
    """However far the sensor may have drifted meanwhile, and beside noise."""
    by = share * (2.0 * FORCE + NOISE) * (LEVER if axis >= 3 else 1.0)
    assert seen(WRENCH, changed(axis, by)).changes is changes


@pytest.mark.parametrize(("between", "changes"), [(0, True), (2, True), (3, False)])
def test_a_change_is_one_against_what_was_felt_while_an_arm_may_move_alone(between: int, changes: bool) -> None:
    """What changes by less from window to window is none."""
    slow = [changed(1, 0.6 * (2.0 * FORCE + NOISE) * min(k / between, 1.0)) for k in range(1, between + 1)]
    assert seen(*[WRENCH] * 9, *slow, changed(1, 1.2 * (2.0 * FORCE + NOISE))).changes is changes


@pytest.mark.parametrize(("needed", "windows"), [(1, 1), (OFTEN, 1), (OFTEN + 1, 2), (2 * OFTEN, 2), (2 * OFTEN + 1, 3)])
def test_a_window_that_has_begun_counts(needed: int, windows: int) -> None:
    """So many windows ago is not too long for a change."""
    for count in (windows, windows + 1):
        watch = ChangingWrench(SENSOR, needed, FORCE)
        for k in range(count + 1):
            watch.step(changed(1, 1.01 * (2.0 * FORCE + NOISE) * k / count), estimate())
        assert watch.changes is (count == windows)


@pytest.mark.parametrize(("share", "changes"), [(0.99, False), (1.01, True)])
def test_what_the_gain_makes_of_a_load_that_turns_is_no_hands(share: float, changes: bool) -> None:
    load = 2.0
    noise = FALSE_ALARM * window_noise(SENSOR, estimate(load_mass=load))
    by = share * (2.0 * FORCE + noise + SENSOR.gain * load * GRAVITY * math.sqrt(2.0))
    watch = ChangingWrench(SENSOR, NEEDED, FORCE)
    watch.step(WRENCH, estimate(load_mass=load))
    after = estimate(load_mass=load)
    after.R_BF = FAR
    watch.step(changed(0, by), after)
    assert watch.changes is changes


def test_with_what_is_forgotten_nothing_is_compared() -> None:
    watch = seen(WRENCH, changed(1, 9.0))
    assert watch.changes
    watch.forget()
    assert not watch.changes
    watch.step(WRENCH, estimate())
    assert not watch.changes


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("share", "turned"), [(-1.01, True), (-0.99, False), (0.99, False), (1.01, True)])
@pytest.mark.parametrize("between", [0, 50])
def test_since_the_way_began_a_hands_change_is_known_however_slow_it_is(
    axis: int, share: float, turned: bool, between: int
) -> None:
    by = share * (2.0 * FORCE + NOISE) * (LEVER if axis >= 3 else 1.0)
    steps = [changed(axis, by * k / 51) for k in range(1, 51)][:between]
    watch = seen(WRENCH, *steps, changed(axis, by), *[WRENCH] * 9)
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
    watch.step(WRENCH, estimate())
    assert not watch.turned


@pytest.mark.parametrize(("share", "turned"), [(0.99, False), (1.01, True)])
def test_nor_does_the_gain_turn_it_where_the_load_weighs(share: float, turned: bool) -> None:
    """The load lay across the sensor as the way began."""
    load = 2.0
    noise = FALSE_ALARM * window_noise(SENSOR, estimate(load_mass=load))
    by = share * (2.0 * FORCE + noise + SENSOR.gain * load * GRAVITY * math.sqrt(2.0))
    watch, after = ChangingWrench(SENSOR, NEEDED, FORCE), estimate(load_mass=load)
    after.R_BF = FAR
    watch.step(WRENCH, estimate(load_mass=load))
    watch.step(changed(0, by), after)
    assert watch.turned is turned
