"""The tools tab: tool in use, table and its editor, payload beyond the tool, the wizard that measures it, the sensor's zero."""

import math
from collections.abc import Callable, Sequence

import viser

from app.web.access.guard import Guard
from app.web.running import Running
from app.web.tabs.tool_editor import ToolEditor
from app.web.tabs.tool_frame import ToolFrame, ToolPlace
from app.web.tool_point.touching_poses import TouchingPoses
from app.web.widgets import svg
from app.web.widgets.html import Html, enable, reveal
from app.web.widgets.svg import Colour
from pendant.decision import Decision
from pendant.equipment.load import Load
from pendant.equipment.payload_fit import LEAST
from pendant.equipment.tools import Tool
from pendant.inputs import Command
from pendant.program.steps import ProgramState
from pendant.tick.modes import Mode, Phase
from pendant.tooling.payload_wizard import Progress
from pendant.tooling.tool_in_use import Fitting
from pendant.tooling.wrist_postures import WANTED
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot

FARTHEST = 300.0
"""Largest coordinate of a payload's centre that the page takes [mm]."""


class ToolsTab:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter."""

    def __init__(self, server: viser.ViserServer, guard: Guard, loop: Running, arm: Arm) -> None:
        self._loop, gui = loop, server.gui
        self._table: tuple[Tool, ...] = ()
        self._fitting: Fitting | None = None
        self.now = Html(gui)
        with gui.add_folder("Payload"):
            self.run = gui.add_button(
                "Measure the payload",
                icon=viser.Icon.SCALE,
                hint="The arm turns its wrist by itself, slowly; it needs room for that",
            )
            self.stop = gui.add_button("Stop measuring", color="red", visible=False)
            self.progress = Html(gui)
            self.apply = gui.add_button(
                "Use this payload", color="gray", disabled=True, hint="Configure the payload that was found"
            )
            with gui.add_folder("Turn the wrist by hand", expand_by_default=False):
                self.measure = gui.add_button("Measure this posture", color="gray")
                self.clear = gui.add_button("Begin again", color="gray", disabled=True)
            with gui.add_folder("Type it in", expand_by_default=False):
                self.mass = gui.add_number("Mass [kg]", 0.0, min=0.0, max=arm.payload, step=0.01)
                self.centre = tuple(
                    gui.add_number(f"Centre {axis} [mm]", 0.0, min=-FARTHEST, max=FARTHEST, step=1.0) for axis in "xyz"
                )
                self.enter = gui.add_button("Set payload", color="gray")
        self.zero = gui.add_button("Zero the force sensor", color="gray", icon=viser.Icon.TARGET)
        self.zeroed = Html(gui)
        with gui.add_folder("Tool"):
            names = tuple(tool.name for tool in loop.tools)
            self.tool: viser.GuiDropdownHandle[str] = gui.add_dropdown("Tool", names)
            self.about = Html(gui)
            self.use = gui.add_button("Use this tool", color="gray")
            self.framed = gui.add_checkbox("Show the frame", False, hint="The axes of the tool centre point in the picture")
            self.handled = gui.add_checkbox(
                "Edit in 3D", False, hint="Arrows and arcs in the picture move and turn the tool centre point"
            )
            self.editor = ToolEditor(gui, loop, arm)
            self.touching = TouchingPoses(gui, loop.latest, self._place)
        self.frame = ToolFrame(server, guard, lambda there: self.editor.place(self.tool.value, there))
        self._connect()

    def show(self, snapshot: Snapshot) -> bool:
        """Show tool, payload and wizard; True if anything changed."""
        decision = snapshot.decision
        locked = decision.mode in (Mode.FREE_DRIVE, Mode.RUN) or decision.phase is Phase.SEQUENCE
        wizard, fitting = decision.wizard, decision.estimator.fitting
        if self._loop.tools != self._table:
            self._tabulate(self._loop.tools)
        if fitting is not None and (self._fitting is None or fitting.number != self._fitting.number):
            self._take(fitting)
        self._fitting = fitting
        measuring, turning = wizard.share > 0.0, wizard.doing != ""
        idle = decision.phase is Phase.OFF and not measuring and not turning
        changed = [
            self.now.show(svg.facts(_facts(fitting, locked))),
            self.about.show(self._about()),
            self.progress.show(_told(wizard, measuring)),
            self.editor.show(self._chosen(), locked, "" if fitting is None else fitting.tool.name),
            self.touching.show(locked),
            self._show_frame(snapshot, locked or turning),
            enable(self.use, not locked and not turning),
            enable(self.enter, not locked and not turning),
            enable(self.run, idle and not locked),
            reveal(self.stop, turning),
            enable(self.measure, idle),
            enable(self.apply, wizard.finding is not None and not locked and not turning),
            enable(self.clear, wizard.postures > 0 and not measuring and not turning),
            enable(self.zero, idle and decision.program is not ProgramState.RUNNING),
            self.zeroed.show(_subtracted(decision)),
        ]
        return any(changed)

    def _show_frame(self, snapshot: Snapshot, locked: bool) -> bool:
        """The axes of the chosen tool, with handles while it is edited in 3D and nobody is asked about it."""
        edits = self.handled.value
        fixed = locked or not edits or self.editor.asking
        return self.frame.show(self._chosen() if self.framed.value or edits else None, snapshot, fixed=fixed)

    def _tabulate(self, tools: tuple[Tool, ...]) -> None:
        """Another table: offer it; what was just added or renamed is chosen, else what was."""
        before, names = self.tool.value, tuple(tool.name for tool in tools)
        wanted = next((name for name in (self.editor.wanted, before) if name in names), names[0])
        self._table, self.editor.wanted = tools, ""
        self.tool.options = names
        if self.tool.value != wanted:
            self.tool.value = wanted

    def _chosen(self) -> Tool | None:
        return next((tool for tool in self._loop.tools if tool.name == self.tool.value), None)

    def _place(self, tcp: tuple[float, float, float]) -> None:
        """The tool centre point of the chosen tool was found; how it is turned stays."""
        tool = self._chosen()
        if tool is not None:
            x, y, z = (round(way, 4) for way in tcp)
            self.editor.place(tool.name, ToolPlace([x, y, z], list(tool.rpy)))

    def _take(self, fitting: Fitting) -> None:
        """Another tool or payload: the controls say what it is."""
        load = fitting.load
        if self.tool.value != fitting.tool.name:
            self.tool.value = fitting.tool.name
        for control, value in zip((self.mass, *self.centre), (load.mass, *(1000.0 * way for way in load.com)), strict=True):
            if control.value != value:
                control.value = value

    def _about(self) -> str:
        """What the table says of the chosen tool, unless it is the one in use."""
        tool = self._chosen()
        if tool is None or (self._fitting is not None and tool.name == self._fitting.tool.name):
            return ""
        pairs = [("Tool centre point", _point(tool.tcp)), ("Mass", f"{tool.mass:.3f} kg"), ("Centre of mass", _point(tool.com))]
        return svg.facts(pairs)

    def _connect(self) -> None:
        desk = self._loop.desk

        def on(button: viser.GuiButtonHandle, act: Callable[[], None]) -> None:
            @button.on_click
            async def _(_: viser.GuiEvent) -> None:
                act()

        on(self.use, lambda: desk.choose(self.tool.value))
        on(self.enter, lambda: desk.configure(self.entered()))
        on(self.run, lambda: desk.command(Command.WIZARD_RUN))
        on(self.stop, lambda: desk.command(Command.WIZARD_CLEAR))
        on(self.measure, lambda: desk.command(Command.WIZARD_MEASURE))
        on(self.apply, lambda: desk.command(Command.WIZARD_APPLY))
        on(self.clear, lambda: desk.command(Command.WIZARD_CLEAR))
        on(self.zero, lambda: desk.command(Command.ZERO_SENSOR))

    def entered(self) -> Load:
        """The payload that the numbers say."""
        return Load(mass=float(self.mass.value), com=[float(way.value) / 1000.0 for way in self.centre])


def _facts(fitting: Fitting | None, locked: bool) -> list[tuple[str, str]]:
    if fitting is None:
        return []
    total = fitting.tool.mass + fitting.load.mass
    if fitting.share < 1.0:
        state = f"changing, {100.0 * fitting.share:.0f} %"
    else:
        state = "locked: the arm is free or runs" if locked else "in use"
    return [
        ("In use", f"{fitting.tool.name}, {fitting.tool.mass:.3f} kg"),
        ("Tool centre point", _point(fitting.tool.tcp)),
        ("Payload", f"{fitting.mass:.2f} kg"),
        ("With the tool", f"{total:.2f} kg"),
        ("Status", state),
    ]


def _told(wizard: Progress, measuring: bool) -> str:
    """How far the wizard is, and what to do next."""
    if wizard.doing:
        done = f"{wizard.postures} of {WANTED} postures measured"
        return svg.note("The arm measures its payload", f"It {wizard.doing}. Hands off the arm.", Colour.BLUE, [done])
    if measuring:
        return svg.note(f"Measuring, {100.0 * wizard.share:.0f} %", "Hands off the arm.", Colour.BLUE)
    found = wizard.finding
    if found is not None:
        x, y, z = (1000.0 * way for way in found.centre)
        lines = [
            f"Centre {x:z.0f}, {y:z.0f}, {z:z.0f} mm, each ± {1000.0 * found.centre_deviation:.1f} mm",
            f"Fit {found.force_fit:.2f} N, {found.torque_fit:.3f} N·m in {found.postures} postures",
            f"Sensor offset {', '.join(f'{value:.1f}' for value in found.force_offset)} N",
        ]
        headline = f"{found.mass:.2f} ± {found.mass_deviation:.2f} kg"
        return svg.note(headline, "Use it, or measure again.", Colour.GREEN, lines)
    if wizard.reason:
        return svg.note("Not found yet", f"{wizard.reason}.", Colour.AMBER)
    if not wizard.postures:
        return svg.fine_print("The arm turns its wrist by itself, through six postures, where there is room for it.")
    text = "Turn the wrist, let go, measure; then the next posture."
    return svg.note(f"{wizard.postures} of at least {LEAST} postures", text, Colour.GREY)


def _subtracted(decision: Decision) -> str:
    """What is subtracted from the force sensor, and whether to zero it, in a line."""
    force, torque = math.hypot(*decision.estimator.zero[:3]), math.hypot(*decision.estimator.zero[3:])
    now = f"{force:.1f} N and {torque:.2f} N·m are subtracted."
    if decision.zero_due:
        return svg.note("Zero the force sensor now", f"{now} Nothing may touch the arm.", Colour.AMBER)
    return svg.fine_print(f"{now} No need to zero now.")


def _point(point: Sequence[float]) -> str:
    return ", ".join(f"{1000.0 * way:z.0f}" for way in point) + " mm"
