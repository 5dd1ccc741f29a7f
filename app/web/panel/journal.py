"""The event log, newest first: the same again is one row with a count, and a row leads to its moment."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import viser

from app.web.panel.state_words import SEVERITY_COLOURS
from app.web.tuning.setting_words import setting_change
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect, Severity
from pendant.tick.modes import TICK_RATE

LENGTH = 60
"""Rows kept."""

CLOSE = 10 * TICK_RATE
"""What happens again within so many ticks, with at most `BETWEEN` other rows between, is the same row."""

BETWEEN = 2
NOW = "now"
"""The choice of the moment that goes on by itself."""

FIRST: tuple[str, ...] = (NOW,)
"""What can be chosen before anything has happened."""


@dataclass(slots=True)
class LogRow:
    """One row: the newest of its events, and how many they are. None divides one beginning from the next."""

    event: Event | None
    count: int = 1


EQUIPMENT = ("setting_", "tool", "payload_", "posture_", "sensor_", "wizard_")
GUIDING = frozenset({Kind.MANIPULATION, Kind.RESTARTED, Kind.PERIOD_ANEW})
"""Told again and again while a hand guides the arm; the ring at the button shows the same."""

FILTERS: dict[str, Callable[[Event], bool]] = {
    "What matters": lambda event: event.kind not in GUIDING,
    "Everything": lambda event: True,
    "Stops and refusals": lambda event: (
        TABLE[event.kind].severity >= Severity.WARNING or TABLE[event.kind].effect in (Effect.NO_ENTRY, Effect.LEAVE)
    ),
    "Free-drive": lambda event: TABLE[event.kind].effect in (Effect.TRY, Effect.ENTER, Effect.NO_ENTRY, Effect.LEAVE),
    "Contacts": lambda event: event.kind.value.startswith("contact_"),
    "Settings, tools, payload": lambda event: event.kind.value.startswith(EQUIPMENT),
}
"""What may be shown."""


class Journal:
    """The tab with the event log; `joints` are the names of the arm's joints."""

    def __init__(self, gui: viser.GuiApi, joints: Sequence[str]) -> None:
        self._joints = joints
        self.look_at: Callable[[int | None], None] = lambda tick: None  # told the tick to show, None for now
        self._rows: list[LogRow] = []
        self._tick = 0
        self._moments: dict[str, int] = {}
        self.filter = gui.add_dropdown("Show", tuple(FILTERS))
        self.moment: viser.GuiDropdownHandle[str] = gui.add_dropdown(
            "Moment", FIRST, hint="Or press a row: plots, picture and an open replay show it"
        )
        self.table = Html(gui, svg.event_log(()))

        @self.filter.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._draw()

        @self.moment.on_update
        async def _(_: viser.GuiEvent) -> None:
            self.look_at(self._moments.get(self.moment.value))

    def show(self, fresh: list[Event]) -> bool:
        """Add events; True if anything changed."""
        told = [event for event in fresh if event.kind is not Kind.OVERRUN]  # the pace of the machine has its own place
        for event in told:
            self._add(event)
        return self._draw() if told else False

    def forget(self, event: Event) -> bool:
        """Take an event off the log; True if it was there."""
        row = next((row for row in self._rows if row.event == event), None)
        if row is None:
            return False
        row.count -= 1
        if not row.count:
            self._rows.remove(row)
        return self._draw()

    def _add(self, event: Event) -> None:
        if event.tick < self._tick:
            self._rows.append(LogRow(None))
        self._tick = event.tick
        for row in self._rows[: -2 - BETWEEN : -1]:
            if row.event is None:
                break
            if row.event.kind is event.kind and event.tick - row.event.tick <= CLOSE and _subject(row.event) == _subject(event):
                row.event, row.count = event, row.count + 1
                self._rows.remove(row)
                self._rows.append(row)
                return
        self._rows = [*self._rows, LogRow(event)][-LENGTH:]

    def _draw(self) -> bool:
        passes = FILTERS[self.filter.value]
        shown = [row for row in reversed(self._rows) if row.event is None or passes(row.event)]
        moments: dict[str, int] = {}
        lines: list[svg.LogLine] = []
        for row in shown:
            if row.event is None:
                lines.append(svg.LogLine("", "Started over", Colour.GREY, "", 0))
                moments = {name: tick for name, tick in moments.items() if tick > 0}
                continue
            time, text = f"{row.event.tick / TICK_RATE:.2f} s", _text(row.event, self._joints)
            moment = f"{time} {text}"
            moments.setdefault(moment, row.event.tick)
            lines.append(svg.LogLine(time, text, SEVERITY_COLOURS[TABLE[row.event.kind].severity], moment, row.count))
        self._moments = moments
        changed = self.table.show(svg.event_log(lines))
        if self.moment.options != (offered := (NOW, *moments)):
            before = self.moment.value
            self.moment.options = offered
            if before in offered and self.moment.value != before:
                self.moment.value = before
        return changed


def _text(event: Event, joints: Sequence[str]) -> str:
    return setting_change(event, joints) if event.kind in (Kind.SETTING_CHANGED, Kind.SETTING_REFUSED) else render(event)[0]


def _subject(event: Event) -> tuple[object, ...]:
    """What the event is about: two settings, walls or parameters are not the same."""
    return tuple(event.values.get(name) for name in ("name", "wall", "parameter", "part"))
