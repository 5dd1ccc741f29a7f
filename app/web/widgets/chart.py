"""A line chart as a small picture: in whole units and relative steps, 200 points of a line take a few hundred bytes."""

import math
from collections.abc import Sequence
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEP = 2  # units of width between two samples
HEIGHT = 150  # units
MARGIN = 4  # units above and below the lines
COLOURS = ("#1971c2", "#e8590c", "#2b8a3e", "#9c36b5", "#0b7285", "#c92a2a", "#868e96")


class Curve(NamedTuple):
    """One line of a chart. A gap is a value that is not a number."""

    name: str
    values: Array  # (N,) oldest first
    dashed: bool = False  # what is told apart by more than colour


class Layer(NamedTuple):
    """One of the shares of a stack."""

    name: str
    colour: str
    values: Array  # (N,) oldest first


def chart(title: str, unit: str, lines: Sequence[Curve], marks: Sequence[int] = (), *, limit: float | None = None) -> str:
    """The picture.

    Args:
        title: above it.
        unit: of the values.
        lines: of equal length.
        marks: samples at which something happened.
        limit: a value to draw across.
    """
    low, high = _range(lines, limit)
    count = max(len(line.values) for line in lines)
    width = STEP * (count - 1)
    scale = (HEIGHT - 2 * MARGIN) / (high - low)
    shapes = [f'<path d="M{STEP * mark} 0v{HEIGHT}" stroke="#c92a2a" stroke-dasharray="3 3"/>' for mark in marks]
    if low < 0.0 < high:
        shapes.append(f'<path d="M0 {_height(0.0, high, scale)}h{width}" stroke="currentColor" stroke-opacity=".25"/>')
    if limit is not None:
        shapes.append(f'<path d="M0 {_height(limit, high, scale)}h{width}" stroke="#c92a2a" stroke-dasharray="8 4"/>')
    for line, colour in zip(lines, COLOURS, strict=False):
        dash = ' stroke-dasharray="7 4"' if line.dashed else ""
        shapes.append(f'<path d="{_path(line.values, high, scale)}" stroke="{colour}"{dash}/>')
    names = "".join(
        f'<span style="--c:{colour}"{" class=pd-dash" if line.dashed else ""}><i></i>{escape(line.name)}</span>'
        for line, colour in zip(lines, COLOURS, strict=False)
    )
    return (
        f'<figure class="pd-chart"><figcaption><b>{escape(title)}</b><em>{low:g} … {high:g} {escape(unit)}</em></figcaption>'
        f'<svg viewBox="0 0 {width} {HEIGHT}" preserveAspectRatio="none" fill="none" stroke-width="2">{"".join(shapes)}</svg>'
        f"<div>{names}</div></figure>"
    )


def stack(title: str, told: str, layers: Sequence[Layer], marks: Sequence[int] = ()) -> str:
    """A picture of shares that add up to 1, each on top of the one before; samples that are not numbers are gaps.

    Args:
        title: above it.
        told: what holds now, in words.
        layers: from below, of equal length.
        marks: samples at which something happened.
    """
    width = STEP * len(layers[0].values)
    tops = np.cumsum([layer.values for layer in layers], axis=0)
    # The topmost first: each layer reaches to the ground, and the next covers it up to its own top.
    seen = [(layer, top) for layer, top in zip(layers, tops, strict=True) if np.nanmax(layer.values, initial=0.0) > 0.0]
    shapes = [f'<path d="{_steps(top)}" fill="{layer.colour}"/>' for layer, top in reversed(seen)]
    shapes += [f'<path d="M{STEP * mark} 0v{HEIGHT}" stroke="currentColor" stroke-dasharray="3 3"/>' for mark in marks]
    names = "".join(f'<span style="--c:{layer.colour}"><i></i>{escape(layer.name)}</span>' for layer in layers)
    label = f"{title}: {told}" if told else title
    return (
        f'<figure class="pd-chart pd-stack"><figcaption><b>{escape(title)}</b><em>{escape(told)}</em></figcaption>'
        f'<svg viewBox="0 0 {width} {HEIGHT}" preserveAspectRatio="none" stroke-width="2" role="img" '
        f'aria-label="{escape(label)}">{"".join(shapes)}</svg><div>{names}</div></figure>'
    )


def _steps(tops: Array) -> str:
    """The area below these shares, in whole units; a step at each change, so that what stays costs nothing."""
    heights = np.rint(HEIGHT * np.nan_to_num(tops)).astype(int)
    edges = np.flatnonzero(np.diff(heights, prepend=0))
    rises = np.diff(np.concatenate(([0], heights[edges])))
    path = "".join(f"H{STEP * at}v{-rise}" for at, rise in zip(edges.tolist(), rises.tolist(), strict=True))
    return f"M0 {HEIGHT}{path}H{STEP * len(heights)}V{HEIGHT}z"


def _range(lines: Sequence[Curve], limit: float | None) -> tuple[float, float]:
    """Round ends that hold all values, and jump seldom."""
    values = np.concatenate([line.values for line in lines])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
    if limit is not None:
        low, high = min(low, limit), max(high, limit)
    size = max(abs(low), abs(high)) or 1.0
    power = 10.0 ** math.floor(math.log10(size))
    end = next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= size)
    return (-end if low < 0.0 else 0.0), (end if high > 0.0 or low >= 0.0 else 0.0)


def _height(value: float, high: float, scale: float) -> int:
    return round(MARGIN + (high - value) * scale)


def _path(values: Array, high: float, scale: float) -> str:
    """The line in whole units, broken at gaps."""
    valid = np.isfinite(values)
    y = np.rint(MARGIN + (high - np.where(valid, values, high)) * scale).astype(int)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], valid.astype(np.int8), [0]))))
    pieces = []
    for begin, end in edges.reshape(-1, 2).tolist():
        steps = "".join(f"l{STEP} {step}" for step in np.diff(y[begin:end]).tolist())
        pieces.append(f"M{STEP * begin} {y[begin]}{steps}")
    return "".join(pieces)
