"""The page for everybody: by keyboard, by finger, read aloud, in every size; after a reload and without a connection."""

from collections.abc import Callable
from itertools import zip_longest

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, expect

from app.web.server import serve
from pendant.tick.modes import Mode
from sim.run.loop import Loop
from tests.e2e.cell import Cell
from tests.e2e.conftest import COARSE
from tests.e2e.finger import middle, tap

pytestmark = pytest.mark.e2e
Visit = Callable[..., Page]

UPPER = ("Jog", "Axes", "Walls", "Tools", "Cell", "Lab", "Settings", "Teach")
LOWER = ("Contacts", "Plots", "Record", "Events")
"""Tabs of the two docks, of which one each is seen at once."""

FURTHER = [pytest.param(*size, marks=pytest.mark.every_size) for size in ((1024, 768), (1280, 800), (1440, 900), (1920, 1080))]
SIZES = [(820, 1180), *FURTHER]
NARROW = [(1024, 768), pytest.param(820, 1180, marks=pytest.mark.every_size)]
GRAVE = ("serious", "critical")
BORDER = '[data-dock-region="left"] [data-dock-divider="column"]'

CUT = """() => {
  const seen = (e) => {
    const r = e.getBoundingClientRect();
    return r.width > 1 && r.height > 1 && getComputedStyle(e).visibility !== "hidden";
  };
  const wrong = [];
  const kinds = ["label", "[role=tab]", ".mantine-Button-label", ".pd-light *", ".pd-note *", ".pd-who *", ".pd-facts *",
    ".pd-cards *", ".pd-log td", ".pd-loads *", ".pd-fine", ".pd-diff td"];
  const texts = [...document.querySelectorAll(kinds.join(","))];
  for (const e of texts) {
    if (!seen(e) || !e.textContent.trim()) continue;
    const block = getComputedStyle(e).display !== "inline" && e.clientWidth > 0;
    if (block && e.scrollWidth > e.clientWidth + 1) wrong.push(["cut", e.textContent.trim().slice(0, 60)]);
    const range = document.createRange(); range.selectNodeContents(e);
    const box = range.getBoundingClientRect();
    for (let p = e.parentElement; p; p = p.parentElement) {
      const style = getComputedStyle(p);
      if (style.overflowX === "visible" || style.overflowX === "clip") continue;
      const room = p.getBoundingClientRect();
      if (box.right > room.right + 1 || box.left < room.left - 1) wrong.push(["beyond", e.textContent.trim().slice(0, 60)]);
      break;
    }
  }
  for (const label of document.querySelectorAll("label[for]")) {
    const control = document.getElementById(label.htmlFor);
    if (!control || !seen(label) || !seen(control)) continue;
    const a = label.getBoundingClientRect(), b = control.getBoundingClientRect();
    if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1)
      wrong.push(["over its control", label.textContent.trim()]);
  }
  return wrong;
}"""
"""Texts that are wider than their place, leave the part that scrolls, or lie over their control."""


def ready(page: Page) -> Page:
    """A page whose opening picture has gone, and whose names are given."""
    expect(page.locator("#pd-opening")).to_have_count(0, timeout=30_000)
    expect(page.locator("canvas[role=img]")).to_have_count(1)
    return page


def tabs(page: Page, see: Callable[[str], None], settle: float = 600.0) -> None:
    """Open every tab, one of each dock at a time; `settle` [ms] is longer than the page takes to name what is new."""
    for upper, lower in zip_longest(UPPER, LOWER, fillvalue=LOWER[-1]):
        for tab in (upper, lower):
            one = page.get_by_role("tab", name=tab, exact=True)
            tap(one)
            expect(one).to_have_attribute("aria-selected", "true")
        page.wait_for_timeout(settle)
        see(f"{upper}, {lower}")


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_axe_finds_nothing_serious_on_any_tab_and_no_text_is_cut(visit: Visit, width: int, height: int) -> None:
    """Everything in the light; of the dark what it changes, which is contrast."""
    page, axe = ready(visit(width, height)), Axe()
    found: list[object] = []

    def grave(where: str, within: str = ".pd-left", **options: object) -> None:
        for issue in axe.run(page, within, {"resultTypes": ["violations"], **options}).response["violations"]:
            if issue["impact"] in GRAVE:
                found.extend(f"{where}: {issue['id']} {node['html'][:120]}" for node in issue["nodes"])

    def look(where: str) -> None:
        grave(where)
        found.extend((where, *cut) for cut in page.evaluate(CUT))

    tabs(page, look)
    grave("all", "html")  # what no tab changes is looked at once
    page.keyboard.press("t")
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    tabs(page, lambda where: grave(f"dark, {where}", runOnly=["color-contrast"]), settle=0)
    grave("dark, all", "html", runOnly=["color-contrast"])
    assert found == []


@pytest.mark.parametrize(("width", "height"), NARROW)
def test_what_stops_or_frees_the_arm_is_found_by_a_finger(visit: Visit, cell: Cell, width: int, height: int) -> None:
    page = ready(visit(width, height, touch=True))
    for name in ("EMERGENCY STOP", "Hold for free-drive", "Leave free-drive", "Reset"):
        box = page.get_by_role("button", name=name, exact=True).bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 44.0, name
    page.wait_for_function("document.querySelector('canvas').getBoundingClientRect().width >= 400")  # docks glide there
    page.get_by_role("button", name="EMERGENCY STOP", exact=True).tap()
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped")
    page.get_by_role("button", name="Reset", exact=True).tap()
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.TEACH, "reset")


def test_a_phone_has_the_stop_in_sight_and_cuts_no_text(visit: Visit, cell: Cell) -> None:
    page = ready(visit(390, 844))
    stop = page.get_by_role("button", name="EMERGENCY STOP", exact=True)
    expect(stop).to_be_in_viewport(ratio=0.99)
    assert page.evaluate(CUT) == []
    tap(stop)
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped")


@pytest.mark.parametrize(("width", "height"), [(1280, 800), pytest.param(1024, 768, marks=pytest.mark.every_size)])
def test_what_is_always_needed_is_in_sight_without_scrolling(visit: Visit, cell: Cell, width: int, height: int) -> None:
    """Also with three steps in the program."""
    page = ready(visit(width, height))
    teach = cell.served.docks.teach
    for _ in range(3):
        teach.mark()
    expect(page.get_by_role("radio", name="3. Move to P3")).to_have_count(1)
    for name in ("Hold for free-drive", "Leave free-drive", "TEACH", "NORMAL", "EMERGENCY STOP", "Reset", "Run", "Stop", "After"):
        expect(page.get_by_role("button", name=name, exact=True)).to_be_in_viewport(ratio=0.95)
    expect(page.get_by_role("slider", name="Speed [%]")).to_be_in_viewport(ratio=0.95)


@pytest.mark.every_size
def test_the_border_between_the_docks_begins_where_it_is_seen(visit: Visit) -> None:
    page = ready(visit(1440, 900))
    (x, y), mouse = middle(page.locator(BORDER)), page.mouse
    mouse.move(x, y)
    mouse.down()
    for to in (y - 12.0, y - 60.0):
        mouse.move(x, to)
        # it snaps where a dock has just the height of its content
        page.wait_for_function(
            "([it, to]) => Math.abs(document.querySelector(it).getBoundingClientRect().y - to) < 10", arg=[BORDER, to]
        )
    mouse.up()


def test_the_first_stop_of_the_keyboard_leads_to_the_stop_of_the_arm(visit: Visit, cell: Cell) -> None:
    page = ready(visit())
    skip = page.locator(".pd-skip")
    skip.wait_for(state="attached")
    page.keyboard.press("Tab")
    expect(skip).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="EMERGENCY STOP", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    cell.wait(lambda: cell.loop.latest().decision.mode is Mode.STOP, "stopped")
    expect(page.locator("[aria-live=polite]")).to_contain_text("Emergency stop")


def test_space_holds_the_free_drive_button(visit: Visit, cell: Cell) -> None:
    page = ready(visit())
    page.get_by_role("button", name="Hold for free-drive").focus()
    for _ in range(4):  # a page that stalls has let go
        page.keyboard.down(" ")
        cell.pass_time(3.5)
        page.keyboard.up(" ")
        if cell.loop.latest().decision.mode is Mode.FREE_DRIVE:
            return
        cell.pass_time(0.5)
    pytest.fail(cell.told())


FIRST_KEY_IS_LOST = """let first = true; addEventListener("keydown", (event) => {
    if (!event.isTrusted && first) { first = false; event.stopImmediatePropagation(); } }, true);"""
"""As on a machine where the simulation does not know the client yet when the page presses the key for it."""


def test_a_reload_comes_back_as_it_was(visit: Visit) -> None:
    page = ready(visit())
    page.add_init_script(FIRST_KEY_IS_LOST)
    page.get_by_role("tab", name="Settings", exact=True).click()
    page.keyboard.press("t")
    html = page.locator("html")
    expect(html).to_have_attribute("data-mantine-color-scheme", "dark")
    page.wait_for_timeout(300)
    page.reload()
    expect(page.get_by_role("tab", name="Settings", exact=True)).to_have_attribute("aria-selected", "true", timeout=60_000)
    expect(html).to_have_attribute("data-mantine-color-scheme", "dark", timeout=30_000)


def test_a_page_without_an_answer_says_so(visit: Visit, cell: Cell) -> None:
    page = ready(visit())
    expect(page.locator("#pd-lost")).not_to_be_visible()
    cell.served._still_page = True
    expect(page.locator("#pd-lost")).to_contain_text("No answer from the simulation", timeout=20_000)
    expect(page.locator("html.pd-cut")).to_have_count(1)
    page.get_by_role("button", name="Register waypoint").click()
    cell.served._still_page = False
    expect(page.locator("#pd-lost")).to_contain_text("What you pressed meanwhile (1) may not have arrived", timeout=20_000)
    expect(page.locator("html.pd-cut")).to_have_count(0)


GONE = (r"WebSocket connection to .* failed", r"Failed to load resource: net::ERR_", r"WebSocket (closed|is closed)")
"""What a browser says of a server that is not there."""

AWAY = [pytest.param(2.0, 0.0, marks=pytest.mark.every_size), pytest.param(40.0, 0.0, marks=pytest.mark.every_size), (3.0, 600.0)]
"""How long there is no server [s], and what the page's clock is moved on by meanwhile."""


@pytest.mark.console(*GONE)
@pytest.mark.parametrize(("seconds", "skipped"), AWAY)
def test_the_page_comes_back_by_itself_when_the_server_does(browser: Browser, loop: Loop, seconds: float, skipped: float) -> None:
    """With its tab, also after more refused connections than a browser lets a page try without a pause."""
    arm, scenario = loop.simulation.arm, loop.simulation.scenario
    first = serve(loop, arm, scenario)
    port = first.server.get_port()
    page = browser.new_context().new_page()
    page.clock.install()
    page.goto(f"{first.url}/{COARSE}")
    page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
    page.get_by_role("tab", name="Walls", exact=True).click()
    page.wait_for_timeout(500)
    first.close()
    expect(page.locator("#pd-lost")).to_contain_text("Trying again", timeout=30_000)
    expect(page.get_by_role("button", name="Reload")).to_be_visible(timeout=30_000)
    page.clock.fast_forward(round(1000 * skipped))
    page.wait_for_timeout(1000 * seconds)
    if skipped:
        expect(page.locator("#pd-lost")).to_contain_text("10 minutes", timeout=20_000)
    second = serve(loop, arm, scenario, port=port)
    try:
        expect(page.locator("#pd-lost")).not_to_be_visible(timeout=60_000)
        expect(page.get_by_role("tab", name="Walls", exact=True)).to_have_attribute("aria-selected", "true", timeout=30_000)
        assert len(second.server.get_clients()) == 1
    finally:
        second.close()
        page.context.close()
