"""Everyday tasks of walls, joints and arms: a wall that stops the hand, only the elbow free, another arm."""

from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from app.kept_setup import setup_of
from app.web.tabs.tool_frame import SCALE as FRAME_SCALE
from app.web.walls.wall_handles import SCALE
from pendant.events.event import Kind
from pendant.tick.modes import Mode
from pendant.walls.definitions import Area
from sim.arm.frames import matrix_from_quaternion
from tests.e2e.cell import Cell
from tests.e2e.finger import pointer, tap
from tests.e2e.first_use import FirstUse
from tests.e2e.hold import enter_free_drive
from tests.e2e.test_everyday import open_tab
from tests.e2e.test_tasks import LATER, choose, click, hold_jog

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]


def plane(cell: Cell) -> Area:
    """The one wall that was made."""
    (wall,) = cell.loop.walls
    assert isinstance(wall, Area)
    return wall


def pull(page: Page, at: tuple[float, float], by: float) -> None:
    """Pull what is in the picture there by so many pixels downwards."""
    (x, y), hand = at, pointer(page)
    if not hand.touches:
        page.mouse.move(x, y - 1.0)
        page.mouse.move(x, y)
        page.wait_for_timeout(700)
    hand.down(at)
    hand.move((x, y + by / 2), steps=4)
    hand.move((x, y + by), steps=4)
    page.wait_for_timeout(300)
    hand.up()


def pull_handle(page: Page, cell: Cell, by: float) -> None:
    """Pull the arrow along z of the plane's handles by so many pixels; a page that is drawn late is pulled again."""
    before = plane(cell).position
    for _ in range(6):
        p = np.array(plane(cell).position)
        x, y = cell.pixel(page, 0, p + np.array([0.0, 0.0, -0.75 * SCALE]))
        pull(page, (x, y), by)
        page.wait_for_timeout(700)
        if plane(cell).position != before:
            return
    pytest.fail(f"the handle was not found: {cell.served.guard.refused}")


@pytest.mark.parametrize(("width", "height"), LATER)
def test_add_a_wall_and_be_stopped_by_it(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """A plane 100 mm below the tool, pulled up by its handle; free-drive ends at it, as shipped, and the arm holds there."""
    page = visit(width, height)
    tab = cell.served.docks.walls
    open_tab(page, "Walls")
    click(page, "Plane")
    cell.wait(lambda: len(cell.loop.walls) == 1 and tab.handles._gizmo is not None, "the plane, with handles")
    first = plane(cell).position
    pull_handle(page, cell, -25.0)
    moved = plane(cell).position
    assert moved[2] > first[2] + 0.01
    assert np.hypot(moved[0] - first[0], moved[1] - first[1]) < 0.005
    use = FirstUse(page, cell)

    def ended() -> bool:
        return any(event.kind is Kind.LEFT_WALL and event.values["wall"] == "plane 1" for event in cell.loop.events(0))

    use.be_free()
    cell.wait(lambda: tab.handles._gizmo is None, "nothing moves a wall that holds")
    use.drag((0.0, 220.0), ended, "free-drive ends at the wall", use.be_free)
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "left")
    page.get_by_text("beyond plane 1").first.wait_for()
    cell.wait(lambda: cell.loop.latest().decision.static, "at rest")
    stopped = float(cell.position("flange")[2])
    cell.pass_time(0.5)
    assert cell.loop.latest().touches, "the hand still pulls, to a place far below"
    assert abs(float(cell.position("flange")[2]) - stopped) < 0.003
    assert moved[2] - 0.05 < stopped < moved[2] + 0.02  # a hand that pulls with all its force arrives fast
    use.let_go()


@pytest.mark.parametrize(("width", "height"), LATER)
def test_free_only_the_elbow(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    open_tab(page, "Axes")
    click(page, "All locked")
    cell.wait(lambda: not cell.loop.settings.joints.j3, "all are locked")
    elbow = page.get_by_role("checkbox", name="Elbow", exact=True)
    expect(elbow).not_to_be_checked(timeout=20_000)
    tap(elbow)
    cell.wait(lambda: cell.loop.settings.joints.j3, "the elbow is free")
    start = cell.loop.latest().truth_q.copy()

    def turned() -> np.ndarray:
        return np.degrees(np.abs(cell.loop.latest().truth_q - start))

    use = FirstUse(page, cell)
    use.drag((0.0, -160.0), lambda: turned()[2] > 5.0, "the elbow turns", use.be_free)
    assert np.delete(turned(), 2).max() < 1.5
    use.let_go()


@pytest.mark.parametrize(("width", "height"), LATER)
def test_change_the_arm(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """The server goes on, and so does the page of a second window."""
    page, other = visit(width, height), visit(width, height)
    open_tab(page, "Cell")
    choose(page, "Arm", "ur10e")
    cell.wait(lambda: cell.served.lab.setup.arm.value == "ur10e", "it is chosen")
    click(page, "Restart with this set-up")
    cell.wait(lambda: cell.loop.simulation.arm.name == "ur10e", "it runs", 120.0)
    for each in (page, other):
        each.get_by_text("Universal Robots UR10e").first.wait_for(timeout=60_000)
        each.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
    tap(other.get_by_role("button", name="EMERGENCY STOP"))
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped from the other window")
    tap(page.get_by_role("button", name="Reset", exact=True))
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "reset")
    enter_free_drive(page, cell)


@pytest.mark.parametrize(("width", "height"), LATER)
def test_a_wall_through_three_points_gets_a_name(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """The tool is jogged between the points, level with the base: the plane lies there, and above it is allowed."""
    page = visit(width, height)
    tab = cell.served.docks.walls
    open_tab(page, "Jog")
    choose(page, "Move by", "Axes of the base")
    cell.wait(lambda: cell.served.docks.jog.chosen == "base", "the frame is chosen")
    choose(page, "Stops after", "50 mm, 50°")
    cell.wait(lambda: cell.served.docks.jog.steps.value == "50 mm, 50°", "the step is chosen")
    cell.pass_time(0.5)
    open_tab(page, "Walls")
    tap(page.get_by_role("button", name="Plane through three points"))
    for count, way in ((1, ("X +", "X +")), (2, ("Y +", "Y +")), (3, ())):
        open_tab(page, "Walls")
        click(page, "Take this point")
        cell.wait(lambda count=count: len(tab.points._points) == count % 3, "taken")
        for button in way:
            open_tab(page, "Jog")
            hold_jog(page, cell, button)
    cell.wait(lambda: len(cell.loop.walls) == 1, "the plane")
    height_there = cell.loop.latest().estimate.tcp[2]
    wall = plane(cell)
    assert abs(wall.position[2] - height_there) < 0.002
    assert matrix_from_quaternion(wall.orientation)[2, 2] < -0.999, "above it is allowed"
    field = page.get_by_label("Name", exact=True).locator("visible=true").first
    field.fill("")
    field.press_sequentially("top of the table")
    cell.wait(lambda: plane(cell).name == "top of the table", "renamed")


@pytest.mark.parametrize(("width", "height"), LATER)
def test_move_the_tool_frame_and_undo_it(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """Along its z axis, which points down: the table of tools says so, and the set-up that is saved; the undo takes it back."""
    page = visit(width, height)
    tab = cell.served.docks.tools
    open_tab(page, "Tools")
    tap(page.get_by_role("checkbox", name="Edit in 3D"))
    cell.wait(lambda: not tab.frame.handles.away, "handles")
    for _ in range(6):
        at = cell.loop.latest().truth_links[-1]
        tip = at[:3] + matrix_from_quaternion(at[3:]) @ np.array([0.0, 0.0, 0.75 * FRAME_SCALE])
        pull(page, cell.pixel(page, 0, tip), 30.0)
        page.wait_for_timeout(700)
        if tab.editor.asking:
            click(page, "Yes, change the tool in use")
            cell.wait(lambda: any(cell.loop.tools[0].tcp), "it is another")
            break
    x, y, z = cell.loop.tools[0].tcp
    assert z > 0.01
    assert np.hypot(x, y) < 0.002
    kept = setup_of(
        cell.loop.simulation.arm, cell.loop.scenario, cell.loop.settings, walls=cell.loop.walls, tools=cell.loop.tools
    )
    assert [tool.tcp for tool in kept.tools if tool.name == "flange"] == [[x, y, z]]
    undo = page.get_by_role("button", name="Undo", exact=True).locator("visible=true").first
    tap(undo)
    cell.wait(lambda: not any(cell.loop.tools[0].tcp), "undone")
