"""Makes the pictures in docs/images: python -m docs.screenshots, from the repository's root. Needs Chromium."""

import shutil
import time
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, ViewportSize, sync_playwright

from app.library import load_arm, load_tool, tools
from app.web.server import serve
from pendant.events import Kind
from pendant.inputs import Command
from pendant.modes import Phase
from pendant.program import JointMove, Program, Wait
from pendant.settings import Settings, apply
from sim.changes import AttachPayload
from sim.loop import Loop
from sim.scenario import Load, Scenario
from sim.simulation import Simulation
from tests.e2e.cell import Cell
from tests.e2e.conftest import FLAGS

IMAGES = Path(__file__).parent / "images"


def refused(page: Page, cell: Cell) -> None:
    """The arm carries 2 kg more than configured, and its entry is refused."""
    page.get_by_role("tab", name="Lab").click()
    cell.loop.desk.change(AttachPayload(load=Load(mass=2.0)))
    hold(page, cell, lambda: cell.happened(Kind.REFUSED_PAYLOAD))


def guided(page: Page, cell: Cell) -> None:
    """The arm is pulled in free-drive, with the force plotted."""
    page.get_by_role("button", name="Register waypoint").click()
    page.get_by_role("tab", name="Plots").click()
    hold(page, cell, lambda: cell.loop.latest().decision.phase is Phase.HELD)
    cell.drag(page, 0, cell.position("wrist_3"), (-40.0, -90.0))
    time.sleep(2.5)


def touched(page: Page, cell: Cell) -> None:
    """A program has touched the table."""
    page.get_by_role("tab", name="Lab").click()
    cell.served.lab.scenarios.choice.value = "Down onto the table until it touches"
    page.get_by_role("button", name="Play").click()
    page.get_by_role("tab", name="Contacts").click()
    cell.wait(lambda: cell.happened(Kind.CONTACT_GAINED), "the table", 60.0)
    page.get_by_role("cell", name="gained").first.wait_for()


def weighed(page: Page, cell: Cell) -> None:
    """The payload wizard has been through four wrist postures of an arm that carries 2 kg."""
    page.get_by_role("tab", name="Tools").click()
    cell.loop.desk.change(AttachPayload(load=Load(mass=2.0, com=[0.02, 0.0, 0.06])))
    home = list(cell.loop.simulation.arm.chain.home)
    for number, (tilt, turn) in enumerate(((0.0, 0.0), (0.8, 0.0), (0.8, 1.5), (-0.8, 1.5)), 1):
        ended = times(cell, Kind.PROGRAM_FINISHED) + 1
        q = (*home[:4], home[4] + tilt, home[5] + turn)
        cell.loop.desk.load(Program(steps=(JointMove(q=q, speed=0.5), Wait(duration=0.5))))
        cell.pass_time(1.0)
        cell.loop.desk.command(Command.START_PROGRAM)
        cell.wait(lambda n=ended: times(cell, Kind.PROGRAM_FINISHED) == n, "the posture", 60.0)
        page.get_by_role("button", name="Measure this posture").click()
        cell.wait(lambda n=number: times(cell, Kind.POSTURE_MEASURED) == n, "the measurement", 30.0)
    page.get_by_role("button", name="Begin again").scroll_into_view_if_needed()
    time.sleep(1.5)


def times(cell: Cell, kind: Kind) -> int:
    """How often an event of a kind has happened."""
    return sum(event.kind is kind for event in cell.loop.events(0))


def hold(page: Page, cell: Cell, until: Callable[[], bool]) -> None:
    """Hold the free-drive button until something is so, and let it go."""
    box = page.get_by_role("button", name="Hold for free-drive").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 90, box["y"] + 20)
    page.mouse.down()
    cell.wait(until, "what the picture shows")
    page.mouse.up()
    time.sleep(0.7)


PICTURES = {
    "page": (guided, ViewportSize(width=1280, height=800)),
    "refused": (refused, ViewportSize(width=1024, height=768)),
    "tools": (weighed, ViewportSize(width=1280, height=800)),
    "contact": (touched, ViewportSize(width=1280, height=800)),
}


def main() -> None:
    """Take every picture with an arm of its own."""
    scenario = Scenario(tools=[load_tool(name) for name in tools()])
    arm, settings = load_arm("ur5e"), apply(Settings(), {"free_drive.period": 30.0})
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        for name, (act, size) in PICTURES.items():
            loop = Loop(lambda: Simulation(arm, scenario, settings))
            loop.start()
            served = serve(loop, arm, scenario)
            page = browser.new_context(viewport=size).new_page()
            page.goto(served.url)
            page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
            page.add_style_tag(content=".mantine-Notification-root { display: none }")
            time.sleep(1.5)
            act(page, Cell(loop, served))
            page.screenshot(path=IMAGES / f"{name}.png")
            page.context.close()
            served.close()
            loop.stop()
        browser.close()


if __name__ == "__main__":
    main()
