"""A payload that drops as a hand lets go (FD-19): told by what stays missing, and from what hands do."""

import math

import numpy as np
import pytest

from pendant.guided.hidden_drop import APART, EXACT, LASTS, LEAST, NEAR, HiddenDrop
from pendant.tick.estimate import GRAVITY
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector
from pendant.tick.state import state_of

MASS, HELD = 1.0, 0.75
NEEDS = (0.0, 0.0, 8.0)  # of the load [N]
GONE = (0.0, 0.0, 6.0)  # the payload's part of it
HAND = (2.0, 0.0, 5.0)


def off(x: float, y: float = 0.0, z: float = 0.0) -> Vector:
    """So far from what the payload weighs."""
    return (GONE[0] + x, GONE[1] + y, GONE[2] + z)


def told(forces: list[Vector], held: float = HELD, drop: HiddenDrop | None = None) -> int | None:
    """The tick in which it is told, of a course of what is missing that was as its first before."""
    drop, course = drop or HiddenDrop(held), [forces[0], forces[0], *forces]
    return next((k for k, now in enumerate(forces) if drop.step(now, course[k], NEEDS, MASS)), None)


@pytest.mark.parametrize("hand", [off(APART), off(0.0, -APART), off(0.0, 0.0, APART), ORIGIN, (0.0, 0.0, -20.0)])
def test_it_is_told_once_it_has_stayed(hand: Vector) -> None:
    assert told([hand] * 5 + [GONE] * 20) == 5 + LASTS


@pytest.mark.parametrize("hand", [off(0.99 * APART), off(0.0, 0.99 * APART), off(0.7, -0.7, 0.7)])
def test_a_hand_that_was_near_before_may_still_be_there(hand: Vector) -> None:
    assert told([hand] * 5 + [GONE] * 100) is None


def test_what_is_missing_swings_with_what_the_payload_needs() -> None:
    """The arm is shaken by the drop: in size and direction."""
    drop = HiddenDrop(HELD)
    needs = [(math.sin(0.5 * k), 0.0, 8.0 + 2.0 * math.cos(k)) for k in range(LASTS + 1)]
    found = [drop.step((0.75 * x, 0.0, 0.75 * z), HAND, (x, 0.0, z), MASS) for x, _, z in needs]
    assert found == [False] * LASTS + [True]


@pytest.mark.parametrize("needs", [(5.0, -4.0, 6.0), (-6.0, 5.0, 4.0), (4.0, 6.0, -5.0)])
def test_it_is_told_in_any_posture(needs: Vector) -> None:
    x, y, z = (HELD / MASS * np.array(needs)).tolist()
    drop = HiddenDrop(HELD)
    assert [drop.step((x, y, z), ORIGIN, needs, MASS) for _ in range(LASTS + 1)] == [False] * LASTS + [True]


@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)])
def test_it_may_be_off_by_the_noise_and_hardly_in_the_mean(way: Vector) -> None:
    def stays(*sizes: float) -> int | None:
        return told([HAND] * 3 + [off(*(size * share for share in way)) for size in sizes] * 40)

    assert stays(NEAR, -NEAR) == 3 + LASTS
    assert stays(1.01 * NEAR, -1.01 * NEAR) is None
    assert stays(0.99 * EXACT) == 3 + LASTS
    assert stays(*[2.0 * EXACT] * 5, EXACT, *[0.0] * 5) == 3 + LASTS
    assert stays(1.01 * EXACT) is None


def test_one_tick_far_off_ends_it() -> None:
    """It starts again two ticks after one that was far enough off."""
    assert told([HAND] * 3 + [GONE] * LASTS + [off(1.01 * NEAR)] + [GONE] * 100) is None
    assert told([HAND] * 3 + [GONE] * LASTS + [HAND] + [GONE] * 20) == 3 + LASTS + 2 + LASTS


@pytest.mark.parametrize("rate", [10.0, 30.0, 60.0, 150.0, 500.0])
def test_a_hand_whose_force_grows_through_it_is_none(rate: float) -> None:
    """Straight against gravity, N/s."""
    assert told([(0.0, 0.0, rate * TICK * k) for k in range(int(20.0 / rate / TICK))]) is None


def test_a_hand_that_comes_to_it_slowly_and_stays_is_none() -> None:
    assert told([(0.0, 0.0, min(0.1 * k, 6.0)) for k in range(500)]) is None


def test_lighter_payloads_are_not_looked_at() -> None:
    light = 0.999 * LEAST / GRAVITY
    course = [HAND] * 3 + [(0.0, 0.0, light * 8.0)] * 30
    assert told(course, light) is None
    assert told([HAND] * 3 + [(0.0, 0.0, LEAST / GRAVITY * 8.0)] * 30, LEAST / GRAVITY) is not None


def test_without_the_sensor_it_begins_anew() -> None:
    drop = HiddenDrop(HELD)
    assert told([HAND, GONE, GONE], drop=drop) is None
    assert drop.ticks == 2
    drop.forget()
    assert drop.ticks == 0
    assert state_of(drop) == state_of(HiddenDrop(HELD))


def test_what_was_before_does_not_count() -> None:
    """A first one far off the mean leaves nothing to the second."""
    drop = HiddenDrop(HELD)
    assert told([HAND] * 2 + [off(0.79)] * LASTS + [HAND] * 2, drop=drop) is None
    assert told([HAND] * 2 + [off(0.39)] * 20, drop=drop) == 2 + LASTS
