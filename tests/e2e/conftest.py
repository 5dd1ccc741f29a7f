"""A real loop, served to a real Chromium with a real pointer."""

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, ViewportSize, WebError, sync_playwright

from app.files.library import load_arm
from app.log.live import LiveRecording
from app.serving import ServedArms, scripts_beside
from app.web.server import Served, serve
from sim.arm.scenario import Scenario
from sim.run.loop import Loop
from sim.simulation import Simulation
from tests.e2e.cell import SETTINGS, Cell

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-quic",
)
COARSE = "?fixedDpr=0.3"
"""Draws the scene with a tenth of the pixels, in software ten times as fast; controls stay sharp, the pointer where it is."""

NOT_OURS = (
    r"THREE\.Clock: This module has been deprecated",  # viser's client uses it
    r"GL Driver Message .*GPU stall due to ReadPixels",  # of a browser that draws in software
)
"""What a console says of the program that drew the page, and not of the page."""


def chromium_path() -> str | None:
    """Where Chromium is on this machine."""
    return next((found for name in BROWSERS if (found := shutil.which(name))), None)


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "e2e: drives a real browser")
    config.addinivalue_line("markers", "console(*patterns): what the browser says in its console of what the test does to it")
    config.addinivalue_line("markers", "every_size: a further size of the window, for `make test-full` and `make e2e-full` alone")


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium of this machine, drawing in software."""
    path = chromium_path()
    if path is None:
        pytest.fail("no Chromium found: install it, on Debian or Ubuntu with `apt-get install chromium`", pytrace=False)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
        yield chromium
        chromium.close()


@pytest.fixture(autouse=True)
def quiet_console(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, browser: Browser) -> Iterator[None]:
    """Fails a test in which the console of any page has an error or a warning, but those of `NOT_OURS` and of its mark."""
    known = re.compile("|".join((*NOT_OURS, *(one for mark in request.node.iter_markers("console") for one in mark.args))))
    told: list[str] = []
    new_context = browser.new_context

    def heard(message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not known.search(message.text):
            told.append(f"{message.type}: {message.text[:300]}")

    def raised(error: WebError) -> None:
        told.append(f"uncaught: {error.error}")

    def listened_to(**options: object) -> BrowserContext:
        context = new_context(**options)  # type: ignore[arg-type]
        context.on("console", heard)
        context.on("weberror", raised)
        return context

    monkeypatch.setattr(browser, "new_context", listened_to)
    yield
    assert told == []


@pytest.fixture
def loop() -> Iterator[Loop]:
    """The shipped UR5e in its default posture."""
    arm = load_arm("ur5e")
    running = Loop(lambda: Simulation(arm, Scenario(), SETTINGS))
    running.start()
    yield running
    running.stop()


@pytest.fixture
def served(loop: Loop) -> Iterator[Served]:
    """The web app of `loop`."""
    recording = LiveRecording(loop, Path())
    arms = ServedArms(loop, recording)
    app = serve(loop, loop.simulation.arm, loop.simulation.scenario, recording=recording, arms=arms)
    yield app
    app.close()


@pytest.fixture
def served_with_scripts(loop: Loop) -> Iterator[Served]:
    """With the tab for scripts, as `pendant serve` has it."""
    arm = loop.simulation.arm
    page = serve(loop, arm, loop.simulation.scenario, scripts=scripts_beside(loop, arm))
    yield page
    page.close()


@pytest.fixture
def cell(loop: Loop, served: Served) -> Cell:
    """Loop and web app, and what tests measure on them."""
    return Cell(loop, served)


@pytest.fixture
def visit(browser: Browser, cell: Cell) -> Iterator[Callable[..., Page]]:
    """Opens the page in a window of its own, and waits until it is there.

    A window of another size has it from the beginning: after a change of size, viser's panels glide at the next change of theirs.
    An upright one is a tablet's, with fingers in place of the mouse.
    """
    pages: list[Page] = []

    def open_page(width: int = 1280, height: int = 800, touch: bool | None = None) -> Page:
        touch = width < height if touch is None else touch
        size = ViewportSize(width=width, height=height)
        page = browser.new_context(viewport=size, has_touch=touch, is_mobile=touch).new_page()
        pages.append(page)
        page.goto(f"{cell.served.url}/{COARSE}")
        page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
        page.add_style_tag(content=".mantine-Notification-root { display: none }")
        cell.wait(lambda: len(cell.served.control._strips) == len(pages), "the page is connected", 60.0)
        return page

    yield open_page
    for page in pages:
        if not page.is_closed():
            page.context.close()
