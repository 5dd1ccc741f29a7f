"""What a stranger does in the first minutes: a wrong payload is refused and understood, and a program touches the table."""

import re
from collections.abc import Callable
from itertools import pairwise

import pytest
from playwright.sync_api import Page

from pendant.events import Kind
from pendant.modes import Mode
from sim.changes import AttachPayload
from sim.scenario import Load
from tests.e2e.cell import Cell
from tests.e2e.test_push import enter_free_drive, hold_until

pytestmark = pytest.mark.e2e
Visit = Callable[[], Page]


def test_two_kilograms_too_much_are_refused_with_numbers_corrected_they_enter_and_left_alone_it_ends(
    visit: Visit, cell: Cell
) -> None:
    page = visit()
    cell.loop.desk.change(AttachPayload(load=Load(mass=2.0)))
    cell.loop.desk.set({"free_drive.period": 2.0})
    cell.wait(lambda: cell.loop.latest().truth_payload_mass == 2.0, "it hangs")
    page.get_by_role("tab", name="Lab").click()
    page.get_by_text("+2.0 kg wrong").wait_for()
    hold_until(page, cell, lambda: cell.happened(Kind.REFUSED_PAYLOAD), "refused")
    page.get_by_text("Consistent with").or_(page.get_by_text("kg more than configured")).first.wait_for()
    page.mouse.up()
    assert not cell.happened(Kind.ENTERED)
    event = next(event for event in cell.loop.events(0) if event.kind is Kind.REFUSED_PAYLOAD)
    assert 1.0 < float(event.values["mass"]) < 3.0
    field = page.locator(f'[id="{cell.served.lab.configured._impl.uuid}"] ~ div input')
    field.fill("2")
    field.press("Enter")
    page.get_by_text("as configured").wait_for()
    cell.pass_time(2.5)  # the cool-down
    enter_free_drive(page, cell)
    cell.wait(lambda: cell.happened(Kind.LEFT_PERIOD), "left alone, it ends")
    page.get_by_text("Free-drive ended: nobody moved the arm").first.wait_for()
    assert cell.loop.latest().decision.mode is Mode.TEACH


def test_a_program_moves_until_it_touches_the_table_and_retracts(visit: Visit, cell: Cell) -> None:
    page = visit()
    page.get_by_role("tab", name="Lab").click()
    part = cell.served.lab.scenarios
    part.choice.value = "Down onto the table until it touches"
    page.get_by_role("button", name="Play").click()
    cell.wait(lambda: cell.happened(Kind.CONTACT_GAINED), "the table", 60.0)
    low = cell.position("wrist_3")[2]
    page.get_by_role("tab", name="Contacts").click()
    page.get_by_role("cell", name="gained").first.wait_for()
    event = next(event for event in cell.loop.events(0) if event.kind is Kind.CONTACT_GAINED)
    page.get_by_role("cell", name=f"{2 * int(event.values['steps'])} ms").first.wait_for()
    cell.wait(lambda: cell.happened(Kind.PROGRAM_FINISHED), "the program ends", 60.0)
    assert 0.04 < cell.position("wrist_3")[2] - low < 0.06


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
