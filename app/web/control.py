"""Who has control, shown to each client in its own words, with a button to take it or to give it back."""

from collections.abc import Callable
from dataclasses import dataclass

import viser

from app.web import style, svg
from app.web.guard import Guard
from app.web.html import Html
from app.web.svg import Colour

TAKE = "Take"
RELEASE = "Release"


@dataclass(slots=True)
class Strip:
    """What one client sees."""

    text: Html
    button: viser.GuiButtonHandle
    label: str = TAKE


class Control:
    """The strips of all clients. Lives on viser's event loop."""

    def __init__(self, server: viser.ViserServer, guard: Guard, let_go: Callable[[int], None]) -> None:
        self._server = server
        self._guard = guard
        self._let_go = let_go
        self._strips: dict[int, Strip] = {}

    def welcome(self, client: viser.ClientHandle) -> None:
        """Give a new client its strip."""
        button = client.gui.add_button(TAKE, color="gray", order=-1.0)
        strip = Strip(Html(client.gui, order=-2.0), button)
        self._strips[client.client_id] = strip

        # The guard has already made whoever presses it the operator, if control was free.
        @button.on_click
        async def _(_: viser.GuiEvent) -> None:
            if strip.label == RELEASE:
                self._let_go(client.client_id)
                self._guard.operator.leave(client.client_id)
            self.show()

        self.show()

    def farewell(self, client: int) -> None:
        """A connection closed: what it held is released at once, and control is free."""
        self._strips.pop(client, None)
        self._let_go(client)
        self._guard.operator.leave(client)
        self.show()

    def close(self) -> None:
        """Tell nobody any more: the server is about to end."""
        self._strips.clear()

    def show(self) -> None:
        """Bring every strip up to date."""
        holder = self._guard.operator.holder
        free = self._guard.operator.free(self._guard.now())
        here = self._server.get_clients()
        for number, strip in self._strips.items():
            if number not in here:
                continue
            if holder == number:
                text, colour, label, able = "You have control", Colour.GREEN, RELEASE, True
            elif holder is None:
                text, colour, label, able = "Nobody has control", Colour.GREY, TAKE, True
            else:
                text, colour, label, able = f"Client {holder + 1} has control", Colour.AMBER, TAKE, free
            strip.text.show(svg.who(text, colour) + style.beside(strip.button._impl.uuid))
            if strip.label != label:
                strip.label = strip.button.label = label
            if strip.button.disabled == able:
                strip.button.disabled = not able
