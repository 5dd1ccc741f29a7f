"""The pendant: mode light, free-drive button, countdowns, messages, emergency stop. Reads snapshots, writes the desk."""

import viser

from app.web.access.guard import Guard
from app.web.panel.activation_switches import ActivationSwitches
from app.web.panel.button_holds import ButtonHolds
from app.web.panel.clock_pace import pace
from app.web.panel.main_bar import MainBar
from app.web.panel.panel_message import HINTS, Remembered
from app.web.panel.reasons_at_the_arm import rgb, show_reasons
from app.web.panel.shown_state import ShownState, shown
from app.web.panel.state_words import FIGURES, PERIOD_COLOURS, PERIOD_WORDS, pull_row, user_row
from app.web.panel.way_back import WayBack
from app.web.running import Running
from app.web.scene.arm_marks import ArmMarks
from app.web.scene.hit_mark import HitMark
from app.web.widgets import svg
from app.web.widgets.html import Html, enable
from app.web.widgets.svg import Bar, Colour
from pendant.all_settings import Settings, safety_checksum
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import Command
from pendant.tick.limit_engine import Monitored
from pendant.tick.modes import TICK_RATE, Mode, Phase
from pendant.walls.containment import TETHER
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot

ACTIVE, IDLE = (25, 113, 194), (134, 142, 150)
"""Colour of the free-drive button where it does something, and where free-drive cannot begin."""

HOLD = "Hold for free-drive"
CONFIRM, LEAVE = "Press to confirm", "Short press: leave"
"""What is written on the free-drive button."""

HOLD_RATE = 30.0
"""How often a held button is asked to say so [Hz]; viser sends at most 20 a second of all controls of a panel."""

LEAST_SPEED = 0.002
"""A speed below this is not told by its figure [m/s]."""

BARS = 5
"""Monitored values shown at once: those nearest to their limits."""


class Panel:
    """The pendant docked on the right, with the emergency stop in a panel of its own below it."""

    def __init__(self, server: viser.ViserServer, guard: Guard, loop: Running, arm: Arm) -> None:
        self._loop = loop
        self.holds = ButtonHolds(loop)
        self._remembered = Remembered()
        self.excused: Event | None = None  # a silence of the button that was a plain release after all
        self._settings: Settings | None = None
        self._digest = ""
        gui = server.gui
        gui.set_panel_label(arm.title)  # more does not fit
        self.light = Html(gui)
        self.bar = MainBar(gui, loop)
        self.free_drive = gui.add_button(HOLD, color=ACTIVE, icon=viser.Icon.HAND_STOP)
        self.rings = Html(gui)
        self.leave = gui.add_button("Leave free-drive", color="gray", disabled=True, hint="Key: L")
        self.note = Html(gui, svg.note(*HINTS[Mode.TEACH][:3]))
        self.back = WayBack(server, arm)
        self.marks = ArmMarks(server, arm)
        self.hit = HitMark(server, arm)
        self.mode = gui.add_button_group("Mode", ("TEACH", "NORMAL"))
        self.numbers = Html(gui)  # after what is always in sight: it grows and shrinks
        self.activation = ActivationSwitches(gui, guard, loop)
        # A panel of its own: viser sends only the newest of several messages that the controls of one panel send within 50 ms,
        # so that a held button beside it could swallow the stop of a second finger.
        self.safety = gui.add_panel()
        with self.safety.add_tab("Safety"):
            self.stop = gui.add_button("EMERGENCY STOP", color=(201, 42, 42), icon=viser.Icon.ALERT_OCTAGON, hint="Key: X")
            self.reset = gui.add_button("Reset", color="gray", disabled=True)
        gui.main_panel.dock_right()
        gui.main_panel.set_width(304)
        self.safety.dock_below(gui.main_panel)
        guard.for_anyone(self.stop)
        self._connect()

    def show(self, snapshot: Snapshot, fresh: list[Event]) -> bool:
        """Show a snapshot and the events since the last call; True if anything changed."""
        decision = snapshot.decision
        for event in fresh:
            self._remembered.take(event)
            if event.kind is Kind.HOLD_SILENT:
                self.holds.silence()
        self.excused = self.holds.excused(fresh, snapshot.tick)
        if self.excused is not None:
            self._remembered.forget(self.excused)
        self._remembered.see(decision, snapshot.tick)
        self.state = state = shown(
            decision,
            self._loop.settings,
            self._remembered,
            paused=self._loop.paused,
            failure=self._loop.failure,
            steps=self.bar.count,
        )
        self.said = state.text
        whole = not self._loop.failure
        changed = [
            self.light.show(
                svg.light(state.name, state.word, state.safety, state.colour, pace=pace(self._loop) if whole else None)
            ),
            self.note.show(svg.note(state.text.headline, state.text.text, state.text.colour, state.text.reasons)),
            self.bar.show(state, decision, fresh),
            enable(self.leave, state.leaves),
            enable(self.free_drive, whole),
            enable(self.reset, state.resets),
            self._name_button(decision, state),
            self._show_free_drive(snapshot, fresh, state) if whole else self.rings.show(svg.windows([])),
        ]
        return any(changed)

    def _show_free_drive(self, snapshot: Snapshot, fresh: list[Event], state: ShownState) -> bool:
        """Periods, the way back, marks on the arm, figures; True if anything changed."""
        decision, colour, bars = snapshot.decision, state.colour, snapshot.decision.monitored
        changed = [
            self.rings.show(svg.windows([self._window(p.name, p.ticks, p.total, colour) for p in decision.periods])),
            self.back.show(snapshot, fresh),
            self.marks.light(rgb(colour)),
            show_reasons(self.said, self._remembered, snapshot, marks=self.marks, hit=self.hit),
            self.numbers.show(svg.bars(_nearest(bars), len(bars)) if bars else svg.facts(self._numbers(snapshot), FIGURES)),
            self.activation.show(snapshot),
        ]
        return any(changed)

    def let_go(self, client: int) -> None:
        """Release what `client` holds: the button, the enabling device."""
        self.activation.let_go(client)
        self.holds.let_go(client)

    def _name_button(self, decision: Decision, state: ShownState) -> bool:
        """While a confirmation is asked for, the button gives it (FD-8); in free-drive a short press leaves (FD-8a).

        Where free-drive cannot begin it is grey. It is not disabled then: that would lose the pointer-up of a press.
        """
        free = decision.mode is Mode.FREE_DRIVE and decision.phase is not Phase.HELD
        label = CONFIRM if decision.phase is Phase.CONFIRM else LEAVE if free else HOLD
        changed = self.free_drive.label != label
        if changed:
            self.free_drive.label = label
        colour = ACTIVE if state.frees else IDLE
        if self.free_drive.color != colour:
            self.free_drive.color, changed = colour, True
        return changed

    def _window(self, name: str, ticks: int, total: int, colour: Colour) -> svg.Window:
        word = PERIOD_WORDS.get(name, name.capitalize())
        return svg.Window(word, ticks / TICK_RATE, ticks / max(total, 1), PERIOD_COLOURS.get(name, colour))

    def _numbers(self, snapshot: Snapshot) -> list[tuple[str, str]]:
        seen = snapshot.estimate
        settings = self._loop.settings
        if settings is not self._settings:
            self._settings, self._digest = settings, safety_checksum(settings)
        return [
            ("Speed of the tool", _speed(seen.v_tcp)),
            ("Speed of the elbow", _speed(seen.v_elbow)),
            *pull_row(snapshot.pull),
            *user_row(snapshot.user),
            *_wall(snapshot.decision),
            ("Payload configured", f"{snapshot.configured_mass:.2f} kg"),
            ("Safety checksum", self._digest),
        ]

    def _connect(self) -> None:
        desk = self._loop.desk

        @self.free_drive.on_hold(callback_hz=HOLD_RATE)
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self.holds.hold(event.client_id)

        @self.free_drive.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self.holds.lift(event.client_id)

        def sends(button: viser.GuiButtonHandle, command: Command) -> None:
            @button.on_click
            async def _(_: viser.GuiEvent) -> None:
                desk.command(command)

        sends(self.stop, Command.EMERGENCY_STOP)
        sends(self.reset, Command.RESET)
        sends(self.leave, Command.LEAVE_FREE_DRIVE)

        @self.mode.on_click
        async def _(_: viser.GuiEvent) -> None:
            desk.command(Command.TEACH if self.mode.value == "TEACH" else Command.NORMAL)


def _speed(v: float) -> str:
    """A speed [m/s]; less than what noise alone makes at rest has no figure, which would flicker."""
    return f"{1000 * v:.0f} mm/s" if v >= LEAST_SPEED else f"under {1000 * LEAST_SPEED:.0f} mm/s"


def _wall(decision: Decision) -> list[tuple[str, str]]:
    """The wall that the arm is nearest to, or furthest beyond; the tether only when it resists, since it goes along."""
    walls = [wall for wall in decision.walls if wall.name != TETHER or wall.near > 0.0]
    if not walls:
        return []
    wall = max(walls, key=lambda wall: wall.distance)
    return [(f"{wall.name}, {wall.part}", f"{1000 * abs(wall.distance):.0f} mm {'beyond' if wall.exceeded else 'left'}")]


def _nearest(monitored: tuple[Monitored, ...]) -> list[Bar]:
    """The bars of the values nearest to their limits, nearest first; to a tenth, so that noise does not reorder them."""
    bars = [Bar(value.name, value.part, value.value, value.limit, value.unit) for value in monitored]
    return sorted(bars, key=lambda bar: -round(bar.share, 1))[:BARS]
