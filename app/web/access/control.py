"""Who has control, shown to each client in its own words, with buttons to take it, to ask for it, to give it back.

One of the three is shown. A single button with three labels could change its label between a press and what the press does, and
would then do the opposite of what was pressed.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import viser

from app.web.access.guard import Guard
from app.web.access.operator import SILENCE
from app.web.widgets import style, svg
from app.web.widgets.html import Html, enable, reveal
from app.web.widgets.svg import Colour


@dataclass(slots=True)
class Strip:
    """What one client sees."""

    text: Html
    take: viser.GuiButtonHandle
    ask: viser.GuiButtonHandle
    release: viser.GuiButtonHandle


class Control:
    """The strips of all clients. Lives on viser's event loop."""

    def __init__(self, server: viser.ViserServer, guard: Guard, let_go: Callable[[int], None]) -> None:
        self._server = server
        self._guard = guard
        self._let_go = let_go
        self._strips: dict[int, Strip] = {}
        self._had: int | None = None  # who had control when it was last shown
        self._closed = False  # control is free because the connection of who had it closed
        self._asking: int | None = None  # who asks the holder for control, the first of them
        self._robbed: set[int] = set()  # those from whom the holder has taken it

    def welcome(self, client: viser.ClientHandle) -> None:
        """Give a new client its strip."""
        gui, number = client.gui, client.client_id
        strip = Strip(
            Html(gui, order=-3.0),
            gui.add_button("Take", color="gray", order=-2.0),
            gui.add_button("Ask for it", color="gray", order=-1.5, visible=False),
            gui.add_button("Release", color="gray", order=-1.0, visible=False),
        )
        self._strips[number] = strip
        self._guard.for_anyone(strip.ask)  # who watches may ask; it stands on this client's page alone

        @strip.ask.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self._asking is None and self._guard.operator.holder not in (None, number):
                self._asking = number
            self.show()

        # The guard has already made whoever presses it the operator, if control was free.
        @strip.take.on_click
        async def _(_: viser.GuiEvent) -> None:
            self.show()

        @strip.release.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._let_go(number)
            asking, self._asking = self._asking, None
            if self._guard.operator.leave(number) and asking is not None:
                self._guard.operator.claim(asking, self._guard.now())
                self._had = asking  # it was given, nobody lost it
            self.show()

        self.show()

    def farewell(self, client: int) -> None:
        """A connection closed: what it held is released at once, and control is free."""
        strip = self._strips.pop(client, None)
        if strip is not None:
            self._guard.for_nobody(strip.ask)
        if self._asking == client:
            self._asking = None
        self._let_go(client)
        self._closed = self._guard.operator.leave(client) or self._closed
        self.show()

    def close(self) -> None:
        """Tell nobody any more: the server is about to end."""
        self._strips.clear()

    def show(self) -> None:
        """Bring every strip up to date."""
        holder, left = self._guard.operator.holder, self._guard.operator.free_in(self._guard.now())
        self._closed = self._closed and holder is None
        if holder != self._had:
            self._robbed = set() if holder is None or self._had is None else {*self._robbed, self._had} - {holder}
            self._had, self._asking = holder, None
        here = self._server.get_clients()
        for number, strip in self._strips.items():
            if number not in here:
                continue
            text, hint, colour = self._words(number, holder, left)
            watching = holder not in (None, number)
            shown = svg.who(text, hint, colour, watching=watching)
            strip.text.show(shown + "".join(style.beside(button._impl.uuid) for button in (strip.take, strip.ask, strip.release)))
            free = left == 0.0
            enable(strip.take, free)
            enable(strip.ask, self._asking is None)
            reveal(strip.take, holder != number and free)
            reveal(strip.ask, holder != number and not free)
            reveal(strip.release, holder == number)
            label = "Give" if holder == number and self._asking is not None else "Release"
            if strip.release.label != label:
                strip.release.label = label

    def _words(self, number: int, holder: int | None, left: float | None) -> tuple[str, str, Colour]:
        """What a client is told, a second line, and the colour."""
        if holder == number:
            if self._asking is not None:
                return f"Window {self._asking + 1} asks for control", "You have it. Give hands it over.", Colour.AMBER
            lapsed = "Idle: others may take it." if left == 0.0 else ""
            return "You have control", lapsed, Colour.GREEN
        if holder is None:
            why = "The connection closed. " if self._closed else ""
            return "Nobody has control", f"{why}Any press takes it.", Colour.GREY
        name = f"Window {holder + 1}"
        text = f"{name} took control" if number in self._robbed else f"{name} has control"
        if self._asking == number and left != 0.0:
            return text, "Asked. Wait for an answer.", Colour.AMBER
        if left is None:
            return text, "It holds the arm.", Colour.AMBER
        if left > 0.0:
            return text, f"Free in {math.ceil(left)} s, or when released.", Colour.AMBER
        return f"{name} idle for {SILENCE:.0f} s", "Press anything to take over.", Colour.AMBER
