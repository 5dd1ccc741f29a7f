"""Whether the bodies of a scenario can exist: what the types of loads and world objects cannot say."""

import math

from app.files.checked import BadInput
from pendant.equipment.load import Problem, problem
from pendant.equipment.tools import table_problem, tool_problem
from sim.arm.arm_file import Arm
from sim.arm.scenario import AnyObject, Fingers, FreeBox, FreeCylinder, Load, Moving, ToolModel

FASTEST = 5.0
"""Of an object that moves [m/s]."""

RINGS_AT_MOST = 2000.0
"""How fast a part rings that touches the arm, sqrt(K / m) [rad/s]: an eighth of the physics' rate of 4 kHz."""

OVERLOAD = 10.0
"""Heaviest load, as a multiple of the arm's rated payload: enough to try any mistake, and within what the physics can bear."""


def check_load(load: Load, arm: Arm, where: str, field: str) -> None:
    """Refuse a load that no arm could carry, or whose inertia no rigid body has.

    Raises:
        BadInput: mass or centre out of range; or the inertia is not six numbers, or has principal moments that are not
            positive or of which one exceeds the sum of the others.
    """
    _refuse(problem(load, OVERLOAD * arm.payload), arm, where, f"{field}.")


def check_tool(tool: ToolModel, arm: Arm, where: str, field: str) -> None:
    """Refuse a tool that no arm could carry, as `check_load`, or whose name, tool centre point or gripper cannot be.

    Raises:
        BadInput: as said.
    """
    _refuse(tool_problem(tool, OVERLOAD * arm.payload), arm, where, f"{field}.")
    gripper = tool.gripper
    if gripper is None:
        return
    if gripper.close_output == gripper.open_output:
        raise BadInput(where, f"{field}.gripper.open_output", gripper.open_output, "another output than close_output")
    if isinstance(gripper, Fingers):
        if gripper.finger >= tool.length:
            raise BadInput(where, f"{field}.gripper.finger", gripper.finger, f"below the tool's length, {tool.length:g} m")
        for least, most in (("least_force", "most_force"), ("least_speed", "most_speed")):
            if getattr(gripper, least) > getattr(gripper, most):
                raise BadInput(where, f"{field}.gripper.{least}", getattr(gripper, least), f"at most {most}")


def check_tools(tools: list[ToolModel], arm: Arm, where: str, *, most: float = OVERLOAD) -> None:
    """Refuse a table of tools with one that `check_tool` refuses, or with two of a name.

    Args:
        tools: the table.
        arm: that is to carry each of them.
        where: the file's name.
        most: mass of a tool, as a multiple of the arm's rated payload.

    Raises:
        BadInput: as said.
    """
    _refuse(table_problem(tools, most * arm.payload), arm, where, "tools")


def _refuse(wrong: Problem | None, arm: Arm, where: str, prefix: str) -> None:
    if wrong is not None:
        whose = f" for the {arm.name}" if wrong.field.endswith("mass") else ""
        raise BadInput(where, prefix + wrong.field, wrong.value, wrong.allowed + whose)


def check_world(world: list[AnyObject], where: str) -> None:
    """Refuse objects of the same name, such as move faster than any machine beside an arm, and such as ring faster than the
    physics can follow.

    Raises:
        BadInput: as said.
    """
    names = [thing.name for thing in world]
    for i, thing in enumerate(world):
        if thing.name in names[:i]:
            raise BadInput(where, f"world[{i}].name", thing.name, "each object needs a name of its own")
        if isinstance(thing, FreeBox | FreeCylinder) and thing.stiffness > RINGS_AT_MOST**2 * thing.mass:
            allowed = f"at most {RINGS_AT_MOST**2 * thing.mass:.3g} N/m for {thing.mass:g} kg"
            raise BadInput(where, f"world[{i}].stiffness", thing.stiffness, allowed)
        if isinstance(thing, Moving):
            speed = 2.0 * math.pi * math.hypot(*thing.amplitude) / thing.period
            if speed > FASTEST:
                allowed = f"at most {FASTEST:g} m/s; this makes {speed:.3g}"
                raise BadInput(where, f"world[{i}].amplitude", thing.amplitude, allowed)
