"""The arm is pushed and guided with the pointer."""

from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Page

from app.web.access import operator
from pendant.events.event import Kind
from pendant.tick.modes import Mode, Phase
from sim.plant.touch import Pull
from tests.e2e.cell import Cell
from tests.e2e.hold import enter_free_drive, hold_free_drive

pytestmark = pytest.mark.e2e
Visit = Callable[[], Page]


def target(cell: Cell) -> np.ndarray:
    """Where the one hand pulls to; waits until it is away from where it began."""
    touches = cell.loop.desk._touches
    cell.wait(lambda: any(isinstance(touch, Pull) for touch in touches.values()), "a hand pulls")
    touch = next(iter(touches.values()))
    assert isinstance(touch, Pull)
    return np.array(touch.target)


def test_guided_by_hand_the_flange_follows_the_pointer_and_stays(visit: Visit, cell: Cell) -> None:
    page = visit()
    cell.pass_time(0.5)
    before = cell.position("wrist_3")
    enter_free_drive(page, cell)
    cell.drag(page, 0, before, (0.0, -120.0))
    part, point = cell.grip()
    start = before - cell.position("wrist_3") + cell.position(part, point)
    way = target(cell) - start
    assert np.linalg.norm(way) > 0.1
    cell.pass_time(2.0)
    moved = cell.position(part, point) - start
    assert moved @ way / np.linalg.norm(way) > 0.050
    page.mouse.up()
    cell.wait(lambda: not cell.loop.desk._touches, "let go")
    cell.wait(lambda: cell.loop.latest().decision.static, "it has come to rest")
    cell.pass_time(0.5)
    at = cell.position(part, point)
    cell.pass_time(0.5)
    assert np.linalg.norm(cell.position(part, point) - at) < 0.0005


def test_held_the_arm_gives_way_by_less_than_three_millimetres_and_comes_back(visit: Visit, cell: Cell) -> None:
    page = visit()
    cell.pass_time(0.5)
    before = cell.position("wrist_3")
    assert cell.loop.latest().decision.mode is Mode.TEACH
    cell.drag(page, 0, before, (0.0, -200.0))
    target(cell)
    cell.wait(lambda: any(np.linalg.norm(touch[2]) > 45.0 for touch in cell.loop.latest().touches), "the hand is at its cap")
    cell.pass_time(0.5)
    assert np.linalg.norm(cell.position("wrist_3") - before) < 0.003
    page.mouse.up()
    cell.wait(lambda: not cell.loop.desk._touches, "let go")
    cell.pass_time(1.0)
    assert np.linalg.norm(cell.position("wrist_3") - before) < 0.0005


def test_closing_the_tab_while_holding_ends_the_hold_at_once(visit: Visit, cell: Cell) -> None:
    page = visit()
    hold_free_drive(page, cell)
    page.context.close()
    cell.wait(lambda: cell.loop.latest().decision.phase is not Phase.HELD, "the hold has ended", 5.0)
    assert not cell.happened(Kind.HOLD_SILENT)
    assert cell.loop.latest().decision.phase is Phase.PERIOD
    assert cell.served.guard.operator.holder is None


def test_closing_the_tab_while_dragging_lets_go_at_once(visit: Visit, cell: Cell) -> None:
    page = visit()
    cell.drag(page, 0, cell.position("wrist_3"), (0.0, -100.0))
    target(cell)
    page.context.close()
    cell.wait(lambda: not cell.loop.desk._touches, "let go", 2.0)


def test_a_page_that_falls_silent_counts_as_released(visit: Visit, cell: Cell) -> None:
    page = visit()
    hold_free_drive(page, cell)
    page.evaluate("setTimeout(() => { const start = Date.now(); while (Date.now() - start < 3000); }, 0)")
    cell.wait(lambda: cell.happened(Kind.HOLD_SILENT), "the silence is seen", 5.0)
    silent = next(event for event in cell.loop.events(0) if event.kind is Kind.HOLD_SILENT)
    assert 1.0 <= float(silent.values["value"]) <= 1.01


def test_the_stop_of_a_second_finger_is_not_lost_while_the_button_is_held(visit: Visit, cell: Cell) -> None:
    page = visit()
    hold_free_drive(page, cell)
    page.get_by_role("button", name="EMERGENCY STOP").dispatch_event("click")
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped", 5.0)
    page.mouse.up()


def test_the_second_client_watches_can_stop_and_takes_over(visit: Visit, cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operator, "SILENCE", 120.0)  # two pages that draw in software need more than 10 s for a few presses
    first, second = visit(), visit()
    first.get_by_role("button", name="Take").click()
    second.get_by_text("Window 1 has control").wait_for()
    first.get_by_text("You have control").wait_for()
    second.get_by_role("button", name="NORMAL").click()
    cell.wait(lambda: cell.served.guard.refused["not the operator"] == 1, "the watcher is refused")
    cell.drag(second, 1, cell.position("wrist_3"), (0.0, -100.0))
    cell.wait(lambda: cell.served.guard.refused["not the operator"] > 1, "the watcher's drag is refused")
    second.mouse.up()
    cell.pass_time(0.2)
    assert cell.loop.latest().touches == ()
    assert cell.loop.latest().decision.mode is Mode.TEACH
    second.get_by_role("button", name="EMERGENCY STOP").click()
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped")
    first.get_by_text("Emergency stop", exact=True).first.wait_for()
    first.get_by_role("button", name="Reset", exact=True).click()
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "reset by the operator")
    first.get_by_role("button", name="Release").click()
    second.get_by_text("Nobody has control").wait_for()
    second.get_by_role("button", name="Take").click()
    second.get_by_text("You have control").wait_for()
    second.context.close()
    first.get_by_text("Nobody has control").wait_for()
