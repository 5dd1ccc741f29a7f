"""Whether any script can hold up the robot: damaged programs, and programs that ask for all there is.

First each runs tick by tick, where nothing waits for a clock: no surprise, a clear error. Then all of them are sent to a robot
whose loop keeps the clock's pace, and whatever they ask for, it loses no time.
"""

import random
import resource
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import yaml

from app.api import session, stepped
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.runs.runner import simulate
from app.runs.warm_up import warm_up
from app.session.prepare import prepare
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner
from benchmarks.common import Report, main
from pendant.inputs import NOTHING
from pendant.tick.modes import TICK
from sim.exchange.desk import Wishes
from sim.run.loop import Loop

PROGRAMS = Path(__file__).parent.parent / "tests" / "app" / "urscript" / "conformance.yaml"

LONGEST = 700
"""Ticks that a program gets."""

PATIENCE = 1.2
"""Time that it gets in the loop: one that lets no time pass is ended after a second [s]."""

SNIPPETS = (
    "end",
    "def f():",
    "while True:",
    "(",
    ")",
    "[",
    "]",
    '"',
    "= =",
    "p[",
    ",",
    "run",
    "9e999",
    "-",
    "if",
    "\n",
    "\0",
    "é",
)

HOSTILE = (
    "while True:\n  x = {n}\nend",
    "while True:\nend",
    "def f():\n  f()\nend\nf()",
    "def f(n):\n  return f(n + {n})\nend\nx = f(1)",
    "x = {n}\nwhile True:\n  x = x * x\nend",
    "x = [1]\nwhile True:\n  x = [x, x]\nend",
    'x = "{n}"\nwhile True:\n  x = str_cat(x, x)\nend',
    "x = make_list(1000, {n})\nwhile True:\n  x = x + x\nend",
    "x = make_list(1000, make_list({n}, 1))",
    "thread t():\n  while True:\n    x = 1\n  end\nend\nwhile True:\n  h = run t()\nend",
    "thread t():\n  while True:\n    sync()\n  end\nend\ni = 0\nwhile i < 5000:\n  h = run t()\n  i = i + 1\nend",
    "thread t():\n  h = run t()\nend\nh = run t()\nwhile True:\n  sync()\nend",
    "thread t():\n  enter_critical\n  while True:\n    x = {n}\n  end\nend\nh = run t()\nwhile True:\n  sync()\nend",
    'x = socket_open("127.0.0.1", 1, "a", 0.1)\nx = socket_read_line("a", {n})\nwhile True:\n  x = socket_read_line("a")\nend',
    'i = 0\nwhile True:\n  x = socket_open("127.0.0.1", 9, str_cat("s", i), 0.01)\n  i = i + 1\nend',
    'while True:\n  textmsg("flood {n}")\nend',
    'while True:\n  textmsg("flood {n}")\n  sync()\nend',
    "def f(x):\n  return x + x + x + x + x + x + x + x\nend\nwhile True:\n  y = f(make_list({n}, 1))\nend",
    "x = pow(10, 308) * pow(10, {n})\nwrite_output_float_register(0, x)",
    "movej([{n}, 9, 9, 9, 9, 9])",
    "write_output_integer_register({n}000000000, 1)",
    "x = get_inverse_kin(p[{n}, 0, 0, 0, 0, 0])",
    "while True:\n  x = get_inverse_kin_has_solution(p[{n}, 0, 0, 0, 0, 0])\nend",
    "x = struct(a=1)\nwhile True:\n  x = struct(a=x, b=x)\nend",
    "while True:\n  x = get_forward_kin()\n  y = {n}\nend",
    "while True:\n  x = get_actual_tool_flange_pose()\n  y = get_jacobian_time_derivative()\n  z = {n}\nend",
    "while True:\n  x = inv([[1, 2], [3, {n}]])\nend",
    "while True:\n  x = rotvec2rpy([{n}, 0, 0])\nend",
    "while True:\n  x = interpolate_pose(p[0, 0, 0, {n}, 0, 0], get_actual_tcp_pose(), 0.5)\nend",
    "while True:\n  x = wrench_trans(get_tcp_offset(), [0, 0, {n}, 0, 0, 0])\n  y = is_steady()\nend",
    "while True:\n  freedrive_mode()\n  x = {n}\nend",
    "x = {n}" + " + 1" * 5000,
    "x = " + "not " * 5000 + "({n} > 1)",
    "x = [{n}]\ny = x" + "[0]" * 5000,
    "if True:\n" * 150 + "x = {n}\n" + "end\n" * 150,
    "if True:\n" * 1000 + "x = {n}\n" + "end\n" * 1000,
    "a = make_list(1000, 1.5)\nb = [a]\nwhile True:\n  b = inv([[1, 2], [3, {n}]])\nend",
)
"""Each with several numbers in place of {n}."""

LEVELS = "\n".join(f"def f{k}(x):\n  return f{k + 1}(x) + f{k + 1}(x)\nend" for k in range(30))
DOUBLING = f"{LEVELS}\ndef f30(x):\n  return x\nend\nwhile True:\n  y = f0({{n}})\nend"
LONG = "def f():\n" + "\n".join(f"  movej([{k}e-6, -1.2, 1.5, -1.87, -1.57, 0.0], a=1.4, v=1.05, r=0.01)" for k in range(9000))
SHORT = "\n".join("x=1" for _ in range(90000))
VAST = (
    f"{LONG}\n  x = {{n}}\nend",
    f"{LONG}\n  x = y{{n}}\nend",
    f"{LONG}\n  x = ({{n}}",
    f"{SHORT}\nx = {{n}}",
    SHORT * 2 + "{n}",
)
"""Hundreds of thousands of characters: that run, that name what is not there, that have no end, of many lines, and too many."""
MANY = "\n".join(f"v{k} = make_list(1000, {k}.5)" for k in range(2000)) + "\nx = {n}"


class Ended(NamedTuple):
    """How a program went."""

    longest: float  # of the script's part of a tick, on the processor [ms]
    refused: bool  # it was not begun
    error: str  # that ended it
    over: bool  # it came to an end by itself
    surprise: str  # what should not happen


class Course:
    """A robot that stands, and runs one script after the other."""

    def __init__(self) -> None:
        self._simulation = stepped(session({"title": "scripts", "robot": "ur5e", "mismatch": "nominal", "duration": 1.0}))
        self._cabinet = Cabinet(lambda: self._simulation, self._simulation.arm.chain.joints, ProgramFolder())
        self.runner = ScriptRunner(self._cabinet)
        decision = self._simulation.tick(Wishes(NOTHING, (), ()))
        self._cabinet.wishes(1, self._simulation.snapshot)
        self._cabinet.see(1, decision)

    def run(self, text: str, ticks: int = LONGEST) -> Ended:
        """Offer a program, and let `ticks` pass."""
        runner, longest = self.runner, 0.0
        try:
            runner.offer(text)
        except ScriptTrouble as trouble:
            return Ended(0.0, True, str(trouble), True, "")
        except (RuntimeError, ValueError, TypeError, KeyError, IndexError, MemoryError) as error:
            return Ended(0.0, True, "", True, repr(error))
        surprise = ""
        for tick in range(ticks):
            begun = time.thread_time_ns()
            try:
                runner.wishes(tick)
            except (RuntimeError, ValueError, TypeError, KeyError, IndexError, AttributeError, MemoryError) as error:
                surprise = repr(error)
            longest = max(longest, (time.thread_time_ns() - begun) / 1e6)
            self._cabinet.ticks += 1
            if runner.state is None or surprise:
                break
        over, trouble = runner.state is None, runner.trouble
        runner.stop()
        runner.wishes(0)
        return Ended(longest, False, "" if trouble is None else str(trouble), over, surprise)


def hostile(count: int) -> Iterator[str]:
    """So many programs that are well formed, and mean no good."""
    made = [*HOSTILE, DOUBLING, MANY, *VAST]
    for k in range(count):
        yield made[k % len(made)].replace("{n}", str(2 + k // len(made)))


def damaged(count: int, seed: int) -> Iterator[str]:
    """So many programs with something cut out, doubled or put in."""
    source = random.Random(seed)
    programs = [row["run"] for row in yaml.safe_load(PROGRAMS.read_text(encoding="utf-8"))]
    for _ in range(count):
        text = source.choice(programs)
        for _ in range(source.randint(1, 3)):
            at, length = source.randint(0, len(text)), source.randint(0, 6)
            middle = source.choice((source.choice(SNIPPETS), "", text[at : at + length] * 2, chr(source.randint(1, 255))))
            text = text[:at] + middle + text[at + length :]
        yield text


def beside_the_clock(report: Report, programs: list[tuple[str, float]]) -> None:
    """Send programs to a robot whose loop keeps the clock's pace; each with the time that it gets [s]."""
    prepared = prepare(session({"title": "scripts", "robot": "ur5e", "duration": 1.0}), "scripts")
    loop = Loop(lambda: simulate(prepared))
    cabinet = Cabinet(lambda: loop.simulation, prepared.arm.chain.joints, ProgramFolder())
    runner = ScriptRunner(cabinet)
    loop.companion = cabinet
    loop.start()
    try:
        time.sleep(1.0)
        begun, before, lost = time.perf_counter(), cabinet.ticks, loop.dropped
        for text, seconds in programs:
            end = time.perf_counter() + seconds
            try:
                runner.offer(text)
            except ScriptTrouble:
                continue
            while time.perf_counter() < end:
                time.sleep(0.01)
                if runner.state is None:
                    break
            runner.stop()
        took, ticks = time.perf_counter() - begun, cabinet.ticks - before
    finally:
        loop.stop()
    report.row("beside the clock: time lost by stalls", loop.dropped - lost, "s", at_most=0.0, n=len(programs))
    report.row("beside the clock: simulated over real time", ticks * TICK / took, at_least=0.99, at_most=1.01, n=ticks)
    report.row("beside the clock: the loop still runs", float(not loop.failure), at_least=1.0)


def measure(report: Report) -> None:
    """Fill the report."""
    warm_up()  # as the app does
    course, full = Course(), report.options.full
    for _ in range(3):
        course.run("x = 1")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for name, programs, ticks in (
        ("damaged", list(damaged(10000 if full else 300, report.options.seed)), 20),
        ("hostile", list(hostile(200 if full else 54)), LONGEST),
    ):
        ended = [course.run(text, ticks) for text in programs]
        wrong = [each for each in ended if each.surprise]
        unsaid = [each for each in ended if each.error and not each.error.startswith("line ")]
        report.row(f"{name} scripts: surprises", len(wrong), "scripts", at_most=0, n=len(ended))
        report.row(f"{name} scripts: errors without a place", len(unsaid), "scripts", at_most=0, n=len(ended))
        report.row(f"{name} scripts: ended with an error", sum(bool(each.error) for each in ended), "scripts", n=len(ended))
        report.row(f"{name} scripts: longest part of a tick", max(each.longest for each in ended), "ms", n=len(ended))
        report.notes += sorted({each.surprise for each in wrong})
    sent = [(text, 0.05) for text in damaged(1000 if full else 50, report.options.seed + 1)]
    beside_the_clock(report, [*sent, *((text, PATIENCE) for text in hostile(200 if full else 41))])
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    report.row("memory that all of them took", grown, "MB", at_most=400.0)


if __name__ == "__main__":
    main("script_hostile", measure)
