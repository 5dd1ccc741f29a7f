"""A process that records is killed at random moments: what its log has lost, and whether `pendant replay` opens it."""

import os
import random
import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path
from tempfile import TemporaryDirectory

from app.log_reading.reader import read
from app.serving import replay_until_interrupted
from benchmarks.common import Report, main
from pendant.tick.modes import TICK

KILLS = 20
LONGEST = 3.0
"""The process lives this long at most after its first tenth of a simulated second [s]."""

LOST = 1.0
"""Simulated time at a log's end that may be lost [s]."""

RECORD = """
import sys
from pathlib import Path
from app.files.checked import convert
from app.session.prepare import prepare
from app.runs.runner import record
from app.session.session_file import Session
session = convert({"title": "killed", "duration": 600.0, "world": "table"}, Session, "s.yaml")
record(session, prepare(session, "s.yaml"), Path(sys.argv[1]), progress=lambda seconds: print(seconds, flush=True))
"""


def kill(out: Path, seconds: float) -> float:
    """Record into `out` in a process of its own and kill it.

    Args:
        out: folder for log.mcap.
        seconds: of the clock that it lives after its first tenth of a simulated second.

    Returns:
        The simulated time that it said to have done [s].
    """
    with subprocess.Popen([sys.executable, "-c", RECORD, str(out)], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        first = child.stdout.readline()
        time.sleep(seconds)
        child.kill()
        told = child.stdout.read().split()
    return float([first, *told][-1])


def opens(path: Path) -> bool:
    """Whether `pendant replay` repairs and shows the log."""
    with replay_until_interrupted(path, host="127.0.0.1", port=0, usual=0, open_browser=False) as site:
        with urllib.request.urlopen(site.url) as page:
            shown = page.status == 200
        os.kill(os.getpid(), signal.SIGTERM)  # the user's end
    return shown and read(path).whole


def measure(report: Report, kills: int = KILLS) -> None:
    """Fill the report; in the full size with five times the kills."""
    kills = 5 * kills if report.options.full else kills
    chance = random.Random(report.options.seed)
    lost: list[float] = []
    opened = cut = 0
    for _ in range(kills):
        with TemporaryDirectory() as out:
            done = kill(Path(out), chance.uniform(0.0, LONGEST))
            path = Path(out) / "log.mcap"
            log = read(path)
            cut += not log.whole
            lost.append(done - len(log.ticks) * TICK)
            opened += opens(path)
    report.share("logs without their end, of processes killed while they recorded", cut, kills, at_least=1.0)
    report.share("logs that replay opens", opened, kills, at_least=1.0)
    report.row("simulated time that a log has lost, largest", max(0.0, *lost), "s", at_most=LOST, n=kills)


if __name__ == "__main__":
    main("crash", measure)
