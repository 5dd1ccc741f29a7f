"""The pendant: mode light, free-drive button, countdowns, messages, emergency stop. Reads snapshots, writes the desk."""

from typing import Protocol

import viser

from app.web import style, svg
from app.web.guard import Guard
from app.web.hand import FORCE, Hand
from app.web.svg import Colour
from pendant.events import Event
from pendant.inputs import Button, Command
from pendant.modes import TICK_RATE, Mode, Phase, Safety
from pendant.table import TABLE, Effect, Severity, render
from sim.desk import Desk
from sim.snapshot import Snapshot

HOLD_RATE = 30.0
"""How often a held button is asked to say so [Hz]; viser sends at most 20 a second of all controls of a panel."""

ABOUT_TO_END = 1.0
"""A free-drive or restart period with less than this left is shown in amber [s]."""

LOG_LENGTH = 60
"""Events shown in the log."""

WORDS = {
    Mode.NORMAL: ("Holding still", Colour.GREEN),
    Mode.TEACH: ("Ready", Colour.GREEN),
    Mode.REMOTE: ("Remote control", Colour.GREY),
    Mode.RUN: ("Program runs", Colour.GREEN),
    Mode.FREE_DRIVE: ("Guide it by hand", Colour.BLUE),
    Mode.STOP: ("Stopped", Colour.RED),
}
SAFETY_WORDS = {
    Safety.NORMAL: "Normal",
    Safety.REDUCED: "Reduced",
    Safety.PROTECTIVE_STOP: "Protective stop",
    Safety.EMERGENCY_STOP: "Emergency stop",
}
SEVERITY_COLOURS = {
    Severity.INFO: Colour.GREY,
    Severity.NOTICE: Colour.BLUE,
    Severity.WARNING: Colour.AMBER,
    Severity.STOP: Colour.RED,
}


class Running(Protocol):
    """What the pendant needs of the loop, sim.loop.Loop."""

    desk: Desk
    speed: float
    paused: bool

    @property
    def actual_rate(self) -> float:
        """Simulated over real time, as it was lately."""
        ...

    @property
    def seed(self) -> int:
        """Seed of the scenario."""
        ...

    def latest(self) -> Snapshot:
        """The newest snapshot; RuntimeError when the simulation has ended."""
        ...

    def events(self, since: int) -> list[Event]:
        """Events from index `since` on."""
        ...

    def step_once(self) -> None:
        """While paused: one tick."""
        ...

    def reset(self) -> None:
        """Back to the scenario's start."""
        ...


class Html:
    """A piece of HTML that is sent only when it differs from what is shown."""

    def __init__(self, gui: viser.GuiApi, content: str = "", order: float | None = None) -> None:
        self.shown = content
        self._handle = gui.add_html(content, order=order)

    def show(self, content: str) -> bool:
        """Show `content`; True if that changed anything."""
        if content == self.shown:
            return False
        self.shown = content
        self._handle.content = content
        return True


class Panel:
    """The pendant docked on the right, the event log on the left."""

    def __init__(self, server: viser.ViserServer, guard: Guard, loop: Running, hand: Hand, title: str) -> None:
        self._loop = loop
        self._hand = hand
        self._guard = guard
        self._log: list[Event] = []
        self._read = 0
        self._holders: set[int] = set()
        self._message_shown = False
        gui = server.gui
        gui.set_panel_label(title)
        self._style = gui.add_html("")
        self.light = Html(gui)
        self.free_drive = gui.add_button("Hold for free-drive", color=(25, 113, 194), icon=viser.Icon.HAND_STOP)
        self.rings = Html(gui)
        self.note = Html(gui)
        self.leave = gui.add_button("Leave free-drive", color="gray", disabled=True)
        self.mode = gui.add_button_group("Mode", ("TEACH", "NORMAL"))
        self.facts = Html(gui)
        self.force = gui.add_slider("Hand force [N]", min=FORCE[0], max=FORCE[2], step=5.0, initial_value=FORCE[1])
        self._log_panel = gui.add_panel()
        with self._log_panel.add_tab("Events"):
            self.events = Html(gui, svg.table(()))
        self._sim_panel = gui.add_panel()
        with self._sim_panel.add_tab("Simulation"):
            self.clock = gui.add_button_group("Clock", ("Run", "Pause", "Step"))
            self.speed = gui.add_slider("Speed", min=0.1, max=1.0, step=0.1, initial_value=1.0)
            self.restart = gui.add_button("Start over", color="gray")
            self.rates = Html(gui)
        # A panel of its own: viser sends only the newest of several messages that the controls of one panel send within 50 ms,
        # so that a held button beside it could swallow the stop of a second finger.
        self._stop_panel = gui.add_panel()
        with self._stop_panel.add_tab("Safety"):
            self.stop = gui.add_button("EMERGENCY STOP", color=(201, 42, 42), icon=viser.Icon.ALERT_OCTAGON)
            self.reset = gui.add_button("Reset", color="gray", disabled=True)
        self._style.content = style.sheet(
            self.stop._impl.uuid,
            self.free_drive._impl.uuid,
            self.restart._impl.uuid,
            [button._impl.uuid for button in (self.leave, self.reset, self.restart)],
        )
        gui.main_panel.dock_right()
        gui.main_panel.set_width(304)
        self._stop_panel.dock_below(gui.main_panel)
        self._log_panel.dock_left()
        self._log_panel.set_width(264)
        self._sim_panel.dock_below(self._log_panel)
        guard.for_anyone(self.stop)
        self._connect()

    def show(self, snapshot: Snapshot) -> bool:
        """Show a snapshot and the events since the last call; True if anything changed."""
        fresh = self._loop.events(self._read)
        self._read += len(fresh)
        self._log = (self._log + fresh)[-LOG_LENGTH:]
        decision = snapshot.decision
        word, colour = WORDS[decision.mode]
        if any(p.name in ("free-drive", "restart") and p.ticks < ABOUT_TO_END * TICK_RATE for p in decision.periods):
            word, colour = "About to end", Colour.AMBER
        if decision.phase is Phase.ACTIVATION:
            word, colour = "Keep holding", Colour.BLUE
        changed = [
            self.light.show(svg.light(decision.mode.replace("_", "-"), word, SAFETY_WORDS[decision.safety], colour)),
            self.rings.show(svg.rings(self._ring(p.name, p.ticks, p.total, colour) for p in decision.periods)),
            self.facts.show(svg.facts(self._numbers(snapshot))),
            self.rates.show(svg.facts(self._pace(snapshot))),
            _enable(self.leave, decision.mode is Mode.FREE_DRIVE),
            _enable(self.reset, decision.mode is Mode.STOP),
        ]
        if fresh or not self._message_shown:
            self._message_shown = True
            changed.append(self.note.show(self._message()))
            changed.append(self.events.show(svg.table(_line(event) for event in reversed(self._log))))
        return any(changed)

    def fail(self, reason: str) -> None:
        """Say that the simulation is no more."""
        self.light.show(svg.light("FAULT", "Stopped", "Unknown", Colour.RED))
        self.note.show(svg.note("The simulation ended", f"{reason}. Start the program again.", Colour.RED))

    def let_go(self, client: int) -> None:
        """Release the button that `client` holds, if it does."""
        if client in self._holders:
            self._holders.discard(client)
            self._loop.desk.release(Button.FREE_DRIVE)

    def _ring(self, name: str, ticks: int, total: int, colour: Colour) -> str:
        shade = Colour.GREY if name == "cool-down" else colour
        return svg.ring(name.capitalize(), ticks / TICK_RATE, ticks / max(total, 1), shade)

    def _numbers(self, snapshot: Snapshot) -> list[tuple[str, str]]:
        seen = snapshot.estimate
        return [
            ("Tool speed", f"{1000 * seen.v_tcp:.0f} mm/s"),
            ("Elbow speed", f"{1000 * seen.v_elbow:.0f} mm/s"),
            ("Payload configured", f"{snapshot.configured_mass:.2f} kg"),
        ]

    def _pace(self, snapshot: Snapshot) -> list[tuple[str, str]]:
        state = "paused" if self._loop.paused else f"{self._loop.actual_rate:.2f} ×"
        return [
            ("Time", f"{snapshot.tick / TICK_RATE:.1f} s"),
            ("Rate asked, real", f"{self._loop.speed:.1f} ×, {state}"),
            ("Seed", f"{self._loop.seed}"),
        ]

    def _message(self) -> str:
        """The last event that ended or refused something, or that wants to be read."""
        for event in reversed(self._log):
            row = TABLE[event.kind]
            if row.effect is not Effect.INFO or row.severity >= Severity.NOTICE:
                headline, guidance = render(event)
                return svg.note(headline, guidance, SEVERITY_COLOURS[row.severity])
        return svg.note("Drag the arm", "It holds its place. Hold the button for free-drive, then drag it again.", Colour.GREY)

    def _connect(self) -> None:
        desk = self._loop.desk

        @self.free_drive.on_hold(callback_hz=HOLD_RATE)
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self._holders.add(event.client_id)
                desk.hold(Button.FREE_DRIVE)

        @self.free_drive.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self.let_go(event.client_id)

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

        @self.force.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._hand.cap = float(self.force.value)

        @self.clock.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self.clock.value == "Step":
                self._loop.paused = True
                self._loop.step_once()
            else:
                self._loop.paused = self.clock.value == "Pause"

        @self.speed.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._loop.speed = float(self.speed.value)

        @self.restart.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._loop.reset()


def _enable(button: viser.GuiButtonHandle, enabled: bool) -> bool:
    if button.disabled == (not enabled):
        return False
    button.disabled = not enabled
    return True


def _line(event: Event) -> tuple[str, str, Colour]:
    return f"{event.tick / TICK_RATE:.2f} s", render(event)[0], SEVERITY_COLOURS[TABLE[event.kind].severity]
