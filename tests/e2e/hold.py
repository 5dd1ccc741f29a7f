"""The free-drive button under a pointer that draws in software."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page

from pendant.events.event import Kind
from pendant.tick.modes import Mode, Phase
from tests.e2e.cell import Cell
from tests.e2e.finger import middle, pointer

IN_VAIN = frozenset({Kind.HOLD_SILENT, Kind.REFUSED_MOVING, Kind.ACTIVATION_CANCELLED, Kind.NOT_YET})
"""After these the button has to be pressed again."""

COOL_DOWN = 0.5
"""Longer than that of the cell [s]."""


def hold_until(page: Page, cell: Cell, true: Callable[[], bool], what: str) -> None:
    """Press the free-drive button with the pointer and hold it until something is true.

    Drawing in software, a page may stall for a second, which FD-23 takes for a released button, or the pointer may press while
    the arm still swings, which is refused: press again then, as a hand would.
    """

    def vain() -> int:
        return sum(event.kind in IN_VAIN for event in cell.loop.events(0))

    at, hand = middle(page.locator(f'[id="{cell.served.panel.free_drive._impl.uuid}"]')), pointer(page)
    for _ in range(4):
        known = vain()
        hand.down(at)
        cell.wait(lambda known=known: true() or vain() > known, what)
        if true():
            return
        hand.up()
        cell.pass_time(COOL_DOWN)
    pytest.fail(f"held in vain, {what}: {cell.told()}")


def hold_free_drive(page: Page, cell: Cell) -> None:
    """Press the free-drive button with the pointer and hold it until free-drive is on."""
    hold_until(page, cell, lambda: cell.loop.latest().decision.phase is Phase.HELD, "free-drive, button held")


def enter_free_drive(page: Page, cell: Cell) -> None:
    """Hold the free-drive button until free-drive is on, then let go."""
    hold_free_drive(page, cell)
    cell.pass_time(0.45)  # it may have been pressed again just now, and a short press leaves
    pointer(page).up()
    cell.wait(lambda: cell.loop.latest().decision.phase is not Phase.HELD, "the button let go")
    assert cell.loop.latest().decision.mode is Mode.FREE_DRIVE
