import numpy as np

from app.learning.feature_statistics import flat, joined, statistics

RNG = np.random.default_rng(0)
PARTS = [RNG.normal(size=(40, 3)), RNG.normal(2.0, 3.0, size=(15, 3))]


def test_of_one_part_they_are_those_of_its_columns() -> None:
    told = statistics(PARTS[0])
    np.testing.assert_allclose(told["mean"], PARTS[0].mean(axis=0))
    np.testing.assert_allclose(told["std"], PARTS[0].std(axis=0))
    np.testing.assert_allclose(told["q50"], np.median(PARTS[0], axis=0))
    assert told["count"].tolist() == [40]
    assert statistics(np.arange(5))["max"].tolist() == [4.0]


def test_of_several_parts_they_are_those_of_all_rows() -> None:
    """Mean and deviation exactly, though only those of the parts are known; quantiles roughly."""
    told, every = joined([statistics(part) for part in PARTS]), np.concatenate(PARTS)
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(told[name], getattr(every, name)(axis=0))
    assert told["count"] == [55]
    assert told["q01"][0] < told["q50"][0] < told["q99"][0]


def test_a_column_for_each_kind() -> None:
    assert flat({"a": {"min": np.array([1.0, 2.0])}}) == {"stats/a/min": [1.0, 2.0]}
