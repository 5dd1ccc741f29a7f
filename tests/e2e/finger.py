"""A finger on the page where the window has touch, the mouse where it has not: both press, move and lift in the same way."""

from typing import Any
from weakref import WeakKeyDictionary

from playwright.sync_api import CDPSession, Locator, Page

Point = tuple[float, float]


class Mouse:
    """The mouse of a page."""

    touches = False

    def __init__(self, page: Page) -> None:
        self._page = page

    def down(self, at: Point) -> None:
        """Go there, and press."""
        self._page.mouse.move(*at)
        self._page.mouse.down()

    def move(self, to: Point, steps: int = 1) -> None:
        """Go on to a place while pressed."""
        self._page.mouse.move(*to, steps=steps)

    def up(self) -> None:
        """Lift."""
        self._page.mouse.up()

    def tap(self, control: Locator) -> None:
        """Press and lift on a control."""
        control.click()


class Finger(Mouse):
    """A finger, which is nowhere before it presses. Chromium is told of it as of a real one: no mouse event is made up."""

    touches = True

    def __init__(self, page: Page) -> None:
        super().__init__(page)
        self._driver: CDPSession = page.context.new_cdp_session(page)
        self._at: Point | None = None

    def down(self, at: Point) -> None:
        """Press there."""
        self._at = at
        self._send("touchStart", at)

    def move(self, to: Point, steps: int = 1) -> None:
        """Go on to a place while pressed."""
        if self._at is None:
            return
        x, y = self._at
        for step in range(1, steps + 1):
            self._send("touchMove", (x + (to[0] - x) * step / steps, y + (to[1] - y) * step / steps))
            self._page.wait_for_timeout(16)  # a screen tells of a finger that often
        self._at = to

    def up(self) -> None:
        """Lift."""
        if self._at is not None:
            self._at = None
            self._send("touchEnd")

    def tap(self, control: Locator) -> None:
        """Press and lift on a control."""
        control.tap()

    def flick(self, at: Point, up: float) -> None:
        """Press at a place, slide up by so many pixels, lift, faster than a page can draw: whatever it takes to answer.

        A finger that waits for a busy page rests for longer than half a second: that is a long press, and scrolls nothing.
        """
        x, y = at
        steps = 12
        self._start("touchStart", at)
        for step in range(1, steps + 1):
            self._start("touchMove", (x, y - up * step / steps))
        self._send("touchEnd")

    def _send(self, kind: str, *points: Point) -> None:
        self._driver.send(TOUCH, _touch(kind, *points))

    def _start(self, kind: str, *points: Point) -> None:
        """The same, and the page's answer is not waited for, for which Playwright has no call."""
        driver: Any = self._driver
        driver._loop.create_task(driver._impl_obj.send(TOUCH, _touch(kind, *points), None))


TOUCH = "Input.dispatchTouchEvent"


def _touch(kind: str, *points: Point) -> dict[str, Any]:
    return {"type": kind, "touchPoints": [{"x": x, "y": y} for x, y in points]}


_pointers: WeakKeyDictionary[Page, Mouse] = WeakKeyDictionary()


def pointer(page: Page) -> Mouse:
    """What a user has at this page."""
    if page not in _pointers:
        _pointers[page] = Finger(page) if page.evaluate("navigator.maxTouchPoints > 0") else Mouse(page)
    return _pointers[page]


def middle(control: Locator) -> Point:
    """Where a control is in the window."""
    control.scroll_into_view_if_needed()
    box = control.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def tap(control: Locator) -> None:
    """Press a control as the user of its page does; it is scrolled to."""
    pointer(control.page).tap(control)
