"""Everyday tasks, each done on the page with a real pointer."""

from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Page

from pendant.events.event import Kind
from sim.arm.frames import matrix_from_quaternion
from tests.e2e.cell import Cell

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]

PRESSES = 3
"""At most: a page that draws in software may stall for a second, which counts as let go."""


def endings(cell: Cell) -> list[str]:
    """Why each jog has ended so far."""
    return [str(event.values["reason"]) for event in cell.loop.events(0) if event.kind is Kind.JOG_ENDED]


def choose(page: Page, label: str, option: str) -> None:
    """Choose from a list with the pointer."""
    page.get_by_role("textbox", name=label).or_(page.get_by_label(label)).first.click()
    page.get_by_role("option", name=option, exact=True).click()


@pytest.mark.parametrize(("width", "height"), [(1440, 900), pytest.param(820, 1180, marks=pytest.mark.every_size)])
def test_jog_fifty_millimetres_along_the_tool(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    tab = cell.served.docks.jog
    page.get_by_role("tab", name="Jog").click()
    choose(page, "Move by", "Axes of the tool")
    cell.wait(lambda: tab.chosen == "tool", "the frame is chosen")
    choose(page, "One press", "50 mm, 50°")
    cell.wait(lambda: tab.steps.value == "50 mm, 50°", "the step is chosen")
    cell.pass_time(0.5)
    button = page.get_by_role("button", name="Z −", exact=True)
    button.scroll_into_view_if_needed()
    box = button.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    for _ in range(PRESSES):
        pose = cell.loop.latest().truth_links[-1].copy()
        before = len(endings(cell))
        page.mouse.down()
        cell.wait(lambda before=before: len(endings(cell)) > before, "the jog has ended")
        page.mouse.up()
        cell.pass_time(1.0)
        if endings(cell)[-1] == "done":
            axis = matrix_from_quaternion(pose[3:])[:, 2]
            np.testing.assert_allclose(cell.loop.latest().truth_links[-1][:3] - pose[:3], -0.05 * axis, atol=0.001)
            return
        assert endings(cell)[-1] == "no word from the button"
    pytest.fail(f"held in vain: {cell.told()}")
