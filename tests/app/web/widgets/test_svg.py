"""Whatever a text says, it cannot become markup."""

import math
import re

import pytest

from app.web.widgets import svg
from app.web.widgets.svg import Bar, Colour

EVIL = '<img src=x onerror="alert(1)">&\'</style>'


@pytest.mark.parametrize(
    "html",
    [
        svg.light(EVIL, EVIL, EVIL, Colour.GREEN),
        svg.windows([svg.Window(EVIL, 1.0, 0.5, Colour.BLUE)]),
        svg.note(EVIL, EVIL, Colour.RED),
        svg.who(EVIL, EVIL, Colour.GREY),
        svg.facts([(EVIL, EVIL)]),
        svg.table([(EVIL, EVIL, Colour.AMBER)]),
        svg.note("", "", Colour.RED, [EVIL]),
        svg.bars([Bar(EVIL, EVIL, 1.0, 2.0, EVIL)], 1),
        svg.fine_print(EVIL),
        svg.contacts([(EVIL, EVIL)]),
        svg.steps([(EVIL, False, False)], ""),
        svg.steps([(EVIL, True, True)], EVIL),
    ],
)
def test_texts_are_escaped(html: str) -> None:
    assert "<img" not in html
    assert html.count("</style>") == html.count("<style>")
    assert "&lt;img src=x onerror=&quot;alert(1)&quot;&gt;&amp;&#x27;&lt;/style&gt;" in html


@pytest.mark.parametrize(("share", "part"), [(0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (-0.5, 0.0), (7.0, 1.0)])
def test_a_ring_shows_its_share_of_the_circle(share: float, part: float) -> None:
    found = re.search(r'stroke-dasharray="([\d.]+) ([\d.]+)"', svg.windows([svg.Window("restart", 2.345, share, Colour.BLUE)]))
    assert found is not None
    arc, around = float(found[1]), float(found[2])
    assert around == pytest.approx(2 * math.pi * 26.0, abs=0.06)
    assert arc == pytest.approx(part * around, abs=0.06)


def test_a_ring_shows_the_seconds_left() -> None:
    assert ">2.3</text>" in svg.windows([svg.Window("restart", 2.31, 0.5, Colour.BLUE)])


def test_a_state_is_never_colour_alone() -> None:
    assert "Stopped" in svg.light("STOP", "Stopped", "Normal", Colour.RED)


def test_without_periods_the_rings_say_so() -> None:
    assert "<svg" not in svg.windows([])
    both = svg.windows([svg.Window("restart", 1.0, 1.0, Colour.BLUE), svg.Window("cool-down", 1.0, 1.0, Colour.GREY)])
    assert both.count("<svg") == 1
    assert both.count("<span") == 2
