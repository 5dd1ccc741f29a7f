"""The time line of a replay: play, place in time, speed, and the events along it."""

from collections.abc import Callable, Sequence
from typing import Any

import viser

from app.log.events_file import EventLine
from app.log_reading.playback import Playback
from app.web.recordings.event_marks import EventMarks

SPEEDS = ("0.1 ×", "0.5 ×", "1 ×", "2 ×", "5 ×")


class TimeLine:
    """Its controls, which move `moment`. Lives on viser's event loop.

    Args:
        gui: of the page.
        moment: where the replay is.
        events: what happened.
        for_anyone: told of each control: whoever sees the page may use it.
    """

    def __init__(
        self, gui: viser.GuiApi, moment: Playback, events: Sequence[EventLine], for_anyone: Callable[[Any], object]
    ) -> None:
        self._moment = moment
        self._set = -1.0  # where we have put the slider ourselves
        self.play = gui.add_button("Play")
        self.line = gui.add_slider("Time [s]", min=0.0, max=max(round(moment.end, 2), 0.01), step=0.01, initial_value=0.0)
        self.speed = gui.add_button_group("Speed", SPEEDS)
        self.speed.value = "1 ×"
        self.marks = EventMarks(gui, self.line, moment.jump)
        self.marks.show(events, moment.end)
        for control in (self.play, self.line, self.speed, self.marks.choice):
            for_anyone(control)

        @self.play.on_click
        async def _(_: viser.GuiEvent) -> None:
            if not moment.playing and moment.time >= moment.end:
                moment.jump(0.0)
            moment.playing = not moment.playing

        @self.line.on_update
        async def _(_: viser.GuiEvent) -> None:
            if self.line.value != self._set:
                moment.jump(float(self.line.value))

        @self.speed.on_click
        async def _(_: viser.GuiEvent) -> None:
            moment.speed = float(self.speed.value.split()[0])

    def show(self) -> None:
        """Bring the controls to the moment."""
        at = round(self._moment.time, 2)
        if self.line.value != at:
            self._set = at
            self.line.value = at
        label = "Pause" if self._moment.playing else "Play"
        if self.play.label != label:
            self.play.label = label
