"""The teach tab: waypoints, a program of steps, and running it."""

from collections.abc import Callable

import msgspec
import numpy as np
import viser
import yaml

from app.files.checked import BadInput, parse
from app.files.taught_program import MOST, Lesson, TaughtStep, Waypoint, program
from app.web.running import Running
from app.web.scene.ghost import Ghost
from app.web.tabs.step_editor import NO_WAYPOINT, Edits, StepEditor, waypoints_of
from app.web.widgets import svg
from app.web.widgets.html import Html, enable
from app.web.widgets.svg import Colour
from app.web.widgets.typed import Typed
from pendant.inputs import Command
from pendant.program.steps import ProgramState, misfit
from pendant.tick.modes import Mode
from sim.arm.arm_file import Arm
from sim.arm.frames import quaternion_from_matrix
from sim.exchange.snapshot import Snapshot

BLUE = (25, 113, 194)
HERE = 0.02
"""The arm is at a waypoint when no joint is further from it [rad]."""

APART = 0.08
"""A recorded path gets a waypoint whenever a joint has turned by this much since the last one [rad]."""


class Teach:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter."""

    def __init__(self, server: viser.ViserServer, loop: Running, arm: Arm) -> None:
        gui = server.gui
        self._loop, self._arm = loop, arm
        self.edits = Edits()
        self.ghost = Ghost(server, arm, "/ghost/waypoint", BLUE)
        self._running: list[TaughtStep] = []  # the steps of the program handed over last
        self._first: int | None = None  # place of the first of them in the plan; None: they are none of it
        self._next = 0  # the step that `TaughtStep` does
        self.register = gui.add_button("Register waypoint", icon=viser.Icon.MAP_PIN_PLUS, disabled=False, hint="Key: M")
        with gui.add_folder("Program"):
            self.message = Html(gui)
            self.steps = StepEditor(gui, self.edits, self._edited)
            self.step = gui.add_button("Do one step", color="gray", hint="The chosen step, then the next")
            enable(self.step, False)  # there is none yet
        with gui.add_folder("Waypoints"):
            self.choice: viser.GuiDropdownHandle[str] = gui.add_dropdown("Waypoint", waypoints_of(self.lesson))
            self.edit = gui.add_button_group("Arm", ("Go to", "Re-teach"))
            self.order = gui.add_button_group("Order", ("↑", "↓", "✕"))
            self.name = gui.add_text("Name", "")
            self._typed = Typed(self.name, self._rename)
            self.record = gui.add_checkbox("Record a path", False)
        self.save = gui.add_button("Save as file", color="gray")
        self.load = gui.add_upload_button("Load a file", mime_type=".yaml", color="gray")
        self.filed = Html(gui)  # what became of the file, beside its button
        self._connect()
        self._refresh()

    @property
    def lesson(self) -> Lesson:
        """What was taught."""
        return self.edits.now

    def show(self, snapshot: Snapshot) -> bool:
        """Show where the program is; record a path while the arm is guided; True if anything changed."""
        decision = snapshot.decision
        if self.record.value and decision.mode is Mode.FREE_DRIVE:
            last = self.lesson.waypoints[-1].q if self.lesson.waypoints else None
            if last is None or float(np.max(np.abs(snapshot.estimate.q - np.array(last)))) > APART:
                self._register(snapshot)
        active = decision.program in (ProgramState.RUNNING, ProgramState.PAUSED)
        at = decision.step if active else 0
        name: str | None = None
        if active and 0 < at <= len(self._running):
            name = self._running[at - 1].to
        elif self.choice.value != NO_WAYPOINT and decision.mode is not Mode.RUN:
            name = self.choice.value
        target = next((w.q for w in self.lesson.waypoints if w.name == name), None)
        if target is not None and float(np.max(np.abs(snapshot.estimate.q - np.array(target)))) < HERE:
            target = None  # the arm is there
        return any(
            [
                self.steps.show(self._now(at), decision.program.value.lower() if active else ""),
                self.ghost.show(target, snapshot, name or ""),
                enable(self.register, decision.mode is not Mode.RUN),
                enable(self.step, bool(self.lesson.plan) and decision.mode in (Mode.TEACH, Mode.NORMAL)),
            ]
        )

    def mark(self) -> None:
        """Register where the arm is; in free-drive that counts as guiding it (FD-13)."""
        self._loop.desk.command(Command.REGISTER_WAYPOINT)
        self._register(self._loop.latest())

    def _now(self, at: int) -> int | None:
        """The place in the plan of step `at` of the program that runs, unless the plan has changed since."""
        if self._first is None or not 0 < at <= len(self._running):
            return None
        now, plan = self._first + at - 1, self.lesson.plan
        return now if now < len(plan) and plan[now] == self._running[at - 1] else None

    def _register(self, snapshot: Snapshot) -> None:
        if len(self.lesson.waypoints) < MOST:
            waypoint = self._here(snapshot, self.lesson.free_name())
            self.edits.to(self.lesson.with_waypoint(waypoint))
            self._refresh(waypoint.name)
            self.steps.refresh(len(self.lesson.plan) - 1)

    def _here(self, snapshot: Snapshot, name: str) -> Waypoint:
        """Where the arm is, as a waypoint."""
        seen = snapshot.estimate
        return Waypoint(
            name=name,
            q=np.round(seen.q, 6).tolist(),
            position=np.round(seen.tcp[:3], 6).tolist(),
            quaternion=np.round(quaternion_from_matrix(seen.R_BF @ snapshot.R_FT), 8).tolist(),
        )

    def _edited(self, place: str | None) -> None:
        """The program was edited, or another step chosen, which single steps begin with; `place` is the waypoint it leads to."""
        self._next = self.steps.chosen or 0
        self._refresh(place)

    def _refresh(self, chosen: str | None = None) -> None:
        names = waypoints_of(self.lesson)
        wanted = next((name for name in (chosen, self.choice.value) if name is not None and name in names), names[-1])
        if self.choice.options != names:
            self.choice.options = names
        if self.choice.value != wanted:
            self.choice.value = wanted
        self._typed.bring("" if wanted == NO_WAYPOINT else wanted)
        self.steps.refresh()

    def _hand_over(self, steps: list[TaughtStep], first: int | None, repeat: int = 1) -> None:
        """Load and start a program of these steps; `first` is the place of the first one in the plan."""
        if not steps:
            self.message.show(svg.note("Nothing to run", "Register a waypoint, or insert a step.", Colour.AMBER))
            return
        made = program(self.lesson, steps, repeat)
        if (reason := misfit(made, self._arm.n)) is not None:
            self.message.show(svg.note("Not run", f"{reason[0].upper()}{reason[1:]}.", Colour.AMBER))
            return
        self._running, self._first = steps, first
        self._loop.desk.load(made)
        self._loop.desk.command(Command.START_PROGRAM)
        self.message.show("")

    def _connect(self) -> None:
        def on(control: viser.GuiButtonHandle | viser.GuiButtonGroupHandle, act: Callable[[], None]) -> None:
            @control.on_click
            async def _(_: viser.GuiEvent) -> None:
                act()

        on(self.register, self.mark)
        on(self.edit, self._edit)
        on(self.order, self._reorder)
        on(self.step, self.do_one)

        @self.choice.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self.name.value = self.choice.value

        @self.save.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                event.client.send_file_download("taught.yaml", self.file(), save_immediately=True)

        @self.load.on_upload
        async def _(_: viser.GuiEvent) -> None:
            self.read(self.load.value.name, self.load.value.content)

    def take(self, lesson: Lesson) -> None:
        """Show what was taught before."""
        if lesson != self.lesson:
            self.edits.to(lesson)
            self._refresh()

    def file(self) -> bytes:
        """What was taught, as a file."""
        return yaml.safe_dump(msgspec.to_builtins(self.lesson), sort_keys=False, allow_unicode=True).encode()

    def read(self, name: str, content: bytes) -> None:
        """Take what a file teaches, or say in a line why not."""
        try:
            lesson = parse(content.decode("utf-8", "replace"), Lesson, name)
            for number, waypoint in enumerate(lesson.waypoints):
                if len(waypoint.q) != self._arm.n:
                    raise BadInput(name, f"waypoints[{number}].q", waypoint.q, f"{self._arm.n} joint angles")
        except BadInput as refusal:
            self.filed.show(svg.note("File refused", str(refusal), Colour.AMBER))
            return
        self.edits.to(lesson)
        self._refresh()
        self.filed.show(svg.note("File loaded", f"{len(lesson.waypoints)} waypoints, {len(lesson.plan)} steps.", Colour.GREEN))

    def _edit(self) -> None:
        name = self.choice.value
        if name == NO_WAYPOINT:
            return
        if self.edit.value == "Go to":
            self._hand_over([TaughtStep(do="joint", to=name)], None)
        else:
            snapshot = self._loop.latest()
            if snapshot.decision.mode is not Mode.RUN:
                self.edits.to(self.lesson.taught_again(name, self._here(snapshot, name)))
        self._refresh(name)

    def _reorder(self) -> None:
        name = self.choice.value
        if name == NO_WAYPOINT:
            return
        if self.order.value == "✕":
            self.edits.to(self.lesson.without(name))
        else:
            self.edits.to(self.lesson.moved(name, -1 if self.order.value == "↑" else 1))
        self._refresh(name)

    def _rename(self, new: str) -> None:
        old = self.choice.value
        taken = any(waypoint.name == new for waypoint in self.lesson.waypoints)
        if old != NO_WAYPOINT and len(new) <= 40 and not taken:
            self.edits.to(self.lesson.renamed(old, new))
            self._refresh(new)
        else:
            self._refresh(old)

    @property
    def start(self) -> Waypoint | None:
        """Where its first move leads; None: it moves to no waypoint."""
        first = next((step.to for step in self.lesson.plan if step.to is not None), None)
        return None if first is None else self.lesson.find(first)

    def begin(self) -> None:
        """Run the program from its first step."""
        self._next = 0
        self._hand_over(self.lesson.plan, 0, self.lesson.repeat)

    def do_one(self) -> None:
        """Do one step, and make ready for the one after it."""
        plan = self.lesson.plan
        self._hand_over(plan[self._next : self._next + 1], self._next)
        self._next = (self._next + 1) % max(len(plan), 1)

    def ended(self) -> None:
        """The program was ended by hand: single steps begin anew."""
        self._next = 0
