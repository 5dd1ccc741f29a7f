"""The event log: what happened, newest first."""

import viser

from app.web.panel.state_words import SEVERITY_COLOURS
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.event_table import TABLE, render
from pendant.events.event import Event
from pendant.tick.modes import TICK_RATE

LENGTH = 60
"""Events shown."""


class Journal:
    """The tab with the event log."""

    def __init__(self, gui: viser.GuiApi) -> None:
        self._log: list[Event] = []
        self.table = Html(gui, svg.table(()))

    def show(self, fresh: list[Event]) -> bool:
        """Add events; True if anything changed."""
        if not fresh:
            return False
        self._log = (self._log + fresh)[-LENGTH:]
        return self.table.show(svg.table(_line(event) for event in reversed(self._log)))


def _line(event: Event) -> tuple[str, str, Colour]:
    return f"{event.tick / TICK_RATE:.2f} s", render(event)[0], SEVERITY_COLOURS[TABLE[event.kind].severity]
