"""What concerns one page alone: dark or light, and sound. Each client has its own switches, in the tab of the settings."""

from collections.abc import Callable
from dataclasses import dataclass

import viser

from app.tones import tone_for
from app.web.access.guard import Guard
from app.web.widgets.sound import Speaker
from pendant.decision import Decision


@dataclass(slots=True)
class Page:
    """The switches of one client."""

    dark: viser.GuiCheckboxHandle
    sound: viser.GuiCheckboxHandle
    speaker: Speaker | None = None


class Preferences:
    """The switches of all clients. Lives on viser's event loop.

    Args:
        tab: where they are.
        theme: gives the page of a client its colours, dark (True) or light.
    """

    def __init__(self, guard: Guard, tab: viser.GuiTabHandle, theme: Callable[[viser.ClientHandle, bool], None]) -> None:
        self._guard, self._tab, self._theme = guard, tab, theme
        self._pages: dict[int, Page] = {}
        self._before: Decision | None = None

    def welcome(self, client: viser.ClientHandle) -> None:
        """Give a new client its switches: light, and silent."""
        with self._tab:
            page = Page(
                client.gui.add_checkbox("Dark page", False, order=-2.0, hint="Key: T"),
                client.gui.add_checkbox("Sound", False, order=-1.0, hint="Key: B"),
            )
        self._pages[client.client_id] = page
        for control in (page.dark, page.sound):
            self._guard.for_anyone(control)

        @page.dark.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._theme(client, page.dark.value)

        @page.sound.on_update
        async def _(_: viser.GuiEvent) -> None:
            page.speaker = Speaker(client) if page.sound.value else None

    def farewell(self, client: int) -> None:
        """A client has gone."""
        page = self._pages.pop(client, None)
        if page is not None:
            for control in (page.dark, page.sound):
                self._guard.for_nobody(control)

    @property
    def dark(self) -> frozenset[int]:
        """Clients whose page is dark."""
        return frozenset(client for client, page in self._pages.items() if page.dark.value)

    def flip_dark(self, client: int) -> None:
        """From light to dark, or back."""
        page = self._pages[client]
        page.dark.value = not page.dark.value

    def flip_sound(self, client: int) -> None:
        """From silent to audible, or back."""
        page = self._pages[client]
        page.sound.value = not page.sound.value

    def show(self, decision: Decision) -> None:
        """Let those hear it who want to."""
        before, self._before = self._before, decision
        tone = None if before is None else tone_for(before, decision)
        if tone is None:
            return
        for page in self._pages.values():
            if page.speaker is not None:
                page.speaker.play(tone)
