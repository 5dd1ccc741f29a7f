"""docs/reference/versions.md and the robot agree: the version that it answers as, and every name that the table dates."""

import re
from collections import deque
from pathlib import Path

import pytest

from app.robot_interface.controller.robot_words import VERSION
from app.robot_interface.controller.rtde_fields import OUTPUTS
from app.robot_interface.dashboard.dashboard_commands import DashboardCommands
from app.urscript.functions.library_of_functions import builtins_of
from app.urscript.machine.signature import Builtin
from app.urscript.running.script_robot import ScriptRobot
from tests.app.robot_interface.robot_bench import RobotBench
from tests.app.urscript.script_bench import ScriptBench

PAGE = (Path(__file__).parents[3] / "docs/reference/versions.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| (5\.\d+) \|(.*)\|(.*)\|(.*)\|$", PAGE, re.MULTILINE)


def named(column: int) -> dict[str, bool]:
    """The names of a column of the table -> whether a dagger says that this robot lacks it."""
    return {name: dagger == "†" for row in ROWS for name, dagger in re.findall(r"`(.+?)`(†?)", row[column])}


def test_the_page_tells_the_version_that_the_robot_answers_as() -> None:
    assert re.findall(r"\*\*(.+?)\*\*", PAGE) == [".".join(map(str, VERSION[:3]))]


def test_the_versions_ascend_up_to_the_robots_own() -> None:
    versions = [tuple(map(int, row[0].split("."))) for row in ROWS]
    assert versions == sorted(set(versions))
    assert versions[-1] <= VERSION[:2]


def test_the_dashboard_knows_every_command_and_does_those_without_a_dagger() -> None:
    robot = RobotBench()
    commands = DashboardCommands(robot.cabinet, "UR5")
    robot.step(60)
    for command, lacking in named(1).items():
        answer = commands.answer(command, True)
        assert not str(answer).startswith("could not understand"), command
        assert str(answer).startswith("Error: this robot writes no") == lacking, command


def test_rtde_has_every_field() -> None:
    assert [name for name, lacking in named(2).items() if (name not in OUTPUTS) != lacking] == []


@pytest.fixture(scope="module")
def functions() -> dict[str, Builtin]:
    bench = ScriptBench()
    robot = ScriptRobot(bench.robot.cabinet, bench.runner.arm, frozenset(), print, memory=bench.runner.memory)
    return builtins_of(robot, deque())


def test_scripts_have_every_function_without_a_dagger(functions: dict[str, Builtin]) -> None:
    wanted = named(3) | {"rpc_factory": False, "modbus_add_signal": False}
    assert all(f"`{name}`" in PAGE for name in wanted)
    assert {name: bool(functions[name].absent) for name in wanted} == wanted
