"""The user's cell in a real browser: two windows edit it, a scenario gives it back, a drag reorders it, typing loses nothing."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from app.kept_setup import any_cell
from pendant.events.event import Kind
from pendant.tick.modes import Mode
from tests.e2e.cell import Cell
from tests.e2e.finger import middle, pointer, tap
from tests.e2e.test_everyday import open_tab
from tests.e2e.test_tasks import LATER, choose, click, teach_three

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]


def plan(cell: Cell) -> list[str | None]:
    """Where the steps of the program lead."""
    return [step.to for step in cell.served.docks.teach.lesson.plan]


def begin_from_its_file(cell: Cell) -> None:
    """As a server does that has kept it: the bare flange is then in the table of tools."""
    work = cell.served.docks.work
    assert work.try_file("cell.yaml", work.file()) == ""
    cell.wait(lambda: bool(work.mine().setup.tools), "it has begun", 60.0)


@pytest.mark.parametrize(("width", "height"), LATER)
def test_a_step_is_dragged_to_its_place(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """A finger rests on it first."""
    page = visit(width, height)
    for _ in range(3):
        cell.served.docks.teach.mark()
    first, last = (page.get_by_role("radio", name=f"{number}. Move to P{number}") for number in (1, 3))
    last.wait_for()
    hand, (x, y) = pointer(page), middle(first)
    box = last.bounding_box()
    assert box is not None
    hand.down((x, y))
    if hand.touches:
        page.locator(".pd-dragged").wait_for()
    hand.move((x, box["y"] + box["height"] - 3.0), steps=8)
    page.locator(".pd-after").wait_for()
    hand.up()
    cell.wait(lambda: plan(cell) == ["P2", "P3", "P1"], "the first is the last")
    expect(page.get_by_role("radio", name="3. Move to P1")).to_have_attribute("aria-checked", "true")


def test_two_windows_edit_one_cell(visit: Visit, cell: Cell) -> None:
    """The last press wins, and both see it."""
    first, second = visit(), visit()
    for page, other, number in ((first, second, 1), (second, first, 2)):
        tap(page.get_by_role("button", name="Take"))
        tap(page.get_by_role("button", name="Register waypoint"))
        for each in (page, other):
            each.get_by_role("radio", name=f"{number}. Move to P{number}").wait_for()
        tap(page.get_by_role("button", name="Release"))
    for page in (first, second):
        open_tab(page, "Cell")
    undo = second.get_by_role("button", name="Undo", exact=True).locator("visible=true").first
    expect(undo).to_be_enabled()
    tap(undo)
    cell.wait(lambda: plan(cell) == ["P1"], "undone by the second")
    for page in (first, second):
        open_tab(page, "Teach")
        expect(page.get_by_role("radio", name="2. Move to P2")).to_have_count(0)
        page.get_by_role("radio", name="1. Move to P1").wait_for()


@pytest.mark.parametrize(("width", "height"), LATER)
def test_a_scenario_gives_the_cell_back(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    begin_from_its_file(cell)
    tap(page.get_by_role("button", name="Register waypoint"))
    cell.wait(lambda: plan(cell) == ["P1"], "a waypoint")
    cell.pass_time(1.0)
    mine = cell.served.docks.work.mine()
    open_tab(page, "Lab")
    click(page, "Play")
    cell.wait(lambda: cell.served.docks.work.lent is not None, "it runs beside the cell")
    click(page, "Back to my cell")
    cell.wait(lambda: cell.served.docks.work.lent is None, "given back")
    cell.wait(lambda: cell.served.docks.work.mine() == mine, "as it was", 40.0)
    page.get_by_role("button", name="Back to my cell").wait_for(state="hidden")


@pytest.mark.parametrize(("width", "height"), LATER)
def test_move_to_the_start_by_holding(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    teach_three(page, cell)
    start = cell.served.docks.teach.start
    assert start is not None
    hand, at = pointer(page), middle(page.get_by_role("button", name="Move to start"))
    for _ in range(3):  # a page that stalls has let go
        known = len(cell.loop.events(0))
        hand.down(at)
        cell.wait(lambda known=known: any(e.kind is Kind.JOG_ENDED for e in cell.loop.events(0)[known:]), "it ends", 40.0)
        hand.up()
        cell.pass_time(0.5)
        if max(abs(cell.loop.latest().truth_q - start.q)) < 0.01:
            return
    pytest.fail(cell.told())


@pytest.mark.parametrize(("width", "height"), LATER)
def test_pause_and_go_on(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    teach_three(page, cell)
    click(page, "Run")
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.RUN, "it runs")
    click(page, "Pause")
    cell.wait(lambda: cell.happened(Kind.PROGRAM_PAUSED), "paused")
    click(page, "Run")
    cell.wait(lambda: cell.happened(Kind.PROGRAM_FINISHED), "finished", 40.0)


def test_typing_fast_loses_no_letter(visit: Visit, cell: Cell) -> None:
    page = visit()
    open_tab(page, "Tools")
    tap(page.get_by_text("Edit tools", exact=True).locator("visible=true").first)
    name = page.get_by_label("Name", exact=True).locator("visible=true").first
    name.fill("")
    page.keyboard.type("mytool with a long name")
    page.wait_for_timeout(1500)
    expect(name).to_have_value("mytool with a long name")


@pytest.mark.every_size
def test_200_drawn_actions_never_lose_the_cell(visit: Visit, cell: Cell, tmp_path: Path) -> None:
    """After each, what is saved and loaded is what was there."""
    page, draw, work = visit(1440, 900), random.Random(67), cell.served.docks.work
    begin_from_its_file(cell)
    pressed = 0

    def press(tab: str, name: str) -> None:
        """Press a button that is there and works: one without a step or a wall does not."""
        nonlocal pressed
        open_tab(page, tab)
        button = page.get_by_role("button", name=name, exact=True).locator("visible=true").first
        if button.is_visible() and button.is_enabled():
            tap(button)
            pressed += 1

    def reload() -> None:
        page.reload()
        page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
        page.add_style_tag(content=".mantine-Notification-root { display: none }")

    def scenario() -> None:
        before = work.mine()
        press("Lab", "Play")
        cell.wait(lambda: work.lent is not None, "beside")
        assert work.mine() == before
        click(page, "Back to my cell")
        cell.wait(lambda: work.lent is None and work.mine() == before, "given back", 40.0)

    def load() -> None:
        before = work.mine()
        open_tab(page, "Cell")
        with page.expect_download() as saved:
            click(page, "Save cell")
        saved.value.save_as(tmp_path / "cell.yaml")
        with page.expect_file_chooser() as chooser:
            click(page, "Load a cell")
        chooser.value.set_files(tmp_path / "cell.yaml")
        page.get_by_text("Cell loaded").first.wait_for()
        cell.wait(lambda: work.mine() == before, "as it was", 40.0)

    def wall() -> None:
        press("Walls", draw.choice(["Plane", "Box", "Sphere"]))

    def step() -> None:
        open_tab(page, "Teach")
        choose(page, "Step", draw.choice(["Wait", "Move until contact"]))

    acts: list[Callable[[], None]] = [
        *[lambda: press("Teach", "Register waypoint")] * 3,
        lambda: press("Teach", draw.choice(["↑", "↓", "✕"])),
        lambda: press("Teach", draw.choice(["Before", "After", "Replace"])),
        step,
        *[wall] * 2,
        lambda: press("Walls", "Delete"),
        *[lambda: press("Cell", draw.choice(["Undo", "Redo"]))] * 3,
        lambda: press("Cell", draw.choice(["Yes, do it", "No"])) if page.get_by_role("button", name="No").is_visible() else None,
        reload,
        scenario,
        load,
    ]
    for _ in range(200):
        draw.choice(acts)()
        cell.pass_time(0.8)
        mine = work.mine()
        assert any_cell("cell.yaml", work.file(), mine) == mine
    assert pressed > 80
