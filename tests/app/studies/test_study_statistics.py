import math

import numpy as np
import pytest

from app.studies.study_file import Roc
from app.studies.study_statistics import LEAST_RUNS, area, curve, first_order, levels, mean_of, pivot, roc, worst


def test_the_interval_of_a_share_is_wilsons() -> None:
    point = mean_of(0.0, np.array([1.0] * 8 + [0.0] * 2), True)
    assert (point.n, point.mean) == (10, 0.8)
    assert (point.low, point.high) == (pytest.approx(0.4902, abs=1e-4), pytest.approx(0.9433, abs=1e-4))
    none = mean_of(0.0, np.zeros(10), True)
    assert (none.low, none.high) == (pytest.approx(0.0, abs=1e-12), pytest.approx(0.2775, abs=1e-4))


def test_the_interval_of_a_mean_is_students() -> None:
    point = mean_of(0.0, np.array([1.0, 2.0, 3.0, 4.0]), False)
    half = 3.1824 * math.sqrt(5 / 3) / 2
    assert (point.mean, point.low, point.high) == (2.5, pytest.approx(2.5 - half, abs=1e-4), pytest.approx(2.5 + half, abs=1e-4))
    assert math.isnan(mean_of(0.0, np.array([1.0]), False).low)
    assert mean_of(0.0, np.array([]), False).n == 0


def test_levels_are_values_names_or_bins() -> None:
    assert [value for value, _ in levels(np.array([2.0, 1.0, 2.0]))] == [1.0, 2.0]
    assert [value for value, _ in levels(np.array(["slow", "at once", "slow"]))] == ["slow", "at once"]
    drawn = np.random.default_rng(1).uniform(size=1200)
    binned = levels(drawn)
    assert len(binned) == 12
    assert all(mine.sum() == 100 for _, mine in binned)
    assert np.sum([mine for _, mine in binned], axis=0).tolist() == [1] * 1200


def test_rows_without_a_value_are_left_out() -> None:
    points = curve(np.array([0.0, 0.0, 1.0]), np.array([1.0, np.nan, np.nan]), False)
    assert [(point.x, point.n) for point in points] == [(0.0, 1), (1.0, 0)]


def test_a_pivot_has_a_place_for_each_pair() -> None:
    down, across, table = pivot(np.array([0, 0, 1]), np.array(["a", "b", "a"]), np.array([1.0, 2.0, 3.0]))
    assert (down, across) == ([0.0, 1.0], ["a", "b"])
    assert table[0].tolist() == [1.0, 2.0]
    assert table[1, 0] == 3.0
    assert math.isnan(table[1, 1])


def test_refusals_are_true_or_false() -> None:
    wanted = Roc(of="refused", over="limit", right="mass", at_least=0.5, zero=2.0)
    limits = np.array([1.0] * 4 + [5.0] * 4)
    masses = np.array([2.0, 2.0, 2.5, 1.5] * 2)
    refused = np.array([1, 0, 1, 1, 0, 0, 1, 0], dtype=float)
    low, high = roc(wanted, limits, masses, refused)
    assert (low.true.mean, low.false.mean, high.true.mean, high.false.mean) == (1.0, 0.5, 0.5, 0.0)
    assert area([low, high]) == pytest.approx(0.875)
    between = roc(wanted, np.ones(1), np.array([2.2]), np.ones(1))  # neither right nor wrong enough
    assert (between[0].true.n, between[0].false.n) == (0, 0)
    assert math.isnan(area(between))


def test_the_factor_that_matters_is_found() -> None:
    """y = 2 a + b: of the variance a explains four fifths, b one fifth."""
    rng = np.random.default_rng(2)
    a, b, c = rng.uniform(size=(3, 4000))
    found = first_order({"a": a, "b": b, "c": c}, 2 * a + b)
    assert found is not None
    shares = {index.factor: index.first_order for index in found}
    assert list(shares)[:2] == ["a", "b"]
    assert shares == {"a": pytest.approx(0.8, abs=0.05), "b": pytest.approx(0.2, abs=0.05), "c": pytest.approx(0.0, abs=0.05)}


def test_a_grid_in_the_order_of_its_plan_gives_the_same() -> None:
    a, b = (each.ravel() for each in np.meshgrid(np.arange(20.0), np.arange(20.0)))
    found = first_order({"a": a, "b": b}, 2 * a + b)
    assert found is not None
    assert {index.factor: index.first_order for index in found} == {
        "a": pytest.approx(0.8, abs=0.1),
        "b": pytest.approx(0.2, abs=0.1),
    }


def test_without_enough_nothing_is_told() -> None:
    x = np.arange(LEAST_RUNS, dtype=float)
    assert first_order({"x": x[1:]}, x[1:]) is None
    assert first_order({"x": x}, np.zeros(len(x))) is None
    assert first_order({"x": np.zeros(len(x))}, x) is None


def test_the_worst_come_first_and_errors_before_them() -> None:
    y, failed = np.array([1.0, 3.0, np.nan, 2.0, np.nan]), np.array([False, False, True, False, False])
    assert worst(y, failed, True) == [2, 1, 3, 0]
    assert worst(y, failed, False, 3) == [2, 0, 3]
