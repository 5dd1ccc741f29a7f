"""The parts of a page, drawn each for itself: one that fails is told in its place, and tried again with the next picture."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import viser

from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from sim.run.troubles import Troubles, reason_of

ABOVE_ALL = -1000.0
"""Order of a note in its tab."""


class DrawnParts:
    """Lives on viser's event loop.

    Args:
        gui: of the page.
        troubles: what does not work.
    """

    def __init__(self, gui: viser.GuiApi, troubles: Troubles) -> None:
        self._gui, self._troubles = gui, troubles
        self._notes: dict[str, Html] = {}

    def draw(self, part: str, show: Callable[[], Any], place: AbstractContextManager[Any] | None = None) -> bool:
        """Draw a part; whatever it raises ends here.

        Args:
            part: its name in words, such as "the tab Script".
            show: brings it up to date; true if that changed anything.
            place: the tab that a note of it stands in; None: the pendant itself.

        Returns:
            Whether anything changed.
        """
        try:
            changed = bool(show())
        except Exception as error:  # noqa: BLE001 - one part must not take the others with it
            self._troubles.failed(part, error)
            return self._tell(part, reason_of(error), place)
        if part in self._notes and not self._troubles.lasts(part):
            self._notes.pop(part).remove()
            changed = True
        return changed

    def _tell(self, part: str, reason: str, place: AbstractContextManager[Any] | None) -> bool:
        """Have a note say it; where not even that can be drawn, the log and the events still do."""
        content = svg.note(f"Not up to date: {part}", f"{reason}. It is tried again.", Colour.RED)
        try:
            if part in self._notes:
                return self._notes[part].show(content)
            with place or nullcontext():
                self._notes[part] = Html(self._gui, content, order=ABOVE_ALL)
        except Exception as error:  # noqa: BLE001
            self._troubles.failed(f"the note on {part}", error)
        return True
