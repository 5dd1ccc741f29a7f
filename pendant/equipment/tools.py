"""The table of tools. The data of a tool are always used together: its tool centre point and its load."""

from collections.abc import Sequence
from typing import NamedTuple

import msgspec

from pendant.equipment.load import NOTHING, Angles, Load, Moments, Problem, Vector, misplaced, problem
from pendant.settings.bounds import Mass

LONGEST = 40
"""Largest length of a tool's name [characters]."""

MOST = 50
"""Largest number of tools in a table."""


class Tool(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A tool: its tool centre point and its load go together, so that no change takes one without the other."""

    name: str
    mass: Mass  # [kg]
    com: Vector  # centre of mass in F [m]
    tcp: Vector  # tool centre point: p_FT [m]
    rpy: Angles = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.0])  # roll, pitch, yaw of T in F [rad]
    inertia: Moments | None = None  # about the centre: ixx iyy izz ixy ixz iyz, axes of F [kg·m²]


BARE = Tool(name="flange", mass=0.0, com=[0.0, 0.0, 0.0], tcp=[0.0, 0.0, 0.0])
"""No tool: the tool centre point is the middle of the flange."""


class Equipment(NamedTuple):
    """What a robot is set up with at the flange."""

    tools: tuple[Tool, ...] = (BARE,)  # the table
    tool: Tool = BARE  # the one in use
    load: Load = NOTHING  # configured beyond it
    most: float = 5.0  # tool and load together, where they are changed while the robot runs [kg]
    fixed: Load = NOTHING  # the sensor's own tool-side face, which no tool takes away


def tool_problem(tool: Tool, most: float) -> Problem | None:
    """Why a tool cannot be used, or None; `most` is the heaviest that is allowed [kg]."""
    if not 0 < len(tool.name) <= LONGEST:
        return Problem("name", tool.name, f"1 to {LONGEST} characters")
    wrong = problem(Load(mass=tool.mass, com=tool.com, inertia=tool.inertia), most) or misplaced(tool.tcp, "tcp")
    if wrong is not None:
        return wrong
    for axis, angle in enumerate(tool.rpy):
        if not abs(angle) <= 7.0:
            return Problem(f"rpy[{axis}]", angle, "-7 .. 7 rad")
    return None


def table_problem(tools: Sequence[Tool], most: float) -> Problem | None:
    """Why a table cannot be used, or None; the field begins with the tool's place."""
    wrong = first_problem(tools, most)
    return None if wrong is None else wrong[1]._replace(field=f"[{wrong[0]}].{wrong[1].field}")


def first_problem(tools: Sequence[Tool], most: float) -> tuple[int, Problem] | None:
    """The place of the first tool with which a table cannot be used, and why, or None."""
    names: set[str] = set()
    for place, tool in enumerate(tools):
        wrong = tool_problem(tool, most)
        if wrong is None and tool.name in names:
            wrong = Problem("name", tool.name, "each tool needs a name of its own")
        if wrong is None and place == MOST:
            wrong = Problem("name", tool.name, f"at most {MOST} tools")
        if wrong is not None:
            return place, wrong
        names.add(tool.name)
    return None
