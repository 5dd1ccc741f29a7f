"""The table of tools: what is refused, and what stands for itself."""

import msgspec
import pytest

from pendant.equipment.tools import BARE, LONGEST, MOST, Equipment, Tool, first_problem, table_problem, tool_problem

GRIPPER = Tool(name="gripper", mass=0.925, com=[0.0, 0.0, 0.058], tcp=[0.0, 0.0, 0.163])


def test_a_tool_says_all_that_belongs_together() -> None:
    assert [field.name for field in msgspec.structs.fields(Tool)] == ["name", "mass", "com", "tcp", "rpy", "inertia"]
    assert (GRIPPER.rpy, GRIPPER.inertia) == ([0.0, 0.0, 0.0], None)


def test_nothing_is_at_the_flange_unless_it_is_said() -> None:
    assert Equipment() == ((BARE,), BARE, Equipment().load, 5.0, Equipment().fixed)
    assert (Equipment().load.mass, Equipment().fixed.mass, BARE.mass, BARE.tcp) == (0.0, 0.0, 0.0, [0.0, 0.0, 0.0])


ONE = msgspec.structs.replace(GRIPPER, name="x")


@pytest.mark.parametrize("tool", [BARE, GRIPPER, msgspec.structs.replace(GRIPPER, name="x" * LONGEST, rpy=[7.0, -7.0, 0.0]), ONE])
def test_a_tool_that_can_be_has_no_problem(tool: Tool) -> None:
    assert tool_problem(tool, 5.0) is None


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"name": ""}, ("name", "", "1 to 40 characters")),
        ({"name": "x" * 41}, ("name", "x" * 41, "1 to 40 characters")),
        ({"mass": 6.0}, ("mass", 6.0, "0 .. 5 kg")),
        ({"com": [1.5, 0.0, 0.0]}, ("com[0]", 1.5, "-1 .. 1 m")),
        ({"tcp": [0.0, 0.0, 1.5]}, ("tcp[2]", 1.5, "-1 .. 1 m")),
        ({"rpy": [0.0, 7.1, 0.0]}, ("rpy[1]", 7.1, "-7 .. 7 rad")),
        ({"inertia": [1.0]}, ("inertia", [1.0], "six numbers: ixx iyy izz ixy ixz iyz")),
    ],
)
def test_a_tool_that_cannot_be_is_one_line(changes: dict[str, object], line: tuple[object, ...]) -> None:
    assert tool_problem(msgspec.structs.replace(GRIPPER, **changes), 5.0) == line


def test_a_table_names_the_place() -> None:
    assert table_problem([BARE, GRIPPER], 5.0) is None
    assert table_problem([], 5.0) is None
    found = table_problem([BARE, msgspec.structs.replace(GRIPPER, mass=9.0)], 5.0)
    assert found == ("[1].mass", 9.0, "0 .. 5 kg")
    assert table_problem([GRIPPER, BARE, GRIPPER], 5.0) == ("[2].name", "gripper", "each tool needs a name of its own")


def test_a_table_has_an_end() -> None:
    many = [msgspec.structs.replace(GRIPPER, name=f"gripper {k}") for k in range(MOST + 1)]
    assert first_problem(many[:MOST], 5.0) is None
    assert first_problem(many, 5.0) == (50, ("name", "gripper 50", "at most 50 tools"))
