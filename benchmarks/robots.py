"""Robots in tests: how long one takes to be up, and whether an example suite is green under pytest-xdist, run after run."""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.common import ROOT, Report, main

UP = 3.0  # [s]

FIRST = """
import sys, tempfile, time
from pathlib import Path
begun = time.perf_counter()
from app.served_robot import ServedRobot
for number in range(int(sys.argv[1])):
    robot = ServedRobot(Path(tempfile.mkdtemp()))
    robot.start()
    print(time.perf_counter() - begun)
    robot.stop()
    begun = time.perf_counter()
"""
"""Prints how long each robot takes, the first one from the import on."""


def started(count: int) -> list[float]:
    """How long so many robots of a fresh process take [s]."""
    said = subprocess.run([sys.executable, "-c", FIRST, str(count)], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [float(each) for each in said.split()]


def measure(report: Report) -> None:
    """All of it."""
    rounds, runs = (10, 50) if report.options.full else (3, 3)
    report.row("first robot ever, whose modules may have no bytecode yet, is up after", started(1)[0], "s", at_most=UP)
    firsts, others = [], []
    for _ in range(rounds):
        first, *more = started(6)
        firsts.append(first)
        others += more
    report.row("first robot of a process is up after, worst", max(firsts), "s", at_most=UP, n=len(firsts))
    report.row("first robot of a process, median", statistics.median(firsts), "s", n=len(firsts))
    report.row("every other one, worst", max(others), "s", at_most=UP, n=len(others))
    report.row("every other one, median", statistics.median(others), "s", n=len(others))
    green, took = 0, []
    for _ in range(runs):
        begun = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            command = [
                sys.executable,
                "-m",
                "pytest",
                "-q",
                "-n",
                "2",
                "-p",
                "no:cacheprovider",
                "--basetemp",
                str(Path(folder) / "t"),
            ]
            run = subprocess.run([*command, "examples/cell"], cwd=ROOT, capture_output=True, text=True, check=False)
        took.append(time.perf_counter() - begun)
        green += run.returncode == 0
        if run.returncode:
            report.notes.append(run.stdout[-1500:])
    report.share("runs of the example suite that are green", green, runs, at_least=1.0)
    report.row("a run of it, median", statistics.median(took), "s", n=runs)


if __name__ == "__main__":
    main("robots", measure)
