"""The cell of a user as one file: what it is now, one that a page hands in, checked, and what is kept over a restart."""

import math
import os
import time
from pathlib import Path
from typing import Annotated, NamedTuple

import msgspec
import yaml
from msgspec import Meta
from msgspec.structs import replace

from app.files.checked import BadInput, load, parse
from app.files.library import load_arm, own_robots, robots, tools
from app.files.taught_program import Lesson
from app.files.yaml_text import parsed, read
from app.session.prepare import Prepared, prepare
from app.session.session_file import Setup
from pendant.all_settings import Settings, describe, value_of
from pendant.equipment.tools import Tool
from pendant.walls.definitions import AnyBorder
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load, Scenario, ToolModel, table

MOST_SCRIPT, LONGEST_NAME = 40_000, 40
"""Of a script, and of the name of an input or output [characters]."""

ScriptText = Annotated[str, Meta(max_length=MOST_SCRIPT)]
Line = Annotated[str, Meta(pattern=r"^(input|output) \d{1,2}$")]
LineName = Annotated[str, Meta(min_length=1, max_length=LONGEST_NAME)]

OFTEN = 1.0
"""What changes is written at most once in this time [s]."""


class Cell(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All that a user has made of one robot: what is kept over a restart, and the one file of the page."""

    setup: Setup  # arm, mounting, tools, payload, world, walls, settings
    taught: Lesson
    without: list[LineName] = []  # tools that are shipped, and were taken off the table
    in_use: str = ""  # the tool that the controller works with; "": the one that is mounted
    script: ScriptText = ""  # in URScript; "": none
    lines: dict[Line, LineName] = {}  # names of inputs and outputs, by what they are called else


class CellNow(NamedTuple):
    """What a cell is made of, as it is now; none of it is copied."""

    arm: Arm
    scenario: Scenario
    settings: Settings
    walls: tuple[AnyBorder, ...]
    tools: tuple[Tool, ...]
    payload_true: Load
    payload_configured: Load
    in_use: str
    taught: Lesson
    script: str
    lines: dict[str, str]

    def same(self, other: "CellNow | None") -> bool:
        """Whether nothing is different."""
        return other is not None and all(a is b or a == b for a, b in zip(self, other, strict=True))


def cell_of(now: CellNow) -> Cell:
    """A cell that begins as it is now."""
    started = setup_of(now.arm, now.scenario, now.settings, walls=now.walls, tools=now.tools)
    mounted, there = now.scenario.tool, {tool.name for tool in now.tools}
    setup = replace(
        started,
        payload_true=now.payload_true,
        payload_configured=now.payload_configured,
        tools=[tool for tool in started.tools if mounted is None or tool.name != mounted.name],
    )
    return Cell(
        setup=setup,
        taught=now.taught,
        without=[name for name in tools() if name not in there],
        in_use="" if now.in_use == table(now.scenario)[0].name else now.in_use,
        script=now.script,
        lines=dict(now.lines),
    )


def any_cell(name: str, content: bytes, now: Cell) -> Cell:
    """The cell in a file: a cell, or a file of one of its parts, whose other parts stay as they are `now`.

    Raises:
        BadInput: it is none of these, is for another arm, names a file of this machine, or does not fit together.
    """
    text = content.decode("utf-8", "replace")
    said = parsed(text, name)
    fields = set(said) if isinstance(said, dict) else set()
    if "setup" in fields:
        cell = parse(text, Cell, name)
    elif fields and fields <= {*Lesson.__struct_fields__}:
        cell = replace(now, taught=parse(text, Lesson, name))
    elif fields == {"tools"}:
        cell = replace(now, setup=replace(now.setup, tools=parse(text, Setup, name).tools), in_use="")
    else:
        cell = replace(now, setup=parse(text, Setup, name), in_use="")
    if cell.setup.robot != now.setup.robot:
        raise BadInput(name, "robot", cell.setup.robot, f"the arm that is served, {now.setup.robot}")
    if isinstance(cell.setup.tool, str) and cell.setup.tool not in tools():
        raise BadInput(name, "tool", cell.setup.tool, "the name of a shipped tool, or a tool in this file")
    check_cell(cell, name)
    return cell


def is_cell(path: Path) -> bool:
    """Whether a file is a cell, and not a configuration."""
    said = parsed(read(path, path.name), path.name)
    return isinstance(said, dict) and "setup" in said


def check_cell(cell: Cell, where: str) -> Prepared:
    """What a cell begins with. Raises BadInput: its parts do not fit together."""
    prepared = prepare(cell.setup, where)
    left = [tool for tool in prepared.scenario.tools if tool.name not in cell.without]
    prepared = prepared._replace(scenario=replace(prepared.scenario, tools=left))
    for number, waypoint in enumerate(cell.taught.waypoints):
        if len(waypoint.q) != prepared.arm.n:
            raise BadInput(where, f"taught.waypoints[{number}].q", waypoint.q, f"{prepared.arm.n} joint angles")
    names = [tool.name for tool in table(prepared.scenario)]
    if cell.in_use and cell.in_use not in names:
        raise BadInput(where, "in_use", cell.in_use, f"a tool of the table: {', '.join(names)}")
    return prepared


def setup_of(arm: Arm, scenario: Scenario, settings: Settings, *, walls: tuple[AnyBorder, ...], tools: tuple[Tool, ...]) -> Setup:
    """A configuration that begins with this arm, scenario, settings, walls and areas, and table of tools."""
    changed = {row.name: value_of(settings, row.name) for row in describe() if value_of(settings, row.name) != row.default}
    return Setup(
        robot=arm.name,
        mounting=scenario.mounting,
        posture=scenario.posture,
        tool=_framed(scenario.tool, tools),
        tools=_others(scenario, tools),
        payload_true=scenario.payload_true,
        payload_configured=scenario.payload_configured,
        settings=changed,
        seed=scenario.seed,
        mismatch=scenario.mismatch,
        soft_sensor=scenario.soft_sensor,
        self_contact=scenario.self_contact,
        world=scenario.world,
        walls=list(walls),
    )


def _framed(tool: ToolModel | None, tools: tuple[Tool, ...]) -> ToolModel | None:
    """The tool at the flange, which is as it is, with its tool centre point as the table has it."""
    told = next((each for each in tools if tool is not None and each.name == tool.name), None)
    return tool if tool is None or told is None else replace(tool, tcp=told.tcp, rpy=told.rpy)


def _others(scenario: Scenario, tools: tuple[Tool, ...]) -> list[ToolModel]:
    """The tools to choose from: as they were, or those of an edited table beside the one at the flange."""
    if list(tools) == table(scenario):
        return scenario.tools
    models = [tool for tool in tools if isinstance(tool, ToolModel)]
    return [tool for tool in models if scenario.tool is None or tool.name != scenario.tool.name]


def text_of(value: msgspec.Struct) -> str:
    """A value as the text of its file."""
    return yaml.dump(msgspec.to_builtins(value), Dumper=yaml.CSafeDumper, sort_keys=False, allow_unicode=True)


def handed_in(name: str, content: bytes, arm: Arm) -> Prepared:
    """What a configuration asks for that comes over the page, which serves `arm`.

    Raises:
        BadInput: it is none, is for another arm, or names a file of this machine.
    """
    setup = parse(content.decode("utf-8", "replace"), Setup, name)
    if setup.robot != arm.name:
        raise BadInput(name, "robot", setup.robot, f"the arm that is served, {arm.name}")
    if isinstance(setup.tool, str) and setup.tool not in tools():
        raise BadInput(name, "tool", setup.tool, "the name of a shipped tool, or a tool in this file")
    return prepare(setup, name)


class Keeper:
    """Keeps the cell of one arm in a file, as it changes.

    Attributes:
        path: of the file.
        problem: why nothing is kept any more, or "".
    """

    def __init__(self, folder: Path, arm: str) -> None:
        self.path = folder / f"{arm}.yaml"
        self.problem = ""
        self._seen: CellNow | None = None
        self._written = -OFTEN

    def read(self) -> Cell | None:
        """What is kept; None: nothing yet.

        Raises:
            BadInput: the file is no such file, or what it says does not fit together.
        """
        return load(self.path, Cell) if self.path.is_file() else None

    def see(self, cell: CellNow, *, now: float | None = None) -> None:
        """Write what has changed since it was seen first; `now` is the clock [s], infinite to write at once."""
        clock = time.monotonic() if now is None else now
        if self._seen is None:
            self._seen = cell
        if self.problem or clock < self._written + OFTEN or cell.same(self._seen):
            return
        self._seen = cell
        if math.isfinite(clock):
            self._written = clock
        self.keep(cell_of(cell))

    def keep(self, cell: Cell) -> None:
        """Write this cell."""
        self.problem = written(self.path, text_of(cell))


def written(path: Path, text: str) -> str:
    """Write a file whole or not at all; why it could not be, or ""."""
    other = path.with_suffix(".new")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        other.write_text(text, encoding="utf-8")
        other.replace(path)
    except OSError as error:
        return f"{path}: cannot be written ({error.strerror})"
    return ""


def usual_folder() -> Path:
    """Where programs keep their state for a user, by the XDG base directory specification."""
    base = os.environ.get("XDG_STATE_HOME", "")
    return (Path(base) if base.startswith("/") else Path.home() / ".local" / "state") / "pendant"


def keeper_for(arm: Arm, folder: Path) -> Keeper | None:
    """The keeper of an arm that goes by its name: a shipped one, or one of the user's own.

    None: the arm comes from a file elsewhere, and may be another one next time.
    """
    return Keeper(folder, arm.name) if arm.name in robots() or _is_own(arm) else None


def _is_own(arm: Arm) -> bool:
    """Whether this is the user's own arm of its name, and no other arm that is called so."""
    try:
        return arm.name in own_robots() and load_arm(arm.name) == arm
    except BadInput:
        return False
