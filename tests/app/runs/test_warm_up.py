"""After the warm-up nothing is left to compile: no first use halts a page."""

import subprocess
import sys
from typing import Any

import msgspec
import pytest

from app.files.library import load_arm
from app.runs import runner, warm_up
from app.runs.runner import RunOutcome
from app.session.session_file import Session
from app.session.timeline_checks import Prepared
from pendant.program.steps import JointMove, Program

PROBE = """
import importlib, pkgutil
from pathlib import Path
from tempfile import TemporaryDirectory

from numba.core.registry import CPUDispatcher

import sim
from app.api import run, session
from app.files.checked import load
from app.session.prepare import prepare
from app.runs.runner import record
from app.session.session_file import Session, find
from app.runs.warm_up import warm_up


def compiled():
    modules = [importlib.import_module(each.name) for each in pkgutil.walk_packages(sim.__path__, "sim.")]
    kernels = [each for module in modules for each in vars(module).values() if isinstance(each, CPUDispatcher)]
    return {each.py_func.__qualname__: len(each.signatures) for each in kernels}


warm_up()
before = compiled()
assert sum(before.values()) > 20, before
for name in ("axis-locks", "program", "wall-resists", "felt", "touch-the-table"):
    with TemporaryDirectory() as out:
        record(load(find(name), Session), prepare(load(find(name), Session), name), Path(out))
limits = "[0.1,0.1,0.03,0.2,0.2,0.2]"
push = f"def push():\\n force_mode(p[0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,-5,0,0,0], 2, {limits})\\n sleep(0.1)\\nend"
torque = "def turn():\\n i = 0\\n while i < 20:\\n  i = i + 1\\n  direct_torque([0,0,0,0,0,1])\\n end\\nend"
for text in (push, torque):
    simulated = run(session({"title": "push", "duration": 2.0, "timeline": [{"at": 0.5, "do": "script", "text": text}]}))
    assert simulated.passed, simulated
print(sorted(name for name, count in compiled().items() if count != before[name]))
"""


def test_sessions_of_every_kind_compile_nothing_more() -> None:
    found = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_an_arm_with_other_joints_goes_through_it_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    gone: list[Prepared] = []

    def run(session: Session, prepared: Prepared, *others: Any, **named: Any) -> RunOutcome:
        gone.append(prepared)
        return runner.run(msgspec.structs.replace(session, duration=0.01), prepared, *others, **named)

    monkeypatch.setattr(warm_up, "run", run)
    for name in ("iiwa7", "ur10e"):
        warm_up.warm_up(load_arm(name))
    assert [prepared.arm.name for prepared in gone] == ["iiwa7", "ur5e"], "kernels go by the number of joints alone"
    program = gone[0].program
    assert isinstance(program, Program)
    assert isinstance(program.steps[0], JointMove)
    assert len(program.steps[0].q) == 7
    assert gone[0].scenario.posture == gone[0].arm.chain.home
