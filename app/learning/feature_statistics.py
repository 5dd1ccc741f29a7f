"""Statistics of a data set's columns, as in LeRobot; a policy scales its inputs by them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}

Values = dict[str, NDArray[Any]]


def statistics(values: NDArray[Any]) -> Values:
    """Statistics of each column of an array (k,) or (k, m): min, max, mean and others, each (m,), and the number of rows (1,)."""
    table = values.reshape(len(values), -1).astype(np.float64)
    found = {"min": table.min(axis=0), "max": table.max(axis=0), "mean": table.mean(axis=0), "std": table.std(axis=0)}
    found |= {name: np.quantile(table, share, axis=0) for name, share in QUANTILES.items()}
    return found | {"count": np.array([len(table)])}


def flat(stats: dict[str, Values]) -> dict[str, Any]:
    """Statistics by the names of columns in the table of demonstrations."""
    return {f"stats/{name}/{kind}": value.tolist() for name, each in stats.items() for kind, value in each.items()}


def joined(parts: list[Values]) -> dict[str, Any]:
    """Statistics of all demonstrations from those of each. The quantiles are weighted means of the demonstrations' quantiles, as
    in LeRobot."""
    counts = np.array([float(part["count"][0]) for part in parts])
    weights = (counts / counts.sum()).reshape(-1, *[1] * parts[0]["mean"].ndim)
    stacked = {name: np.array([part[name] for part in parts]) for name in parts[0]}
    mean = (weights * stacked["mean"]).sum(axis=0)
    variance = (weights * (stacked["std"] ** 2 + (stacked["mean"] - mean) ** 2)).sum(axis=0)
    found = {"min": stacked["min"].min(axis=0), "max": stacked["max"].max(axis=0), "mean": mean, "std": np.sqrt(variance)}
    found |= {name: (weights * stacked[name]).sum(axis=0) for name in QUANTILES}
    return {name: value.tolist() for name, value in found.items()} | {"count": [int(counts.sum())]}
