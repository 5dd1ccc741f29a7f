"""What the rows of a study say: means with confidence, refusals against limits, sensitivity, the worst runs."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.studies.study_file import Roc

Array = NDArray[np.float64]
CONFIDENCE = 0.95
MOST_POINTS = 60
"""Values of a numeric factor that are points by themselves; more of them, as those drawn from a distribution, go into bins."""

BINS = 12
LEAST_RUNS = 64
"""Runs below which first-order indices are noise."""

HARMONICS = 10
"""Of RBD-FAST at most, M in SALib: M of them need more than 4 M^2 runs (Saltelli, Tarantola and Chan 1999)."""


class Point(NamedTuple):
    """A mean with its confidence interval."""

    x: float | str
    n: int
    mean: float
    low: float
    high: float


class RocPoint(NamedTuple):
    """A limit, and the shares that it refuses."""

    limit: float | str
    true: Point  # share of those that ought to be refused
    false: Point  # share of those that ought not


class SobolIndex(NamedTuple):
    """How much of the variance a factor explains by itself."""

    factor: str
    first_order: float
    confidence: float


def mean_of(x: float | str, values: Array, share: bool) -> Point:
    """Mean of values, with its interval: Wilson's for a share, Student's for numbers."""
    n = len(values)
    if n == 0:
        return Point(x, 0, math.nan, math.nan, math.nan)
    mean = float(values.mean())
    if share:
        from scipy.special import ndtri

        z = float(ndtri(0.5 + CONFIDENCE / 2))
        middle = (mean + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * math.sqrt(mean * (1 - mean) / n + z * z / (4 * n * n))
        return Point(x, n, mean, max(0.0, middle - half), min(1.0, middle + half))
    if n == 1:
        return Point(x, 1, mean, math.nan, math.nan)
    from scipy.special import stdtrit

    half = float(stdtrit(n - 1, 0.5 + CONFIDENCE / 2)) * float(values.std(ddof=1)) / math.sqrt(n)
    return Point(x, n, mean, mean - half, mean + half)


def levels(values: NDArray[Any]) -> list[tuple[float | str, NDArray[np.bool_]]]:
    """The values of a factor in order, or the means of bins of as many runs; with the rows of each."""
    found = np.unique(values)
    if values.dtype.kind not in "fi":
        order = list(dict.fromkeys(values.tolist()))  # as the study lists them
        return [(str(value), values == value) for value in order]
    if len(found) <= MOST_POINTS:
        return [(float(value), values == value) for value in found]
    edges = np.quantile(values, np.linspace(0.0, 1.0, BINS + 1))
    places = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, BINS - 1)
    return [(float(values[places == k].mean()), places == k) for k in range(BINS) if (places == k).any()]


def curve(x: NDArray[Any], y: Array, share: bool) -> list[Point]:
    """The mean of `y` over `x`; rows without a value (NaN) are left out."""
    there = np.isfinite(y)
    return [mean_of(value, y[mine & there], share) for value, mine in levels(x)]


def pivot(rows: NDArray[Any], columns: NDArray[Any], y: Array) -> tuple[list[float | str], list[float | str], Array]:
    """Means of `y` (rows, columns) for each pair of levels, NaN where there is no value."""
    down, across = levels(rows), levels(columns)
    there = np.isfinite(y)
    table = np.full((len(down), len(across)), np.nan)
    for i, (_, a) in enumerate(down):
        for k, (_, b) in enumerate(across):
            mine = y[a & b & there]
            table[i, k] = mine.mean() if len(mine) else np.nan
    return [value for value, _ in down], [value for value, _ in across], table


def roc(wanted: Roc, limits: NDArray[Any], right: Array, refused: Array) -> list[RocPoint]:
    """True against false refusals for each limit."""
    size = np.abs(right - wanted.zero)
    ought, ought_not = size >= wanted.at_least - 1e-12, size <= wanted.at_most + 1e-12
    there = np.isfinite(refused)
    points: list[RocPoint] = []
    for limit, mine in levels(limits):
        yes, no = refused[mine & ought & there], refused[mine & ought_not & there]
        points.append(RocPoint(limit, mean_of(limit, yes, True), mean_of(limit, no, True)))
    return points


def area(points: Sequence[RocPoint]) -> float:
    """Area below the curve through the points, with (0, 0) and (1, 1) as its ends; NaN without both kinds of runs."""
    pairs = sorted({(point.false.mean, point.true.mean) for point in points})
    if not pairs or any(math.isnan(value) for pair in pairs for value in pair):
        return math.nan
    x, y = (np.array([end, *column, 1.0 - end]) for end, column in ((0.0, [a for a, _ in pairs]), (0.0, [b for _, b in pairs])))
    return float(np.trapezoid(y, x))


def first_order(columns: dict[str, NDArray[Any]], y: Array) -> list[SobolIndex] | None:
    """First-order indices of the factors; None with too few runs, or where nothing varies."""
    there = np.isfinite(y)
    y = y[there]
    numbers = {name: np.unique(values[there], return_inverse=True)[1].astype(np.float64) for name, values in columns.items()}
    numbers = {name: values for name, values in numbers.items() if len(values) and values.max() > 0.0}
    if len(y) < LEAST_RUNS or not numbers or float(y.std()) == 0.0:
        return None
    from SALib.analyze import rbd_fast

    harmonics = min(HARMONICS, math.isqrt((len(y) - 1) // 4))

    order = np.random.default_rng(0).permutation(len(y))  # runs of one value come in the order of the plan, which is no chance
    x = np.column_stack([values[order] for values in numbers.values()])
    problem = {
        "num_vars": len(numbers),
        "names": list(numbers),
        "bounds": [[0.0, float(each.max())] for each in numbers.values()],
    }
    found = rbd_fast.analyze(problem, x, y[order], M=harmonics, num_resamples=30, seed=1)
    values = zip(found["names"], found["S1"], found["S1_conf"], strict=True)
    return sorted((SobolIndex(name, float(s), float(c)) for name, s, c in values), key=lambda each: -each.first_order)


def worst(y: Array, failed: NDArray[np.bool_], largest: bool, count: int = 10) -> list[int]:
    """Places of the worst runs: those with an error, then by their measure."""
    size = np.where(np.isfinite(y), y if largest else -y, -np.inf)
    order = np.lexsort((np.arange(len(y)), -size, ~failed))
    return [int(k) for k in order[:count] if failed[k] or np.isfinite(y[k])]
