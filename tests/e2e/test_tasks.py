"""Everyday tasks, each done on the page with a real pointer."""

from collections.abc import Callable

import numpy as np
import pytest
from msgspec.structs import replace
from playwright.sync_api import Page

from pendant.events.event import Kind
from sim.arm.frames import matrix_from_quaternion
from sim.arm.scenario import BoxObject
from sim.simulation import Simulation
from tests.e2e.cell import SETTINGS, Cell
from tests.e2e.finger import Finger, middle, pointer, tap

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]

PRESSES = 3
"""At most: a page that draws in software may stall for a second, which counts as let go."""


def endings(cell: Cell) -> list[str]:
    """Why each jog has ended so far."""
    return [str(event.values["reason"]) for event in cell.loop.events(0) if event.kind is Kind.JOG_ENDED]


def choose(page: Page, label: str, option: str) -> None:
    """Choose from a list with the pointer."""
    box = page.get_by_role("textbox", name=label, exact=True).or_(page.get_by_label(label, exact=True)).first
    tap(box)
    tap(page.get_by_role("option", name=option, exact=True))


SIZES = [(1440, 900), pytest.param(820, 1180, marks=pytest.mark.every_size)]
"""A desk's screen, and a tablet held upright, where fingers take the place of the mouse."""

BY_FINGER = [pytest.param(1440, 900, marks=pytest.mark.every_size), (820, 1180)]
"""The same, where `make test` has the tablet."""

LATER = [pytest.param(*size, marks=pytest.mark.every_size) for size in ((1440, 900), (820, 1180))]
"""Of what `make test` leaves to `make e2e-full`."""


def click(page: Page, name: str) -> None:
    """Press a button with the pointer."""
    button = page.get_by_role("button", name=name, exact=True).first
    tap(button)


def fill(page: Page, label: str, value: str) -> None:
    """Type a value into a field."""
    field = page.get_by_label(label, exact=True).first
    field.fill(value)
    field.press("Enter")


def teach_three(page: Page, cell: Cell) -> None:
    """Three waypoints; between them the wrist is jogged."""
    teach, jog = cell.served.docks.teach, cell.served.docks.jog
    for number in (1, 2, 3):
        tap(page.get_by_role("tab", name="Teach"))
        tap(page.get_by_role("button", name="Register waypoint"))
        cell.wait(lambda number=number: len(teach.lesson.waypoints) == number, f"waypoint {number}")
        if number < 3:
            tap(page.get_by_role("tab", name="Jog"))
            if jog.steps.value != "10 mm, 10°":
                choose(page, "Stops after", "10 mm, 10°")
                cell.wait(lambda: jog.steps.value == "10 mm, 10°", "the step is chosen")
            hold_jog(page, cell, "Wrist 3 +")


def hold_jog(page: Page, cell: Cell, name: str) -> None:
    """Hold a jog button until it has done its step."""
    button = page.get_by_role("button", name=name, exact=True)
    at, hand = middle(button), pointer(page)
    for _ in range(PRESSES):
        before = len(endings(cell))
        hand.down(at)
        cell.wait(lambda before=before: len(endings(cell)) > before, "the jog has ended")
        hand.up()
        cell.pass_time(0.6)
        if endings(cell)[-1] == "done":
            return
    pytest.fail(f"held in vain: {cell.told()}")


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_teach_three_waypoints_and_loop_them(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    teach = cell.served.docks.teach
    teach_three(page, cell)
    tap(page.get_by_label("Loop", exact=True))
    cell.wait(lambda: teach.lesson.repeat == 0, "it loops")
    click(page, "Run")
    seen: list[int] = []

    def round_again() -> bool:
        step = cell.loop.latest().decision.step
        if step and (not seen or seen[-1] != step):
            seen.append(step)
        return seen[-4:] == [2, 3, 1, 2]

    cell.wait(round_again, "the second round", 40.0)
    click(page, "Stop")
    cell.wait(lambda: cell.happened(Kind.PROGRAM_STOPPED), "stopped")
    assert not cell.happened(Kind.PROGRAM_FINISHED)


@pytest.mark.parametrize(("width", "height"), LATER)
def test_insert_a_wait(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    teach = cell.served.docks.teach
    teach_three(page, cell)
    tap(page.get_by_role("radio", name="1. Move to P1"))
    cell.wait(lambda: teach.steps.chosen == 0, "the first step is chosen")
    choose(page, "Step", "Wait")
    cell.wait(lambda: teach.steps.fields["seconds"].visible, "how long")
    fill(page, "Seconds", "0.5")
    cell.wait(lambda: teach.steps.fields["seconds"].value == 0.5, "half a second")
    click(page, "After")
    cell.wait(lambda: len(teach.lesson.plan) == 4, "inserted")
    assert [step.text for step in teach.lesson.plan] == ["Move to P1", "Wait 0.5 s", "Move to P2", "Move to P3"]
    click(page, "Run")
    cell.wait(lambda: cell.happened(Kind.PROGRAM_FINISHED), "the program ends", 30.0)


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_move_down_until_contact(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """Onto a block whose top is 0.25 m below the flange; 200 mm are too few, and the page says so."""
    page = visit(width, height)
    teach, running = cell.served.docks.teach, cell.loop.simulation
    block = BoxObject(name="block", position=[-0.6283, -0.1334, 0.043], size=[0.2, 0.2, 0.1], stiffness=2.0e4)
    cell.loop.begin(lambda: Simulation(running.arm, replace(running.scenario, world=[block]), SETTINGS))
    choose(page, "Step", "Move until contact")
    cell.wait(lambda: teach.steps.fields["distance"].visible, "how far")
    fill(page, "Distance [mm]", "200")
    fill(page, "Speed [mm/s]", "150")
    cell.wait(lambda: teach.steps.fields["distance"].value == 200.0, "how far")
    cell.wait(lambda: teach.steps.fields["speed"].value == 150.0, "how fast")
    click(page, "After")
    cell.wait(lambda: len(teach.lesson.plan) == 1, "inserted")
    click(page, "Run")
    cell.wait(lambda: cell.happened(Kind.PROGRAM_FAILED), "nothing met", 30.0)
    page.get_by_text("no contact within 200 mm").first.wait_for()
    fill(page, "Distance [mm]", "400")
    cell.wait(lambda: teach.steps.fields["distance"].value == 400.0, "further")
    click(page, "Replace")
    cell.wait(lambda: teach.lesson.plan[0].distance == 0.4, "changed")
    cell.pass_time(0.5)
    click(page, "Run")
    cell.wait(lambda: cell.happened(Kind.PROGRAM_FINISHED), "it has met the floor", 30.0)
    assert cell.happened(Kind.CONTACT_GAINED)
    assert not cell.loop.settings.contact.on
    assert abs(float(cell.position("flange")[2]) - 0.093) < 0.003


@pytest.mark.parametrize(("width", "height"), BY_FINGER)
def test_jog_fifty_millimetres_along_the_tool(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    tab = cell.served.docks.jog
    tap(page.get_by_role("tab", name="Jog"))
    choose(page, "Move by", "Axes of the tool")
    cell.wait(lambda: tab.chosen == "tool", "the frame is chosen")
    choose(page, "Stops after", "50 mm, 50°")
    cell.wait(lambda: tab.steps.value == "50 mm, 50°", "the step is chosen")
    cell.pass_time(0.5)
    button = page.get_by_role("button", name="Z −", exact=True)
    at, hand = middle(button), pointer(page)
    for _ in range(PRESSES):
        pose = cell.loop.latest().truth_links[-1].copy()
        before = len(endings(cell))
        hand.down(at)
        cell.wait(lambda before=before: len(endings(cell)) > before, "the jog has ended")
        hand.up()
        cell.pass_time(1.0)
        if endings(cell)[-1] == "done":
            axis = matrix_from_quaternion(pose[3:])[:, 2]
            np.testing.assert_allclose(cell.loop.latest().truth_links[-1][:3] - pose[:3], -0.05 * axis, atol=0.001)
            return
        assert endings(cell)[-1] == "no word from the button"
    pytest.fail(f"held in vain: {cell.told()}")


def test_a_finger_that_scrolls_from_a_jog_button_moves_nothing_and_the_next_press_counts(visit: Visit, cell: Cell) -> None:
    page = visit(820, 1180)
    tap(page.get_by_role("tab", name="Jog"))
    button = page.get_by_role("button", name="Shoulder −", exact=True)
    button.tap(trial=True)  # waits until it stays where it is
    hand = pointer(page)
    assert isinstance(hand, Finger)
    for _ in range(PRESSES):
        hand.flick(middle(button), 120.0)
        cell.pass_time(2.0)
        if page.evaluate("[...document.querySelectorAll('*')].some(one => one.scrollTop > 40)"):
            break
    else:
        pytest.fail(f"no finger has scrolled: {cell.told()}")
    assert not cell.happened(Kind.JOG_STARTED)
    choose(page, "Stops after", "10 mm, 10°")
    cell.wait(lambda: cell.served.docks.jog.steps.value == "10 mm, 10°", "the step is chosen")
    hold_jog(page, cell, "Wrist 3 +")
