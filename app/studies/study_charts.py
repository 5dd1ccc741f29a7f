"""The pictures of a study: response curves with their bands, heat maps, refusals true and false, sensitivity."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from app.report.drawing import INK, empty_axes
from app.studies.study_statistics import Point, RocPoint, SobolIndex, area

COLOURS = ("#1971c2", "#e8590c", "#2f9e44", "#9c36b5", "#c92a2a", "#0c8599", "#f08c00", "#495057")
MARKS = "osD^vP*X"
SPREAD = 20.0
"""What spans more than this is drawn on a logarithmic scale."""

BANDS = 3
"""Lines up to which intervals are bands; those of more lines hide each other, and are bars that stand side by side."""

ASIDE = 0.008
"""From bar to bar at most, as a share of the axis."""

LETTERS_A_ROW, MARK = 110, 9
"""What a row of names above a chart holds, and what of it goes with the mark of each name."""

NAMED = 0.2
"""Room left of a chart for names, as a share of its width."""


def curves(lines: Mapping[str, Sequence[Point]], x: str, y: str, *, share: bool, by: str = "") -> Figure:
    """Means over a factor with their intervals, a line each.

    Args:
        lines: by the name of the line; "" for the only one.
        x: the axis, with its unit.
        y: the axis, with its unit.
        share: y is a share of runs.
        by: what the names of the lines are.
    """
    in_a_row = min(len(lines), max(1, LETTERS_A_ROW // (max(map(len, lines)) + MARK)))
    above = 0.25 + 0.17 * -(-len(lines) // in_a_row) if len(lines) > 1 else 0.0
    figure, axes = empty_axes(2.8 + above, 0.1 + above)
    values = [point.x for line in lines.values() for point in line]
    places = _places(axes, values)
    aside = _side_by_side([places(value) for value in values], len(lines), log=axes.get_xscale() == "log")
    factor = 100.0 if share else 1.0
    for k, (name, line) in enumerate(lines.items()):
        seen = [point for point in line if point.n]
        at = np.array([places(point.x) for point in seen], dtype=float)
        mean, low, high = (factor * np.array([getattr(point, each) for point in seen]) for each in ("mean", "low", "high"))
        look: dict[str, Any] = {"color": COLOURS[k % len(COLOURS)], "marker": MARKS[k % len(MARKS)]}
        look |= {"markersize": 3.5, "linewidth": 1.2, "label": name or None}
        if len(lines) <= BANDS:
            axes.plot(at, mean, **look)
            axes.fill_between(at, low, high, color=look["color"], alpha=0.16, linewidth=0)
        else:
            error = np.maximum(0.0, [mean - low, high - mean])  # a share's interval ends at the share itself, but for rounding
            axes.errorbar(aside(at, k), mean, yerr=error, elinewidth=0.8, capsize=1.5, capthick=0.8, **look)
    axes.set_xlabel(x, fontsize=7.5)
    axes.set_ylabel(f"{y} [% of runs]" if share else y, fontsize=7.5)
    if share:
        axes.set_ylim(-3.0, 103.0)
    if len(lines) > 1:
        place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": in_a_row}
        axes.legend(title=by, fontsize=7, title_fontsize=7, frameon=False, **place)
    return figure


def heat_map(
    down: Sequence[float | str], across: Sequence[float | str], table: NDArray[np.float64], names: Sequence[str], *, share: bool
) -> Figure:
    """Means over two factors; `names` of the row's factor, the column's, and the measure."""
    figure, axes = empty_axes(max(2.2, 1.1 + 0.24 * len(down)))
    values = 100.0 * table if share else table
    low, high = (float(np.nanmin(values)), float(np.nanmax(values))) if np.isfinite(values).any() else (0.0, 1.0)
    scale = (
        LogNorm(low, high)
        if not share and low > 0.0 and high / low > SPREAD
        else Normalize(*((0.0, 100.0) if share else (low, high)))
    )
    picture = axes.imshow(values, aspect="auto", origin="lower", cmap="viridis", norm=scale)
    axes.grid(False)
    axes.set_xticks(range(len(across)), [short(value) for value in across], fontsize=7)
    axes.set_yticks(range(len(down)), [short(value) for value in down], fontsize=7)
    axes.set_ylabel(names[0], fontsize=7.5)
    axes.set_xlabel(names[1], fontsize=7.5)
    if values.size <= 150:
        for (i, k), value in np.ndenumerate(values):
            text = "-" if math.isnan(value) else f"{value:.3g}"
            axes.text(k, i, text, ha="center", va="center", fontsize=6.5, color=INK if scale(value) > 0.5 else "white")
    left, bottom, width, top = axes.get_position().bounds
    beside = 0.12 if not isinstance(down[0], str) else NAMED
    axes.set_position((beside, bottom, left + width - beside - 0.1, top))
    bar = figure.colorbar(picture, cax=figure.add_axes((0.915, bottom, 0.018, top)))
    bar.ax.tick_params(labelsize=6.5)
    bar.set_label(f"{names[2]} [% of runs]" if share else names[2], fontsize=7)
    return figure


def roc_chart(points: Sequence[RocPoint], limit: str) -> Figure:
    """True against false refusals, a point for each limit, with its two intervals."""
    figure, axes = empty_axes(3.6)
    usable = [point for point in points if point.true.n and point.false.n]
    numeric = all(isinstance(point.limit, float) for point in usable)
    shades = mpl.colormaps["viridis"](np.linspace(0.0, 0.92, max(1, len(usable))))
    axes.plot([0, 100], [0, 100], color="#adb5bd", linewidth=0.8, linestyle="--")
    ordered = sorted(usable, key=lambda each: (each.false.mean, each.true.mean))
    axes.plot(
        [100 * each.false.mean for each in ordered], [100 * each.true.mean for each in ordered], color="#868e96", linewidth=0.9
    )
    for point, shade in zip(usable, shades, strict=True):
        x, y = 100 * point.false.mean, 100 * point.true.mean
        error = [[[100 * abs(each.mean - each.low)], [100 * abs(each.high - each.mean)]] for each in (point.false, point.true)]
        text = f"{point.limit:g}" if numeric else str(point.limit)
        axes.errorbar([x], [y], xerr=error[0], yerr=error[1], color=shade, marker="o", markersize=5, linewidth=0.7, label=text)
        axes.annotate(text, (x, y), (5, -9), textcoords="offset points", fontsize=7, color=INK)
    axes.set_xlim(-4, 104)
    axes.set_ylim(-4, 104)
    axes.set_xlabel("refused, of those that ought not to be [% of runs]", fontsize=7.5)
    axes.set_ylabel("refused, of those that ought to be [% of runs]", fontsize=7.5)
    under = area(points)
    title = f"{limit}\narea {under:.3f}" if math.isfinite(under) else limit
    axes.legend(title=title, fontsize=6.5, title_fontsize=7, frameon=False, loc="lower right", ncols=2 if len(usable) > 6 else 1)
    return figure


def sensitivity(found: Mapping[str, Sequence[SobolIndex]]) -> Figure:
    """First-order indices with their intervals, a group of bars for each measure."""
    names = list(dict.fromkeys(index.factor for line in found.values() for index in line))
    figure, axes = empty_axes(0.9 + 0.3 * len(names) * len(found))
    height = 0.8 / len(found)
    for k, (measure, line) in enumerate(found.items()):
        at = [names.index(index.factor) + (k - (len(found) - 1) / 2) * height for index in line]
        colour = COLOURS[k % len(COLOURS)]
        axes.barh(at, [each.first_order for each in line], height=0.9 * height, color=colour, label=measure,
                  xerr=[each.confidence for each in line], error_kw={"linewidth": 0.8, "ecolor": INK})  # fmt: skip
    axes.set_yticks(range(len(names)), names, fontsize=7)
    axes.set_xlabel("share of the variance that the factor explains by itself", fontsize=7.5)
    axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    axes.invert_yaxis()
    if len(found) > 1:
        axes.legend(fontsize=7, frameon=False, loc="lower right")
    _, bottom, _, top = axes.get_position().bounds
    axes.set_position((NAMED, bottom, 0.98 - NAMED, top))
    return figure


def _places(axes: Axes, values: Sequence[float | str]) -> Any:
    """Sets the scale of x; gives the function from a value to its place."""
    if any(isinstance(value, str) for value in values):
        names = list(dict.fromkeys(map(str, values)))
        axes.set_xticks(range(len(names)), names)
        return lambda value: names.index(str(value))
    low, high = min(values, default=0.0), max(values, default=0.0)
    if isinstance(low, float) and isinstance(high, float) and low > 0.0 and high / low > SPREAD:
        axes.set_xscale("log")
    return lambda value: value


def _side_by_side(places: Sequence[float], count: int, *, log: bool) -> Any:
    """Gives the function from the places of a line, and its number among `count`, to where its marks stand."""
    scale = np.log if log else np.asarray
    levels = np.unique(scale(np.array(places, dtype=float)))
    step = min(ASIDE * float(np.ptp(levels)), 0.6 * float(np.diff(levels).min()) / count) if len(levels) > 1 else 0.0

    def aside(at: NDArray[np.float64], k: int) -> NDArray[np.float64]:
        shift = (k - (count - 1) / 2) * step
        return at * math.exp(shift) if log else at + shift

    return aside


def short(value: float | str) -> str:
    """A value on an axis: four digits, and no power of ten below a million."""
    return value if isinstance(value, str) else f"{float(f'{value:.4g}'):g}"
