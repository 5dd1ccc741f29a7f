"""A page that is served: viser behind the guard, and what is drawn on it, again and again."""

import asyncio
import io
import logging
from abc import ABC, abstractmethod
from concurrent.futures import Future
from contextlib import redirect_stdout
from typing import Any

import viser

from app.web.access.guard import Guard
from app.web.access.listening import Access
from app.web.access.operator import Operator

FRAME = 1.0 / 60.0
"""Time between two pictures [s]."""


class Site(ABC):
    """One viser server with its guard, drawn on by viser's own event loop.

    viser wakes the connection of a client from whatever thread draws, and there is a moment in which that fails: with
    clients at the page nothing may be drawn from another thread.

    Args:
        access: where to listen, and for whom.
        port: 0 for any free one.
        theme: of viser's `configure_theme`.
    """

    def __init__(self, access: Access, port: int, **theme: Any) -> None:
        self.access = access
        self.guard = Guard(Operator(), access)
        with self.guard.installed(), quiet():
            self.server = viser.ViserServer(host=access.host, port=port, verbose=False)
        self._theme = theme
        self.set_theme(self.server.gui, dark=False)
        self._still = asyncio.Event()

    @property
    def url(self) -> str:
        """Where the page is."""
        return self.access.address(self.server.get_port())

    @property
    def link(self) -> str:
        """What a browser has to open: the address, with the token if one is needed."""
        return self.access.link(self.server.get_port())

    def set_theme(self, gui: viser.GuiApi, dark: bool) -> None:
        """Give the page of one client, or of all, its colours."""
        gui.configure_theme(show_logo=False, show_share_button=False, control_width="medium", dark_mode=dark, **self._theme)

    @abstractmethod
    def draw(self) -> bool:
        """Bring the page up to date; False when there will be nothing new any more."""

    def start_drawing(self) -> None:
        """Draw a picture each FRAME from now on."""
        self._painter = asyncio.run_coroutine_threadsafe(self._paint(), self.server.get_event_loop())
        self._painter.add_done_callback(_tell)

    def stop_drawing(self) -> None:
        """Draw no more. Raises what drawing failed with."""
        self.server.get_event_loop().call_soon_threadsafe(self._still.set)
        self._painter.result()

    def close(self) -> None:
        """Stop serving; connections are closed. Raises what drawing failed with."""
        try:
            self.stop_drawing()
        finally:
            with quiet():
                self.server.stop()

    async def _paint(self) -> None:
        clock = asyncio.get_running_loop().time
        due = clock()
        while not self._still.is_set() and self.draw():
            due = max(due + FRAME, clock())
            await asyncio.sleep(due - clock())


def _tell(painter: Future[None]) -> None:
    """A page that stands still must not look as if the arm did."""
    if not painter.cancelled() and (failure := painter.exception()):
        logging.getLogger(__name__).error("the page is no longer drawn", exc_info=failure)


def quiet() -> redirect_stdout[io.StringIO]:
    """viser announces itself and its end on the terminal, also when it is told not to."""
    return redirect_stdout(io.StringIO())
