"""Makes the pictures in docs/images: python -m tools.screenshots, from the repository's root. Needs Chromium."""

import io
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from PIL import Image
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from app.files.library import load_arm, load_tool, tools
from app.web.server import serve
from pendant.events.event import Kind
from pendant.tick.modes import Phase
from pendant.walls.definitions import AnyBorder, Area, Policy, Wall
from pendant.walls.shapes import Box, HalfSpace
from sim.arm.scenario import Load, Scenario
from sim.plant.changes import AttachPayload
from sim.plant.touch import Pull
from sim.run.loop import Loop
from sim.simulation import Simulation
from tests.e2e.cell import SETTINGS, Cell
from tests.e2e.conftest import FLAGS
from tests.e2e.first_use import FirstUse
from tests.e2e.hold import COOL_DOWN, enter_free_drive, hold_until

IMAGES = Path(__file__).parent.parent / "docs" / "images"


def guided(page: Page, cell: Cell) -> None:
    """The arm is pulled in free-drive, with the force plotted."""
    page.get_by_role("button", name="Register waypoint").click()
    page.get_by_role("tab", name="Plots").click()
    enter_free_drive(page, cell)
    cell.drag(page, 0, cell.position("wrist_3"), (-40.0, -90.0))
    time.sleep(2.5)


def walled(page: Page, cell: Cell) -> None:
    """The flange is pushed down to a plane that it can be walked down with; a cart is kept out of, a table lies below."""
    enter_free_drive(page, cell)
    x, y, z = cell.position("wrist_3")
    cell.loop.desk.touch("hand", Pull("wrist_3", (0.0, 0.0, 0.0), (x, y, z - 0.15), 40.0))
    cell.wait(lambda: any(wall.near > 0.5 and wall.name == "step down" for wall in cell.loop.latest().decision.walls), "the wall")
    time.sleep(6.0)  # the page is behind


def led_back(page: Page, cell: Cell) -> None:
    """A hand has carried the flange beyond a fence, and the way back is told."""
    page.get_by_role("tab", name="Lab").click()
    cell.served.lab.scenarios.choice.value = "The way back is told"
    page.get_by_role("button", name="Play").click()
    cell.wait(lambda: cell.happened(Kind.LEFT_WALL), "the fence", 60.0)
    page.get_by_text("To return to where free-drive began").first.wait_for()
    cell.pass_time(COOL_DOWN)


def asked(page: Page, cell: Cell) -> None:
    """The robot waits for a confirmation; what starts free-drive is unfolded."""
    cell.loop.desk.set({"handshake.on": True, "handshake.window": 10.0})
    cell.pass_time(0.2)
    page.get_by_text("Free-drive starts by").click()
    hold_until(page, cell, lambda: cell.loop.latest().decision.phase is Phase.FEEDBACK, "asked")
    page.mouse.up()
    cell.wait(lambda: cell.loop.latest().decision.phase is Phase.CONFIRM, "the confirmation")
    time.sleep(1.0)


def weighed(page: Page, cell: Cell) -> None:
    """The payload wizard has turned the wrist of an arm that carries 2 kg through its postures."""
    page.get_by_role("tab", name="Tools").click()
    cell.loop.desk.change(AttachPayload(load=Load(mass=2.0, com=[0.02, 0.0, 0.06])))
    cell.pass_time(2.0)
    page.get_by_role("button", name="Measure the payload").click()
    cell.wait(lambda: times(cell, Kind.WIZARD_FINISHED) == 1, "the postures", 120.0)
    time.sleep(1.5)


def times(cell: Cell, kind: Kind) -> int:
    """How often an event of a kind has happened."""
    return sum(event.kind is kind for event in cell.loop.events(0))


class Picture(NamedTuple):
    """What a page of its own does before its picture is taken, in a window of a size, with walls."""

    act: Callable[[Page, Cell], None]
    width: int = 1280
    height: int = 800
    walls: tuple[AnyBorder, ...] = ()


WALLS = (
    Area(name="table", reference="world", position=(0.0, 0.0, 0.05), shape=HalfSpace(normal=(0.0, 0.0, -1.0))),
    Area(name="cart", position=(-0.3, 0.65, 0.25), shape=Box(size=(0.3, 0.4, 0.5)), keep_out=True),
    Wall(name="step down", policy=Policy.USER, shape=HalfSpace(normal=(0.0, 0.0, -1.0), distance=0.1)),
)
PICTURES = {
    "page": Picture(guided),
    "tools": Picture(weighed),
    "walls": Picture(walled, walls=WALLS),
    "way-back": Picture(led_back),
    "confirm": Picture(asked, 1024, 768),
}
WINDOWS = ((1280, 800), (1024, 768))


def shoot(page: Page, name: str) -> None:
    """Take a picture; as WebP, which takes a quarter of the room of PNG."""
    Image.open(io.BytesIO(page.screenshot())).convert("RGB").save(IMAGES / f"{name}.webp", quality=85, method=6)


@contextmanager
def cell_at(browser: Browser, picture: Picture) -> Iterator[tuple[Page, Cell]]:
    """An arm of its own, and its page."""
    scenario = Scenario(tools=[load_tool(name) for name in tools()], walls=list(picture.walls))
    arm = load_arm("ur5e")
    loop = Loop(lambda: Simulation(arm, scenario, SETTINGS))
    loop.start()
    served = serve(loop, arm, scenario)
    page = browser.new_context(viewport=ViewportSize(width=picture.width, height=picture.height)).new_page()
    page.goto(served.url)
    page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
    page.add_style_tag(content=".mantine-Notification-root { display: none }")
    time.sleep(1.5)
    yield page, Cell(loop, served)
    page.context.close()
    served.close()
    loop.stop()


def main() -> None:
    """Take every picture, or those that are named: `first-use-1280`, `first-use-1024`, and the names above."""
    chosen = sys.argv[1:] or [*PICTURES, *(f"first-use-{width}" for width, _ in WINDOWS)]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        for name in [name for name in chosen if name in PICTURES]:
            with cell_at(browser, PICTURES[name]) as (page, cell):
                PICTURES[name].act(page, cell)
                shoot(page, name)
        for width, height in [size for size in WINDOWS if f"first-use-{size[0]}" in chosen]:
            with cell_at(browser, Picture(guided, width, height)) as (page, cell):

                def see(state: str, page: Page = page, width: int = width) -> None:
                    time.sleep(0.5)
                    shoot(page, f"first-use-{state}-{width}")

                FirstUse(page, cell, see).walk()
        browser.close()


if __name__ == "__main__":
    main()
