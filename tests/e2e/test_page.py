"""The page in a browser that somebody else's link has opened."""

import threading
from collections.abc import Callable

import pytest
from playwright.sync_api import Browser, Page
from websockets.sync.server import ServerConnection
from websockets.sync.server import serve as serve_websocket

from pendant.events.event import Kind
from tests.e2e.cell import Cell

pytestmark = pytest.mark.e2e


@pytest.mark.console("Content Security Policy", "Failed to open WebSocket", "WebSocket connection to")
def test_a_link_cannot_make_the_page_talk_to_another_server(browser: Browser, cell: Cell) -> None:
    called = threading.Event()

    def answer(_: ServerConnection) -> None:
        called.set()

    with serve_websocket(answer, "127.0.0.1", 0) as elsewhere:
        threading.Thread(target=elsewhere.serve_forever, daemon=True).start()
        other = f"ws://127.0.0.1:{elsewhere.socket.getsockname()[1]}"
        page = browser.new_context().new_page()
        with page.expect_console_message(lambda message: f"Connecting to: {other}" in message.text, timeout=60_000):
            page.goto(f"{cell.served.url}/?websocket={other}")
        assert not called.wait(3.0)
        assert cell.served.server.get_clients() == {}
        page.context.close()
        elsewhere.shutdown()


def test_the_page_bears_our_name_and_offers_no_tunnel(visit: Callable[[], Page]) -> None:
    page = visit()
    assert page.title() == "pendant"
    assert page.get_by_label("Share").count() == 0


def test_a_press_on_the_stop_stops_though_the_palette_lies_over_it(visit: Callable[[], Page], cell: Cell) -> None:
    page = visit()
    box = page.get_by_role("button", name="EMERGENCY STOP", exact=True).bounding_box()
    assert box is not None
    page.keyboard.press("Control+k")
    page.locator(".mantine-Spotlight-content").wait_for()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    cell.wait(lambda: cell.happened(Kind.EMERGENCY_STOP), "it stops")
