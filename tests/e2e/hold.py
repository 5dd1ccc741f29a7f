"""The free-drive button under a pointer that draws in software."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page

from pendant.events import Kind
from pendant.modes import Mode, Phase
from tests.e2e.cell import Cell


def hold_until(page: Page, cell: Cell, true: Callable[[], bool], what: str) -> None:
    """Press the free-drive button with the pointer and hold it until something is true.

    Drawing in software, a page may stall for half a second, which FD-23 takes for a released button: press again then, as
    a hand would.
    """

    def silences() -> int:
        return sum(event.kind is Kind.HOLD_SILENT for event in cell.loop.events(0))

    box = page.get_by_role("button", name="Hold for free-drive").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    for _ in range(4):
        known = silences()
        page.mouse.down()
        cell.wait(lambda known=known: true() or silences() > known, what)
        if true():
            return
        page.mouse.up()
    pytest.fail("the page stalled each time that the button was held")


def hold_free_drive(page: Page, cell: Cell) -> None:
    """Press the free-drive button with the pointer and hold it until free-drive is on."""
    hold_until(page, cell, lambda: cell.loop.latest().decision.phase is Phase.HELD, "free-drive, button held")


def enter_free_drive(page: Page, cell: Cell) -> None:
    """Hold the free-drive button until free-drive is on, then let go."""
    hold_free_drive(page, cell)
    cell.pass_time(0.45)  # it may have been pressed again just now, and a short press leaves
    page.mouse.up()
    cell.wait(lambda: cell.loop.latest().decision.phase is not Phase.HELD, "the button let go")
    assert cell.loop.latest().decision.mode is Mode.FREE_DRIVE
