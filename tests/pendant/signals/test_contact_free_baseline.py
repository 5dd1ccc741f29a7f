"""The untouched state: how it is learned, what of a change it follows, and how it measures noise (FD-5)."""

import math
from itertools import pairwise

import numpy as np
import pytest

from pendant.limits.validity import WINDOW
from pendant.sensor.hand_model import KEEPS, TREMOR
from pendant.signals.contact_free_baseline import CREEP, FOLLOW, STILL, Untouched
from pendant.tick.modes import TICK

WEIGHTS = (1.0, 1.0, 1.0, 5.0, 5.0, 5.0)
AT_ONCE = 1e-6
"""Time constant that smooths nothing [s]."""


def settled(near: float = 3.0, values: tuple[float, ...] = (0.0,) * 6) -> Untouched:
    """It has learned `values`."""
    untouched = Untouched(WEIGHTS, near, AT_ONCE)
    for _ in range(WINDOW):
        untouched.step(values)
    return untouched


def test_it_is_the_mean_over_the_ticks_of_learning() -> None:
    untouched = Untouched(WEIGHTS, 3.0, AT_ONCE)
    learned = [[float((3 * tick + 7 * k) % 11) for k in range(6)] for tick in range(WINDOW)]
    assert all(untouched.step(values) == [0.0] * 6 for values in learned)
    now = (1.0, 2.0, 30.0, 4.0, 50.0, 6.0)
    np.testing.assert_allclose(untouched.step(now), now - np.mean(learned, axis=0), atol=1e-12)


def test_a_change_is_felt_from_the_tick_after_learning_on_and_after_each_restart() -> None:
    untouched = settled()
    for value in (20.0, 50.0):
        assert untouched.step((value,) * 6) != [0.0] * 6
        untouched.restart()
        assert all(untouched.step((value,) * 6) == [0.0] * 6 for _ in range(WINDOW))


@pytest.mark.parametrize("k", range(6))
@pytest.mark.parametrize(
    ("size", "rate"), [(2.5, 2.5 * FOLLOW), (2.99, 2.99 * FOLLOW), (3.0, CREEP), (3.01, CREEP), (40.0, CREEP)]
)
def test_a_change_is_followed_quickly_below_the_size_that_is_near_only(k: int, size: float, rate: float) -> None:
    """The size of a change is that of its largest value, as weighted."""
    changed = tuple(-size / WEIGHTS[k] if i == k else 0.0 for i in range(6))
    untouched = settled()
    sizes = [WEIGHTS[k] * abs(untouched.step(changed)[k]) for _ in range(2)]
    assert sizes[0] == pytest.approx(size)
    assert sizes[0] - sizes[1] == pytest.approx(rate)


@pytest.mark.parametrize("size", [0.1, 1.0, 2.9])
def test_noise_is_the_root_of_the_mean_square_of_what_is_near(size: float) -> None:
    """With the time constant of a change that stays, over 1 s; a torque counts five times."""
    untouched = settled(values=(3.0,) * 6)
    for _ in range(500):
        untouched.step((3.0,) * 6)
    assert untouched.noise == 0.0
    for tick in range(500):
        untouched.step((3.0, 3.0, 3.0, 3.0, 3.0 + (-1) ** tick * size / 5.0, 3.0))
    assert untouched.noise == pytest.approx(size * math.sqrt(1.0 - math.exp(-1.0 / KEEPS)), rel=0.01)
    for _ in range(500):
        untouched.step((100.0,) * 6)
    assert untouched.noise == pytest.approx(size * math.sqrt(1.0 - math.exp(-1.0 / KEEPS)), rel=0.01), "a push is no noise"


def test_what_is_measured_is_smoothed() -> None:
    untouched = Untouched((1.0,), 3.0, 0.03)
    for _ in range(WINDOW):
        untouched.step((0.0,))
    course = [untouched.step((10.0,))[0] for _ in range(30)]
    assert all(before < after for before, after in pairwise(course))
    assert course[14] == pytest.approx(10.0 * (1.0 - math.exp(-15 * TICK / 0.03)), rel=0.01)


@pytest.mark.parametrize("again", [False, True])
@pytest.mark.parametrize(("size", "ticks"), [(TREMOR - 0.1, STILL), (TREMOR + 0.1, STILL + 1), (1.5, STILL + 1)])
def test_a_change_that_stays_steady_for_long_enough_is_nobodys_to_the_tick(size: float, ticks: int, again: bool) -> None:
    """It is steady from the tick of its last move by more than a tremor on, or from the learning of the untouched state on."""
    untouched = Untouched((1.0,), 0.3, AT_ONCE)
    if again:
        for tick in range(WINDOW + 9):
            untouched.step((9.0 * (tick > WINDOW),))
        untouched.restart()
    for _ in range(WINDOW):
        untouched.step((0.0,))
    course = (untouched.step((size + CREEP * tick,))[0] for tick in range(ticks + 9))  # it keeps pace with the creeping
    assert next(tick for tick, change in enumerate(course) if change < 0.3) == ticks
