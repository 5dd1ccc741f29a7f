"""When the page sounds, and what it is sent for that."""

import json
from collections.abc import Callable
from typing import Any

from app.web.server import Served
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def sounds(client: RawClient, last: str) -> list[str]:
    """The clips that the page was told to play, up to the one named `last`."""
    played: list[str] = []

    def see(message: dict[str, Any]) -> bool:
        if message["type"] != "RunJavascriptMessage" or "__VISER_AUDIO__.receive(" not in message["source"][:60]:
            return False
        told = json.loads(json.loads(message["source"].partition("receive(")[2].removesuffix(");")))
        if told["type"] == "AudioPlaybackMessage":
            assert (told["playing"], told["offset"]) == (True, 0.0)
            played.append(told["name"])
        return told["type"] == "AudioPlaybackMessage" and told["name"] == last

    client.messages_until(see)
    return played


def test_only_the_page_that_wants_it_is_sent_sound(served: Served, join: Join, loop: FakeLoop) -> None:
    loud, silent = join(), join()
    pages = served.preferences._pages
    until(lambda: len(pages) == 2, "both have their switches")
    loud.set(pages[0].sound._impl.uuid, value=True)
    until(lambda: pages[0].speaker is not None, "a speaker")
    loop.mode = Mode.FREE_DRIVE
    assert sounds(loud, "/sound/FREE") == ["/sound/FREE"]
    loop.mode = Mode.STOP
    assert sounds(loud, "/sound/STOP") == ["/sound/STOP"]
    served.server.gui.set_panel_label("mark")
    told = silent.messages_until(lambda m: m["type"] == "SetGuiPanelLabelMessage" and m["label"] == "mark")
    assert [m for m in told if m["type"] == "RunJavascriptMessage"] == []


def test_switched_off_it_is_silent_and_who_leaves_is_forgotten(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    pages = served.preferences._pages
    until(lambda: len(pages) == 1, "the switches")
    for value in (True, False):
        client.set(pages[0].sound._impl.uuid, value=value)
        until(lambda value=value: (pages[0].speaker is not None) is value, "switched")
    anyone = len(served.guard._anyone)
    client.close()
    until(lambda: not pages, "forgotten")
    until(lambda: len(served.guard._anyone) == anyone - 3, "its switches and the request for control")
    loop.mode = Mode.STOP
    until(lambda: served.preferences._before is not None and served.preferences._before.mode is Mode.STOP, "seen by nobody")
