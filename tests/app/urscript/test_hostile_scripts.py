"""A small part of benchmarks/script_hostile.py: nothing that a script says or does is a surprise."""

import gc
import itertools
import socket
from contextlib import suppress

import pytest

from app.urscript.language import grammar, tree
from app.urscript.language.reading import read_script
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.machine.limits import NODES_A_TICK, NODES_OF_START
from app.urscript.machine.machine import Machine
from app.urscript.machine.signature import builtin
from app.urscript.running import script_runner
from benchmarks.script_hostile import Course, damaged, hostile
from tests.app.urscript.script_bench import ScriptBench


@pytest.fixture(scope="module")
def course() -> Course:
    return Course()


def test_damaged_programs_end_with_a_place_or_run(course: Course) -> None:
    for text in damaged(150, seed=1):
        ended = course.run(text, 5)
        assert ended.surprise == "", text
        assert not ended.error or ended.error.startswith("line "), text


@pytest.mark.parametrize("text", list(hostile(12)), ids=lambda text: text[:30].replace("\n", "|"))
def test_programs_that_ask_for_all_there_is_are_ended_with_a_message(course: Course, text: str) -> None:
    ended = course.run(text, 560)
    assert ended.surprise == ""
    assert ended.error.startswith("line ") or not ended.over


@pytest.mark.parametrize(
    ("allowed", "beyond", "said"),
    [
        (
            "x = " + "(" * 60 + "1" + ")" * 60,
            "x = " + "(" * 61 + "1" + ")" * 61,
            "column 65: brackets within brackets, more than 60",
        ),
        ("x = 1 #" + "-" * 32761, "x = 1 #" + "-" * 32762, "column 1: the line has 32769 characters, allowed: 32768"),
    ],
)
def test_the_limits_of_a_line_are_named(allowed: str, beyond: str, said: str) -> None:
    assert len(read_script(allowed)) == 1
    with pytest.raises(ScriptTrouble) as refused:
        read_script(f"x = 1\n{beyond}")
    assert str(refused.value) == f"line 2, {said}"


DEEP = {
    "sum": "x = 1" + " + 1" * 600,
    "not": "x = " + "not " * 600 + "True",
    "or": "x = True" + " or True" * 600,
    "elements": "x = [1]\ny = x" + "[0]" * 600,
    "members": "x = struct(a=1)\ny = x" + ".a" * 600,
    "target": "x = [1]\nx" + "[0]" * 600 + " = 1",
    "blocks": "if True:\n" * 300 + "x = 1\n" + "end\n" * 300,
}


@pytest.mark.parametrize("text", DEEP.values(), ids=DEEP)
def test_what_is_nested_too_deeply_is_an_error_with_its_place(course: Course, text: str) -> None:
    ended = course.run(text, 5)
    assert ended.surprise == ""
    assert ended.error.startswith("line ")
    assert "within one another" in ended.error


@pytest.mark.parametrize(
    "text",
    ["x = 1" + " + 1" * 190, "x = " + "not " * 190 + "True", "if True:\n" * 190 + "x = 1\n" + "end\n" * 190],
    ids=["sum", "not", "blocks"],
)
def test_what_is_nested_less_deeply_runs(course: Course, text: str) -> None:
    ended = course.run(text, 50)
    assert (ended.surprise, ended.error, ended.over) == ("", "", True)


def test_a_script_of_too_many_words_is_refused_before_it_is_a_tree(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grammar, "MOST_TOKENS", 100)
    assert len(read_script("x=1\n" * 25)) == 25
    with pytest.raises(ScriptTrouble, match=r"line 26, column 1: the script has more than 100 words"):
        read_script("x=1\n" * 26)


def counted(text: str, ticks: int) -> list[int]:
    """The variable n of a program after each tick."""
    heavy = builtin("heavy", lambda: 1, cost=10 * NODES_A_TICK)
    machine, found = Machine(read_script(text), {"heavy": heavy}), []
    for _ in range(ticks):
        machine.tick()
        found.append(int(machine.variables()["n"]))
    return found


def test_what_a_statement_takes_beyond_the_budget_is_made_up_for() -> None:
    assert counted("n = 0\nwhile True:\n  n = n + heavy()\nend", 41)[::10] == [1, 2, 3, 4, 5]


def test_threads_that_start_threads_take_what_they_cost() -> None:
    text = "global n = 0\nthread t():\n  n = n + 1\n  h = run t()\nend\nh = run t()\nwhile True:\n  sync()\nend"
    found = counted(text, 20)
    assert found[-1] > 20
    assert max(b - a for a, b in itertools.pairwise(found)) <= NODES_A_TICK // NODES_OF_START


LASTING = "def f():\n" + "  x = [1.0, 2.0]\n" * 700 + "  while True:\n    sync()\n  end\nend"
"""Long enough that nobody looks for garbage in it."""


@pytest.mark.parametrize("text", ["x = 1", LASTING, LASTING + "\ny = z"], ids=["short", "long", "wrong"])
def test_a_script_leaves_no_circle_behind(course: Course, text: str) -> None:
    """What is kept out of the search for garbage would stay for ever."""
    runner, counts = course.runner, []
    gc.collect()
    gc.disable()
    try:
        for _ in range(6):
            with suppress(ScriptTrouble):
                runner.offer(text)
            runner.wishes(1)
            runner.stop()
            runner.wishes(2)
            with suppress(ScriptTrouble):
                runner.offer("x = (")  # what the one before was is let go
            gc.unfreeze()
            counts.append(len(gc.get_objects()))
    finally:
        gc.enable()
    assert counts[-1] - counts[1] < 200  # messages that are kept


@pytest.mark.parametrize("text", ["x = 1", "x = (", LASTING], ids=["short", "unreadable", "long"])
def test_no_garbage_is_looked_for_while_a_script_is_read(course: Course, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each look would stop every thread, and a long script makes many objects to be looked at."""
    seen: list[bool] = []

    def read(offered: str) -> list[tree.Node]:
        seen.append(gc.isenabled())
        return read_script(offered)

    monkeypatch.setattr(script_runner, "read_script", read)
    try:
        course.runner.offer(text)
    except ScriptTrouble:
        assert text.endswith("(")
    assert seen == [False]
    assert gc.isenabled()


def test_who_floods_a_program_neither_ends_it_nor_holds_its_threads_up() -> None:
    """The UR client library's example of tool contact writes its speeds as fast as it can."""
    server = socket.create_server(("127.0.0.1", 0))
    text = (
        f'h = socket_open("127.0.0.1", {server.getsockname()[1]}, "a")\nglobal i = 0\nglobal n = 0\n'
        "thread t():\n  while True:\n    i = i + 1\n    sync()\n  end\nend\nh = run t()\n"
        'while True:\n  enter_critical\n  x = socket_read_binary_integer(1, "a")\n  n = n + x[0]\n  exit_critical\nend'
    )
    bench = ScriptBench()
    with server:
        bench.runner.offer(text)
        bench.robot.step(3)
        client, _ = server.accept()
        with client:
            client.sendall(b"\0\0\0\1" * 8000)
            bench.robot.step(700)
            seen = bench.runner.variables()
    assert bench.runner.trouble is None
    assert int(seen["n"]) > 1000
    assert int(seen["i"]) > 600
