"""How it ends: SIGTERM at any moment, under load, with clients that hang; and a disk that is full at any byte.

Each case is a process of its own. A log that it leaves must open, and say what it lacks.
"""

import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from app.files.bad_input import BadInput
from app.log_reading.reader import read
from app.robot_interface.ports import PORTS
from app.served_robot import free_addresses
from benchmarks.common import ROOT, Report, main
from pendant.tick.modes import TICK

SIZES = (10, 50)  # signals
FULL = (5, 20)  # disks
ENDED = 3.0  # from the signal to the end [s]
HANGS = 30.0  # what has not ended by then hangs [s]
FIRST, LAST = 0.01, 6.0  # when the signal comes, after the start or after the recording has begun [s]
LONGEST_START = 60.0  # [s]
CLIENTS = 20
TOLD = 1.0  # from the last tick in the file to the event [s]
ROOM = (20_000, 2_000_000)  # of a disk [bytes]

COMMAND = [sys.executable, "-c", "from pendant_sim.start import main; main()"]
LOAD = [sys.executable, "-c", "while True: pass"]

LIMITED = """
import json, resource, sys, time
from pathlib import Path
from app.log.live import LiveRecording
from app.runs.runner import simulate
from app.runs.warm_up import warm_up
from app.session.prepare import prepare
from app.session.session_file import Setup
from pendant.tick.modes import TICK
from sim.run.loop import Loop
warm_up()
loop = Loop(lambda: simulate(prepare(Setup(), "ends")))
loop.start()
sys.dont_write_bytecode = True
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), int(sys.argv[2])))
recording = LiveRecording(loop, Path(sys.argv[1]))
path = recording.start().result(20.0)
begun = loop.simulation.tick_count
end = time.monotonic() + 20.0
while not (told := [e for e in loop.events(0) if e.kind == "recording_broken"]) and time.monotonic() < end:
    time.sleep(0.005)
seconds = (told[0].tick - begun) * TICK if told else 0.0
recording.close()
loop.stop()
print(json.dumps({"path": str(path), "told": bool(told), "seconds": seconds}))
"""


class Crowd:
    """Clients of a robot that come as soon as it is there, and stay: some stream, some never finish what they say."""

    def __init__(self, host: str, token: str, fifo: Path) -> None:
        self._host, self._token, self._fifo = host, token, fifo
        self._over = threading.Event()
        self._held: list[socket.socket] = []
        self._thread = threading.Thread(target=self._come, daemon=True)
        self._thread.start()

    def go(self) -> int:
        """Leave; how many were there."""
        self._over.set()
        self._thread.join()
        for each in self._held:
            each.close()
        return len(self._held)

    def _come(self) -> None:
        names = [*PORTS]
        setup = json.dumps({"robot": str(self._fifo)})
        begin = f"POST /begin HTTP/1.1\r\nHost: {self._host}:{PORTS['control']}\r\nAuthorization: Bearer {self._token}\r\n"
        said = (
            b"GET /state HTTP/1.1\r\nHost: x\r\n",
            f"{begin}Content-Length: {len(setup)}\r\n\r\n{setup}".encode(),
            f"{begin}Content-Length: 1000\r\n\r\n{{".encode(),
        )
        while len(self._held) < CLIENTS and not self._over.wait(0.02):
            number = len(self._held)
            port = PORTS["control"] if number % 2 else PORTS[names[number // 2 % len(names)]]
            with suppress(OSError):
                line = socket.create_connection((self._host, port), timeout=1.0)
                line.sendall(said[number // 2 % 3] if number % 2 else b"")
                self._held.append(line)


def ended(command: list[str], folder: Path, chance: random.Random, host: str) -> tuple[float, int, str]:
    """Start a command, and ask for its end; the time that took [s], its exit code and what it said."""
    fifo = folder / "pipe.yaml"
    os.mkfifo(fifo)
    environment = {**os.environ, "PENDANT_TOKEN": "t", "HOME": str(folder)}
    with (folder / "said").open("w+") as said:
        process = subprocess.Popen([*COMMAND, *command], stdout=said, stderr=said, env=environment, cwd=folder)
        crowd = Crowd(host, "t", fifo)
        recording = chance.random() < 0.5
        begun = time.monotonic()
        while recording and not any(folder.rglob("*.mcap")) and time.monotonic() < begun + LONGEST_START:
            time.sleep(0.02)
        time.sleep(chance.choice((FIRST, chance.uniform(FIRST, 1.0), chance.uniform(1.0, LAST))))
        asked = time.monotonic()
        process.send_signal(chance.choice((signal.SIGTERM, signal.SIGINT)))
        try:
            code = process.wait(HANGS)
        except subprocess.TimeoutExpired:
            process.kill()
            code = process.wait()
        took = time.monotonic() - asked
        crowd.go()
        said.seek(0)
        return took, code, said.read()


def unreadable(folder: Path) -> list[str]:
    """Recordings below a folder that do not open, or do not say what they lack."""
    found = []
    for path in folder.rglob("*.mcap"):
        if path.stat().st_size == 0:  # it was about to be opened: nothing was recorded
            continue
        try:
            log = read(path)
            if len(log):
                assert len(log.state["q"]) == len(log.truth["touched"])
            elif not log.missing and not log.whole:
                found.append(f"{path.name}: nothing is said of what it lacks")
        except BadInput as error:
            found.append(str(error))
    return found


def signals(report: Report, count: int) -> None:
    """The rows of signals."""
    chance = random.Random(report.options.seed)
    slowest, tracebacks, hung, bad, logs = 0.0, 0, 0, list[str](), 0
    load = subprocess.Popen(LOAD)
    try:
        for _ in range(count):
            host = next(free_addresses())
            with tempfile.TemporaryDirectory() as place:
                folder = Path(place)
                served = ["--interfaces", "--port", "0", "--host", host]
                command = chance.choice(
                    (
                        ["serve", *served, "--record", "logs"],
                        ["robot", "--host", host, "--record", "logs"],
                        ["run", "hold", "free-drive", "--out", "out"],
                    )
                )
                took, code, said = ended(command, folder, chance, host)
                slowest, hung = max(slowest, took), hung + (took >= HANGS)
                if took > ENDED:
                    report.notes.append(f"{command[0]}: {took:.2f} s, code {code}: {said[-300:]!r}")
                if "Traceback" in said and f"{ROOT}/app" in said:  # Python's own start tells a Ctrl-C as it likes
                    tracebacks += 1
                    report.notes.append(f"{command[0]}, code {code}: {said[-600:]}")
                logs += len([*folder.rglob("*.mcap")])
                bad += unreadable(folder)
    finally:
        load.kill()
        load.wait()
    report.row("processes that were asked to end", count)
    report.row("longest until the end", slowest, "s", at_most=ENDED)
    report.row("processes that hung", hung, at_most=0)
    report.row("tracebacks", tracebacks, at_most=0)
    report.row("recordings that they left", logs)
    report.row("recordings that do not open, or do not say what they lack", len(bad), at_most=0)
    report.notes += bad


def disks(report: Report, count: int) -> None:
    """The rows of full disks."""
    chance = random.Random(report.options.seed)
    told, latest, bad = 0, 0.0, list[str]()
    for _ in range(count):
        with tempfile.TemporaryDirectory() as place:
            size = chance.randrange(*ROOM)
            command = [sys.executable, "-c", LIMITED, place, str(size)]
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120.0)
            if done.returncode:
                bad.append(done.stderr[-400:])
                continue
            found: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
            path = Path(found["path"])
            told += found["told"]
            bad += unreadable(path.parent)
            latest = max(latest, found["seconds"] - len(read(path)) * TICK)
    report.share("full disks that ended the recording with an event", told, count, at_least=1.0)
    report.row("longest from the last tick in the file to the event", latest, "s", at_most=TOLD)
    report.row("recordings on them that do not open, or do not say what they lack", len(bad), at_most=0)
    report.notes += bad


def measure(report: Report) -> None:
    """Fill the report."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a bench in the background ignores it, and so would all it starts
    signals(report, SIZES[report.options.full])
    disks(report, FULL[report.options.full])


if __name__ == "__main__":
    main("ends", measure)
