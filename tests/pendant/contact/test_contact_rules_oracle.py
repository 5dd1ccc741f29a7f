"""The rules of contact against a second, plain statement of them (CD-0, CD-3 to CD-9), and at limits that are hit exactly.

The streams are random, in all axes, with changes of about the sizes of the limits; the statements are about arrays with a row
a tick: df (n, 3) [N] and da (n, 3) [m/s²] are changes of force and acceleration.
"""

from collections.abc import Callable

import msgspec
import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from pendant.contact.contact_limits import OLDER, ContactLimits
from pendant.contact.contact_rules import (
    DIED_OUT,
    LAGS,
    LATE,
    MEAN,
    NEW,
    OBJECT,
    OLD,
    RESTLESS,
    STEP,
    clear,
    hard,
    slow,
    statistical,
)
from pendant.contact.history import History
from pendant.contact.settings import BufferStatistic
from pendant.tick.source_signal import Signal
from tests.pendant.contacts import USE, limit

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

BIAS = np.array([3.0, -4.0, 5.0, 2.0, -3.0, 9.0])

KINDS = [
    limit(mass=0.0),
    limit(),
    limit(msgspec.structs.replace(USE, angle=0.8), mass=2.0),
    limit(msgspec.structs.replace(USE, angle=0.0), mass=0.5),
    limit(msgspec.structs.replace(USE, opposite=False)),
]

MEDIANS = {"newest": 4, "oldest": 12, "statistic": BufferStatistic.MEDIAN}
OTHER_BUFFERS = [
    limit(msgspec.structs.replace(USE, force_step=5, acceleration_step=2, tested=3, window=40, **MEDIANS)),
    limit(msgspec.structs.replace(USE, force_step=2, acceleration_step=4, tested=8, window=20, newest=15, oldest=50)),
]
"""What each rule looks at, other than as shipped."""


def size(vectors: Array) -> Array:
    return np.sqrt((vectors**2).sum(axis=-1))


def along(f: Array, a: Array) -> Array:
    return (f * a).sum(axis=-1)


def lie_against(f: Array, a: Array, limits: ContactLimits) -> Flags:
    """CD-0: with a cosine below minus the angle limit; where directions need not be opposite, along the same line."""
    cosine, least = along(f, a) / (size(f) * size(a)), limits.cosine_sq**0.5
    return (cosine < 0.0) & (cosine <= -least) if limits.opposite else abs(cosine) >= least


def object_pushes(df: Array, da: Array, least: Array | float, limits: ContactLimits) -> Flags:
    """CD-0, CD-11: the contact force against the acceleration, beyond `least` [N] and what a wrong payload explains."""
    push = df - limits.mass * da
    return lie_against(push, da, limits) & (size(push) > least + limits.payload_margin * size(da))


def signals(rows: Array, turning: Array | None = None) -> list[Signal]:
    s = np.zeros((len(rows), 3)) if turning is None else turning
    return [Signal(*row, sx=x, sy=y, sz=z) for row, (x, y, z) in zip(rows.tolist(), s.tolist(), strict=True)]


def told(stream: list[Signal], rule: Callable[[History, ContactLimits], object], limits: ContactLimits) -> list[object]:
    """What the rule says in each tick."""
    history, said = History(), []
    for signal in stream:
        history.push(signal)
        said.append(rule(history, limits))
    return said


@pytest.mark.parametrize("limits", [*KINDS, *OTHER_BUFFERS])
def test_difference_and_ratio_in_space(limits: ContactLimits) -> None:
    """CD-4, CD-5, eq. 5 to 7."""
    rng, n = np.random.default_rng(1), 1500
    a = rng.normal(0.0, 0.5, (n, 3))
    f = -np.repeat(rng.uniform(-1.0, 2.5, (n // 30, 1)), 30, axis=0) * a + rng.normal(0.0, 0.4, (n, 3))
    i, j = limits.force_step, limits.acceleration_step
    far = max(i, j)
    df, da = (f[i:] - f[:-i])[far - i :], (a[j:] - a[:-j])[far - j :]
    sight = lie_against(df, da, limits) & (size(df) > limits.noise_force_sq**0.5) & (size(da) > limits.noise_acceleration_sq**0.5)
    difference = sight & (size(df) > limits.force_sq**0.5) & (size(da) > limits.acceleration_sq**0.5)
    large = size(da) > limits.ratio_acceleration_sq**0.5
    ratio = sight & large & (abs(along(df, da)) / size(da) ** 2 > limits.ratio)
    expected = list(zip(difference.tolist(), ratio.tolist(), strict=True))
    assert told(signals(BIAS + np.hstack([f, a])), hard, limits) == [(False, False)] * far + expected
    assert {expected.count((one, other)) > 20 for one in (True, False) for other in (True, False)} == {True}


@pytest.mark.parametrize("limits", KINDS)
def test_a_clear_difference_in_space(limits: ContactLimits) -> None:
    """CD-9: a sudden change in every 17th tick, of about the size that stands out from what was restless before."""
    rng, n = np.random.default_rng(2), 300
    unrest = rng.choice([0.02, 0.2, 0.5], (2, n, 1, 1))
    older = rng.normal(0.0, 0.05, (n, OLDER, 6))
    older[..., 3:] += unrest[0] * rng.normal(size=(n, OLDER, 3))
    turning = unrest[1] * rng.normal(size=(n, OLDER + 1, 3)) * rng.choice([0.2, 2.0], (n, OLDER + 1, 1))
    restless = np.maximum(older[..., 3:].var(axis=1).mean(axis=-1), RESTLESS * (turning[:, :-1] ** 2).mean(axis=(1, 2)))
    restless = np.maximum(restless, limits.acceleration_variance)
    least = np.sqrt(limits.clear_sq * (limits.force_variance + limits.mass**2 * restless))
    da = rng.normal(0.0, 1.0, (n, 3))
    push = -da * rng.choice([1.0, 1.0, 1.0, -1.0], (n, 1)) + rng.normal(0.0, 0.7, (n, 3))
    push *= (rng.uniform(0.7, 1.5, n) * (least + limits.payload_margin * size(da)) / size(push))[:, None]
    df, late = push + limits.mass * da, da + LATE * turning[:, -1]
    expected = (size(da) > limits.clear_acceleration_sq**0.5) & (size(late) > limits.clear_acceleration_sq**0.5)
    expected &= object_pushes(df, da, least, limits) & object_pushes(df, late, least, limits)
    newest = older.mean(axis=1, keepdims=True) + np.hstack([df, da])[:, None]
    rows = BIAS + np.concatenate([older, newest], axis=1).reshape(-1, 6)
    said = told(signals(rows, turning.reshape(-1, 3)), clear, limits)
    assert said[OLDER :: OLDER + 1] == expected.tolist()
    assert 20 < expected.sum() < n - 20


@pytest.mark.parametrize("limits", [*KINDS, *OTHER_BUFFERS])
def test_the_statistical_rule_in_space(limits: ContactLimits) -> None:
    """CD-6, eq. 9, 10: the newest five samples against the thirty before them; then CD-0's contact force."""
    rng, n = np.random.default_rng(3), 1200
    rows = jumps(rng, n, 40, limits.mass)
    tested, window = limits.tested, limits.window
    old = sliding_window_view(rows, window, axis=0)[:-tested]
    new = sliding_window_view(rows, tested, axis=0)[window:].mean(axis=-1)
    df, da = np.hsplit(new - old.mean(axis=-1), 2)
    variances = old.var(axis=-1)
    error = np.sqrt(limits.confidence_sq * (1.0 / tested + 1.0 / window))
    force = np.maximum(variances[:, :3].mean(axis=1), limits.force_variance)
    acceleration = np.maximum(variances[:, 3:].mean(axis=1), limits.acceleration_variance)
    expected = lie_against(df, da, limits) & (size(df) > error * np.sqrt(force))
    expected |= object_pushes(df, da, OBJECT * error * np.sqrt(force + limits.mass**2 * acceleration), limits)
    expected &= size(da) > error * np.sqrt(acceleration)
    assert told(signals(rows), statistical, limits) == [False] * (window + tested - 1) + expected.tolist()
    assert 30 < expected.sum() < n - 30


@pytest.mark.parametrize("limits", [*KINDS, *OTHER_BUFFERS])
def test_the_slow_rule_in_space(limits: ContactLimits) -> None:
    """CD-7, CD-8, eq. 11 to 17: the newest mean against the stored ones, the youngest first."""
    rng, n = np.random.default_rng(4), 1500
    rows = jumps(rng, n, 25, limits.mass)
    expected = [(0, False)] * n
    p, q, of = limits.newest, limits.oldest, np.median if limits.median else np.mean
    for lag in reversed(LAGS):
        old = of(sliding_window_view(rows, q, axis=0), axis=-1)[: n - lag - q + 1]
        new = of(sliding_window_view(rows, p, axis=0), axis=-1)[lag + q - p :]
        df, da = np.hsplit(new - old, 2)
        force, change = size(df - limits.mass * da), size(da)
        clamping = force > limits.clamping * change
        beyond = lie_against(df, da, limits) & (force >= limits.slow_force + limits.payload_margin * change)
        for k in np.flatnonzero((force >= limits.slow_force) & (clamping | beyond)).tolist():
            sightings = min(int(force[k] // limits.slow_force), 5)
            expected[lag + q - 1 + k] = (sightings, bool(clamping[k] and change[k] < DIED_OUT))
    assert told(signals(rows), slow, limits) == expected
    assert set(expected) >= {(count, False) for count in range(6)}


def jumps(rng: np.random.Generator, n: int, length: int, mass: float) -> Array:
    """Rows of force and acceleration, in noise, that stay about `length` ticks and change by about the limits."""
    changes = rng.random(n) < 1.0 / length
    da = rng.normal(0.0, 0.4, (n, 3)) * rng.choice([0.2, 1.0, 1.0], (n, 1))
    push = -rng.uniform(-0.3, 2.0 + 2.0 * mass, (n, 1)) * da + rng.normal(0.0, 0.4, (n, 3))
    steps = np.hstack([push + mass * da, da]) * changes[:, None]
    level = steps.cumsum(axis=0)
    return BIAS + level + rng.normal(0.0, 1.0, (n, 6)) * rng.choice([0.05, 0.2], 6)


LOW = limit(mass=0.0)._replace(
    noise_force_sq=0.25, noise_acceleration_sq=0.25, cosine_sq=0.0, force_sq=0.25, acceleration_sq=0.25,
    clear_sq=0.0, clear_acceleration_sq=0.25, ratio=0.5, ratio_acceleration_sq=0.25, confidence_sq=1.0 / (1.0 / NEW + 1.0 / OLD),
    force_variance=0.25, acceleration_variance=0.25, slow_force=0.5, payload_margin=0.0, clamping=8.0,
)  # fmt: skip
"""Without a payload, and far below the changes under test; the tests put one of them where it is hit."""

X, HALF = (2.0, 0.0, 0.0), (-1.0, 1.0, 0.0)  # the square of the cosine between them is 0.5


def reached(f: tuple[float, ...], a: tuple[float, ...], older: int, newer: int) -> History:
    """`older` ticks of nothing, then `newer` of these: all sums and means of them are exact."""
    history = History()
    for row in [(0.0,) * 6] * older + [(*f, *a)] * newer:
        history.push(Signal(*row))
    return history


@pytest.mark.parametrize(
    ("a", "hit", "expected"),
    [
        ((-1.0, 0.0, 0.0), {}, (True, True)),
        ((-1.0, 0.0, 0.0), {"noise_acceleration_sq": 1.0}, (True, True)),  # noise is what lies below
        ((-1.0, 0.0, 0.0), {"noise_force_sq": 4.0}, (True, True)),
        (HALF, {"cosine_sq": 0.5}, (True, True)),
        ((-1.0, 0.0, 0.0), {"force_sq": 4.0}, (False, True)),  # a change is what lies beyond
        ((-1.0, 0.0, 0.0), {"acceleration_sq": 1.0}, (False, True)),
        ((-1.0, 0.0, 0.0), {"ratio_acceleration_sq": 1.0}, (True, False)),
        ((-1.0, 0.0, 0.0), {"ratio": 2.0}, (True, False)),
        ((0.0, 1.0, 0.0), {}, (False, False)),  # across is not opposite
        ((0.0, 1.0, 0.0), {"opposite": False}, (True, False)),
    ],
)
def test_a_difference_at_a_limit(a: tuple[float, ...], hit: dict[str, float], expected: tuple[bool, bool]) -> None:
    """CD-0, CD-4, CD-5."""
    assert hard(reached(X, a, 1, STEP), LOW._replace(**hit)) == expected


@pytest.mark.parametrize(
    ("a", "hit", "seen"),
    [
        ((-1.0, 0.0, 0.0), {}, True),
        ((-1.0, 0.0, 0.0), {"clear_acceleration_sq": 1.0}, False),
        ((-1.0, 0.0, 0.0), {"payload_margin": 2.0}, False),  # it explains all of the 2 N
        (HALF, {}, True),
        (HALF, {"cosine_sq": 0.5}, False),
    ],
)
def test_a_clear_difference_at_a_limit(a: tuple[float, ...], hit: dict[str, float], seen: bool) -> None:
    """CD-9: nothing is clear that merely reaches one."""
    assert clear(reached(X, a, OLDER, 1), LOW._replace(**hit)) is seen


def test_a_clear_difference_takes_all_of_the_older_samples() -> None:
    """CD-4: also where the sensor's values are zero, as those are that were never written."""
    assert not clear(reached(X, (-1.0, 0.0, 0.0), OLDER - 1, 1), LOW)


@pytest.mark.parametrize(
    ("a", "hit", "seen"),
    [
        (HALF, {}, True),
        (HALF, {"cosine_sq": 0.5}, True),
        (HALF, {"force_variance": 4.0}, False),  # a standard error of 2 N
        (HALF, {"acceleration_variance": 2.0}, False),
        ((0.0, 1.0, 0.0), {}, False),  # across is not opposite
    ],
)
def test_a_statistical_difference_at_a_limit(a: tuple[float, ...], hit: dict[str, float], seen: bool) -> None:
    """CD-0, CD-6."""
    assert statistical(reached(X, a, OLD, NEW), LOW._replace(**hit)) is seen


@pytest.mark.parametrize(("change", "seen"), [(1.0, False), (1.0625, True)])
def test_a_statistical_difference_at_the_limit_that_is_the_buffers_own(change: float, seen: bool) -> None:
    """CD-6: 1 m/s² to and fro in each axis is a standard error of 1 m/s²."""
    history = History()
    for way in (1.0, -1.0) * (OLD // 2):
        history.push(Signal(0.0, 0.0, 0.0, way, way, way))
    for _ in range(NEW):
        history.push(Signal(*X, -change, 0.0, 0.0))
    assert statistical(history, LOW) is seen


@pytest.mark.parametrize(
    ("a", "hit", "expected"),
    [
        ((0.0, 0.0, 0.0), {"slow_force": 2.0}, (1, True)),
        ((0.0, 0.0, 0.0), {"slow_force": 2.0625}, (0, False)),
        ((0.1875, 0.0, 0.0), {}, (4, True)),
        ((DIED_OUT, 0.0, 0.0), {"clamping": 4.0}, (4, False)),  # has not died out
        ((0.5, 0.0, 0.0), {"clamping": 4.0}, (0, False)),  # no clamping, and along the force
        ((0.5, 0.0, 0.0), {"clamping": 3.75}, (4, False)),
        ((-1.0, 0.0, 0.0), {"payload_margin": 1.5}, (4, False)),  # it may explain 1.5 N, 0.5 N are left
        ((-1.0, 0.0, 0.0), {"payload_margin": 1.5625}, (0, False)),
    ],
)
def test_a_slow_difference_at_a_limit(a: tuple[float, ...], hit: dict[str, float], expected: tuple[int, bool]) -> None:
    """CD-0, CD-7."""
    assert slow(reached(X, a, MEAN, LAGS[0]), LOW._replace(**hit)) == expected


@pytest.mark.parametrize(("cosine_sq", "sightings"), [(0.49, 5), (0.5, 0)])
def test_a_slow_difference_at_the_angle_limit(cosine_sq: float, sightings: int) -> None:
    """CD-0: beyond it."""
    seen = reached((2.0, 2.0, 0.0), (-1.0, 0.0, 0.0), MEAN, LAGS[0])
    assert slow(seen, LOW._replace(cosine_sq=cosine_sq)) == (sightings, False)
