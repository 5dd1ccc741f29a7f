"""How a value came to be what it is: at once, or as a hand brings it about."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pendant.sensor.hand_model import SUSPECTED
from sim.estimation.momentum_observer import follow
from sim.estimation.sudden_change import SEEN, Came, add, came, courses, forget

Array = NDArray[np.float64]
SEEDS = range(20)
NOISE = 0.05


def seen(value: Array, seed: int, noise: float = NOISE) -> Came:
    """What is told of the last of these values behind the filters, in noise."""
    known, rng = courses(), np.random.default_rng(seed)
    first, second = np.zeros(1), np.zeros(1)
    for each in value:
        follow(first, second, each, 0)
        add(known, second[0] + noise * rng.normal())
    return Came(*came(known))


def ramp(begin: int, rise: int) -> Array:
    """From 0 to 1 in so many ticks, from `begin` ticks before the end on."""
    ticks = np.arange(2 * SEEN)
    return np.clip((ticks - (2 * SEEN - begin) + 1) / rise, 0.0, 1.0)


@pytest.mark.parametrize("level", [-0.5, 0.0, 0.3])
@pytest.mark.parametrize("begin", [8, 12, 18])
def test_a_step_is_told_with_its_size_and_its_level(begin: int, level: float) -> None:
    for seed in SEEDS:
        found = seen(level + (1.0 - level) * ramp(begin, 1), seed)
        assert found.at_all > SUSPECTED
        assert found.by_hand < SUSPECTED
        assert found.size == pytest.approx(1.0 - level, abs=6.0 * NOISE)
        assert found.level == pytest.approx(1.0, abs=4.0 * NOISE)


def test_without_noise_it_is_exactly_the_step() -> None:
    found = seen(0.2 + 0.8 * ramp(10, 1), 0, noise=0.0)
    assert found.size == pytest.approx(0.8, rel=1e-4)
    assert found.level == pytest.approx(1.0, rel=1e-4)
    assert found.by_hand < -100.0


@pytest.mark.parametrize("rise", [15, 20, 30, 50])
def test_what_comes_more_slowly_is_a_hand(rise: int) -> None:
    told = [seen(ramp(rise, rise), seed).by_hand for seed in SEEDS]
    assert np.mean(np.array(told) >= SUSPECTED) >= 0.95


def test_what_comes_and_goes_is_a_hand() -> None:
    ticks = np.arange(2 * SEEN)
    bump = 1.0 + 1.8 * np.exp(-(((ticks - 2 * SEEN + 14) / 6.0) ** 2))
    assert min(seen(bump, seed).by_hand for seed in SEEDS) >= SUSPECTED


def test_noise_is_no_step() -> None:
    told = [seen(np.full(2 * SEEN, 0.4), seed) for seed in range(200)]
    assert np.mean([found.at_all >= SUSPECTED for found in told]) < 0.1


def test_what_was_before_can_be_forgotten() -> None:
    known, fresh = courses(), courses()
    for k in range(SEEN + 3):
        add(known, float(k))
    forget(known)
    for each in (known, fresh):
        for _ in range(10):
            add(each, 1.0)
    assert Came(*came(known)) == pytest.approx(Came(*came(fresh)))
