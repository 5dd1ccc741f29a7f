"""Serves the app to three clients for ten minutes, or for an hour with --full: memory, pace, and whatever is logged as wrong.

Two clients use the page at random, one looks on; all come and go. Every ten minutes, or every three in the quick size, the first
of them does what somebody does who comes back to the arm, and the others look on: free-drive is entered, guided and left alone.
All the while a script talks, for the page to show.
"""

import json
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from benchmarks.common import Report, main
from benchmarks.soak.first_use import FirstUses
from benchmarks.soak.user import User

SIZES = (10.0, 60.0)  # [min]
FIRST_USES = (3.0, 10.0)  # between two of them [min]
WARM = 5.0  # until memory counts [min]
STRETCH = 30.0  # over which memory is a mean [s]
GROWTH, PACE = 20.0, (0.99, 1.01)  # [MB], simulated over real time


def soak(report: Report, minutes: float, warm: float = WARM, every: float | None = None) -> None:
    """Serve it for so long, and report.

    Args:
        report: takes the rows.
        minutes: for which it is served.
        warm: until memory counts [min].
        every: between two first uses [min], as the report's size if None.
    """
    with tempfile.TemporaryFile("w+") as errors:
        command = [sys.executable, "-u", "-m", "benchmarks.soak.served", f"{report.options.seed}"]
        pipe = subprocess.PIPE
        app = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=errors, text=True)
        assert app.stdout is not None
        assert app.stdin is not None
        url = app.stdout.readline().strip()
        states: list[dict[str, Any]] = []
        lines = app.stdout
        reader = threading.Thread(target=lambda: states.extend(json.loads(line) for line in lines))
        reader.start()
        uses = FirstUses(60.0 * (FIRST_USES[report.options.full] if every is None else every))
        users = [
            User(url, report.options.seed + number, idle=number == 2, first_uses=uses, operator=number == 0)
            for number in range(3)
        ]
        threads = [threading.Thread(target=user.run, args=(time.monotonic() + 60.0 * minutes,)) for user in users]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        app.stdin.close()
        reader.join()
        report.row("exit code of the app", app.wait(), at_most=0, at_least=0)
        report.share("clients that stayed to the end", sum(user.stayed for user in users), len(users), at_least=1.0)
        errors.seek(0)
        log = errors.read()
    judge(report, states, log, 60.0 * warm)
    judge_first_uses(report, uses)
    for user in users:
        report.notes.append(f"client: {dict(user.done)}")


def judge(report: Report, states: list[dict[str, Any]], log: str, warm: float) -> None:
    """The rows."""
    last = states[-1]
    first = statistics.mean(s["memory"] for s in states if warm <= s["at"] < warm + STRETCH)
    final = statistics.mean(s["memory"] for s in states if s["at"] >= last["at"] - STRETCH)
    report.row(f"memory after {warm / 60.0:g} min", first, "MB")
    report.row("memory grown since", final - first, "MB", at_most=GROWTH)
    report.row("pace, simulated over real time", last["simulated"] / last["real"], at_least=PACE[0], at_most=PACE[1])
    report.row("time that the pace counts", last["real"] / 60.0, "min")
    report.row("time lost by stalls", last["dropped"], "s")
    report.row("lines of the log", len(log.splitlines()), at_most=0)
    report.row("simulation or page stands", sum(s["failed"] for s in states), at_most=0)
    report.row("scenarios begun", last["resets"])
    report.row("events", last["events"])
    report.row("most clients", max(s["clients"] for s in states))
    if log:
        path = report.options.out / "soak.log"
        Path(report.options.out).mkdir(parents=True, exist_ok=True)
        path.write_text(log, encoding="utf-8")
        report.notes.append(f"the log: {path}")


def judge_first_uses(report: Report, uses: FirstUses) -> None:
    """The rows of the first uses, and what the page said where one did not go as it should."""
    report.share("first uses that entered free-drive", uses.entered, uses.begun, at_least=1.0)
    report.share("first uses that then ended by their period", uses.ended, uses.begun)
    report.notes += uses.told


def measure(report: Report) -> None:
    """Ten minutes, or an hour."""
    soak(report, SIZES[report.options.full])


if __name__ == "__main__":
    main("soak", measure)
