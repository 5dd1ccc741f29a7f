"""The page opened to a network, in a browser that has been given the link; its keys, its colours, its sound."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from app.web.server import Served, serve
from pendant.tick.modes import Mode
from sim.run.loop import Loop
from tests.e2e.cell import Cell

pytestmark = pytest.mark.e2e
EVIL = '<img src=x onerror="window.evil=1">'
HEARD = """() => window.__VISER_AUDIO__.debug().some(
    clip => clip.name === "/sound/STOP" && clip.contextState === "running" && clip.position > 0)"""


@pytest.fixture
def network(loop: Loop) -> Iterator[Served]:
    """The web app of `loop`, listening everywhere."""
    app = serve(loop, loop.simulation.arm, loop.simulation.scenario, host="0.0.0.0")
    yield app
    app.close()


@pytest.mark.console("the server responded with a status of 401")
def test_the_link_lets_in_and_a_text_stays_a_text(browser: Browser, network: Served) -> None:
    here = f"http://127.0.0.1:{network.server.get_port()}"
    page = browser.new_context().new_page()
    answer = page.goto(here)
    assert answer is not None
    assert answer.status == 401
    page.get_by_text("open the link that pendant has printed").wait_for()
    page.goto(f"{here}/?token={network.access.token}")
    assert page.url == f"{here}/"
    page.get_by_role("button", name="Take").click(timeout=60_000)
    page.get_by_text("You have control").wait_for()
    page.get_by_role("button", name="Register waypoint").click()
    name = page.locator(".mantine-TextInput-input:visible")
    expect(name).not_to_have_value("")  # the name that the new waypoint was given, after which it may be another
    name.fill(EVIL)
    expect(page.get_by_role("combobox", name="Waypoint")).to_have_value(EVIL)
    page.get_by_role("radio", name=f"1. Move to {EVIL}").wait_for()
    assert page.evaluate("window.evil") is None
    assert set(network.guard.refused) == {"no token"}
    page.context.close()


def test_keys_switch_colours_and_sound_and_stop_the_arm(visit: Callable[[], Page], cell: Cell) -> None:
    page = visit()
    page.keyboard.press("t")
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    page.keyboard.press("b")
    cell.wait(lambda: cell.served.preferences._pages[0].speaker is not None, "sound")
    page.get_by_role("button", name="Take").click()
    page.keyboard.press("x")
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped")
    page.wait_for_function(HEARD)
    page.get_by_text("Emergency stop", exact=True).first.wait_for()
    assert page.get_by_role("button", name="Enable audio").count() == 0
