"""How often what the bank of hypotheses tells is true, against how sure it said that it was (bench `observer`), as a picture."""

import re
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.common import NO_CASE, bound

NAME = "reliability.webp"
TOLD = re.compile(r"^(?:a|an) (\w+) is told with ([\d.]+) to ([\d.]+) %: it is one$")


class Point(NamedTuple):
    """Of what was told with a probability between two, so much was true."""

    low: float
    high: float
    true: float  # share, over the cases of all seed bases
    n: int


def points(documents: list[dict[str, Any]]) -> dict[str, list[Point]]:
    """What the results of one code say, by what was told, from the least sure to the surest."""
    found: dict[tuple[str, float, float], list[tuple[float, int]]] = {}
    for row in (row for document in documents if document["bench"] == "observer" for row in document["rows"]):
        told = TOLD.match(row["what"])
        if told is not None and row["value"] != NO_CASE and row["n"]:
            found.setdefault((told[1], float(told[2]) / 100.0, float(told[3]) / 100.0), []).append((row["value"], row["n"]))
    curves: dict[str, list[Point]] = {}
    for (what, low, high), some in sorted(found.items()):
        n = sum(count for _, count in some)
        curves.setdefault(what, []).append(Point(low, high, sum(share * count for share, count in some) / n, n))
    return curves


def draw(curves: dict[str, list[Point]], path: Path) -> None:
    """Write the picture: a curve for each that was told, with 95 % bounds either way; what is honest lies on the diagonal."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.0, 4.0), layout="constrained")
    axes = figure.add_subplot()
    axes.plot([0.5, 1.0], [0.5, 1.0], "--", color="gray", label="as sure as it is true")
    for what, some in curves.items():
        told, true = [0.5 * (point.low + point.high) for point in some], [point.true for point in some]
        hits = [round(point.true * point.n) for point in some]
        least, most = ([bound(k, p.n, upper=upper) for k, p in zip(hits, some, strict=True)] for upper in (False, True))
        below = [max(t - low, 0.0) for t, low in zip(true, least, strict=True)]
        above = [max(high - t, 0.0) for t, high in zip(true, most, strict=True)]
        axes.errorbar(told, true, yerr=(below, above), marker="o", capsize=3.0, label=f"a {what}")
        for x, y, point in zip(told, true, some, strict=True):
            axes.annotate(f"n = {point.n}", (x, y), textcoords="offset points", xytext=(6, -10), fontsize=8)
    axes.set(xlabel="told with this probability", ylabel="share that is true", xlim=(0.5, 1.02), ylim=(0.0, 1.05))
    axes.legend(loc="lower right")
    figure.savefig(path, dpi=130, pil_kwargs={"quality": 80})
