"""Makes the pictures in docs/images: python -m tools.screenshots, from the repository's root. Needs Chromium."""

import io
import itertools
import math
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from app.files.library import load_arm, load_tool, tools
from app.web.server import serve
from pendant.events.event import Kind
from pendant.tick.modes import TICK_RATE, Phase
from pendant.walls.definitions import AnyBorder, Area, Policy, Wall
from pendant.walls.settings import Reaction
from pendant.walls.shapes import Box, HalfSpace
from sim.arm.scenario import Load, Scenario
from sim.plant.changes import AttachPayload
from sim.plant.touch import Pull
from sim.run.loop import Loop
from sim.simulation import Simulation
from tests.e2e.cell import SETTINGS, Cell
from tests.e2e.conftest import FLAGS
from tests.e2e.finger import middle
from tests.e2e.first_use import FirstUse
from tests.e2e.hold import COOL_DOWN, enter_free_drive, hold_until

IMAGES = Path(__file__).parent.parent / "docs" / "images"


def guided(page: Page, cell: Cell) -> None:
    """The arm is pulled in free-drive, with the force plotted."""
    page.get_by_role("button", name="Register waypoint").click()
    page.get_by_role("tab", name="Plots").click()
    enter_free_drive(page, cell)
    cell.drag(page, 0, cell.position("wrist_3"), (-40.0, -90.0))
    time.sleep(1.5)


def walled(page: Page, cell: Cell) -> None:
    """The flange is pushed down to a plane that it can be walked down with; a cart is kept out of, a table lies below."""
    enter_free_drive(page, cell)
    x, y, z = cell.position("wrist_3")
    cell.loop.desk.touch("hand", Pull("wrist_3", (0.0, 0.0, 0.0), (x, y, z - 0.15), 20.0))
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
    page.evaluate("document.querySelector('.pd-light').scrollIntoView()")
    page.mouse.move(500.0, 500.0)  # a control under it would explain itself
    time.sleep(1.0)


def weighed(page: Page, cell: Cell) -> None:
    """The payload wizard has turned the wrist of an arm that carries 2 kg through its postures."""
    page.get_by_role("tab", name="Tools").click()
    cell.loop.desk.change(AttachPayload(load=Load(mass=2.0, com=[0.02, 0.0, 0.06])))
    cell.pass_time(2.0)
    page.get_by_role("button", name="Measure the payload").click()
    cell.wait(lambda: times(cell, Kind.WIZARD_FINISHED) == 1, "the postures", 120.0)
    time.sleep(1.5)


def led(page: Page, cell: Cell) -> Iterator[None]:
    """Frame by frame: the button is held until free-drive is on, then a hand leads the flange up and back, and lets go."""
    button, mouse = page.locator(f'[id="{cell.served.panel.free_drive._impl.uuid}"]'), page.mouse
    x, y = middle(button)
    mouse.move(x - 200.0, y + 100.0)
    yield from itertools.repeat(None, 3)
    mouse.move(x, y)
    yield
    mouse.down()
    for _ in range(MOST_FRAMES):
        yield
        if cell.loop.latest().decision.phase is Phase.HELD:
            break
    else:
        raise RuntimeError(f"free-drive did not begin: {cell.told()}")
    yield from itertools.repeat(None, 5)
    mouse.up()
    yield from itertools.repeat(None, 2)
    start = cell.pixel(page, 0, cell.position("wrist_3"))
    for k in range(1, 4):  # to the arm, in view
        mouse.move(x + (start[0] - x) * k / 3, y + (start[1] - y) * k / 3)
        yield
    cell.wait(lambda: cell._on_the_arm(page, *start), "the pointer is on the arm")
    mouse.down()
    for right, down in PULLED:
        mouse.move(start[0] + right, start[1] + down)
        yield
    mouse.up()
    yield from itertools.repeat(None, 8)


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
    Wall(name="step down", policy=Policy.USER, reaction=Reaction.STAY, shape=HalfSpace(normal=(0.0, 0.0, -1.0), distance=0.1)),
)
PICTURES = {
    "page": Picture(guided),
    "tools": Picture(weighed),
    "walls": Picture(walled, walls=WALLS),
    "way-back": Picture(led_back),
    "confirm": Picture(asked, 1024, 768),
}
WINDOWS = ((1280, 800), (1024, 768))


FILMS = {"guided": led}
FILM = Picture(guided, 1024, 640)
FRAME = 0.1
"""Simulated time from one frame of a film to the next, which is the time that it is shown [s]."""
SLOWED = 0.05
"""Share of real time at which a film is taken: in software a browser draws a few pictures a second."""
MOST_FRAMES = 60
"""Until free-drive is on."""
PULLED = [(-40.0 * math.sin(a), -80.0 * math.sin(0.5 * a)) for a in np.linspace(0.0, 2.0 * math.pi, 30)]
"""Where the pointer pulls to, from where it took hold [pixels]: a loop up and back."""
POINTER = """() => {
    const disc = document.createElement("div");
    disc.style = "position:fixed;z-index:9999;width:22px;height:22px;margin:-11px;border-radius:50%;border:2px solid #212529;" +
        "pointer-events:none;background:#ffffff99";
    document.body.append(disc);
    const at = event => { disc.style.left = event.clientX + "px"; disc.style.top = event.clientY + "px"; };
    const press = event => { disc.style.background = event.type === "pointerdown" ? "#e8590c" : "#ffffff99"; at(event); };
    for (const kind of ["pointermove", "mousemove"]) addEventListener(kind, at, true);
    for (const kind of ["pointerdown", "pointerup"]) addEventListener(kind, press, true);
}"""
"""A disc where the pointer is, filled while it presses: a picture of the page has no pointer."""


def film(page: Page, cell: Cell, name: str) -> None:
    """Take a moving picture: simulated time is slowed, and a frame is taken when it is due."""
    page.add_style_tag(content=".pd-pace { visibility: hidden }")  # it tells the pace of the filming
    page.evaluate(POINTER)
    page.get_by_role("button", name="No, thanks").click()
    page.get_by_role("button", name="Collapse panel area").first.click()
    time.sleep(1.0)
    cell.loop.speed = SLOWED
    frames, due = [], cell.loop.latest().tick
    for _ in FILMS[name](page, cell):
        due += round(FRAME * TICK_RATE)
        cell.wait(lambda due=due: cell.loop.latest().tick >= due, "the next frame")
        frames.append(Image.open(io.BytesIO(page.screenshot())).convert("RGB"))
    first, *others = frames
    target = IMAGES / f"{name}.webp"
    first.save(target, save_all=True, append_images=others, duration=round(1000 * FRAME), loop=0, quality=60, method=4)


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
    chosen = sys.argv[1:] or [*PICTURES, *FILMS, *(f"first-use-{width}" for width, _ in WINDOWS)]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        for name in [name for name in chosen if name in PICTURES]:
            with cell_at(browser, PICTURES[name]) as (page, cell):
                PICTURES[name].act(page, cell)
                shoot(page, name)
        for name in [name for name in chosen if name in FILMS]:
            with cell_at(browser, FILM) as (page, cell):
                film(page, cell, name)
        for width, height in [size for size in WINDOWS if f"first-use-{size[0]}" in chosen]:
            with cell_at(browser, Picture(guided, width, height)) as (page, cell):

                def see(state: str, page: Page = page, width: int = width) -> None:
                    time.sleep(0.5)
                    shoot(page, f"first-use-{state}-{width}")

                FirstUse(page, cell, see).walk()
        browser.close()


if __name__ == "__main__":
    main()
