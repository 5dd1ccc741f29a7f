"""Every setting as a control, a section at a time, rendered from the one schema (pendant.all_settings.describe)."""

import threading
from collections.abc import Callable
from typing import Any

import viser

from app.web.running import Running
from app.web.widgets import svg
from app.web.widgets.html import Html, enable
from pendant.all_settings import Settings, describe, limits_checksum, value_of
from pendant.events.event import Event, Kind
from pendant.settings.schema import SettingRow, Value
from pendant.tick.modes import Mode, Phase
from sim.exchange.snapshot import Snapshot

CHANGED = "● "
"""Stands before the name of a setting that is not at its default."""


def section_of(row: SettingRow) -> str:
    """The section that a setting is shown in."""
    return ".".join(row.name.split(".")[: 2 if row.name.startswith("limits.") else 1])


SECTIONS = tuple(dict.fromkeys(section_of(row) for row in describe()))
BASIC = tuple(dict.fromkeys(section_of(row) for row in describe() if row.basic))
"""The sections that hold a basic setting."""


class SettingsTab:
    """The tab with the settings."""

    def __init__(self, gui: viser.GuiApi, tab: viser.GuiTabHandle, loop: Running) -> None:
        self._gui, self._tab, self._loop = gui, tab, loop
        self._settings: Settings | None = None
        self._locked = False
        self._lock = threading.Lock()  # controls are made on viser's event loop and brought up to date by the painter
        self._line = Html(gui)
        self.expert = gui.add_checkbox("Expert settings", False, hint="Without it: what most users need, and what was changed.")
        self.section = gui.add_dropdown("Section", BASIC)
        self.defaults = gui.add_button("Section to defaults", color="gray")
        self.controls: dict[str, Any] = {}
        self._rows: list[SettingRow] = []
        self._texts: list[viser.GuiHtmlHandle] = []
        self._fill()

        @self.section.on_update
        async def _(_: viser.GuiEvent) -> None:
            with self._lock, self._tab:
                self._fill()

        @self.expert.on_update
        async def _(_: viser.GuiEvent) -> None:
            with self._lock, self._tab:
                self._offer()
                self._fill()

        @self.defaults.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._loop.desk.set({row.name: row.default for row in describe() if section_of(row) == self.section.value})

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Bring the controls up to date with the settings that hold; True if anything changed."""
        settings = self._loop.settings
        decision = snapshot.decision
        locked = decision.mode in (Mode.FREE_DRIVE, Mode.RUN) or decision.phase is Phase.SEQUENCE
        with self._lock:
            relocked = locked != self._locked
            if relocked:
                self._locked = locked
                self._let()
            if not relocked and settings is self._settings and all(event.kind is not Kind.SETTING_REFUSED for event in fresh):
                return False
            self._settings = settings
            self._refresh(settings)
        return True

    def _fill(self) -> None:
        """Make the controls of the chosen section; within the tab."""
        for handle in (*self.controls.values(), *self._texts):
            handle.remove()
        controls: dict[str, Any] = {}
        self._texts = []
        settings = self._loop.settings
        self._rows = [row for row in describe() if section_of(row) == self.section.value and self._shows(row, settings)]
        for row in self._rows:
            controls[row.name] = self._control(row, value_of(settings, row.name))
            self._texts.append(self._gui.add_html(svg.fine_print(_about(row))))
        self.controls = controls
        self._let()
        self._refresh(settings)

    def _shows(self, row: SettingRow, settings: Settings) -> bool:
        return self.expert.value or row.basic or value_of(settings, row.name) != row.default

    def _offer(self) -> None:
        """Offer the sections that have something to show."""
        settings = self._loop.settings
        offered = tuple(dict.fromkeys(section_of(row) for row in describe() if self._shows(row, settings)))
        chosen = self.section.value
        self.section.options = offered
        if chosen in offered:
            self.section.value = chosen

    def _control(self, row: SettingRow, value: Value) -> Any:
        label = _label(row, value)
        if row.choices:
            handle: Any = self._gui.add_dropdown(label, row.choices, initial_value=str(value), hint=row.name)
        elif row.low is None or row.high is None:
            handle = self._gui.add_checkbox(label, bool(value), hint=row.name)
        elif row.is_count:
            handle = self._gui.add_number(label, int(value), min=int(row.low), max=int(row.high), step=1, hint=row.name)
        else:
            step = 10.0 ** round_down(row.high - row.low)
            handle = self._gui.add_number(label, float(value), min=row.low, max=row.high, step=step, hint=row.name)
        handle.on_update(self._sets(row.name))
        return handle

    def _sets(self, name: str) -> Callable[[viser.GuiEvent], Any]:
        async def update(event: viser.GuiEvent) -> None:
            if event.client_id is not None:  # a person, and not the page bringing itself up to date
                self._loop.desk.set({name: self.controls[name].value})

        return update

    def _let(self) -> None:
        for row in self._rows:
            enable(self.controls[row.name], not (row.locked and self._locked))
        enable(self.defaults, not self._locked)

    def _refresh(self, settings: Settings) -> None:
        count = 0
        for row in describe():
            value = value_of(settings, row.name)
            count += value != row.default
            control = self.controls.get(row.name)
            if control is None:
                continue
            if control.value != value:
                control.value = value
            if control.label != (label := _label(row, value)):
                control.label = label
        state = "Locked while the arm is free or runs" if self._locked else "Taken at the next tick"
        self._line.show(svg.facts([("Limits checksum", limits_checksum(settings)), ("Changed", f"{count}"), ("Now", state)]))


def round_down(span: float) -> int:
    """The power of ten of a step that divides `span` into 100 to 1000."""
    return next(power for power in range(-6, 4) if 100.0 * 10.0**power * 10.0 >= span)


def _label(row: SettingRow, value: Value) -> str:
    name = row.name.removeprefix(section_of(row) + ".").replace("_", " ").removesuffix(".max").replace(".", " · ")
    return f"{CHANGED if value != row.default else ''}{name}{f' [{row.unit}]' if row.unit else ''}"


def _about(row: SettingRow) -> str:
    if row.choices:
        return f"{row.id} · {row.text} · default {row.default}"
    if row.low is None or row.high is None:
        return f"{row.id} · {row.text} · default {'on' if row.default else 'off'}"
    return f"{row.id} · {row.text} · {row.low:g} … {row.high:g} {row.unit} · default {row.default:g}"
