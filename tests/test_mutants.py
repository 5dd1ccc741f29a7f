"""The sum of a mutation run."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from types import ModuleType

import pytest

from tests.mutant_detours import standing
from tests.mutant_order import FIRST, chosen
from tools.mutants import TABLES, main, second_trial, summary

CODES = {
    "pendant.a.x_f__mutmut_1": 1,
    "pendant.a.x_f__mutmut_2": 0,
    "pendant.b.x_g__mutmut_1": 33,
    "pendant.b.x_g__mutmut_2": None,
}


def test_survivors_are_those_that_pass_or_that_no_test_reaches() -> None:
    lines, share = summary(CODES)
    assert share == pytest.approx(2 / 3)
    assert lines[:2] == ["pendant.a.x_f__mutmut_2", "pendant.b.x_g__mutmut_1"]
    assert [line.split() for line in lines[2:4]] == [["1", "of", "2", "pendant.a"], ["1", "of", "1", "pendant.b"]]
    assert "2 of     3  in all: 66.7 %" in lines[-1]


def test_a_run_that_tried_nothing_is_no_success() -> None:
    with pytest.raises(ValueError, match="no mutant was tried"):
        summary({"pendant.a.x_f__mutmut_1": None})


@pytest.mark.parametrize(("alive", "code"), [(1, 0), (2, 1)])
def test_up_to_a_tenth_may_survive(alive: int, code: int, tmp_path: Path) -> None:
    codes = {f"pendant.a.x_f__mutmut_{k}": int(k >= alive) for k in range(10)}
    (tmp_path / "a.py.meta").write_text(json.dumps({"exit_code_by_key": codes}))
    assert main(tmp_path) == code


MADE_ON_IMPORT = """
import os

def x_table__mutmut_orig(): return [1, 2]
def x_table__mutmut_1(): return [1, 3]
def x_table__mutmut_2(): return [1, 2]
def x_last__mutmut_orig(): return TABLE[-1]
def x_last__mutmut_1(): return 2

def set_or(function):
    return globals().get(os.environ.get("MUTANT_UNDER_TEST", "").removeprefix("pendant.a."), function)

TABLE = set_or(x_table__mutmut_orig)()
"""
"""A module as mutmut leaves it: each function with its mutants beside it; the environment says which one runs."""


def test_survivors_of_what_runs_on_import_are_tried_again_with_the_mutant_set_before_it(tmp_path: Path) -> None:
    """The one that no test of tables tells from the original survives; what runs later, and what was killed, is left as it is."""
    for name in TABLES:
        test = tmp_path / name
        test.parent.mkdir(parents=True, exist_ok=True)
        test.write_text("from pendant.a import TABLE\n\ndef test_table():\n    assert TABLE == [1, 2]\n")
    (tmp_path / "pendant").mkdir()
    (tmp_path / "pendant" / "__init__.py").touch()
    (tmp_path / "pendant" / "a.py").write_text(MADE_ON_IMPORT)
    codes = dict.fromkeys([f"pendant.a.x_{name}__mutmut_{k}" for name in ("table", "last") for k in (1, 2)], 0)
    codes["pendant.a.x_table__mutmut_3"] = 1
    assert second_trial(codes, tmp_path) == {"pendant.a.x_table__mutmut_1": 1, "pendant.a.x_table__mutmut_2": 0}


def test_tests_of_the_mutants_own_module_come_first_and_of_the_others_the_quickest() -> None:
    own = {"tests/pendant/test_a.py::test_long": 90.0, "tests/pendant/test_a.py::test_short[a/test_b.py::x]": 0.5}
    others = {"tests/pendant/test_b.py::test_x": 5.5, "tests/pendant/test_b.py::test_y": 0.4, "tests/sim/test_c.py::test_z": 0.2}
    order = chosen([*own, *others], "a", own | others)
    assert [name.rpartition("::")[2] for name in order] == ["x]", "test_long", "test_z", "test_y"]


def detour(function: Callable[..., str]) -> Callable[..., str]:
    """A function as mutmut puts it in place of another."""

    @wraps(function)
    def _trampoline_wrapper(*self: object) -> str:
        return f"round {function(*self)}"

    return _trampoline_wrapper


def test_all_functions_but_the_mutants_are_called_straight(monkeypatch: pytest.MonkeyPatch) -> None:
    class Arm:
        pass

    def f() -> str:
        return "f"

    def g(self: Arm) -> str:
        return "g"

    def h(self: Arm) -> str:
        return "h"

    module, user = ModuleType("pendant.a"), ModuleType("tests.a")
    Arm.__module__ = f.__module__ = g.__module__ = h.__module__ = "pendant.a"
    f.__qualname__, g.__qualname__, h.__qualname__ = "f", "Arm.g", "Arm.h"
    for name, value in {"f": detour(f), "Arm": Arm, "Other": str}.items():
        setattr(module, name, value)
    Arm.g, Arm.h, user.f = detour(g), detour(h), module.f  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pendant.a", module)
    monkeypatch.setitem(sys.modules, "tests.a", user)

    def calls() -> list[str]:
        return [module.f(), user.f(), Arm().g(), Arm().h()]

    detours = [detour for detour in standing() if detour.original.__module__ == "pendant.a"]
    for mutant, expected in {
        "": ["f", "f", "g", "h"],
        "pendant.a.xǁArmǁg__mutmut_3": ["f", "f", "round g", "h"],
        "pendant.a.x_f__mutmut_13": ["round f", "round f", "g", "h"],
        "pendant.b.x_f__mutmut_13": ["f", "f", "g", "h"],
    }.items():
        for one in detours:
            one.put(mutant)
        assert calls() == expected
    for one in detours:
        one.put_back()
    assert calls() == ["round f", "round f", "round g", "round h"]


def test_the_first_tests_are_collected_alone_and_the_rest_where_they_pass(tmp_path: Path) -> None:
    """With a mutant set, each test runs once, in the order chosen, up to the first that fails."""
    names = [f"tests/pendant/test_a.py::test_{number:02d}" for number in range(2 * FIRST)]
    for package in ("tests", "tests/pendant", "mutmut"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").touch()
    for plugin in ("mutant_order.py", "mutant_detours.py"):
        shutil.copy(Path(__file__).parent / plugin, tmp_path / "tests")
    lasts = {name: float(number) for number, name in enumerate(names)}
    state = f"from types import SimpleNamespace\n\ndef state():\n    return SimpleNamespace(duration_by_test={lasts})\n"
    (tmp_path / "mutmut" / "state.py").write_text(state)

    def run(fails: int) -> tuple[int, list[str]]:
        tests = [f"def {name.rpartition('::')[2]}():\n    assert {number} != {fails}\n" for number, name in enumerate(names)]
        (tmp_path / "tests" / "pendant" / "test_a.py").write_text("\n".join(tests))
        command = [
            sys.executable,
            "-B",
            "-m",
            "pytest",
            "-x",
            "-v",
            "-p",
            "tests.mutant_order",
            "-p",
            "no:cacheprovider",
            *reversed(names),
        ]
        environment = {**os.environ, "MUTANT_UNDER_TEST": "pendant.a.x_f__mutmut_1", "PYTHONPATH": str(tmp_path)}
        done = subprocess.run(command, cwd=tmp_path, env=environment, check=False, capture_output=True, text=True)
        words = [line.split() for line in done.stdout.splitlines()]
        return done.returncode, [line[0] for line in words if len(line) > 1 and line[1] in ("PASSED", "FAILED")]

    for fails, code, count in ((0, 1, 1), (FIRST, 1, FIRST + 1), (len(names) - 1, 1, len(names)), (-1, 0, len(names))):
        assert run(fails) == (code, names[:count])
