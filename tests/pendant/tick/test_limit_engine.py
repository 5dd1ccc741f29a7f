"""The engine of all limits: maxima, minima, ranges, allowed times (FD-12a)."""

import math

import pytest

from pendant.tick.limit_engine import Excess, Gauge, Monitored
from pendant.tick.state import state_of


@pytest.mark.parametrize(
    ("low", "high", "within", "beyond"),
    [
        (-math.inf, 2.0, [-1e9, 0.0, 2.0], [math.nextafter(2.0, 3.0), 7.0, math.inf, math.nan]),
        (1.0, math.inf, [1.0, 5.0, 1e9], [math.nextafter(1.0, 0.0), -3.0, -math.inf, math.nan]),
        (-2.0, 3.0, [-2.0, 0.0, 3.0], [-2.1, 3.1, math.nan]),
    ],
)
def test_maximum_minimum_range(low: float, high: float, within: list[float], beyond: list[float]) -> None:
    gauge = Gauge("speed", "m/s", low=low, high=high)
    for value in within:
        assert not gauge.judge(value, "flange")
    for value in beyond:
        assert gauge.judge(value, "flange")


@pytest.mark.parametrize("allowed", [0, 1, 7, 50])
def test_only_longer_than_the_allowed_time_exceeds(allowed: int) -> None:
    gauge = Gauge("speed", "m/s", high=1.0, allowed=allowed)
    for _ in range(2):
        for count in range(1, allowed + 4):
            assert gauge.judge(1.5, "flange") == (count > allowed)
        assert not gauge.judge(1.0, "flange")  # one tick within: the time begins again


@pytest.mark.parametrize(
    ("low", "high", "value", "limit"),
    [
        (-5.0, 5.0, 5.5, 5.0),
        (-5.0, 5.0, -5.5, -5.0),
        (-5.0, 5.0, 0.1, 5.0),
        (-5.0, 5.0, -0.1, -5.0),
        (-math.inf, 5.0, -90.0, 5.0),
        (2.0, math.inf, 90.0, 2.0),
    ],
)
def test_it_shows_the_side_that_is_near(low: float, high: float, value: float, limit: float) -> None:
    gauge = Gauge("force", "N", low=low, high=high)
    gauge.judge(value, "flange")
    assert gauge.excess == Excess("force", "flange", value, limit, "N")
    assert gauge.monitored == Monitored("force", "flange", value, low, high, "N")
    assert gauge.monitored.limit == limit


def test_before_its_first_value_it_is_at_zero_and_no_stop() -> None:
    gauge = Gauge("force", "N", high=3.0)
    assert (gauge.monitored, gauge.stop) == (Monitored("force", "", 0.0, -math.inf, 3.0, "N"), False)


def test_its_state_tells_all_of_it() -> None:
    one, other = Gauge("force", "N", high=3.0, allowed=2), Gauge("force", "N", high=3.0, allowed=2)
    assert state_of(one) == state_of(other)
    one.judge(4.0, "flange")
    assert state_of(one) != state_of(other)
    other.judge(4.0, "flange")
    assert state_of(one) == state_of(other)
