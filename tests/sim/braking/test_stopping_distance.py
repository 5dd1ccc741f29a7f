"""How far an arm goes on when it brakes, how fast it may be for that, and where on its way a border is."""

import math

import numpy as np
import pytest

from sim.braking.stopping_distance import StoppingDistance, free_way

STOP = StoppingDistance(lambda q, qd: float(np.abs(qd).max()), 0.08, 0.01)
Q, QD = np.zeros(2), np.array([1.0, 0.0])


@pytest.mark.parametrize("seconds", [0.02, 0.08, 0.5, 3.0])
@pytest.mark.parametrize("delay", [0.0, 0.002, 0.01])
@pytest.mark.parametrize("way", [1e-4, 0.01, 0.04, 0.1, 0.4])
def test_from_the_share_of_its_speed_that_is_allowed_an_arm_comes_to_rest_on_the_way(
    seconds: float, delay: float, way: float
) -> None:
    """What is said of the share, held against the way that a stop from it takes."""
    share = STOP.share(way, seconds, delay)
    assert 0.0 < share <= 1.0
    taken = share * STOP.way(share * seconds, delay)
    assert taken == pytest.approx(min(way, STOP.way(seconds, delay)))


def test_no_way_allows_no_speed() -> None:
    assert STOP.share(0.0, 0.5, 0.002) == STOP.share(-0.1, 0.5, 0.002) == 0.0


def test_half_a_cosine_goes_half_as_far_as_it_would_without() -> None:
    assert STOP.way(0.5, 0.01) == pytest.approx(0.26)
    assert STOP.way(0.01, 0.01) == pytest.approx(0.05)  # no stop is shorter
    assert STOP.seconds(Q, QD) == 1.0


def test_nothing_in_the_way_leaves_all_of_it() -> None:
    assert free_way(lambda q: float(q[0]) - 2.0, Q, QD, 1.5) == 1.5


@pytest.mark.parametrize("at", [0.03, 0.2, 0.7, 1.1])
def test_a_border_on_the_way_is_found(at: float) -> None:
    assert free_way(lambda q: float(q[0]) - at, Q, QD, 1.5) == pytest.approx(at, abs=1e-6)


@pytest.mark.parametrize("at", [0.03, 0.2, 0.7, 1.1])
def test_one_that_bends_is_found_from_before_it(at: float) -> None:
    for out in (lambda q: math.expm1(3.0 * (float(q[0]) - at)), lambda q: 1.0 - math.exp(-3.0 * (float(q[0]) - at))):
        found = free_way(out, Q, QD, 1.5)
        assert found <= at
        assert found == pytest.approx(at, abs=5e-3)


def test_a_thin_body_is_found_that_the_arm_would_come_through() -> None:
    found = free_way(lambda q: 0.2 - abs(float(q[0]) - 0.8), Q, QD, 1.5)
    assert found == pytest.approx(0.6, abs=2e-3)
    assert found <= 0.6


def test_from_outside_back_is_free_and_further_out_is_not() -> None:
    def out(q: np.ndarray) -> float:
        return float(q[0]) + 0.1

    assert free_way(out, Q, -QD, 1.5) == 1.5
    assert free_way(out, Q, QD, 1.5) == 0.0
    assert free_way(lambda q: 0.1 + abs(float(q[0]) + 0.5) - 0.5, Q, -QD, 1.5) == 0.0  # in, and out again on the other side


def test_what_cannot_be_told_is_no_way() -> None:
    assert free_way(lambda q: math.nan if q[0] > 0.5 else -1.0, Q, QD, 1.5) <= 0.5
