"""Checks what happens in a session, and what is expected of it, against the arm, the world and the settings."""

from typing import NamedTuple

from app.files.bodies import check_load
from app.files.checked import ABSENT, BadInput
from app.session.actions import (
    Action,
    AnyAction,
    Axes,
    ChangeSettings,
    Effort,
    HoldJog,
    Laboratory,
    LoadProgram,
    OfClient,
    SelectTool,
    SetPayload,
    SetWalls,
    UseGripper,
)
from app.session.expectations import Displacement, Expectation, Value
from app.session.session_file import Session
from pendant.all_settings import Settings, apply
from pendant.program.jog_move import unfit
from pendant.program.steps import Program as Steps
from pendant.settings.schema import SettingError
from pendant.walls.containment import PARTS, TETHER
from pendant.walls.definitions import AnyBorder, problem
from sim.arm.arm_file import Arm
from sim.arm.scenario import AnyObject, Cup, Scenario, ToolModel, table
from sim.plant.changes import AttachPayload, DriveGripper, FrictionChange, MoveObject, SensorFault, Temperature, TrueChange

LONGEST = 3600.0
"""Of a session [s]."""


class Prepared(NamedTuple):
    """A setup, checked and turned into what `sim.simulation.Simulation` takes."""

    arm: Arm
    scenario: Scenario
    settings: Settings
    program: Steps | None
    where: str = ""  # the file's name, for messages


def applied(settings: Settings, changes: dict[str, float | bool | str], where: str, field: str) -> Settings:
    """Settings with changes by dotted name. Raises BadInput: one is not possible."""
    try:
        return apply(settings, dict(changes))
    except SettingError as error:
        value = ABSENT if error.value is None else error.value
        raise BadInput(where, f"{field}.{error.name}", value, error.allowed) from None


def check_actions(actions: list[AnyAction], prepared: Prepared) -> None:
    """Check a time line that comes while `prepared` runs. Raises BadInput: an action does not fit it."""
    session = Session(title=prepared.where, duration=LONGEST, timeline=actions)
    parts = ["foot", *prepared.arm.chain.joints, "flange", "tool"]
    for i, action in enumerate(actions):
        if isinstance(action, OfClient):
            raise BadInput(
                prepared.where,
                f"actions[{i}].do",
                action.__struct_config__.tag,
                "what no client does: clients have their own ports",
            )
        _check_action(action, f"actions[{i}]", session=session, prepared=prepared, parts=parts, where=prepared.where)


def check_timeline(session: Session, prepared: Prepared) -> None:
    """Check a session's time line and expectations. Raises BadInput: one does not fit what is simulated."""
    where = prepared.where
    parts = ["foot", *prepared.arm.chain.joints, "flange", "tool"]
    for i, action in enumerate(session.timeline):
        _check_action(action, f"timeline[{i}]", session=session, prepared=prepared, parts=parts, where=where)
    for i, expectation in enumerate(session.expectations):
        _check_expectation(expectation, f"expectations[{i}]", session=session, parts=parts, where=where)


def _check_action(action: Action, field: str, *, session: Session, prepared: Prepared, parts: list[str], where: str) -> None:
    if action.at is not None and action.at >= session.duration:
        raise BadInput(where, f"{field}.at", action.at, f"below the duration, {session.duration:g} s")
    if isinstance(action, Effort):
        _one_of(action.part, parts, where, f"{field}.part")
    elif isinstance(action, ChangeSettings):
        applied(prepared.settings, action.set, where, f"{field}.set")
    elif isinstance(action, SelectTool):
        _one_of(action.tool, [tool.name for tool in table(prepared.scenario)], where, f"{field}.tool")
    elif isinstance(action, SetPayload):
        check_load(action.load, prepared.arm, where, f"{field}.load")
    elif isinstance(action, Axes):
        applied(prepared.settings, action.set, where, field)
    elif isinstance(action, SetWalls):
        check_walls(action.walls, prepared.scenario.world, where, f"{field}.walls")
    elif isinstance(action, LoadProgram) and session.program is None:
        raise BadInput(where, f"{field}.do", "program", "needs a `program:` in the header")
    elif isinstance(action, HoldJog):
        why = unfit(action.move, prepared.arm.n)
        if why is not None:
            raise BadInput(where, f"{field}.move", ABSENT, why)
    elif isinstance(action, Laboratory | UseGripper):
        _check_change(action.change, field if isinstance(action, UseGripper) else f"{field}.change", prepared, where)


def check_walls(walls: list[AnyBorder], world: list[AnyObject], where: str, field: str = "walls") -> None:
    """Raise BadInput when walls and areas do not fit together, or lie in what is not in the world."""
    references = {"base", "world", "flange", "tcp", *(thing.name for thing in world)}
    if any(wall.name == TETHER for wall in walls):
        raise BadInput(where, field, TETHER, "another name: the tether is set by settings, walls.*")
    why = problem(tuple(walls), frozenset(PARTS), frozenset(references))
    if why is not None:
        raise BadInput(where, field, ABSENT, why)


def _check_drive(change: DriveGripper, field: str, tool: ToolModel | None, where: str) -> None:
    if tool is None or tool.gripper is None:
        raise BadInput(where, field.removesuffix(".change") + ".do", "gripper", "needs a tool with a gripper: `tool: two-finger`")
    if isinstance(tool.gripper, Cup):
        for name in ("speed", "force", "speed_share", "force_share"):
            value = getattr(change, name)
            if value is not None:
                raise BadInput(where, f"{field}.{name}", value, f"{name} is of fingers; a cup draws, or does not")


def _check_change(change: TrueChange, field: str, prepared: Prepared, where: str) -> None:
    if isinstance(change, DriveGripper):
        _check_drive(change, field, prepared.scenario.tool, where)
    elif isinstance(change, AttachPayload):
        check_load(change.load, prepared.arm, where, f"{field}.load")
    elif isinstance(change, SensorFault):
        _check_channel(change, prepared.arm, where, f"{field}.channel")
    elif isinstance(change, MoveObject):
        _one_of(change.name, [thing.name for thing in prepared.scenario.world], where, f"{field}.name")
    elif isinstance(change, FrictionChange | Temperature) and change.joint is not None:
        _one_of(change.joint, prepared.arm.chain.joints, where, f"{field}.joint")


def _check_channel(change: SensorFault, arm: Arm, where: str, field: str) -> None:
    count = {"force_torque": 6, "accelerometer": 3, "gyro": 3}.get(change.sensor, arm.n)
    if change.channel is not None and not 0 <= change.channel < count:
        raise BadInput(where, field, change.channel, f"0 .. {count - 1} for {change.sensor}, or nothing for all")


def _check_expectation(expectation: Expectation, field: str, *, session: Session, parts: list[str], where: str) -> None:
    for name, key in (("at", "at"), ("by", "by"), ("begin", "from"), ("end", "to")):
        moment = getattr(expectation, name, None)
        if expectation.after is None and moment is not None and moment > session.duration:
            raise BadInput(where, f"{field}.{key}", moment, f"at most the duration, {session.duration:g} s")
    if isinstance(expectation, Value) and expectation.joint is not None:
        _one_of(expectation.joint, parts[1:-2], where, f"{field}.joint")
    elif isinstance(expectation, Displacement):
        _one_of(expectation.part, parts, where, f"{field}.part")


def _one_of(value: str, allowed: list[str], where: str, field: str) -> None:
    if value not in allowed:
        raise BadInput(where, field, value, f"one of {', '.join(allowed)}" if allowed else "there is none in this session")
