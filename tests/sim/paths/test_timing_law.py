"""The timing law: every way has one, it keeps its limits, and it ends exactly at its end, at rest."""

import math
from itertools import pairwise

import numpy as np
import pytest

from sim.paths.timing_law import REST, Limits, MoveRefused, PathState, TimingLaw, TooShort

RAMP = 0.1  # time in which the acceleration is reached [s]
TICK = 0.002


def drawn(rng: np.random.Generator) -> tuple[float, Limits]:
    """A length and limits; half of the lengths lie within some ulps of where one kind of law goes over into another."""
    a = float(rng.choice([0.5, 1.0, 1.2, 2.5, 10.0 ** rng.uniform(-2.0, 2.0)]))
    v = float(rng.choice([0.25, 1.0, 10.0 ** rng.uniform(-3.0, 1.0)]))
    k = int(rng.integers(1, 500))
    exact = [0.0, 2.0 * a * RAMP**2, a * RAMP**2, v * RAMP, v * v / a + v * RAMP, v * v / a, k * v * TICK, k * a * TICK**2]
    length = float(rng.choice(exact)) if rng.random() < 0.5 else 10.0 ** float(rng.uniform(-9.0, 0.5))
    return length + int(rng.integers(-4, 5)) * math.ulp(length) * (length > 0.0), Limits(v, a, a / RAMP)


def check(law: TimingLaw, limits: Limits, begin: PathState = REST) -> None:
    """Within its limits, or those of a begin beyond them; way and speed are the integrals of speed and acceleration."""
    most_v = max(limits.speed, begin.v, begin.v + 0.5 * begin.a * abs(begin.a) / limits.jerk)
    most_a = max(limits.acceleration, abs(begin.a))
    assert law.at(0.0) == pytest.approx(begin, rel=1e-9, abs=1e-12)
    assert law.at(law.duration) == law.at(2.0 * law.duration + 1.0) == (law.length, 0.0, 0.0)
    for before, now in pairwise(np.linspace(0.0, law.duration, 60)):
        (s, v, a), (s_0, v_0, a_0), dt = law.at(now), law.at(before), now - before
        assert -1e-9 * most_v <= v <= most_v * (1.0 + 1e-9)
        assert abs(a) <= most_a * (1.0 + 1e-9)
        assert abs(a - a_0) <= limits.jerk * dt * (1.0 + 1e-6) + 1e-9 * most_a
        # The mean of a cubic's slopes is off by at most jerk dt³/6, once for each change of the jerk.
        assert abs(v - v_0 - 0.5 * (a + a_0) * dt) <= limits.jerk * dt**2 / 4.0 + 1e-9 * most_v
        assert abs(s - s_0 - 0.5 * (v + v_0) * dt) <= most_a * dt**2 / 4.0 + 1e-12


def test_every_way_from_rest_has_a_law() -> None:
    rng = np.random.default_rng(1)
    for _ in range(1000):
        length, limits = drawn(rng)
        check(TimingLaw(length, limits), limits)


def test_a_hundred_thousand_ways_on_the_borders_of_two_kinds_have_one() -> None:
    """Whole multiples of a t_j², v and the tick, and their neighbours: a search for roots fails for one in twenty of them."""
    rng = np.random.default_rng(2)
    for _ in range(100):
        _, limits = drawn(rng)
        v, a, _ = limits
        for length in (2.0 * a * RAMP**2, v * RAMP, v * v / a + v * RAMP):
            for ulps in range(-10, 11):
                way = length + ulps * math.ulp(length)
                law = TimingLaw(way, limits)
                assert law.at(law.duration) == (way, 0.0, 0.0)
                half = law.at(0.5 * law.duration).s
                assert half == pytest.approx(0.5 * way, rel=1e-9)


@pytest.mark.parametrize(
    ("length", "duration"),
    [
        (1.0, 1.0 / 0.25 + 0.25 / 0.5 + 0.1),  # speed and acceleration are reached
        (0.1, 0.1 + math.sqrt(0.1**2 + 4.0 * 0.1 / 0.5)),  # the acceleration alone
        (1e-3, 4.0 * (1e-3 / (2.0 * 5.0)) ** (1.0 / 3.0)),  # neither
    ],
)
def test_it_takes_no_longer_than_its_limits_ask_for(length: float, duration: float) -> None:
    assert TimingLaw(length, Limits(0.25, 0.5, 5.0)).duration == pytest.approx(duration, rel=1e-9)


def test_a_moving_start_goes_on_to_any_end_that_it_can_stop_at() -> None:
    rng, refused = np.random.default_rng(3), 0
    for _ in range(1000):
        length, limits = drawn(rng)
        before = TimingLaw(length, limits)
        begin = before.at(float(rng.random()) * before.duration)
        v, a = limits.speed * float(rng.choice([0.3, 1.0, 3.0])), limits.acceleration * float(rng.choice([0.3, 1.0, 3.0]))
        other, end = Limits(v, a, a / RAMP), length + float(rng.choice([0.0, 10.0 ** rng.uniform(-6.0, 0.0)]))
        try:
            law = TimingLaw(end, other, begin)
        except TooShort:
            assert a < limits.acceleration, "what is planned already can be done"
            refused += 1
            continue
        check(law, other, begin)
    assert 0 < refused < 300


def test_a_motion_that_is_planned_again_on_its_way_takes_what_is_left() -> None:
    limits = Limits(0.25, 0.5, 5.0)
    law = TimingLaw(0.3, limits)
    for share in np.linspace(0.0, 1.0, 101):
        again = TimingLaw(0.3, limits, law.at(share * law.duration))
        assert again.duration == pytest.approx((1.0 - share) * law.duration, abs=1e-5)


def test_a_way_on_which_it_cannot_stop_is_refused() -> None:
    limits = Limits(1.0, 1.0, 10.0)
    with pytest.raises(TooShort, match=r"cannot stop within 0\.5 from a speed of 1"):
        TimingLaw(0.5, limits, PathState(0.0, 1.0, 0.0))
    assert TimingLaw(0.55, limits, PathState(0.0, 1.0, 0.0)).duration == pytest.approx(1.1)  # v²/2a + v/2 a/j


def test_it_says_where_it_has_come_down_to_a_lower_speed() -> None:
    law = TimingLaw(2.0, Limits(0.5, 1.0, 10.0), PathState(0.3, 1.0, 0.0))
    assert law.level == pytest.approx(0.3 + 0.75 * 0.6)  # at the mean speed, for V/a + a/j


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("which", range(3))
def test_limits_without_a_meaning_are_refused(value: float, which: int) -> None:
    limits = Limits(*(value if k == which else 1.0 for k in range(3)))
    with pytest.raises(MoveRefused, match="no motion by 1"):
        TimingLaw(1.0, limits)
    with pytest.raises(MoveRefused, match="no motion by"):
        TimingLaw(-1.0, Limits(1.0, 1.0, 1.0))


def test_glances_see_each_kind_of_acceleration_however_long_the_motion_lasts() -> None:
    law = TimingLaw(0.3, Limits(1e-6, 1.0, 10.0))
    times = law.glances(0.02, 24)
    assert len(times) < 100
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(law.duration)
    assert max(law.at(time).a for time in times) == pytest.approx(math.sqrt(10.0 * 1e-6))  # that changes the speed by 1e-6
    assert TimingLaw(0.0, Limits(1.0, 1.0, 1.0)).glances(0.02, 24) == [0.0]


def test_a_share_of_the_speed_takes_so_many_times_as_long() -> None:
    limits = Limits(0.25, 0.5, 5.0)
    fast, slow = TimingLaw(0.3, limits), TimingLaw(0.3, limits.slower(0.2))
    assert slow.duration == pytest.approx(5.0 * fast.duration)
    assert slow.at(2.5).s == pytest.approx(fast.at(0.5).s)
