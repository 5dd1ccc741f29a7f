import math

import pytest

from app.session.profiles import Constant, HalfSine, Points, Ramp, Tremor


def test_a_constant_is_always_whole() -> None:
    assert [Constant().factor(t, 2.0) for t in (0.0, 1.0, 2.0)] == [1.0, 1.0, 1.0]


@pytest.mark.parametrize(("t", "factor"), [(0.0, 0.0), (0.1, 0.5), (0.2, 1.0), (0.5, 1.0), (0.8, 0.5), (1.0, 0.0)])
def test_a_ramp_rises_stays_and_falls(t: float, factor: float) -> None:
    assert Ramp(rise=0.2, fall=0.4).factor(t, 1.0) == pytest.approx(factor)


def test_a_ramp_without_times_is_a_step() -> None:
    assert Ramp(rise=0.0, fall=0.0).factor(0.0, 1.0) == 1.0


def test_a_bump_has_its_peak_in_the_middle_and_the_impulse_of_a_half_sine() -> None:
    factors = [HalfSine().factor(0.02 * i / 1000, 0.02) for i in range(1001)]
    assert max(factors) == factors[500] == pytest.approx(1.0)
    assert sum(factors) * 0.02 / 1000 == pytest.approx(0.02 * 2 / math.pi, rel=1e-5)


def test_a_tremor_swings_by_its_share_at_its_frequency() -> None:
    tremor = Tremor(rise=0.0, fall=0.0, frequency=8.0, share=0.25)
    assert tremor.factor(1 / 32, 1.0) == pytest.approx(1.25)
    assert tremor.factor(3 / 32, 1.0) == pytest.approx(0.75)


@pytest.mark.parametrize(("t", "factor"), [(0.0, 0.5), (0.1, 0.5), (0.2, 1.25), (0.3, 2.0), (0.9, 2.0)])
def test_points_are_joined_by_straight_lines(t: float, factor: float) -> None:
    assert Points(times=[0.1, 0.3], factors=[0.5, 2.0]).factor(t, 1.0) == pytest.approx(factor)


@pytest.mark.parametrize(
    ("times", "factors", "says"), [([0.0, 1.0], [1.0], "2 times but 1 factors"), ([1.0, 1.0], [1.0, 2.0], "must rise")]
)
def test_points_must_fit(times: list[float], factors: list[float], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Points(times=times, factors=factors)
