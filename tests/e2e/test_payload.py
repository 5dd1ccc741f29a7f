"""A payload that nobody knows is measured on the page, and free-drive is entered with it."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page

from pendant.events.event import Kind
from sim.arm.scenario import Load
from sim.plant.changes import AttachPayload
from tests.e2e.cell import Cell
from tests.e2e.hold import enter_free_drive
from tests.e2e.test_everyday import open_tab
from tests.e2e.test_tasks import LATER, click

pytestmark = pytest.mark.e2e

MASS, ERROR = 2.0, 0.046
"""On the arm, and the largest error of docs/guide/tools.md [kg]."""


@pytest.mark.parametrize(("width", "height"), LATER)
def test_measure_the_payload(visit: Callable[..., Page], cell: Cell, width: int, height: int) -> None:
    page = visit(width, height)
    cell.loop.desk.change(AttachPayload(load=Load(mass=MASS, com=[0.02, 0.0, 0.06])))
    cell.pass_time(2.0)
    open_tab(page, "Tools")
    click(page, "Measure the payload")
    page.get_by_text("The arm measures its payload").first.wait_for()
    cell.wait(lambda: cell.happened(Kind.WIZARD_FINISHED), "measured", 90.0)
    page.get_by_text("2.0", exact=False).first.wait_for()
    click(page, "Use this payload")
    cell.wait(lambda: cell.happened(Kind.PAYLOAD_CHANGED), "taken")
    fitting = cell.loop.latest().decision.estimator.fitting
    assert fitting is not None
    assert abs(fitting.load.mass - MASS) < ERROR
    cell.pass_time(0.5)
    enter_free_drive(page, cell)
    assert not cell.happened(Kind.REFUSED_PAYLOAD)


@pytest.mark.parametrize(("width", "height"), LATER)
def test_stop_measuring(visit: Callable[..., Page], cell: Cell, width: int, height: int) -> None:
    """On the page's button, and the arm comes to rest."""
    page = visit(width, height)
    cell.pass_time(1.0)
    open_tab(page, "Tools")
    click(page, "Measure the payload")
    cell.wait(lambda: cell.happened(Kind.POSTURE_MEASURED), "the first posture", 20.0)
    cell.pass_time(1.0)
    click(page, "Stop measuring")
    cell.wait(lambda: cell.happened(Kind.WIZARD_STOPPED), "stopped")
    cell.wait(lambda: cell.loop.latest().decision.static, "at rest")
    page.get_by_role("button", name="Stop measuring").wait_for(state="hidden")
