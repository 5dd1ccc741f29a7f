"""A page that is served: viser behind the guard, and what is drawn on it, again and again."""

import asyncio
import io
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import CancelledError
from contextlib import redirect_stdout, suppress
from typing import Any

import viser

from app.web.access.guard import Guard
from app.web.access.listening import Access
from app.web.access.operator import Operator
from sim.run.troubles import Troubles

FRAME = 1.0 / 60.0
"""Time between two pictures [s]."""

PATIENCE = 1.0
"""Longest wait for a picture that is being drawn when the page ends [s]."""


class Site(ABC):
    """One viser server with its guard, drawn on by viser's own event loop. Whatever fails there is told, and ends nothing.

    viser wakes the connection of a client from whatever thread draws, and there is a moment in which that fails: with
    clients at the page nothing may be drawn from another thread.

    Args:
        access: where to listen, and for whom.
        port: 0 for any free one.
        troubles: what does not work.
        theme: of viser's `configure_theme`.
    """

    def __init__(self, access: Access, port: int, troubles: Troubles, **theme: Any) -> None:
        self.access, self.troubles = access, troubles
        self.guard = Guard(Operator(), access)
        with self.guard.installed(), quiet():
            self.server = viser.ViserServer(host=access.host, port=port, verbose=False)
        self._theme = theme
        self.set_theme(self.server.gui, dark=False)
        self._still = asyncio.Event()
        events = self.server.get_event_loop()
        events.call_soon_threadsafe(events.set_exception_handler, self._control_failed)

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

    @property
    def drawing(self) -> bool:
        """Pictures follow."""
        return not self._painter.done()

    def stop_drawing(self) -> None:
        """Draw no more."""
        self.server.get_event_loop().call_soon_threadsafe(self._still.set)
        with suppress(TimeoutError, CancelledError):
            self._painter.result(PATIENCE)

    def close(self) -> None:
        """Stop serving; connections are closed."""
        self.attempt("the end of drawing", self.stop_drawing)
        with quiet():
            self.attempt("the end of the page", self.server.stop)

    def attempt(self, part: str, work: Callable[[], object]) -> None:
        """Do something; what it raises is told, and ends nothing else."""
        try:
            work()
        except Exception as error:  # noqa: BLE001
            self.troubles.failed(part, error)

    async def _paint(self) -> None:
        clock = asyncio.get_running_loop().time
        due = clock()
        while not self._still.is_set():
            try:
                if not self.draw():
                    return
            except Exception as error:  # noqa: BLE001 - the next picture may be drawn
                self.troubles.failed("the page", error)
            due = max(due + FRAME, clock())
            await asyncio.sleep(due - clock())

    def _control_failed(self, events: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """What a control of the page does has raised: viser hands that to the event loop."""
        error = context.get("exception")
        if error is None:
            events.default_exception_handler(context)
        else:
            self.troubles.failed("a control of the page", error)


def quiet() -> redirect_stdout[io.StringIO]:
    """viser announces itself and its end on the terminal, also when it is told not to."""
    return redirect_stdout(io.StringIO())
