"""docs/reference/script-functions.md and the code agree: every function, its parameters, what is not there and why."""

import re
from collections import deque

import pytest

from app.urscript.functions.library_of_functions import builtins_of
from app.urscript.machine.signature import Builtin
from app.urscript.running.script_robot import ScriptRobot
from tests.app.urscript.function_table import AS_DOCUMENTED, DIFFERENT, NOT_THERE, PAGE, signature, table
from tests.app.urscript.script_bench import ScriptBench


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


@pytest.fixture(scope="module")
def functions(bench: ScriptBench) -> dict[str, Builtin]:
    robot = ScriptRobot(bench.robot.cabinet, bench.runner.arm, frozenset(), print, memory=bench.runner.memory)
    return builtins_of(robot, deque())


def test_the_table_has_every_function_and_no_other(functions: dict[str, Builtin]) -> None:
    assert set(table()) == set(functions)


def test_the_table_tells_the_parameters_and_what_is_not_there(functions: dict[str, Builtin]) -> None:
    for name, row in table().items():
        function = functions[name]
        assert row.here in (AS_DOCUMENTED, DIFFERENT, NOT_THERE), name
        assert (row.here == NOT_THERE) == bool(function.absent), name
        assert bool(row.words) == (row.here != AS_DOCUMENTED), name
        if function.absent:
            assert row.words.lower() == function.absent.lower(), name
        else:
            assert row.signature == signature(function)


def test_the_page_counts_its_rows() -> None:
    here = [row.here for row in table().values()]
    counts = [here.count(each) for each in (AS_DOCUMENTED, DIFFERENT, NOT_THERE)]
    said = re.search(r"(\d+) are as documented, (\d+) different, (\d+) not there", PAGE.read_text(encoding="utf-8"))
    assert said is not None
    assert [int(each) for each in said.groups()] == counts


@pytest.mark.parametrize("name", [name for name, row in table().items() if row.here == NOT_THERE])
def test_a_program_may_name_what_is_not_there_and_ends_where_it_calls_it(bench: ScriptBench, name: str) -> None:
    told, trouble = bench.run(
        f'def p():\n  def never():\n    x = {name}(1, a=2)\n  end\n  textmsg(1)\n  x = {name}("a", 1 + 1)\n  textmsg(2)\nend'
    )
    assert told == ["1"]
    assert trouble.startswith(f"line 6, column 7: {name}(): ")
    assert table()[name].words[1:] in trouble
