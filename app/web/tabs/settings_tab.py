"""The settings in three depths: a safety page, presets, and every setting with search; all from the one schema."""

import asyncio
import threading
from collections.abc import Callable
from typing import Any

import viser

from app.files.checked import BadInput
from app.web.running import Running
from app.web.tuning.limit_presets import AS_SHIPPED, limit_presets, preset_of, told_limits
from app.web.tuning.presets import as_file, changes, from_file, presets
from app.web.tuning.setting_words import SAFETY, about, found, label, name_of, section_of, title_of, told
from app.web.widgets import style, svg
from app.web.widgets.html import Html, enable
from app.web.widgets.svg import Colour
from pendant.all_settings import Settings, describe, find, safety_checksum, value_of
from pendant.events.event import Event, Kind
from pendant.limits.axis_locks import JOINTS
from pendant.settings.schema import SettingRow, Value
from pendant.tick.modes import Mode, Phase
from sim.exchange.snapshot import Snapshot

SETTLED = 0.6
"""A number or a search counts once nobody has typed for this long: of "30" the "3" is not meant [s]."""

MOST = 24
"""Rows shown of a search."""

UNDOS = 50
"""Changes that can be taken back."""

VIEWS = ("Safety", "Presets", "All settings")
BASIC = tuple(dict.fromkeys(section_of(row) for row in describe() if row.basic))
"""The sections that hold a basic setting."""


class SettingsTab:
    """The tab with the settings."""

    def __init__(self, gui: viser.GuiApi, tab: viser.GuiTabHandle, loop: Running, joints: int) -> None:
        self._gui, self._tab, self._loop = gui, tab, loop
        self._absent = frozenset(f"joints.{name}" for name in JOINTS[joints:])  # joints that this arm has not
        self._settings: Settings | None = None
        self._locked = False
        self._lock = threading.Lock()  # controls are made on viser's event loop and brought up to date by the painter
        self._typing: dict[str, asyncio.TimerHandle] = {}
        self._before: list[dict[str, Value]] = []  # what each change replaced
        self.controls: dict[str, Any] = {}
        self._rows: list[SettingRow] = []
        self._presets = dict(presets())  # by title, with those of files
        self._texts: dict[str, Html] = {}
        self.view = gui.add_button_group("View", VIEWS)
        self._chosen = VIEWS[0]
        self._line = Html(gui)
        self.undo = gui.add_button("Undo", color="gray", disabled=True)
        self.message = Html(gui)
        self.limits = Html(gui)
        self.limit_preset = gui.add_dropdown(
            "Robot limits", tuple(limit_presets()), initial_value=AS_SHIPPED, hint="RL-4: presets"
        )
        self.limit_source = Html(gui)
        self.take_limits = gui.add_button("Take these limits")
        self.preset = gui.add_dropdown("Preset", tuple(presets()), visible=False)
        self.listed = Html(gui)
        self.take = gui.add_button("Take this preset", visible=False)
        self.save = gui.add_button("Save settings as file", color="gray", visible=False)
        self.load = gui.add_upload_button("Load settings", mime_type=".yaml", color="gray")
        self._hidden = Html(gui)
        self.search = gui.add_text("Search", "", hint="Search names and descriptions")
        self.expert = gui.add_checkbox("Expert settings", False, hint="Without it: what most users need, and what was changed.")
        self.section = gui.add_dropdown("Section", tuple(map(title_of, BASIC)))
        self.defaults = gui.add_button("Section as shipped", color="gray")
        self._show_view()
        self._fill()
        self._connect()

    def _connect(self) -> None:
        def again(control: Any, act: Callable[[], None]) -> None:
            register = control.on_click if control is self.view else control.on_update

            @register
            async def _(_: viser.GuiEvent) -> None:
                with self._lock, self._tab:
                    act()
                    self._fill()

        again(self.view, self._show_view)
        for control in (self.section, self.preset, self.limit_preset):
            again(control, lambda: None)
        again(self.expert, self._offer)
        self.search.on_update(self._typed_search)

        @self.defaults.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._change({row.name: row.default for row in describe() if title_of(section_of(row)) == self.section.value})

        @self.take.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._change(
                {change.row.name: change.new for change in changes(self._loop.settings, self._presets[self.preset.value])}
            )

        @self.take_limits.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._change(limit_presets()[self.limit_preset.value].settings)

        @self.save.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                event.client.send_file_download("settings.yaml", as_file(self._loop.settings), save_immediately=True)

        @self.load.on_upload
        async def _(_: viser.GuiEvent) -> None:
            self.read(self.load.value.name, self.load.value.content)

        @self.undo.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self._before:
                self._loop.desk.set(self._before.pop())

    def read(self, name: str, content: bytes) -> None:
        """Offer the settings of a file as a preset, which lists what it would change; or say in a line why not."""
        try:
            preset = from_file(name, content)
        except BadInput as refusal:
            self.message.show(svg.note("File refused", str(refusal), Colour.AMBER))
            return
        title = preset.title if preset.title not in presets() else f"{preset.title} (file)"
        with self._lock:  # the new choice makes another thread fill the tab
            self._presets = dict(presets()) | {title: preset}
            self.preset.options = tuple(self._presets)
            self.preset.value = title
            self.message.show(svg.note("File loaded", "Below is what it would change.", Colour.GREEN))
            self._refresh(self._loop.settings)

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Bring the controls up to date with the settings that hold; True if anything changed."""
        settings = self._loop.settings
        decision = snapshot.decision
        locked = decision.mode in (Mode.FREE_DRIVE, Mode.RUN) or decision.phase is Phase.SEQUENCE
        undone = enable(self.undo, bool(self._before))
        with self._lock:
            relocked = locked != self._locked
            if relocked:
                self._locked = locked
                self._let()
            if not relocked and settings is self._settings and all(event.kind is not Kind.SETTING_REFUSED for event in fresh):
                return undone
            self._settings = settings
            self._refresh(settings)
        return True

    def _show_view(self) -> None:
        """Show the controls of the chosen view alone."""
        self.message.show("")
        self._chosen = self.view.value if self.view.value in VIEWS else VIEWS[0]
        for control in (self.preset, self.take, self.save):
            control.visible = self._chosen == VIEWS[1]
        for control in (self.limit_preset, self.take_limits):
            control.visible = self._chosen == VIEWS[0]
        self._hidden.show(style.shown(self.load._impl.uuid, self._chosen == VIEWS[1]))
        for control in (self.search, self.expert, self.section, self.defaults):
            control.visible = self._chosen == VIEWS[2]

    def _fill(self) -> None:
        """Make the controls of the chosen view; within the tab."""
        for handle in (*self.controls.values(), *self._texts.values()):
            handle.remove()
        controls: dict[str, Any] = {}
        self._texts = {}
        settings = self._loop.settings
        self._rows = self._wanted(settings)
        for row in self._rows[:MOST] if self.search.value.strip() else self._rows:
            value = value_of(settings, row.name)
            controls[row.name] = self._control(row, value)
            self._texts[row.name] = Html(self._gui, svg.fine_print(about(row, value)))
        self._rows = [row for row in self._rows if row.name in controls]
        self.controls = controls
        self._let()
        self._refresh(settings)

    async def _typed_search(self, _: viser.GuiEvent) -> None:
        self._when_typed("search", self._find)

    def _when_typed(self, what: str, act: Callable[[], None]) -> None:
        """Act once nobody has typed there for a while."""
        waiting = self._typing.pop(what, None)
        if waiting is not None:
            waiting.cancel()

        def settled() -> None:
            del self._typing[what]
            act()

        self._typing[what] = asyncio.get_running_loop().call_later(SETTLED, settled)

    def _find(self) -> None:
        """Show what the search finds: with each letter, rows would come and go that a page is still told of."""
        with self._lock, self._tab:
            self._fill()

    def _wanted(self, settings: Settings) -> list[SettingRow]:
        if self._chosen == VIEWS[0]:
            return [find(name) for name in SAFETY]
        if self._chosen == VIEWS[1]:
            return []
        if self.search.value.strip():
            return [row for row in found(self.search.value, describe()) if row.name not in self._absent]
        return [row for row in describe() if title_of(section_of(row)) == self.section.value and self._shows(row, settings)]

    def _shows(self, row: SettingRow, settings: Settings) -> bool:
        if row.name in self._absent:
            return False
        return self.expert.value or row.basic or value_of(settings, row.name) != row.default

    def _offer(self) -> None:
        """Offer the sections that have something to show."""
        settings = self._loop.settings
        offered = dict.fromkeys(title_of(section_of(row)) for row in describe() if self._shows(row, settings))
        chosen = self.section.value
        self.section.options = tuple(offered)
        if chosen in offered:
            self.section.value = chosen

    def _label(self, row: SettingRow, value: Value) -> str:
        if self._chosen == VIEWS[0]:
            return label(row, value, SAFETY[row.name])
        return label(row, value, f"{title_of(section_of(row))}: {name_of(row)}" if self.search.value.strip() else "")

    def _control(self, row: SettingRow, value: Value) -> Any:
        text, hint = self._label(row, value), f"{row.id}: {row.name}"
        if row.choices:
            handle: Any = self._gui.add_dropdown(text, row.choices, initial_value=str(value), hint=hint)
        elif row.low is None or row.high is None:
            handle = self._gui.add_checkbox(text, bool(value), hint=hint)
        elif row.is_count:
            handle = self._gui.add_number(text, int(value), min=int(row.low), max=int(row.high), step=1, hint=hint)
        else:
            step = 10.0 ** round_down(row.high - row.low)
            handle = self._gui.add_number(text, float(value), min=row.low, max=row.high, step=step, hint=hint)
        handle.on_update(self._sets(row))
        return handle

    def _sets(self, row: SettingRow) -> Callable[[viser.GuiEvent], Any]:
        typed = row.low is not None

        async def update(event: viser.GuiEvent) -> None:
            if event.client_id is None:  # the page brings itself up to date
                return
            value: Value = event.target.value
            if not typed:
                self._change({row.name: value})
                return
            self._when_typed(row.name, lambda: self._change({row.name: value}))

        return update

    def _change(self, wanted: dict[str, Any]) -> None:
        """Ask for values, and remember what they replace."""
        now = self._loop.settings
        old = {name: value_of(now, name) for name, value in wanted.items() if value_of(now, name) != value}
        if old:
            self._before = [*self._before, old][-UNDOS:]
        self._loop.desk.set(wanted)

    def _let(self) -> None:
        for row in self._rows:
            enable(self.controls[row.name], not (row.locked and self._locked))
        enable(self.defaults, not self._locked)
        enable(self.take, not self._locked)
        enable(self.take_limits, not self._locked)

    def _refresh(self, settings: Settings) -> None:
        count = 0
        for row in describe():
            value = value_of(settings, row.name)
            count += value != row.default
            control = self.controls.get(row.name)
            if control is None:
                continue
            if control.value != value and row.name not in self._typing:
                control.value = value
            if control.label != (text := self._label(row, value)):
                control.label = text
            self._texts[row.name].show(svg.fine_print(about(row, value)))
        self._tell_limits(settings)
        state = "Locked while the arm is free or runs" if self._locked else "Changes apply immediately"
        self._line.show(svg.facts([("Safety checksum", safety_checksum(settings)), ("Changed", f"{count}"), ("Status", state)]))
        self.listed.show(self._changes(settings) if self._chosen == VIEWS[1] else "")

    def _changes(self, settings: Settings) -> str:
        """What taking the chosen preset would change."""
        preset = self._presets[self.preset.value]
        rows = [
            (f"{title_of(section_of(row))}: {name_of(row)}", told(old, row.unit), told(new, row.unit))
            for row, old, new in changes(settings, preset)
        ]
        return svg.differences(preset.text, rows)

    def _tell_limits(self, settings: Settings) -> None:
        """The robot's limits as they are, and the chosen preset of them."""
        if self._chosen != VIEWS[0]:
            self.limits.show("")
            self.limit_source.show("")
            return
        held = settings.robot_limits
        state = f"Robot limits: {preset_of(held)}." if held.on else "Robot limits are switched off (robot_limits.on)."
        self.limits.show(svg.limits(told_limits(held)) + svg.fine_print(state))
        chosen = limit_presets()[self.limit_preset.value]
        self.limit_source.show(svg.fine_print(f"{'Assumed. ' if chosen.assumed else ''}{chosen.source}"))


def round_down(span: float) -> int:
    """The power of ten of a step that divides `span` into 100 to 1000."""
    return next(power for power in range(-6, 4) if 100.0 * 10.0**power * 10.0 >= span)
