"""A served robot in which page, scripts, network, recorder and laboratory race: ten minutes, or an hour with --full.

Threads are changed every 20 us. Then the same for two minutes with an old defect put back, which must be found: scripts shared a
list of what they told with the page, which went through it while they appended.
"""

import json
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any, NamedTuple
from urllib.error import HTTPError

from websockets.exceptions import ConnectionClosed

from app.files.bad_input import BadInput
from app.log_reading.reader import read
from app.robot_interface.ports import PORTS
from app.served_robot import free_addresses
from benchmarks.common import Report, main
from benchmarks.races.attackers import Attacked, Attacker, Caller, Laboratory, Reader, Recorder, Streamer, Talker, Watcher
from benchmarks.soak.client import Client
from benchmarks.soak.user import User

SIZES = (10.0, 60.0)  # [min]
FOUND = 120.0  # within which an old defect is found [s]
ENDED = 3.0  # from SIGTERM to the end [s]
STILL = 10.0  # without a beat of the page: it is dead [s]
AT_THE_END = ("nanobind:", " - ", "See https://nanobind")
"""Lines of a library that counts what is left when the process ends: its threads are not waited for."""

LOOK = 0.5  # between two looks at the robot's state [s]


class Seen(NamedTuple):
    """What went wrong in one race."""

    log: str
    broken: dict[str, str]  # parts of the robot, and why
    failures: list[str]  # of the simulation or a recording
    surprises: list[str]  # answers that nobody should get
    stillest: float  # longest time without a beat of the page [s]
    found: float  # when the first of these was seen [s]; infinite: none
    ended: float  # time from SIGTERM to the end [s]
    code: int
    unreadable: list[str]  # recordings
    done: list[str]


class Page:
    """Looks on at the page, and notes whether it lives."""

    def __init__(self, url: str) -> None:
        self._client = Client(url)
        self.stillest = 0.0
        self.told: list[str] = []  # that a part is not up to date

    def run(self, end: float) -> None:
        """Look on until `end`, of `time.monotonic`."""
        came = beaten = 0.0
        beat = ""
        while time.monotonic() < end:
            try:
                if not came:
                    self._client.come()
                    came = beaten = time.monotonic()
                self._client.look(0.2)
            except (ConnectionClosed, TimeoutError, OSError):
                self.stillest = max(self.stillest, time.monotonic() - beaten) if beaten else self.stillest
                came = 0.0
                continue
            texts = [str(thing.get("content", "")) for thing in self._client.things.values()]
            now = "".join(text for text in texts if "data-pd-beat" in text)
            self.told += [text for text in texts if "Not up to date" in text]
            if now != beat:
                beat, beaten = now, time.monotonic()
            self.stillest = max(self.stillest, time.monotonic() - beaten)


def race(seed: int, seconds: float, folder: Path, *, defect: bool = False) -> Seen:
    """One race; with a `defect` it ends as soon as that is found."""
    host = next(free_addresses())
    with (folder / "log").open("w+") as errors:
        command = [sys.executable, "-u", "-m", "benchmarks.races.raced", str(folder), host, *(["defect"] if defect else [])]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True) as app:
            assert app.stdout is not None
            told: dict[str, Any] = json.loads(next(line for line in app.stdout if line.startswith("{")))
            robot = Attacked(host, PORTS, told["token"])
            kinds = (Talker, Talker, Streamer, Streamer, Watcher, Caller, Reader, Laboratory)
            attackers: list[Attacker] = [kind(robot, seed + number) for number, kind in enumerate(kinds)]
            attackers.append(Recorder(robot, seed + 50, folder))
            users = [User(told["url"], seed + 60 + number) for number in range(2)]
            page = Page(told["url"])
            begun = time.monotonic()
            end = begun + seconds
            others = [each.run for each in (*attackers, *users, page)]
            threads = [threading.Thread(target=_to_the_end, args=(run, end), daemon=True) for run in others]
            for thread in threads:
                thread.start()
            broken: dict[str, str] = {}
            failures: list[str] = []
            found = float("inf")
            answered = time.monotonic()
            while (now := time.monotonic()) < end:
                try:
                    state = robot.ask("state")
                except OSError as error:  # while another arm is brought, nobody answers
                    if isinstance(error, HTTPError) or now > answered + STILL:
                        app.kill()
                        raise
                    time.sleep(LOOK)
                    continue
                answered = now
                broken |= state["broken"]
                failures += [state[name] for name in ("failure", "recording_failure") if state[name]]
                if (broken or failures or page.told) and found == float("inf"):
                    found = now - begun
                    if defect:
                        break
                time.sleep(LOOK)
            stillest, stopped = page.stillest, time.monotonic()
            app.send_signal(signal.SIGTERM)
            code = app.wait(60.0)
            ended = time.monotonic() - stopped
        errors.seek(0)
        log = "".join(line for line in errors if not line.startswith(AT_THE_END))
    done = [f"{type(each).__name__}: {dict(each.done)}" for each in attackers] + [f"page: {dict(user.done)}" for user in users]
    surprises = [text for each in attackers for text in each.surprises]
    still = (stillest, found, ended, code)
    return Seen(log, broken, failures, surprises, *still, _unreadable(folder), done)


def _to_the_end(run: Any, end: float) -> None:
    """Until the robot has ended: then nobody answers."""
    while time.monotonic() < end:
        try:
            run(end)
        except (OSError, TimeoutError, ConnectionClosed, LookupError, StopIteration, EOFError):
            time.sleep(0.5)


def _unreadable(folder: Path) -> list[str]:
    """Recordings that do not open, or say that they are not whole though the process ended in order."""
    found = []
    for path in folder.glob("*.mcap"):
        try:
            log = read(path)
        except BadInput as error:
            found.append(str(error))
        else:
            found += [f"{path.name}: without its end"] if not log.whole else []
    return found


def judge(report: Report, seen: Seen, minutes: float) -> None:
    """The rows of a race without a defect."""
    report.row("time of the race", minutes, "min")
    report.row("lines of the log", len(seen.log.splitlines()), at_most=0)
    report.row("parts that broke", len(seen.broken), at_most=0)
    report.row("failures of simulation and recording", len(seen.failures), at_most=0)
    report.row("answers of the control channel that nobody should get", len(seen.surprises), at_most=0)
    report.row("longest time without a beat of the page", seen.stillest, "s", at_most=STILL)
    report.row("recordings that are not whole", len(seen.unreadable), at_most=0)
    report.row("from SIGTERM to the end", seen.ended, "s", at_most=ENDED)
    report.row("exit code", seen.code, at_most=0, at_least=0)
    told = [
        *(f"{part}: {why}" for part, why in seen.broken.items()),
        *seen.failures[:5],
        *seen.surprises[:5],
        *seen.unreadable[:5],
    ]
    report.notes += told + seen.done
    if seen.log:
        path = report.options.out / f"races-{report.options.seed}.log"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(seen.log, encoding="utf-8")
        report.notes.append(f"the log: {path}")


def measure(report: Report, minutes: float | None = None) -> None:
    """Race, and race with the defect."""
    minutes = SIZES[report.options.full] if minutes is None else minutes
    with tempfile.TemporaryDirectory() as folder:
        judge(report, race(report.options.seed, 60.0 * minutes, Path(folder)), minutes)
    with tempfile.TemporaryDirectory() as folder:
        seen = race(report.options.seed, FOUND, Path(folder), defect=True)
        report.row("until an old defect that is put back is found", seen.found, "s", at_most=FOUND)
        report.notes += [f"found: {part}: {why}" for part, why in seen.broken.items()]


if __name__ == "__main__":
    main("races", measure)
