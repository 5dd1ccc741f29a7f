"""What a script that waits for its client costs in a tick, side by side with none."""

import subprocess
import sys
import time

from app.api import session
from app.robot_interface.controller.callers import Ask
from app.robot_interface.interfaces import RobotInterfaces
from app.runs.runner import simulate
from app.session.prepare import prepare
from benchmarks.common import Report, main
from benchmarks.script_hostile import Course
from pendant.inputs import Command
from sim.run.loop import Loop

HOST = "127.83.21.7"
"""A loopback address of its own, for a client knows no other ports than the usual ones."""


CLIENT = f"""
from rtde_control import RTDEControlInterface
client = RTDEControlInterface("{HOST}", 500.0)
client.stopScript()
client.disconnect()
"""


def uploaded() -> str:
    """The program that ur-rtde's RTDEControlInterface, unmodified, uploads to a robot on this machine."""
    prepared = prepare(session({"title": "upload", "duration": 1.0}), "upload")
    loop = Loop(lambda: simulate(prepared))
    interfaces = RobotInterfaces(loop, prepared.arm, host=HOST)
    interfaces.start()
    loop.start()
    try:
        interfaces.cabinet.ask(Ask((Command.REMOTE,), standing=True)).result(10.0)
        subprocess.run([sys.executable, "-c", CLIENT], check=True, timeout=60.0)
        return interfaces.scripts.text
    finally:
        interfaces.close()
        loop.stop()


def cost(course: Course, ticks: int) -> float:
    """Of the script's part of a tick, on the processor [us]; the least of five runs, as others use the machine."""
    best = float("inf")
    for _ in range(5):
        begun = time.thread_time_ns()
        for tick in range(ticks):
            course.runner.wishes(tick)
        best = min(best, (time.thread_time_ns() - begun) / 1e3 / ticks)
    return best


def measure(report: Report) -> None:
    """Fill the report."""
    ticks = 20000 if report.options.full else 4000
    course = Course()
    none = cost(course, ticks)
    course.runner.offer(uploaded())
    running = cost(course, ticks)
    if course.runner.state is None:
        raise RuntimeError(f"the program has ended: {course.runner.trouble}")
    report.row("no script: part of a tick", none, "us", n=ticks)
    report.row("ur-rtde's program while it waits: part of a tick", running, "us", n=ticks)
    report.row("ur-rtde's program while it waits: more than no script", running - none, "us", at_most=10.0, n=ticks)


if __name__ == "__main__":
    main("script_cost", measure)
