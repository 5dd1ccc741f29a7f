"""Each rule at its boundaries: opposite directions, thresholds, full buffers (CD-0, CD-3 to CD-8)."""

import msgspec
import numpy as np
import pytest

from pendant.contact_limits import limits
from pendant.contact_rules import LAGS, MEAN, NEW, OLD, STEP, contact_force, hard, instant, slow, statistical
from pendant.history import History
from pendant.modes import Mode
from pendant.settings import ContactUse
from pendant.signal import Signal
from tests.pendant.contacts import USE, limit

PAIR = 2.0**0.5


def history(*rows: tuple[float, ...], repeat: int = 1) -> History:
    result = History()
    for row in rows:
        for _ in range(repeat):
            result.push(Signal(*row))
    return result


def stepped(df: tuple[float, float, float], da: tuple[float, float, float]) -> History:
    """A difference of df, da within the difference rule's step, on top of a bias."""
    return history((1.0, 2.0, 3.0, 0.0, 0.0, 9.81), *[(1 + df[0], 2 + df[1], 3 + df[2], *da[:2], 9.81 + da[2])] * STEP)


@pytest.mark.parametrize(
    ("df", "da", "difference", "ratio"),
    [
        ((2.0, 0.0, 0.0), (-2.0, 0.0, 0.0), True, True),
        ((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0), True, True),  # sign-symmetric: contact lost
        ((2.0, 0.0, 0.0), (2.0, 0.0, 0.0), False, False),  # parallel: free motion
        ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), False, False),  # neither
        ((0.0, 2.0, 0.0), (0.1, -2.0, 0.3), True, True),  # in 3-D
        ((0.86, 0.0, 0.0), (-0.6, 0.0, 0.0), True, False),  # 0.849 N, 0.566 m/s² are the limits; 1 m/s² the ratio's second
        ((0.84, 0.0, 0.0), (-0.6, 0.0, 0.0), False, False),
        ((0.86, 0.0, 0.0), (-0.55, 0.0, 0.0), False, False),
        ((0.7, 0.0, 0.0), (-1.1, 0.0, 0.0), False, True),  # ratio -0.64 kg
        ((0.7, 0.0, 0.0), (-1.5, 0.0, 0.0), False, False),  # ratio -0.47 kg, threshold -0.5 kg
        ((0.6, 0.0, 0.0), (-1.1, 0.0, 0.0), False, False),  # force within the noise
    ],
)
def test_difference_and_ratio(
    df: tuple[float, float, float], da: tuple[float, float, float], difference: bool, ratio: bool
) -> None:
    assert hard(stepped(df, da), limit()) == (difference, ratio)


@pytest.mark.parametrize(("cosine", "opposite"), [(-0.29, False), (-0.31, True), (-0.99, True)])
def test_the_angle_limit(cosine: float, opposite: bool) -> None:
    sine = (1.0 - cosine**2) ** 0.5
    assert hard(stepped((3.0, 0.0, 0.0), (3.0 * cosine, 3.0 * sine, 0.0)), limit()) == (opposite, opposite and cosine < -0.5)
    values = history((40.0 * 1.0, 0.0, 0.0, 10.0 * cosine, 10.0 * sine, 0.0))
    assert instant(values, limit()) is opposite


def test_the_ratio_follows_payload_and_posture() -> None:
    assert limits(USE, 2.0, 10.0, 0.0, Mode.RUN).ratio == pytest.approx(1.0)  # half of the payload
    assert limits(USE, 0.0, 10.0, 0.0, Mode.RUN).ratio == pytest.approx(0.15)  # half of the least one
    assert limits(USE, 5.0, 1.0, 0.0, Mode.RUN).ratio == pytest.approx(0.3)  # 0.3 of the arm's effective mass


def test_thresholds_follow_sensitivity_speed_and_mode() -> None:
    base = limits(USE, 1.0, 2.0, 0.5, Mode.RUN)
    gentle = limits(msgspec.structs.replace(USE, sensitivity=2.0), 1.0, 2.0, 0.5, Mode.RUN)
    fast = limits(msgspec.structs.replace(USE, speed_share=1.0), 1.0, 2.0, 0.5, Mode.RUN)
    guided = limits(USE, 1.0, 2.0, 0.5, Mode.FREE_DRIVE)
    for other, factor in ((gentle, 0.5), (fast, 1.5), (guided, 3.0)):
        assert other.slow_force == pytest.approx(factor * base.slow_force)
        assert other.ratio == pytest.approx(factor * base.ratio)
        assert other.force_sq == pytest.approx(factor**2 * base.force_sq)
        assert other.confidence_sq == pytest.approx(factor**2 * base.confidence_sq)
        assert other.value_force == pytest.approx(factor * base.value_force)
    assert base.noise_force_sq == pytest.approx((3.0 * PAIR * 0.15) ** 2)


def test_a_link_has_its_own_thresholds() -> None:
    on_link = limits(USE, 0.0, 2.0, 0.0, Mode.RUN, True)
    assert (on_link.slow_force, on_link.payload_margin) == (60.0, 20.0)
    assert on_link.force_variance == pytest.approx(9.0)


@pytest.mark.parametrize(
    ("force", "acceleration", "seen"),
    [(10.6, -3.1, True), (10.4, -3.1, False), (10.6, -2.9, False), (10.6, 3.1, False), (-10.6, 3.1, True)],
)
def test_instant_at_its_thresholds(force: float, acceleration: float, seen: bool) -> None:
    """8 N and a quarter of the payload's weight, 10.45 N; 3 m/s². The payload's m·A is subtracted, gravity too."""
    mass = 1.0
    row = (force + mass * acceleration, 0.0, mass * 9.81, acceleration, 0.0, 9.81, 0.0, 0.0, -9.81, mass)
    assert instant(history(row), limit()) is seen


def test_no_decision_from_buffers_that_are_not_full() -> None:
    before, after = (0.0, 0.0, 9.81, 0.0, 0.0, 9.81), (30.0, 0.0, 9.81, -20.0, 0.0, 9.81)
    assert hard(history(*[after] * STEP), limit()) == (False, False)
    assert not instant(History(), limit())
    assert not statistical(history(*[before] * (OLD - 1), *[after] * NEW), limit())
    assert statistical(history(*[before] * OLD, *[after] * NEW), limit())
    assert slow(history(*[before] * (MEAN - 1), *[after] * LAGS[0]), limit()) == (0, False)
    assert slow(history(*[before] * MEAN, *[after] * LAGS[0]), limit())[0] == LAGS[0]


def test_the_statistical_rule_takes_its_thresholds_from_the_buffer() -> None:
    rng = np.random.default_rng(1)

    def noisy(sigma: float) -> History:
        rows = rng.normal(0.0, 1.0, (OLD + NEW, 6)) * ([sigma] * 3 + [0.1] * 3)
        rows[-NEW:] += [1.0, 0.0, 0.0, -1.0, 0.0, 0.0]
        return history(*[tuple(row) for row in rows.tolist()])

    assert statistical(noisy(0.15), limit())
    assert not statistical(noisy(2.0), limit())


@pytest.mark.parametrize(
    ("df", "da", "expected"),
    [
        (0.55, -0.4, (LAGS[0], False)),  # against a payload of 1 kg: 0.95 N beyond it, opposite
        (0.3, -0.4, (0, False)),  # 0.7 N: within the 0.8 N and 0.1 N that a payload wrong by a quarter explains
        (2.0, 0.0, (LAGS[0], True)),  # the acceleration has died out
        (0.75, 0.0, (0, False)),
        (0.4, 0.4, (0, False)),  # the payload alone
        (3.0, 0.9, (0, False)),  # parallel, and not died out
    ],
)
def test_the_slow_rule(df: float, da: float, expected: tuple[int, bool]) -> None:
    seen = history(*[(5.0, 0.0, 0.0, 1.0, 0.0, 9.81)] * MEAN, *[(5.0 + df, 0.0, 0.0, 1.0 + da, 0.0, 9.81)] * LAGS[0])
    assert slow(seen, limit()) == expected


def test_a_flat_change_shows_against_an_older_mean() -> None:
    rows = [(0.008 * k, 0.0, 0.0, 0.0, 0.0, 9.81) for k in range(LAGS[-1] + MEAN)]
    assert slow(history(*rows), limit()) == (LAGS[-1], True)
    assert slow(history(*rows[:100]), limit()) == (0, False)


def test_contact_force_leaves_out_the_payload() -> None:
    assert contact_force((5.0, 2.0, 12.0, 1.0, 0.0, 4.0), 2.0) == (3.0, 2.0, 4.0)


def test_the_settings_ship_with_detection_off() -> None:
    assert not ContactUse().on
