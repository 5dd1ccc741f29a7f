"""What all figures of reports share: their frame, and how they become SVG."""

import io

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

WIDTH = 7.2
"""Of a figure [inch]."""

INK = "#212529"


def empty_axes(height: float, above: float = 0.1) -> tuple[Figure, Axes]:
    """An empty figure of that height, with `above` [inch] for what stands above its axes."""
    figure = Figure(figsize=(WIDTH, height))
    # The same left and right for all figures: their times lie below each other.
    axes = figure.add_axes((0.075, 0.4 / height, 0.915, 1.0 - (0.4 + above) / height))
    axes.tick_params(labelsize=7)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, linewidth=0.3, alpha=0.6)
    axes.set_axisbelow(True)
    return figure, axes


def svg_of(figure: Figure) -> str:
    """The figure as an <svg> element. Same numbers, same text: no date, no random names."""
    out = io.StringIO()
    with mpl.rc_context({"svg.hashsalt": "pendant", "svg.fonttype": "none", "font.family": "sans-serif"}):
        figure.savefig(out, format="svg", metadata={"Date": None})
    text = out.getvalue()
    return text[text.index("<svg") :]
