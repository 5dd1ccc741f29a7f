import math

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection

from app.report.drawing import svg_of
from app.studies.study_charts import curves, heat_map, roc_chart, sensitivity, short
from app.studies.study_statistics import Point, RocPoint, SobolIndex


def points(*values: float | str) -> list[Point]:
    return [Point(value, 4, 0.5, 0.25, 0.75) for value in values]


def test_a_curve_has_its_axes_and_its_lines() -> None:
    text = svg_of(curves({"a": points(1.0, 2.0), "b": points(1.0, 2.0)}, "mass [kg]", "refused", share=True, by="limit"))
    for word in ("mass [kg]", "refused [% of runs]", "limit", ">a<", ">b<"):
        assert word in text
    assert text == svg_of(curves({"a": points(1.0, 2.0), "b": points(1.0, 2.0)}, "mass [kg]", "refused", share=True, by="limit"))


def test_a_band_reaches_from_low_to_high() -> None:
    axes = curves({"": points(1.0, 2.0)}, "x", "y", share=True).axes[0]
    box = axes.collections[0].get_paths()[0].get_extents()
    assert (box.ymin, box.ymax) == (25.0, 75.0)


def test_intervals_of_many_lines_are_bars_side_by_side() -> None:
    axes = curves({name: points(1.0, 2.0, 4.0) for name in "abcd"}, "x", "y", share=True).axes[0]
    assert not any(isinstance(each, PolyCollection) for each in axes.collections), "bands hide each other"
    bars = [each for each in axes.collections if isinstance(each, LineCollection)]
    places = [bar.get_segments()[1][0][0] for bar in bars]
    assert len(places) == 4
    assert places == sorted(set(places)), "in the order of the lines, none above another"
    assert np.mean(places) == pytest.approx(2.0)
    assert places[-1] - places[0] < 0.6, "nearer to their value than to the next"
    assert [tuple(y for _, y in bar.get_segments()[1]) for bar in bars] == [(25.0, 75.0)] * 4


def test_bars_of_a_logarithmic_scale_keep_their_distance() -> None:
    axes = curves({name: points(1.0, 100.0) for name in "abcd"}, "x", "y", share=False).axes[0]
    bars = [each.get_segments() for each in axes.collections if isinstance(each, LineCollection)]
    shifts = [[math.log(segment[0][0] / value) for segment, value in zip(bar, (1.0, 100.0), strict=True)] for bar in bars]
    assert all(first == pytest.approx(second) for first, second in shifts)


@pytest.mark.parametrize(("values", "scale"), [((1.0, 10.0), "linear"), ((1.0, 100.0), "log"), ((0.0, 100.0), "linear")])
def test_a_wide_factor_has_a_logarithmic_scale(values: tuple[float, ...], scale: str) -> None:
    assert curves({"": points(*values)}, "x", "y", share=False).axes[0].get_xscale() == scale


def test_names_stand_beside_each_other() -> None:
    text = svg_of(curves({"": points("slowly", "at once")}, "x", "y", share=False))
    assert ">slowly<" in text
    assert ">at once<" in text


def test_a_map_says_its_numbers_and_what_is_missing() -> None:
    text = svg_of(heat_map([1.0, 2.0], ["a", "b"], np.array([[0.1, 0.2], [np.nan, 0.4]]), ["r", "c", "m"], share=True))
    assert all(f">{word}<" in text for word in ("10", "20", "40", "-", "r", "c", "m [% of runs]"))


def test_a_limit_is_a_point_with_two_shares() -> None:
    text = svg_of(roc_chart([RocPoint(5.8, *points(0.0, 0.0)), RocPoint(7.0, *points(0.0, 0.0))], "limit [N]"))
    assert ">5.8<" in text
    assert ">area 0.500<" in text


def test_bars_name_their_factors() -> None:
    both = [SobolIndex("mass", 0.2, 0.1), SobolIndex("gap", 0.1, 0.1)]
    text = svg_of(sensitivity({"way": [SobolIndex("mass", 0.5, 0.1)], "time": both}))
    assert all(f">{word}<" in text for word in ("mass", "gap", "way", "time"))


def test_short_numbers() -> None:
    assert [short(value) for value in (200000.0, 0.0747674, 2.0, "x")] == ["200000", "0.07477", "2", "x"]
