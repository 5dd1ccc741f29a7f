"""The editor of the table of tools: a form for one tool, and the whole table as a file."""

import math
from collections.abc import Callable, Sequence
from typing import Annotated, Any, NamedTuple

import msgspec
import viser
import yaml
from msgspec import Meta

from app.files.bodies import OVERLOAD, check_tools
from app.files.checked import BadInput, parse
from app.runs.runner import try_tool
from app.web.running import Running
from app.web.tabs.tool_frame import ToolPlace
from app.web.widgets import svg
from app.web.widgets.html import Html, enable, reveal
from app.web.widgets.svg import Colour
from app.web.widgets.vector_field import vector
from pendant.equipment.tools import MOST, Tool, tool_problem
from pendant.settings.bounds import FARTHEST
from sim.arm.arm_file import Arm
from sim.arm.scenario import BARE
from sim.arm.scenario import ToolModel as ShapedTool


class Unit(NamedTuple):
    """How a quantity is shown: so many of it are one SI unit, with so many digits after the point."""

    many: float
    digits: int

    @property
    def step(self) -> float:
        """The least difference that is shown."""
        return 10.0**-self.digits


MILLIMETRES, DEGREES, SQUARE_CENTIMETRES = Unit(1e3, 1), Unit(180.0 / math.pi, 2), Unit(1e4, 2)
"""Of lengths, angles, moments of inertia [kg·cm²]."""

FAR = MILLIMETRES.many * FARTHEST
"""Largest coordinate that the page takes [mm]: as large as in files."""

ADD, SET, DELETE = "Save as new", "Change this", "✕"

REMEMBERED = 50
"""Edits that can be undone."""

FULLEST = 402.0
"""Largest angle that the page takes [°]: as large as in files."""

HEAVIEST = 1e4
"""Largest moment of inertia that the page takes [kg·cm²]."""


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A file of tools; it also serves as a file for `pendant serve --config`."""

    tools: Annotated[list[ShapedTool], Meta(max_length=MOST)]


class ToolEditor:
    """A folder of the tools' tab. It asks for another table; the pendant's logic takes or refuses that, whole."""

    def __init__(self, gui: viser.GuiApi, loop: Running, arm: Arm) -> None:
        self._loop, self._arm = loop, arm
        self._tool: Tool = BARE  # that the form was filled with
        self._before: list[tuple[Tool, ...]] = []  # the table before each edit
        self.wanted = ""  # name of the tool that was asked for last
        self._used = ""  # name of the tool in use
        self._pending: tuple[Tool, ...] | None = None  # a table in which the tool in use is another, until somebody is sure
        self.question = Html(gui)
        self.yes = gui.add_button("Yes, change the tool in use", color="gray", visible=False)
        self.no = gui.add_button("No, leave it", color="gray", visible=False)
        self.undo = gui.add_button("Undo", color="gray", disabled=True, hint="Of the table, also of what was edited in 3D")
        with gui.add_folder("Edit tools", expand_by_default=False):
            self.name = gui.add_text("Name", BARE.name)
            self.mass = gui.add_number("Mass [kg]", 0.0, min=0.0, max=OVERLOAD * arm.payload, step=0.001)
            self.com = vector(gui, "Centre of mass [mm]", FAR, MILLIMETRES.step, hint="Centre of mass in the flange: x, y, z")
            self.tcp = vector(gui, "TCP [mm]", FAR, MILLIMETRES.step, hint="Tool centre point in the flange: x, y, z")
            self.rpy = vector(gui, "Rotation [°]", FULLEST, DEGREES.step, hint="Roll, pitch, yaw of the tool in the flange")
            self.known = gui.add_checkbox("Own inertia", False, hint="Else it follows from mass and shape")
            self.moments = vector(gui, "I [kg·cm²]", HEAVIEST, SQUARE_CENTIMETRES.step, hint="xx, yy, zz about the centre")
            self.products = vector(
                gui, "I xy xz yz", HEAVIEST, SQUARE_CENTIMETRES.step, hint="Products about the centre [kg·cm²]"
            )
            self.change = gui.add_button_group(
                "Table", (ADD, SET, DELETE), hint="Add this, set the chosen one to it, delete that"
            )
            self.save = gui.add_button("Save the table", color="gray")
            self.load = gui.add_upload_button("Load tools", mime_type=".yaml", color="gray")
            self.message = Html(gui)
        self._reveal()
        self._connect()

    @property
    def asking(self) -> bool:
        """Somebody is asked whether the tool in use is to change."""
        return self._pending is not None

    def show(self, chosen: Tool | None, locked: bool, used: str = "") -> bool:
        """Fill the form with the tool chosen, once; `used` names the one in use. True if anything changed."""
        self._used = used
        if locked:
            self._answer(None)
        filled = chosen is not None and chosen != self._tool
        if chosen is not None and filled:
            self._fill(chosen)
        turned = self.change.visible is locked
        if turned:
            self.change.visible = not locked  # viser knows no disabled group of buttons
        return any([filled, turned, enable(self.load, not locked), enable(self.undo, bool(self._before) and not locked)])

    def entered(self) -> Tool:
        """What the form says; what was not touched is as it was."""
        was = self._tool
        inertia = None
        if self.known.value:
            old = was.inertia or [0.0] * 6
            inertia = _back(self.moments, old[:3], SQUARE_CENTIMETRES) + _back(self.products, old[3:], SQUARE_CENTIMETRES)
        return msgspec.structs.replace(
            was,
            name=self.name.value.strip(),
            mass=float(self.mass.value),
            com=_back(self.com, was.com, MILLIMETRES),
            tcp=_back(self.tcp, was.tcp, MILLIMETRES),
            rpy=_back(self.rpy, was.rpy, DEGREES),
            inertia=inertia,
        )

    def file(self) -> bytes:
        """The table as a file."""
        tools = [msgspec.to_builtins(tool) for tool in self._loop.tools]
        return yaml.safe_dump({"tools": tools}, sort_keys=False, allow_unicode=True).encode()

    def read(self, name: str, content: bytes) -> None:
        """Take the tools of a file into the table, over those of the same names, or say in a line why not."""
        try:
            tools = parse(content.decode("utf-8", "replace"), Table, name).tools
            check_tools(tools, self._arm, name, most=1.0)
            self._try(tools, name)
        except BadInput as refusal:
            self.message.show(svg.note("File refused", str(refusal), Colour.AMBER))
            return
        new = {tool.name: tool for tool in tools}
        old = [new.pop(tool.name, tool) for tool in self._loop.tools]
        self._ask((*old, *new.values()))
        self.message.show(svg.note("File read", f"{len(tools)} tools.", Colour.GREEN))

    def _try(self, tools: Sequence[ShapedTool], where: str) -> None:
        """Let each tool that is not in the table stand on an arm of its own for a tick. Raises BadInput: it cannot."""
        for tool in tools:
            if tool not in self._loop.tools:
                try_tool(self._arm, tool, where)

    def _fill(self, tool: Tool) -> None:
        self._tool = tool
        inertia = tool.inertia or [0.0] * 6
        values: list[tuple[Any, Any]] = [
            (self.name, tool.name),
            (self.mass, tool.mass),
            (self.com, _shown(tool.com, MILLIMETRES)),
            (self.tcp, _shown(tool.tcp, MILLIMETRES)),
            (self.rpy, _shown(tool.rpy, DEGREES)),
            (self.known, tool.inertia is not None),
            (self.moments, _shown(inertia[:3], SQUARE_CENTIMETRES)),
            (self.products, _shown(inertia[3:], SQUARE_CENTIMETRES)),
        ]
        for control, value in values:
            if control.value != value:
                control.value = value
        self._reveal()

    def _reveal(self) -> None:
        for control in (self.moments, self.products):
            if control.visible != self.known.value:
                control.visible = self.known.value

    def _change(self) -> None:
        """Ask for the table with the tool of the form, or without it."""
        table, tool = self._loop.tools, self.entered()
        if self.change.value == ADD:
            table = (*table, tool)
        elif self.change.value == SET:
            table = tuple(tool if each.name == self._tool.name else each for each in table)
        else:
            table = tuple(each for each in table if each.name != self._tool.name)
        if self.change.value != DELETE and isinstance(tool, ShapedTool) and tool_problem(tool, self._arm.payload) is None:
            try:
                self._try((tool,), tool.name)
            except BadInput as refusal:
                self.message.show(svg.note("Tool refused", str(refusal), Colour.AMBER))
                return
        self.wanted = tool.name
        self.message.show("")
        self._ask(table)

    def place(self, name: str, there: ToolPlace) -> None:
        """The tool centre point of a tool was moved in the picture."""
        self._ask(
            tuple(
                msgspec.structs.replace(each, tcp=there.tcp, rpy=there.rpy) if each.name == name else each
                for each in self._loop.tools
            )
        )

    def _ask(self, table: tuple[Tool, ...]) -> None:
        """Ask the robot for this table; where it changes the tool in use, ask the user first."""
        now = next((tool for tool in self._loop.tools if tool.name == self._used), None)
        if now is not None and now not in table:
            self._answer(table)
        else:
            self._take(table)

    def _answer(self, pending: tuple[Tool, ...] | None) -> None:
        """Have a question about this table, or none."""
        self._pending = pending
        text = f"{self._used} is in use. The arm moves and weighs by it. Change it?"
        self.question.show("" if pending is None else svg.note("The tool in use", text, Colour.AMBER))
        for button in (self.yes, self.no):
            reveal(button, pending is not None)

    def _sure(self) -> None:
        pending = self._pending
        self._answer(None)
        if pending is not None:
            self._take(pending)

    def _take(self, table: tuple[Tool, ...]) -> None:
        if table != self._loop.tools:
            self._before = [*self._before, self._loop.tools][-REMEMBERED:]
            self._loop.desk.tabulate(table)

    def _undo(self) -> None:
        """Ask for the table as it was before the last edit that was taken."""
        while self._before:
            table = self._before.pop()
            if table != self._loop.tools:
                self._loop.desk.tabulate(table)
                return

    def _connect(self) -> None:
        def on(control: Any, act: Callable[[], None]) -> None:
            @control.on_click
            async def _(_: viser.GuiEvent) -> None:
                act()

        on(self.change, self._change)
        on(self.undo, self._undo)
        on(self.yes, self._sure)
        on(self.no, lambda: self._answer(None))

        @self.known.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._reveal()

        @self.save.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                event.client.send_file_download("tools.yaml", self.file(), save_immediately=True)

        @self.load.on_upload
        async def _(_: viser.GuiEvent) -> None:
            self.read(self.load.value.name, self.load.value.content)


def _shown(values: Sequence[float], unit: Unit) -> tuple[float, ...]:
    """Three values as the page shows them."""
    return tuple(round(unit.many * value, unit.digits) for value in values)


def _back(control: viser.GuiVector3Handle, was: Sequence[float], unit: Unit) -> list[float]:
    """What a control says, in SI units: exactly what it was filled with, unless it was touched."""
    said = control.value
    return list(was) if said == _shown(was, unit) else [value / unit.many for value in said]
