"""Turns a checked file into what a simulation takes, and checks what its fields say against each other and against the arm."""

import math
import re
from typing import Literal

import msgspec

from app.files.bodies import check_load, check_tool, check_tools, check_world
from app.files.checked import ABSENT, BadInput, load
from app.files.library import load_arm, load_tool, tools
from app.session.claims import CLAIMS
from app.session.session_file import Session, Setup, WorldSection, bundled, find, folder
from app.session.timeline_checks import Prepared, applied, check_timeline, check_walls
from pendant.all_settings import Settings, apply, describe, value_of
from pendant.freedrive.settings import SequenceDynamic
from pendant.limits.settings import MaintainLimits, OperationLimits
from pendant.program.steps import misfit
from pendant.settings.schema import Limit
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario, ToolModel

MOUNTINGS: dict[str, list[float]] = {
    "floor": [0.0, 0.0, 0.0],
    "wall": [0.0, math.pi / 2, 0.0],
    "ceiling": [math.pi, 0.0, 0.0],
}
"""Named mountings: roll, pitch, yaw of B in W [rad]. On a wall, z of B is horizontal, along x of W."""

LIMITED = [name for name in MaintainLimits.__struct_fields__ if isinstance(getattr(MaintainLimits(), name), Limit)]
"""Parameters that manipulation is told by."""

RULES = SequenceDynamic.__struct_fields__
"""What lowers limits, by the same names in free-drive and in its activation sequence."""

FEATURES: dict[str, dict[str, float | bool]] = {
    "FD-3": {"free_drive.gain": 0.0},
    "FD-5": {
        "signals.digital": False,
        "signals.push.on": False,
        "signals.twist.on": False,
        "signals.joints.on": False,
        "signals.pattern.on": False,
        "signals.turn.on": False,
        "signals.force_step.on": False,
        "signals.tap.on": False,
    },
    "FD-6": {  # no axis is any direction, no radius any place
        "signals.push.x": 0.0,
        "signals.push.y": 0.0,
        "signals.push.z": 0.0,
        "signals.push.torque_limit": 20.0,
        "signals.push.radius": 0.0,
    },
    "FD-7": {"activation.period": 0.0},
    "FD-8": {"handshake.on": False},
    "FD-8a": {"let_go.on": False},
    "FD-9": {"sequence.on": False},
    "FD-12b": dict.fromkeys(
        [f"soft.{rule}" for rule in RULES] + [f"sequence.dynamic.{rule}" for rule in RULES],
        False,
    ),
    "FD-13": dict.fromkeys([f"limits.maintain.{name}.on" for name in LIMITED], False),
    "FD-14": {"free_drive.period": 30.0},  # longer than a session: nothing ends by itself
    "FD-15": {"free_drive.restart_period": 30.0},
    "FD-18": dict.fromkeys([f"limits.operation.{name}.on" for name in OperationLimits.__struct_fields__], False),
    "CD-11": {  # as with no payload
        "contact.payload_error": 0.0,
        "contact.hard_payload": 0.0,
        "contact.slow_payload": 0.0,
        "contact.ratio_share": 0.05,
    },
    "AF-2": {"joint_control.adaptive": False},
    "AF-4": {"joint_control.feed_forward": False},
    "AF-7": {"joint_control.friction": False},
}
"""Requirement id -> the settings, by dotted name, that turn it off. Features without a switch are not in it."""

SWITCHES = {
    row.name: value_of(Settings(), row.name) if row.choices else False for row in describe() if row.choices or row.is_switch
}
"""Settings that are true or false, or a choice, by dotted name, with what stands for off: false, or the default."""

LAST_OF = {"FD": 25, "VW": 10, "HF": 2, "CD": 18, "AF": 9}
"""The highest number of each group of requirements."""


def prepare(setup: Setup, where: str) -> Prepared:
    """Turn a setup into arm, scenario, settings and program; for a session, check its time line and expectations too.

    Args:
        setup: from a file.
        where: the file's name, for messages.

    Raises:
        BadInput: what the fields say does not fit together, or is not available yet.
    """
    arm = load_arm(setup.robot, where)
    if setup.posture is not None:
        _check_posture(setup.posture, arm, where)
    _check_features(setup.features, where)
    program = setup.program if isinstance(setup, Session) else None
    if program is not None and (why := misfit(program, arm.n)) is not None:
        raise BadInput(where, "program", ABSENT, why)
    settings = applied(Settings(), setup.settings, where, "settings")
    for ident, state in setup.features.items():
        if state == "off":
            settings = apply(settings, dict(FEATURES[ident]))
    prepared = Prepared(arm, _scenario(setup, arm, where), settings, program, where)
    if isinstance(setup, Session):
        _check_claims(setup, where)
        check_timeline(setup, prepared)
    return prepared


def _scenario(setup: Setup, arm: Arm, where: str) -> Scenario:
    world = setup.world
    if isinstance(world, str):
        if world not in bundled("worlds"):
            raise BadInput(where, "world", world, f"a list of objects, or one of {', '.join(bundled('worlds'))}")
        world = load(folder("worlds") / f"{world}.yaml", WorldSection).objects
    check_world(world, where)
    check_walls(setup.walls, world, where)
    check_load(setup.payload_true, arm, where, "payload_true")
    check_load(setup.payload_configured, arm, where, "payload_configured")
    tool = load_tool(setup.tool, where) if isinstance(setup.tool, str) else setup.tool
    return Scenario(
        mounting=MOUNTINGS[setup.mounting] if isinstance(setup.mounting, str) else setup.mounting,
        posture=setup.posture,
        tool=tool,
        tools=_tools(setup, tool, arm, where),
        payload_true=setup.payload_true,
        payload_configured=setup.payload_configured,
        world=world,
        walls=setup.walls,
        soft_sensor=setup.soft_sensor,
        self_contact=setup.self_contact,
        seed=setup.seed,
        mismatch=setup.mismatch,
    )


def _tools(setup: Setup, tool: ToolModel | None, arm: Arm, where: str) -> list[ToolModel]:
    """The table: the file's tools, then those shipped whose names they leave."""
    if tool is not None:
        check_tool(tool, arm, where, "tool")
    check_tools(setup.tools, arm, where)
    names = {entry.name for entry in setup.tools}
    return setup.tools + [shipped for shipped in map(load_tool, tools()) if shipped.name not in names]


def _check_posture(posture: list[float], arm: Arm, where: str) -> None:
    if len(posture) != arm.n:
        raise BadInput(where, "posture", posture, f"{arm.n} joint angles, {arm.chain.joints[0]} to {arm.chain.joints[-1]}")
    for i, (angle, (low, high)) in enumerate(zip(posture, arm.limits.ends, strict=True)):
        if not low <= angle <= high:
            raise BadInput(where, f"posture[{i}]", angle, f"{low:g} .. {high:g} rad ({arm.chain.joints[i]} of {arm.name})")


def _check_features(features: dict[str, Literal["on", "off"]], where: str) -> None:
    for ident in features:
        match = re.fullmatch(r"([A-Z]{2})-(\d{1,2})[a-z]?", ident)
        if match is None or not 0 <= int(match[2]) <= LAST_OF.get(match[1], -1):
            raise BadInput(where, "features", ident, "the id of a requirement, such as FD-9")
        if ident not in FEATURES:
            raise BadInput(where, f"features.{ident}", ABSENT, f"has no switch; these have: {', '.join(FEATURES)}")


def without(session: Session) -> Session:
    """The session with its switch off; `prepare` has checked that it names one."""
    switch = session.switch or ""
    if switch in FEATURES:
        return msgspec.structs.replace(session, features={**session.features, switch: "off"})
    return msgspec.structs.replace(session, settings={**session.settings, switch: SWITCHES[switch]})


def claiming() -> dict[str, Session]:
    """The bundled sessions that show a claim, by name, checked.

    Raises:
        BadInput: one of them cannot be used.
    """
    found: dict[str, Session] = {}
    for name in bundled("sessions"):
        session = load(find(name), Session)
        if session.switch is not None:
            prepare(session, f"{name}.yaml")
            found[name] = session
    return found


def _check_claims(session: Session, where: str) -> None:
    for i, name in enumerate(session.claims):
        if name not in CLAIMS:
            allowed = "the name of a claim, such as A 3, B 22, B fig 3h falling, C 1 or FD-13"
            raise BadInput(where, f"claims[{i}]", name, allowed)
    if session.claims and session.switch is None:
        raise BadInput(where, "switch", ABSENT, "missing: the feature, such as FD-7, without which the claims do not hold")
    if session.switch is not None and session.switch not in {*FEATURES, *SWITCHES}:
        allowed = f"one of {', '.join(FEATURES)}, or a setting that is true or false or a choice, such as sequence.on"
        raise BadInput(where, "switch", session.switch, allowed)
