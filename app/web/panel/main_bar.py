"""The main bar: run, pause, stop, the way to the start, speed, and which step of which program is done; on every tab."""

from collections.abc import Callable
from typing import NamedTuple

import viser

from app.urscript.running.script_runner import ScriptRunner
from app.web.panel.shown_state import ShownState
from app.web.running import Running
from app.web.widgets import style, svg
from app.web.widgets.html import Html, enable
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import Command
from pendant.program.steps import ProgramState

SHARES = (0.19, 0.22, 0.19, 0.4)
"""Of the width of the row, for each of its buttons."""

NO_PROGRAM = "No program yet: register a waypoint"


class Taught(NamedTuple):
    """The program that Run begins."""

    steps: tuple[str, ...]  # in words
    begin: Callable[[], None]
    target: bool  # its first step that moves has a place to move to


class MainBar:
    """Its part of the pendant. Its controls run on viser's event loop; `show` runs in the painter.

    Attributes:
        taught: what Run begins; the tab that teaches gives it.
        scripts: runs programs in URScript; None: nobody does.
        ended: told of each press of Stop.
        start: the button that moves to the start while it is held.
    """

    def __init__(self, gui: viser.GuiApi, loop: Running) -> None:
        self._loop = loop
        self._name = ""  # of the program that was loaded last
        self.taught: Callable[[], Taught] = lambda: Taught((), lambda: None, False)
        self.scripts: ScriptRunner | None = None
        self.ended: Callable[[], None] = lambda: None
        self.run = gui.add_button("Run", color="gray", disabled=True, hint="The program, or what is paused")
        self.pause = gui.add_button("Pause", color="gray", disabled=True)
        self.stop = gui.add_button("Stop", color="gray", disabled=True, hint="The program, or the payload wizard")
        self.start = gui.add_button("Move to start", color="gray", disabled=True, hint="Hold it: to where the program begins")
        row = (self.run, self.pause, self.stop, self.start)
        Html(gui, style.row([button._impl.uuid for button in row], SHARES, held=self.start._impl.uuid))
        self.home = gui.add_button(
            "Back to my cell", color="gray", visible=False, hint="The scenario ends; nothing of it is kept"
        )
        self.line = Html(gui, svg.program_line(NO_PROGRAM))
        self.speed = gui.add_slider(
            "Speed [%]", min=0, max=100, step=5, initial_value=100, hint="Of programs and of jogging, at once"
        )
        self._connect()

    @property
    def count(self) -> int:
        """Steps of the program that Run would begin."""
        return len(self.taught().steps)

    def show(self, state: ShownState, decision: Decision, fresh: list[Event]) -> bool:
        """Show where the program is, and what can be pressed; True if anything changed."""
        for event in fresh:
            if event.kind is Kind.PROGRAM_LOADED:
                self._name = str(event.values["name"])
        percent = round(100.0 * self._loop.settings.program.speed)
        changed = self.speed.value != percent
        if changed:
            self.speed.value = percent
        return any(
            [
                changed,
                enable(self.run, state.runs),
                enable(self.pause, state.pauses),
                enable(self.stop, state.stops),
                enable(self.start, state.jogs and self.taught().target),
                self.line.show(svg.program_line(self._said(decision))),
            ]
        )

    def _said(self, decision: Decision) -> str:
        steps = self.taught().steps
        if decision.program not in (ProgramState.RUNNING, ProgramState.PAUSED):
            return f"Program: {len(steps)} step{'s' if len(steps) != 1 else ''}" if steps else NO_PROGRAM
        if self.scripts is not None and self.scripts.state is not None:
            return f'Script "{self._name}", line {self.scripts.line}'
        return f'Program "{self._name}", step {decision.step}'

    def _go_on(self) -> None:
        """Begin the program, or let what is paused go on."""
        scripts = self.scripts
        if self._loop.latest().decision.program is not ProgramState.PAUSED:
            self.taught().begin()
        elif scripts is not None and scripts.state is not None:
            scripts.resume()
        else:
            self._loop.desk.command(Command.RESUME_PROGRAM)

    def _halt(self) -> None:
        if self.scripts is not None and self.scripts.state is not None:
            self.scripts.pause()
        else:
            self._loop.desk.command(Command.PAUSE_PROGRAM)

    def _end(self) -> None:
        """End what moves the arm by itself."""
        self.ended()
        if self.scripts is not None and self.scripts.state is not None:
            self.scripts.stop()
        elif self._loop.latest().decision.wizard.doing:
            self._loop.desk.command(Command.WIZARD_CLEAR)
        else:
            self._loop.desk.command(Command.STOP_PROGRAM)

    def _connect(self) -> None:
        for button, act in ((self.run, self._go_on), (self.pause, self._halt), (self.stop, self._end)):

            @button.on_click
            async def _(_: viser.GuiEvent, act: Callable[[], None] = act) -> None:
                act()

        @self.speed.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:  # a person, and not the page bringing itself up to date
                self._loop.desk.set({"program.speed": float(self.speed.value) / 100.0})
