"""Charts: round ends, gaps, marks, and a size that a stream can bear."""

import re

import numpy as np
import pytest

from app.web.widgets.chart import HEIGHT, MARGIN, STEP, Curve, Layer, chart, stack


def ys(html: str) -> list[int]:
    """Heights of the one line that has more than a step."""
    d = next(d for d in re.findall(r'd="([^"]+)"', html) if "l" in d)
    start, *steps = re.findall(r"-?\d+ (-?\d+)", d)
    return np.cumsum([int(start), *map(int, steps)]).tolist()


@pytest.mark.parametrize(
    ("values", "ends"),
    [([0.0, 3.0], "0 … 5 N"), ([-0.3, 0.1], "-0.5 … 0.5 N"), ([-7.0, -1.0], "-10 … 0 N"), ([0.0, 1.0], "0 … 1 N")],
)
def test_the_ends_are_round(values: list[float], ends: str) -> None:
    assert ends in chart("t", "N", [Curve("a", np.array(values))])


def test_a_line_goes_from_the_bottom_to_the_top_of_its_range() -> None:
    assert ys(chart("t", "N", [Curve("a", np.array([0.0, 2.5, 5.0]))])) == [HEIGHT - MARGIN, HEIGHT // 2, MARGIN]


def test_a_gap_breaks_the_line_and_nothing_at_all_draws_none() -> None:
    html = chart("t", "N", [Curve("a", np.array([1.0, 1.0, np.nan, 1.0, 1.0]))])
    assert len(re.findall(r"M\d+ \d+l", html)) == 2
    assert "l2" not in chart("t", "N", [Curve("a", np.full(5, np.nan))])


def test_marks_and_limits_are_drawn() -> None:
    html = chart("t", "N", [Curve("a", np.array([1.0, 2.0]))], marks=[1], limit=10.0)
    assert f"M{STEP} 0v{HEIGHT}" in html
    assert f"M0 {MARGIN}h{STEP}" in html


def test_texts_are_escaped() -> None:
    assert "<b>x" not in chart("<b>x", "<b>x", [Curve("<b>x", np.zeros(2))])


def test_six_noisy_lines_of_ten_seconds_stay_below_ten_kilobytes() -> None:
    noise = np.random.default_rng(1).standard_normal((6, 200))
    assert len(chart("t", "N", [Curve(f"{i}", row) for i, row in enumerate(noise)])) < 10_000


def test_a_stack_reaches_as_high_as_its_shares_and_has_gaps() -> None:
    rows = np.array([[1.0, 0.25, np.nan, 0.0], [0.0, 0.75, np.nan, 0.5], [0.0, 0.0, np.nan, 0.5]])
    layers = [Layer(name, colour, row) for name, colour, row in zip("<bc", ("red", "green", "blue"), rows, strict=True)]
    picture = stack("Who", "c & d", layers, [1])
    paths = {colour: path for path, colour in re.findall(r'<path d="([^"]+)" fill="(\w+)"/>', picture)}
    top = HEIGHT
    assert list(paths) == ["blue", "green", "red"], "the lower cover the upper"
    assert paths["red"] == f"M0 {top}H0v-{top}H2v{top - round(0.25 * top)}H4v{round(0.25 * top)}H8V{top}z"
    assert paths["green"] == f"M0 {top}H0v-{top}H4v{top}H6v-{top // 2}H8V{top}z"
    assert paths["blue"] == f"M0 {top}H0v-{top}H4v{top}H6v-{top}H8V{top}z"
    assert '<path d="M2 0v150"' in picture
    assert "&lt;" in picture
    assert "c &amp; d" in picture


def test_of_a_stack_nothing_is_drawn_of_what_never_was() -> None:
    nothing = np.full(200, np.nan)
    assert "<path" not in stack("Who", "", [Layer("a", "red", nothing), Layer("b", "blue", nothing)])
    ones = np.ones(200)
    assert len(stack("Who", "", [Layer("a", "red", ones), Layer("b", "blue", 0.0 * ones)])) < 600, "what stays costs nothing"
