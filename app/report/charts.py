"""The figures of a report, as SVG: drawn without a screen, with peaks that no thinning takes away."""

from collections.abc import Sequence

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch

from app.report.drawing import INK, empty_axes, svg_of
from app.report.gathering import Array, Column, Gathered, Span
from app.report.pull_colours import PULL_COLOURS
from app.report.summary import SLOW, Summary
from pendant.guided.pull import SHARE_WORDS
from pendant.limits.parameters import PARAMETERS

Line = tuple[Array, Array]
"""Times and values."""

COLOURS = {
    "NORMAL": "#2f9e44",
    "TEACH": "#69db7c",
    "RUN": "#15aabf",
    "REMOTE": "#868e96",
    "FREE_DRIVE": "#1971c2",
    "STOP": "#c92a2a",
    "ACTIVATION": "#ffd43b",
    "SEQUENCE": "#f59f00",
    "HELD": "#1864ab",
    "PERIOD": "#4dabf7",
    "GUIDED": "#228be6",
    "RESTART": "#74c0fc",
}
DARK = frozenset({"NORMAL", "RUN", "REMOTE", "FREE_DRIVE", "STOP", "HELD", "GUIDED"})
"""Colours on which text is white."""

BAD = "#c92a2a"
NAMES_A_ROW = 6
"""Modes and phases in a row above their figure."""

PARAMETERS_DRAWN = 6
"""Monitored parameters in their chart: those nearest to their limits."""


PULL_CAPTION = (
    "What pulls at the free arm, as the controller sees it: how likely each cause is. Each stretch shows the moment in which a "
    "hand is least likely."
)


def charts(gathered: Gathered, summary: Summary) -> list[tuple[str, str]]:
    """Captions and SVG texts."""
    log = gathered.log
    if not len(log):
        return []
    lines = {name: line.found for name, line in gathered.lines.items()}
    speeds = [(name, lines[name]) for name in ("tcp", "elbow")]
    torques = [(joint, line.found) for joint, line in gathered.torques.items()]
    marks = [event.t for event in (*summary.messages, *summary.contacts)]
    columns, end = gathered.pulls.found, gathered.end
    drawn = [
        ("Modes, and phases of free-drive", _bars(summary.modes, summary.phases, summary)),
        (
            "Speed of tool centre point and elbow, against 250 mm/s",
            _lines(end, speeds, "speed [mm/s]", marks, bar=1000 * SLOW),
        ),
        (
            "Force on the tool by the flange sensor, and the largest true force on the arm",
            _lines(end, [("sensed", lines["force"]), ("true", lines["true"])], "force [N]", marks),
        ),
        *([(PULL_CAPTION, _stacked(columns, summary.duration))] if columns else []),
        ("External torque of the joints, size", _lines(end, torques, "torque [N·m]", marks)),
    ]
    shares = _shares(gathered)
    if shares:
        caption = "Monitored values against their limits, while they are checked"
        drawn.append((caption, _lines(end, shares, "of limit [%]", marks, bar=100)))
    return drawn


def _shares(gathered: Gathered) -> list[tuple[str, Line]]:
    """Monitored values over their limits [%], those that come nearest; NaN while they are not checked."""
    found: list[tuple[float, str, Line]] = []
    for name, row in PARAMETERS.items():
        if gathered.checked[name] > 1:
            t, share = gathered.shares[name].found
            found.append((float(np.nanmax(share)), row.text, (t, share)))
    return [(text, line) for _, text, line in sorted(found, key=lambda each: -each[0])[:PARAMETERS_DRAWN]]


def _stacked(columns: Sequence[Column], duration: float) -> str:
    figure, axes = empty_axes(1.5, 0.27)
    shares = np.array([column.pull.shares for column in columns])
    tops = np.cumsum(shares, axis=1)
    edges = np.array([(column.begin, column.end) for column in columns])
    for number, (name, colour) in enumerate(zip(SHARE_WORDS, PULL_COLOURS, strict=True)):
        there = shares[:, number] >= 0.005  # less is no more than its outline
        low = tops[there, number] - shares[there, number]
        bars = [
            [(begin, 100.0 * below), (end, 100.0 * below), (end, 100.0 * above), (begin, 100.0 * above)]
            for (begin, end), below, above in zip(edges[there], low, tops[there, number], strict=True)
        ]
        axes.add_collection(PolyCollection(bars, facecolors=colour, edgecolors=colour, linewidths=0.3, label=name))
    axes.set_ylabel("share [%]", fontsize=7.5)
    axes.set_xlabel("time [s]", fontsize=7.5)
    axes.set_xlim(0.0, duration)
    axes.set_ylim(0.0, 100.0)
    handles = [Patch(color=colour, label=name) for name, colour in zip(SHARE_WORDS, PULL_COLOURS, strict=True)]
    axes.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 0.97), ncols=NAMES_A_ROW, frameon=False, fontsize=6.5)
    return svg_of(figure)


def _lines(end: float, series: Sequence[tuple[str, Line]], label: str, marks: Sequence[float], *, bar: float = 0.0) -> str:
    figure, axes = empty_axes(1.9)
    for name, line in series:
        axes.plot(*line, linewidth=0.9, label=name)
    for mark in marks:
        axes.axvline(mark, color=INK, linewidth=0.7, linestyle=":")
    if bar:
        axes.axhline(bar, color=BAD, linewidth=0.9, linestyle="--")
    axes.set_ylabel(label, fontsize=7.5)
    axes.set_xlabel("time [s]", fontsize=7.5)
    axes.set_xlim(0.0, end)
    rows = -(-len(series) // 3) if len(series) > 1 else 0
    top = max(bar, *(float(np.nanmax(values)) for _, (_, values) in series))
    axes.set_ylim(0.0, top * (1.06 + 0.13 * rows) or 1.0)  # room for the names above the lines
    if len(series) > 1:
        axes.legend(loc="upper right", ncols=min(len(series), 3), frameon=False, fontsize=7, borderaxespad=0.1)
    return svg_of(figure)


def _bars(modes: Sequence[Span], phases: Sequence[Span], summary: Summary) -> str:
    names = {span.name for span in (*modes, *phases)}
    rows = -(-len(names) // NAMES_A_ROW)
    figure, axes = empty_axes(1.25 + 0.17 * rows, 0.04 + 0.17 * rows)
    seen: dict[str, str] = {}
    for row, spans in ((1.0, modes), (0.0, phases)):
        for span in spans:
            colour = COLOURS.get(span.name, "#adb5bd")
            seen[span.name] = colour
            axes.barh(row, span.end - span.begin, left=span.begin, height=0.7, color=colour, edgecolor="white", linewidth=0.4)
            if span.end - span.begin > 0.09 * summary.duration:
                text, ink = span.name.replace("_", "-").lower(), "white" if span.name in DARK else INK
                axes.text((span.begin + span.end) / 2, row, text, ha="center", va="center", fontsize=6.5, color=ink)
    axes.set_yticks([0.0, 1.0], ["phase", "mode"])
    axes.set_xlim(0.0, summary.duration)
    axes.set_xlabel("time [s]", fontsize=7.5)
    handles = [Patch(color=colour, label=name) for name, colour in seen.items()]
    axes.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 0.97), ncols=NAMES_A_ROW, frameon=False, fontsize=6.5)
    return svg_of(figure)
