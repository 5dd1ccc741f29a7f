"""The events of a recording: marks along its time line, and the choice of one, to go to its moment."""

from collections.abc import Callable, Sequence

import viser

from app.log.events_file import EventLine
from app.web.panel.state_words import SEVERITY_COLOURS
from app.web.widgets import svg
from app.web.widgets.html import Html, reveal
from pendant.events.event_row import Severity

NOWHERE = "Jump to ..."

FIRST: tuple[str, ...] = (NOWHERE,)
"""What can be chosen while there is no recording."""

MOST_CHOICES = 1000
"""Events that can be chosen, the last ones."""

PLACES = 150
"""Marks at most: each is the gravest event of its part of the time line."""


class EventMarks:
    """Below the slider of a time line. Lives on viser's event loop.

    Args:
        gui: of the page.
        line: the slider, whose track the marks lie along.
        jump: told the time that is chosen [s].
    """

    def __init__(self, gui: viser.GuiApi, line: viser.GuiSliderHandle[float], jump: Callable[[float], None]) -> None:
        self._line = line._impl.uuid
        self._times: dict[str, float] = {}
        self._strip = Html(gui)
        self.choice: viser.GuiDropdownHandle[str] = gui.add_dropdown("Event", FIRST, visible=False)

        @self.choice.on_update
        async def _(_: viser.GuiEvent) -> None:
            if self.choice.value in self._times:
                jump(self._times[self.choice.value])

    @property
    def shown(self) -> str:
        """The marks, as HTML."""
        return self._strip.shown

    def show(self, events: Sequence[EventLine], end: float) -> None:
        """Show the events of a recording that ends at `end` [s]; none of them, nothing."""
        self._times = {moment(event): event.t for event in events[-MOST_CHOICES:]}
        self.choice.options = (NOWHERE, *self._times)
        self.choice.value = NOWHERE
        reveal(self.choice, bool(self._times))
        gravest: dict[int, EventLine] = {}
        for event in events[-MOST_CHOICES:]:
            place = min(int(PLACES * event.t / max(end, 1e-9)), PLACES - 1)
            held = gravest.get(place)
            if held is None or Severity[event.severity] > Severity[held.severity]:
                gravest[place] = event
        marks = [
            svg.TimeMark(min(event.t / max(end, 1e-9), 1.0), moment(event), SEVERITY_COLOURS[Severity[event.severity]])
            for event in gravest.values()
        ]
        self._strip.show(svg.time_marks(self._line, marks))


def moment(event: EventLine) -> str:
    """The name of an event's moment: its choice, its mark, and its row of a log, which lead there."""
    return f"{event.t:.2f} s: {event.headline}"  # with a colon, as no moment of the running arm is called
