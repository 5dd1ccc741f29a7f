"""What a stranger does in the first minutes, at both window sizes, and what stays in sight meanwhile."""

from collections.abc import Callable
from itertools import pairwise

import pytest
from playwright.sync_api import Page

from tests.e2e.cell import Cell
from tests.e2e.first_use import FirstUse

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]
SIZES = ((1280, 800), (1024, 768))


@pytest.mark.parametrize("size", [SIZES[0], pytest.param(SIZES[1], marks=pytest.mark.every_size)])
def test_a_stranger_walks_through_the_first_use(visit: Visit, cell: Cell, size: tuple[int, int]) -> None:
    FirstUse(visit(*size), cell).walk()


def test_nothing_of_the_pendant_is_out_of_sight(visit: Visit) -> None:
    page = visit()
    for width, height in SIZES:
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
