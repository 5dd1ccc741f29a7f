"""Set-ups as files: what runs, as a configuration; one that a page hands in, checked; and what is kept over a restart."""

import os
import time
from pathlib import Path

import msgspec
import yaml

from app.files.checked import BadInput, load, parse
from app.files.library import robots, tools
from app.files.taught_program import Lesson
from app.session.prepare import Prepared, prepare
from app.session.session_file import Setup
from pendant.all_settings import Settings, describe, value_of
from pendant.equipment.tools import Tool
from pendant.walls.definitions import AnyBorder
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario, ToolModel, table

OFTEN = 1.0
"""What changes is written at most once in this time [s]."""


class Kept(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What is kept of a served robot over a restart."""

    setup: Setup
    taught: Lesson


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
    return tool if tool is None or told is None else msgspec.structs.replace(tool, tcp=told.tcp, rpy=told.rpy)


def _others(scenario: Scenario, tools: tuple[Tool, ...]) -> list[ToolModel]:
    """The tools to choose from: as they were, or those of an edited table beside the one at the flange."""
    if list(tools) == table(scenario):
        return scenario.tools
    models = [tool for tool in tools if isinstance(tool, ToolModel)]
    return [tool for tool in models if scenario.tool is None or tool.name != scenario.tool.name]


def text_of(value: msgspec.Struct) -> str:
    """A value as the text of its file."""
    return yaml.safe_dump(msgspec.to_builtins(value), sort_keys=False, allow_unicode=True)


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
    """Keeps set-up, settings and what was taught of one arm in a file, as they change.

    Attributes:
        path: of the file.
        problem: why nothing is kept any more, or "".
    """

    def __init__(self, folder: Path, arm: str) -> None:
        self.path = folder / f"{arm}.yaml"
        self.problem = ""
        self._seen: tuple[object, ...] | None = None
        self._written = -OFTEN

    def read(self) -> Kept | None:
        """What is kept; None: nothing yet.

        Raises:
            BadInput: the file is no such file, or what it says does not fit together.
        """
        return load(self.path, Kept) if self.path.is_file() else None

    def see(
        self,
        lesson: Lesson,
        arm: Arm,
        scenario: Scenario,
        settings: Settings,
        *,
        walls: tuple[AnyBorder, ...],
        tools: tuple[Tool, ...],
        now: float | None = None,
    ) -> None:
        """Write what has changed since it was seen first: all `walls` and `tools` as they are; `now` is the clock [s]."""
        clock = time.monotonic() if now is None else now
        seen = (lesson, scenario, settings, walls, tools)
        if self._seen is None:
            self._seen = seen
        if self.problem or all(a is b for a, b in zip(seen, self._seen, strict=True)) or clock < self._written + OFTEN:
            return
        self._seen, self._written = seen, clock
        setup = setup_of(arm, scenario, settings, walls=walls, tools=tools)
        self.problem = written(self.path, text_of(Kept(setup=setup, taught=lesson)))


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
    """The keeper of an arm; None: the arm comes from a file, and may be another one next time."""
    return Keeper(folder, arm.name) if arm.name in robots() else None
