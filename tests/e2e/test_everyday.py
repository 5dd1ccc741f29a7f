"""Everyday tasks beside programs: settings, payload, sensor, files, a second window; each with a real pointer."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page

from app.web.server import serve
from pendant.events.event import Kind
from pendant.tick.modes import Mode
from tests.e2e.cell import SETTINGS, Cell
from tests.e2e.finger import tap
from tests.e2e.first_use import FirstUse
from tests.e2e.test_tasks import BY_FINGER, LATER, SIZES, choose, click

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]


def open_tab(page: Page, name: str) -> None:
    """Press a tab."""
    tap(page.get_by_role("tab", name=name, exact=True))


@pytest.mark.parametrize(("width", "height"), BY_FINGER)
def test_change_the_free_drive_period_and_undo_it(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    open_tab(page, "Settings")
    field = page.get_by_label(re.compile("Free-drive, no motion"))
    field.scroll_into_view_if_needed()
    field.fill("8")
    field.press("Enter")
    cell.wait(lambda: cell.loop.settings.free_drive.period == 8.0, "eight seconds")
    click(page, "Undo")
    cell.wait(lambda: cell.loop.settings == SETTINGS, "as before")


@pytest.mark.parametrize(("width", "height"), LATER)
def test_take_the_classroom_preset(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    open_tab(page, "Settings")
    click(page, "Presets")
    page.get_by_role("button", name="Take this preset").wait_for()
    choose(page, "Preset", "Classroom")
    page.get_by_text("For many hands at one arm").wait_for()
    click(page, "Take this preset")
    cell.wait(lambda: cell.loop.settings.program.speed == 0.5, "taken")


@pytest.mark.parametrize(("width", "height"), LATER)
def test_find_why_free_drive_was_refused(visit: Visit, cell: Cell, width: int, height: int) -> None:
    FirstUse(visit(width, height), cell).be_refused()


@pytest.mark.parametrize(("width", "height"), LATER)
def test_zero_the_sensor(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    cell.pass_time(2.0)
    open_tab(page, "Tools")
    click(page, "Zero the force sensor")
    cell.wait(lambda: cell.happened(Kind.SENSOR_ZEROED), "zeroed")
    page.get_by_text("Force sensor zeroed").first.wait_for()


@pytest.mark.parametrize(("width", "height"), LATER)
def test_stop_from_a_second_window(visit: Visit, cell: Cell, width: int, height: int) -> None:
    first, second = visit(width, height), visit(width, height)
    tap(first.get_by_role("button", name="Take"))
    second.get_by_text("Window 1 has control").wait_for()
    tap(second.get_by_role("button", name="EMERGENCY STOP"))
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped")
    first.get_by_text("Emergency stop", exact=True).first.wait_for()


@pytest.mark.console("ERR_CONNECTION_REFUSED", "WebSocket connection to")  # the server is started anew
@pytest.mark.parametrize(("width", "height"), SIZES)
def test_save_a_program_restart_and_load_it(visit: Visit, cell: Cell, tmp_path: Path, width: int, height: int) -> None:
    """The page of another server knows nothing of it until the file is loaded; a file that is none gets a line."""
    page = visit(width, height)
    tap(page.get_by_role("button", name="Register waypoint"))
    teach = cell.served.docks.teach
    cell.wait(lambda: len(teach.lesson.waypoints) == 1, "a waypoint")
    with page.expect_download() as saved:
        click(page, "Save as file")
    path = tmp_path / "taught.yaml"
    saved.value.save_as(path)
    other = serve(cell.loop, cell.loop.simulation.arm, cell.loop.simulation.scenario)
    try:
        again = Cell(cell.loop, other)
        page.goto(f"{other.url}/?fixedDpr=0.3")
        page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
        again.wait(lambda: len(other.control._strips) == 1, "the page is connected", 60.0)
        (tmp_path / "wrong.yaml").write_text("waypoints: [{name: P1}]")
        for name in ("wrong.yaml", "taught.yaml"):
            with page.expect_file_chooser() as chooser:
                click(page, "Load a file")
            chooser.value.set_files(tmp_path / name)
            if name == "wrong.yaml":
                page.get_by_text("File refused").wait_for()
                assert other.docks.teach.lesson.waypoints == []
        again.wait(lambda: other.docks.teach.lesson == teach.lesson, "loaded")
        page.get_by_role("radio", name="1. Move to P1").wait_for()
    finally:
        other.close()
