"""A program in the robot's own language, run from the page without a network."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from app.web.server import Served
from pendant.events.event import Kind
from tests.e2e.cell import Cell
from tests.e2e.test_everyday import open_tab

pytestmark = pytest.mark.e2e

TYPED = 'def typed_fast():\n  textmsg("one, two, three")\n  sleep(0.5)\nend\n'


@pytest.fixture
def served(served_with_scripts: Served) -> Served:
    return served_with_scripts


def test_run_the_example_and_mend_a_mistake(visit: Callable[..., Page], cell: Cell) -> None:
    page = visit(1280, 800)
    open_tab(page, "Script")
    page.locator(".pd-left").get_by_role("button", name="Run", exact=True).last.click()
    page.locator(".pd-listing .pd-now", has_text="movej").wait_for()
    cell.wait(lambda: cell.happened(Kind.PROGRAM_FINISHED), "there and back")
    page.get_by_text("turned by 0.3").wait_for()
    page.locator("textarea:visible").first.fill("def wrong():\n  nothing()\nend")
    cell.wait(lambda: "wrong" in str(cell.served.docks.script and cell.served.docks.script.text.value), "typed")
    page.locator(".pd-left").get_by_role("button", name="Run", exact=True).last.click()
    page.get_by_text("line 2, column").last.wait_for()


def test_a_script_is_typed_fast_beside_the_numbers_of_its_lines(visit: Callable[..., Page], cell: Cell) -> None:
    page, tab = visit(1280, 800), cell.served.docks.script
    assert tab is not None
    open_tab(page, "Script")
    text = page.locator("textarea:visible").first
    text.fill("")
    text.focus()
    page.keyboard.type(TYPED)
    cell.wait(lambda: tab.text.value == TYPED, "all that was typed")
    expect(text).to_have_value(TYPED)
    expect(page.locator(".pd-lines pre")).to_have_text("1\n2\n3\n4\n5")
    for each in (text, page.locator(".pd-lines pre")):
        assert "monospace" in each.evaluate("e => getComputedStyle(e).fontFamily")
