"""The robot on the network: RTDE at 500 Hz beside the page, and whether anybody's packets cost somebody else a frame.

The robot and its page run in this process, as `pendant serve --interfaces` runs them; readers and attackers have processes of
their own, but the machine's processors are shared with them. Times are of `time.perf_counter`, which all processes share.
"""

import itertools
import json
import multiprocessing
import multiprocessing.process
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

from benchmarks.common import Report, main
from benchmarks.network_clients import HOST, OFFSET, RATE, dies, floods, never_reads, read, send_damaged
from benchmarks.viewer import Task

if TYPE_CHECKING:  # a reader starts without them
    from app.robot_interface.interfaces import RobotInterfaces
    from pendant.events.event import Event
    from sim.run.loop import Loop

READERS = 3
WORST_GAP = 1.5  # p99 of the gaps between frames, of that of the gaps between ticks
PACE = 0.01  # by which simulated time may differ from the clock's
PACKETS = 100_000
SETTLE = 2.0  # [s]


class Clock:
    """Notes when each tick was done (app.robot_interface.controller.cabinet.Listener)."""

    def __init__(self) -> None:
        self.times: list[float] = []

    def tick(self, number: int) -> None:
        """Note it."""
        self.times.append(time.perf_counter())

    def told(self, event: "Event") -> None:
        """Events do not matter."""

    def repeat(self) -> None:
        """A robot that stands does not matter."""

    def again(self) -> None:
        """Nor does one whose loop is busy."""


def gaps(times: list[float]) -> list[float]:
    """Between one and the next, smallest first."""
    return sorted(after - before for before, after in itertools.pairwise(times))


def p99(values: list[float]) -> float:
    """99 % are at most this."""
    return values[round(0.99 * (len(values) - 1))]


def started(work: Callable[..., None], *what: object) -> tuple[multiprocessing.process.BaseProcess, Connection]:
    """A process that has said that it is ready."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=work, args=(*what, there))
    process.start()
    here.recv()
    return process, here


def viewer(url: str, seconds: float) -> subprocess.Popen[bytes]:
    """A client of the page's own protocol, that reads the whole stream."""
    now = time.perf_counter()
    task = Task(
        url.replace("http", "ws", 1), "reader", now, now + seconds, now + seconds, now + seconds, "", (0.0, 0.0, 0.0), "", ""
    )
    process = subprocess.Popen([sys.executable, "-m", "benchmarks.viewer"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
    assert process.stdin is not None
    process.stdin.write(json.dumps(asdict(task)).encode() + b"\n")
    process.stdin.close()
    return process


def streams(report: Report, interfaces: "RobotInterfaces", url: str, seconds: float) -> None:
    """Three readers at 500 Hz beside the page."""
    watching = viewer(url, seconds + 4.0 * SETTLE)
    reader, back = started(read, READERS, seconds + 2.0 * SETTLE)
    time.sleep(SETTLE)
    clock = Clock()
    interfaces.cabinet.listen(clock)
    begun, first = time.perf_counter(), interfaces.cabinet.ticks
    time.sleep(seconds)
    ended, last = time.perf_counter(), interfaces.cabinet.ticks
    interfaces.cabinet.forget(clock)
    frames: list[list[tuple[float, int]]] = back.recv()
    reader.join()
    watching.wait()
    pace = (last - first) / RATE / (ended - begun)
    report.row("streams: simulated over real time", pace, at_least=1.0 - PACE, at_most=1.0 + PACE)
    loop = p99(gaps(clock.times))
    report.row("streams: p99 of the gap between ticks", 1e3 * loop, "ms")
    missing = again = 0
    for number, each in enumerate(frames, 1):
        inside = [(at, step) for at, step in each if first < step <= last]
        steps = [step for _, step in inside]
        missing += (last - first) - len(set(steps))
        again += sum(after != before + 1 for before, after in itertools.pairwise(steps))
        share = p99(gaps([at for at, _ in inside])) / loop
        report.row(f"streams: reader {number}, p99 of its gaps over that of the ticks", share, at_most=WORST_GAP, n=len(steps))
    report.row("streams: frames missing", missing, at_most=0, n=READERS * (last - first))
    report.row("streams: frames twice or out of order", again, at_most=0)


def beside(report: Report, loop: "Loop", name: str, work: Callable[..., None], *what: object, seconds: float) -> None:
    """An attack, while one reader reads: whether it loses a frame."""
    reader, back = started(read, 1, seconds + 4.0 * SETTLE)
    dropped, begun = loop.dropped, time.perf_counter()
    attacker, done = started(work, *what)
    count = done.recv()
    attacker.join()
    took = time.perf_counter() - begun
    (frames,) = back.recv()
    reader.join()
    steps = [step for _, step in frames]
    lost = (steps[-1] - steps[0] + 1) - len(set(steps))
    report.row(f"{name}: frames lost by somebody else", lost, at_most=0, n=len(steps))
    report.row(f"{name}: time lost by stalls", loop.dropped - dropped, "s")
    report.row(f"{name}: done", count, n=None)
    report.row(f"{name}: took", took, "s")


def resident() -> float:
    """Memory of this process [MB]."""
    with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - a file of the system's, read in the middle of a run
        return int(file.read().split()[1]) * 4096 / 1e6


def measure(report: Report) -> None:
    """All of it."""
    import logging
    from pathlib import Path

    from app.log.live import LiveRecording
    from app.robot_interface.interfaces import RobotInterfaces
    from app.runs.runner import simulate
    from app.runs.warm_up import warm_up
    from app.session.prepare import prepare
    from app.session.session_file import Setup
    from app.web.server import serve
    from sim.run.loop import Loop

    failures: list[str] = []
    handler = logging.Handler(logging.ERROR)
    handler.emit = lambda record: failures.append(record.getMessage())  # type: ignore[method-assign]
    logging.getLogger().addHandler(handler)
    warm_up()
    prepared = prepare(Setup(seed=report.options.seed % 2**31), "bench")
    loop = Loop(lambda: simulate(prepared))
    recording = LiveRecording(loop, Path("out"))
    interfaces = RobotInterfaces(loop, prepared.arm, host=HOST, offset=OFFSET, recording=recording)
    interfaces.start()
    loop.start()
    served = serve(loop, prepared.arm, prepared.scenario, recording=recording, interfaces=interfaces)
    seconds = 600.0 if report.options.full else 20.0
    attack = 20.0 if report.options.full else 6.0
    count = PACKETS if report.options.full else PACKETS // 10
    try:
        streams(report, interfaces, served.url, seconds)
        beside(report, loop, "never reads", never_reads, attack, seconds=attack)
        beside(report, loop, "dies", dies, attack, seconds=attack)
        beside(report, loop, "floods", floods, attack, seconds=attack)
        name, last = "damaged packets", 60.0 if report.options.full else 12.0
        before = resident()
        beside(report, loop, name, send_damaged, count // 2, report.options.seed, seconds=last)
        half = resident()
        beside(report, loop, f"{name}, again", send_damaged, count // 2, report.options.seed + 1, seconds=last)
        time.sleep(SETTLE)
        report.row("damaged packets: memory kept of the first half", half - before, "MB")
        report.row("damaged packets: memory kept of the second half", resident() - half, "MB", at_most=2.0)
        report.row("connections left", len(interfaces.peers.all()), at_most=0)
        report.row("errors in the log", len(failures), at_most=0)
        report.row("the robot still runs", float(not loop.failure and interfaces.cabinet.ticks > 0), at_least=1.0)
        report.notes += failures[:5]
    finally:
        served.close()
        interfaces.close()
        loop.stop()


if __name__ == "__main__":
    main("network", measure)
