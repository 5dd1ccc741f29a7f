"""What a stranger does in the first minutes, at both window sizes, and what stays in sight meanwhile."""

import re
from collections.abc import Callable
from itertools import pairwise

import pytest
from playwright.sync_api import Page

from tests.e2e.cell import Cell
from tests.e2e.first_use import FirstUse

pytestmark = pytest.mark.e2e
Visit = Callable[[], Page]


@pytest.mark.parametrize("size", [(1280, 800), (1024, 768)])
def test_a_stranger_walks_through_the_first_use(visit: Visit, cell: Cell, size: tuple[int, int]) -> None:
    page = visit()
    page.set_viewport_size({"width": size[0], "height": size[1]})
    FirstUse(page, cell).walk()


def test_control_goes_to_the_second_page_when_the_first_gives_it_back(visit: Visit, cell: Cell) -> None:
    first, second = visit(), visit()
    first.get_by_role("button", name="Take").click()
    second.get_by_text(re.compile(r"Client \d+ has control")).wait_for()
    first.get_by_role("button", name="Release").click()
    second.get_by_text("Nobody has control").wait_for()
    second.get_by_role("button", name="Take").click()
    second.get_by_text("You have control").wait_for()
    second.context.close()
    first.get_by_text("Nobody has control").wait_for()


@pytest.mark.parametrize("size", [(1280, 800), (1024, 768)])
def test_nothing_of_the_pendant_is_out_of_sight(visit: Visit, size: tuple[int, int]) -> None:
    page = visit()
    width, height = size
    page.set_viewport_size({"width": width, "height": height})
    boxes = []
    for name in ("Take", "Hold for free-drive", "Leave free-drive", "TEACH", "EMERGENCY STOP", "Reset"):
        box = page.get_by_role("button", name=name, exact=True).first.bounding_box()
        assert box is not None
        assert box["x"] >= width - 310
        assert box["x"] + box["width"] <= width
        assert box["y"] + box["height"] <= height
        boxes.append(box)
    for upper, lower in pairwise(boxes):
        assert upper["y"] + upper["height"] <= lower["y"]
