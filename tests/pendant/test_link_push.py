"""A hand on a link: told from friction's errors, from what brakes, and from what a soft gear hides."""

import pytest

from pendant.link_push import LEAST, TURNS, UNSURE, LinkPush
from tests.pendant.estimates import estimate

RATED = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)
BEFORE = (0.0, -8.0, 0.0, 0.0, 0.0, 0.0)


def told(*rows: tuple[int, float, float, float], deviation: float = 0.0) -> bool:
    """After rows of ticks, speed and external torque of the shoulder [rad/s], [N·m], and the torque of wrist 1."""
    push = LinkPush(BEFORE, RATED)
    value = estimate(tau_ext_deviation=deviation)
    for count, speed, torque, wrist in rows:
        value = estimate(
            qd=[0.0, speed, 0.0, speed, 0.0, 0.0], tau_ext=[0.0, torque, 0.0, wrist, 0.0, 0.0], tau_ext_deviation=deviation
        )
        for _ in range(count):
            push.step(value)
    return push.told(value)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_change_since_entry_counts_in_the_direction_of_the_turn(way: float) -> None:
    enough = LEAST * 150.0
    assert told((100, way * 0.2, -8.0 + way * (enough + 0.01), 0.0))
    assert not told((100, way * 0.2, -8.0 + way * (enough - 0.01), 0.0))
    assert not told((100, way * 0.2, -8.0 - way * 20.0, 0.0)), "that brakes it"


def test_each_joint_is_measured_by_its_own_size() -> None:
    assert told((100, 0.2, -8.0, 28.0 * LEAST + 0.01))
    assert not told((100, 0.2, -8.0, 28.0 * LEAST - 0.01))


def test_a_joint_that_stands_tells_nothing_and_the_mean_is_over_all_ticks() -> None:
    assert not told((100, 0.9 * TURNS, 12.0, 0.0))
    assert told((50, 0.9 * TURNS, 12.0, 0.0), (50, 0.2, -4.3, 0.0))
    assert not told((50, 0.9 * TURNS, 12.0, 0.0), (50, 0.2, -4.5, 0.0))


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_joint_turns_from_its_least_speed_on(way: float) -> None:
    assert told((10, way * TURNS, -8.0 + way * 20.0, 0.0))


def test_what_the_gear_may_hide_is_no_hand() -> None:
    assert not told((100, 0.2, -5.1, 0.0), deviation=3.0 / UNSURE)
    assert told((100, 0.2, -5.0, 0.0), deviation=3.0 / UNSURE), "3 N·m more than at entry is just enough"


def test_it_begins_anew() -> None:
    push = LinkPush(BEFORE, RATED)
    fresh = push.memory
    pushed = estimate(qd=[0.0, 0.2, 0.0, 0.0, 0.0, 0.0], tau_ext=[0.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    push.step(pushed)
    assert push.told(pushed)
    assert push.memory != fresh
    push.begin()
    assert push.memory == fresh


def test_without_a_tick_nobody_is_told() -> None:
    assert not told()
