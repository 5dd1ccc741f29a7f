"""The first use of the arm by somebody who comes back to it: tidied up, free-drive entered, guided, left alone.

What a random user leaves behind may refuse free-drive with good reason (limits, walls, faults, a wrong payload). So whoever comes
back has a ready-made scenario set up, as a person does with one click, and enters the payload that hangs on the arm.
"""

import html
import math
import random
import re
import threading
import time

from benchmarks.soak.client import FREE_DRIVE, HOLD_RATE, Client

SCENARIO = "Free-drive by the button, guided by hand, left alone"  # the arm on the floor, nothing in its way, default settings
FREE, READY = "FREE-DRIVE", "TEACH"  # what the mode light says
FLANGE = "/arm/wrist_3"
HAND = 50.0  # force of the hand, as shipped [N]
HUSH = 5.0  # until the others have let go [s]
BUILT = 8.0  # until another scenario has been built [s]
WAIT = 20.0  # hands off, before the button is held [s]
ENTRY = 8.0  # longest that the button is held [s]: it takes a second, the check of the freed arm one more
GUIDED = 4.0  # [s]
RADIUS, ROUND = 0.05, 4.0  # of the circle on which the cursor leads the flange [m], [s]
ALONE = 12.0  # longest until free-drive has ended by its period [s]
BY_ITSELF = ("Free-drive ended: nobody moved the arm", "Free-drive ended: the arm stood still")


class FirstUses:
    """All of one page: when the next is due, and how those before it went.

    Attributes:
        hush: set while one is going on; nobody else does anything then.
        begun, entered, ended: how many began, entered free-drive, and ended by their period.
        told: of each that did not: when [min], with which payload [kg], what the page says.
    """

    def __init__(self, every: float = math.inf) -> None:
        """`every` is the time between two of them [s]."""
        self.hush = threading.Event()
        self.begun = self.entered = self.ended = 0
        self.told: list[str] = []
        self._every = every
        self._start = time.monotonic()

    def due(self, now: float) -> bool:
        """Whether the next one is, at `now` of `time.monotonic`."""
        return now - self._start >= self._every * (self.begun + 1)

    def do(self, client: Client, chance: random.Random) -> None:
        """Do one; `chance` gives the payload."""
        at = (time.monotonic() - self._start) / 60.0
        self.begun += 1
        mass = chance.choice((0.0, 1.0, 2.0, 3.5))
        refused, went_on = "the connection was lost", "the connection was lost"
        self.hush.set()
        try:
            client.look(HUSH)
            tidy(client, mass)
            refused = enter(client)
            if not refused:
                self.entered += 1
                went_on = guide_and_leave(client)
                self.ended += not went_on
        finally:
            self.hush.clear()
            if refused or went_on:
                what = f"refused: {refused}" if refused else f"entered, but: {went_on}"
                self.told.append(f"first use at {at:.1f} min, {mass:g} kg: {what}")


def tidy(client: Client, mass: float) -> None:
    """Take control, stop what runs, have the arm as it is delivered, with `mass` [kg] on it that the controller knows; wait."""
    take = client.called("Take")
    if client.things[take].get("visible", True):
        client.set(take, True)
    client.set(client.called("Clock"), "Go on")
    client.set(client.called("Run"), "Stop")
    client.set(client.offering(SCENARIO), SCENARIO)
    client.look(0.5)
    client.set(client.called("Begin"), "Set up")
    client.look(BUILT)
    reset = client.called("Reset")
    if not client.things[reset].get("disabled", False):
        client.set(reset, True)
    client.set(client.called("Hand [N]"), HAND)
    client.set(client.called("True [kg]"), mass)
    client.set(client.called("Configured"), mass)
    client.look(WAIT)


def enter(client: Client) -> str:
    """Hold the button, hands off, until free-drive is entered: "", or why it was not."""
    end = time.monotonic() + ENTRY
    while mode(client) != FREE and time.monotonic() < end:
        client.hold()
    entered = mode(client) == FREE
    client.set(client.called(*FREE_DRIVE), True)  # let go
    client.look(0.3)
    return "" if entered else page_text(client)


def guide_and_leave(client: Client) -> str:
    """Lead the flange on a circle, let go, wait until free-drive has ended: "" if by its period, or what the page says."""
    start = [float(x) for x in client.things[FLANGE]["position"]]
    client.drag("start", FLANGE, modifier=None, start=start, here=start)
    for step in range(1, round(GUIDED * HOLD_RATE) + 1):
        turn = 2.0 * math.pi * step / (ROUND * HOLD_RATE)
        here = [start[0], start[1] + RADIUS * math.sin(turn), start[2] + RADIUS * (1.0 - math.cos(turn))]
        client.drag("update", FLANGE, modifier=None, start=start, here=here)
        client.look(1.0 / HOLD_RATE)
    client.drag("end", FLANGE, modifier=None, start=start, here=start)
    end = time.monotonic() + ALONE
    while mode(client) == FREE and time.monotonic() < end:
        client.look(0.2)
    client.look(0.5)
    said = page_text(client)
    return "" if mode(client) == READY and any(words in said for words in BY_ITSELF) else said


def mode(client: Client) -> str:
    """What the mode light says."""
    return _texts(client, "pd-light")[:1][0].split(" ")[0]


def page_text(client: Client) -> str:
    """What the pendant says: the mode light, and its message."""
    return "; ".join(_texts(client, "pd-light")[:1] + _texts(client, "pd-note")[:1])


def _texts(client: Client, kind: str) -> list[str]:
    """Pieces of HTML of a kind, as plain text."""
    contents = (str(thing.get("content", "")) for thing in client.things.values())
    return [_plain(content) for content in contents if content.startswith(f'<div class="{kind}"')]


def _plain(content: str) -> str:
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", content)).split())
