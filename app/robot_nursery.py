"""Starts robots for tests in a tenth of a second: one process makes everything ready once, then forks for each robot.

It reads orders from its standard input, a line of JSON each, and answers each with a line; when the input ends, so do all robots.
"""

import gc
import json
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Any

from app.files.bad_input import BadInput
from app.robot_serving import Network, robot_until_interrupted
from app.runs.warm_up import warm_up
from app.session.prepare import prepare
from app.session.session_file import AllowedFiles, Setup, opened


def main() -> None:
    """Obey until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the tests, which then stop their robots
    warm_up()
    gc.freeze()
    robots: set[int] = set()
    for line in sys.stdin:
        order: dict[str, Any] = json.loads(line)
        if "stop" in order:
            answer = _stop(order["stop"])
            robots.discard(order["stop"])
        else:
            answer = _start(order)
            robots.add(answer)
        sys.stdout.write(f"{answer}\n")
        sys.stdout.flush()
    for pid in robots:
        _stop(pid)


def _stop(pid: int) -> int:
    """End a robot; returns how it ended, as `os.waitstatus_to_exitcode` says it."""
    try:
        os.kill(pid, signal.SIGTERM)
        waited = threading.Timer(10.0, os.kill, (pid, signal.SIGKILL))
        waited.start()
        _, status = os.waitpid(pid, 0)
        waited.cancel()
    except (ProcessLookupError, ChildProcessError):
        return 0
    return os.waitstatus_to_exitcode(status)


def _start(order: dict[str, Any]) -> int:
    """Fork a robot; returns its process id."""
    pid = os.fork()
    if pid:
        return pid
    code = 1
    try:
        os.chdir(order["folder"])
        log = os.open("robot.log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        for stream in (1, 2):
            os.dup2(log, stream)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.environ["PENDANT_TOKEN"] = order["token"]
        code = _be_a_robot(order)
    finally:
        os._exit(code)  # nothing of the nursery is to run in its child


def _be_a_robot(order: dict[str, Any]) -> int:
    try:
        network = Network(order["host"], files=AllowedFiles(Path(order["folder"]).resolve()))
        setup = Setup() if order["setup"] is None else opened(Path(order["setup"]), Setup)
        with robot_until_interrupted(prepare(setup, "setup.yaml"), network, None):
            pass
    except BadInput as error:
        sys.stderr.write(f"{error}\n")
        sys.stderr.flush()
        return 2
    return 0


if __name__ == "__main__":
    main()
