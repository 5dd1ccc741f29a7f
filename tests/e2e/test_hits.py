"""An arm that hits the table: the page says so and marks the place, and nothing moves on its own afterwards."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page, expect

from app.files.library import load_arm
from app.web.server import Served
from pendant.events.event import Event, Kind
from pendant.tick.modes import Mode, Safety
from sim.arm.scenario import BoxObject, Scenario, ToolModel
from sim.run.loop import Loop
from sim.simulation import Simulation
from tests.e2e.cell import SETTINGS, Cell
from tests.e2e.finger import middle, pointer
from tests.e2e.test_everyday import open_tab
from tests.e2e.test_tasks import choose, endings

pytestmark = pytest.mark.e2e

ROD = ToolModel(name="rod", mass=0.3, com=[0.0, 0.0, 0.05], tcp=[0.0, 0.0, 0.15], length=0.15, radius=0.02)
TABLE = BoxObject(name="table", position=[-0.6283, -0.1334, 0.06], size=[0.5, 0.7, 0.12])
"""Its top is 73 mm below the rod's end in the arm's first posture."""

DOWN = "def down():\n  p = get_actual_tcp_pose()\n  p[2] = p[2] - 0.6\n  movel(p, a=1, v=0.25)\nend\n"
PRESSES = 5
"""At most."""

STILL = 0.001
"""An arm that stands in its brake creeps by less in a second [m]."""


@pytest.fixture
def loop() -> Iterator[Loop]:
    """A UR5e with a rod as its tool over a table."""
    arm = load_arm("ur5e")
    running = Loop(lambda: Simulation(arm, Scenario(tool=ROD, world=[TABLE]), SETTINGS))
    running.start()
    yield running
    running.stop()


@pytest.fixture
def served(served_with_scripts: Served) -> Served:
    return served_with_scripts


def hit_of(cell: Cell) -> Event:
    """The collision, once the arm is stopped by it."""
    cell.wait(lambda: cell.happened(Kind.COLLISION), "a collision", 40.0)
    cell.wait(lambda: cell.loop.latest().decision.safety is Safety.PROTECTIVE_STOP, "stopped")
    return next(event for event in cell.loop.events(0) if event.kind is Kind.COLLISION)


def told(page: Page, cell: Cell, hit: Event) -> None:
    """The page tells the stop, and marks where the tool was."""
    expect(page.locator(".pd-light")).to_contain_text("PROTECTIVE STOP", timeout=20_000)
    expect(page.locator(".pd-light")).not_to_contain_text("Ready")
    expect(page.locator(".pd-note").first).to_contain_text("collision")
    mark = cell.served.panel.hit
    cell.wait(lambda: mark.ball.visible, "the place is marked")
    assert mark.label.text.startswith("Tool: ")
    assert f"{float(hit.values['force']):.0f} N" in mark.label.text
    assert np.linalg.norm(np.asarray(mark.ball.position) - tip(cell)) < 0.03
    open_tab(page, "Contacts")
    expect(page.locator(".pd-contacts")).to_contain_text("collision")


def tip(cell: Cell) -> NDArray[np.float64]:
    """The true tool centre point, in W [m]."""
    return cell.position("flange", (0.0, 0.0, 0.15))


def stays(cell: Cell) -> None:
    """Nothing moves within a second."""
    before = tip(cell)
    cell.pass_time(1.0)
    assert np.linalg.norm(tip(cell) - before) < STILL, cell.told()


def test_a_jog_that_is_held_into_the_table_is_stopped_and_stays_there_after_the_release(
    visit: Callable[..., Page], cell: Cell
) -> None:
    page = visit(1440, 900)
    open_tab(page, "Jog")
    choose(page, "Move by", "Axes of the base")
    cell.wait(lambda: cell.served.docks.jog.chosen == "base", "the frame is chosen")
    cell.pass_time(0.5)
    hand, at = pointer(page), middle(page.get_by_role("button", name="Z −", exact=True))
    for _ in range(PRESSES):  # a page that stalls counts as let go
        before = len(endings(cell))
        hand.down(at)
        cell.wait(lambda before=before: cell.happened(Kind.COLLISION) or len(endings(cell)) > before, "it hits, or stops", 40.0)
        if cell.happened(Kind.COLLISION):
            break
        hand.up()
        cell.pass_time(0.6)
    hit = hit_of(cell)
    cell.pass_time(1.0)
    hand.up()
    told(page, cell, hit)
    stays(cell)
    page.get_by_role("button", name="Reset", exact=True).click()
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "reset")
    cell.wait(lambda: not cell.served.panel.hit.ball.visible, "the mark has gone")
    stays(cell)


def test_a_script_into_the_table_is_stopped_and_ends(visit: Callable[..., Page], cell: Cell) -> None:
    page = visit(1440, 900)
    open_tab(page, "Script")
    page.locator("textarea:visible").first.fill(DOWN)
    cell.wait(lambda: cell.served.docks.script is not None and "down" in str(cell.served.docks.script.text.value), "typed")
    page.locator(".pd-left").get_by_role("button", name="Run", exact=True).last.click()
    hit = hit_of(cell)
    told(page, cell, hit)
    stays(cell)
    assert not cell.happened(Kind.PROGRAM_FINISHED)
