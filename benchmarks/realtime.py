"""The app in real time: pace, lateness, bytes and latency, with viewers that drag, move sliders, read and come late.

The app runs in this process, each viewer in one of its own. Nothing of the app is changed: the desk and two functions are
wrapped to note times.
"""

import json
import subprocess
import sys
import threading
import time
from bisect import bisect_left
from collections import Counter, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any, NamedTuple

import numpy as np

from app.files.library import load_arm
from app.web.access.messages import Drag, decode
from app.web.server import Served, serve
from benchmarks.common import Report, main
from benchmarks.viewer import ENTRY, HOLD_RATE, Task
from pendant.all_settings import Settings
from pendant.tick.modes import TICK, Mode
from sim.arm.scenario import Scenario
from sim.exchange.desk import Desk, Wishes
from sim.exchange.snapshot import Snapshot
from sim.plant.touch import Touch
from sim.run.loop import Loop
from sim.simulation import Simulation

PART = "wrist_3"  # is dragged
BEFORE = 6.0  # from the viewers' start to the measurement: their imports, their first picture, the way into free-drive [s]
AFTER = 2.0  # from the end of the measurement to the end of the viewers: they all get the last picture [s]
JOINING = 2.0  # after the late joiner's connection, its first picture is no part of its stream [s]
QUICK, FULL = 60.0, 300.0  # length of the measurement [s]
ALONE = 10.0  # length of the same before there is a page: what the machine itself adds [s]


class Ledger(Desk):
    """A desk that notes which tick uses which drag message."""

    def __init__(self) -> None:
        super().__init__()
        self.arrivals: deque[float] = deque()
        self.used: list[tuple[int, float]] = []  # of each drag message: the tick that used it, its arrival
        self.tick: Callable[[], int] = lambda: 0
        self._fresh: deque[float] = deque()

    def touch(self, who: str, touch: Touch) -> None:
        """Set a touch, made from the drag message that arrived first of those not handled yet."""
        super().touch(who, touch)
        self._fresh.append(self.arrivals.popleft())

    def take(self) -> Wishes:
        """Read all wishes for the next tick."""
        fresh = len(self._fresh)
        wishes = super().take()
        for _ in range(fresh):
            self.used.append((self.tick() + 1, self._fresh.popleft()))
        return wishes


class Window(NamedTuple):
    """What the app did while it was measured."""

    start: float
    seconds: float
    ticks: int
    lateness: np.ndarray  # of each tick [s]
    dropped: float  # debt [s]
    modes: Counter[Mode]
    cpu: float  # CPU time of this process [s]


def note_arrivals(served: Served, ledger: Ledger) -> None:
    """Note when each drag message that is let through arrives at the guard."""
    admit = served.guard.admit

    def noting(client: int, raw: str | bytes) -> bytes | None:
        now = time.perf_counter()
        admitted = admit(client, raw)
        if admitted is not None:
            message = decode(admitted)
            if isinstance(message, Drag) and message.phase != "end":
                ledger.arrivals.append(now)
        return admitted

    setattr(served.guard, "admit", noting)  # noqa: B010 - a method of an instance


def note_frames(served: Served, row: int) -> list[tuple[int, list[float]]]:
    """The frames drawn from now on: tick, and position of the dragged part as it is sent [m]."""
    frames: list[tuple[int, list[float]]] = []
    show = served.scene.show

    def noting(snapshot: Snapshot) -> bool:
        frames.append((snapshot.tick, np.round(snapshot.truth_links[row, :3], 5).tolist()))
        return show(snapshot)

    setattr(served.scene, "show", noting)  # noqa: B010 - a method of an instance
    return frames


@contextmanager
def viewers(tasks: dict[str, Task]) -> Iterator[dict[str, dict[str, Any]]]:
    """Let the viewers run while the body does; what they saw is there afterwards."""
    seen: dict[str, dict[str, Any]] = {}

    def follow(name: str, process: subprocess.Popen[str], task: Task) -> None:
        seen[name] = json.loads(process.communicate(json.dumps(asdict(task)) + "\n")[0])

    threads = []
    for name, task in tasks.items():
        command = [sys.executable, "-m", "benchmarks.viewer"]
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        threads.append(threading.Thread(target=follow, args=(name, process, task)))
        threads[-1].start()
    yield seen
    for thread in threads:
        thread.join()


def observe(loop: Loop, start: float, seconds: float) -> Window:
    """Watch the loop from `start` on."""
    time.sleep(max(0.0, start - time.perf_counter()))
    loop.lateness.clear()
    begun, ticks, dropped, cpu = time.perf_counter(), loop.simulation.tick_count, loop.dropped, time.process_time()
    lateness: list[float] = []
    modes: Counter[Mode] = Counter()
    while (left := begun + seconds - time.perf_counter()) > 0.0:
        time.sleep(min(left, 0.5))
        modes[loop.latest().decision.mode] += 1
        lateness += [loop.lateness.popleft() for _ in range(len(loop.lateness))]
    took = time.perf_counter() - begun
    done = loop.simulation.tick_count - ticks
    used = time.process_time() - cpu
    return Window(begun, took, done, np.array(lateness), loop.dropped - dropped, modes, used)


def latencies(
    used: list[tuple[int, float]], frames: list[tuple[int, list[float]]], sent: list[Any], window: Window
) -> np.ndarray:
    """From the arrival of each drag message to the sending of the first picture of a tick that used it [s].

    A picture is known by the position of the dragged part: the app's thread that draws notes it with its tick, the client
    notes it with the time at which the app's sender made the batch.
    """
    ticks: list[int] = []
    times: list[float] = []
    at = 0
    for stamp, position in sent:
        match = next((k for k in range(at, len(frames)) if frames[k][1] == position), None)
        if match is not None:
            at = match
            ticks.append(frames[match][0])
            times.append(stamp)
    found = []
    for tick, arrival in used:
        first = bisect_left(ticks, tick)
        if window.start <= arrival < window.start + window.seconds - 0.5 and first < len(ticks):
            found.append(times[first] - arrival)
    return np.array(found)


def rate(seen: dict[str, Any], start: float, end: float) -> float:
    """Received bytes a second, in kB/s."""
    return sum(size for at, size in seen["received"] if start <= at < end) / (end - start) / 1000.0


def missing(late: dict[str, Any], others: list[dict[str, Any]]) -> tuple[int, int]:
    """How many of the things that all others have the late joiner lacks, and how many it shows differently at the end."""
    common = set.intersection(*(set(other["picture"]) for other in others))
    absent = [name for name in common if name not in late["picture"]]
    moving = ("position", "wxyz", "visible", "content", "value", "disabled", "points", "text")
    reader = others[-1]["picture"]

    def shown(picture: dict[str, Any], name: str) -> dict[str, Any]:
        return {key: value for key, value in picture[name].items() if key in moving and "__binary" not in str(value)}

    differing = [name for name in common if name not in absent and shown(reader, name) != shown(late["picture"], name)]
    return len(absent), len(differing)


def measure(report: Report, seconds: float | None = None) -> None:
    """Fill the report, from `seconds` of real time."""
    seconds = seconds or (FULL if report.options.full else QUICK)
    arm, scenario = load_arm("ur5e"), Scenario(seed=report.options.seed)
    ledger = Ledger()
    loop = Loop(lambda: Simulation(arm, scenario, Settings()))
    loop.desk = ledger
    ledger.tick = lambda: loop.simulation.tick_count
    loop.start()
    try:
        alone = observe(loop, time.perf_counter() + 1.0, ALONE)
        served = serve(loop, arm, scenario)
        try:
            _measure(report, loop, served, ledger, seconds=seconds)
        finally:
            served.close()
    finally:
        loop.stop()
    _pace(report, alone, "before there is a page: ", bars=False)


def _measure(report: Report, loop: Loop, served: Served, ledger: Ledger, *, seconds: float) -> None:
    row = 1 + loop.simulation.arm.chain.joints.index(PART)
    note_arrivals(served, ledger)
    frames = note_frames(served, row)
    x, y, z = loop.latest().truth_links[row, :3].tolist()
    url = served.url.replace("http", "ws", 1)
    now = time.perf_counter()
    start = now + BEFORE
    end = start + seconds

    def task(role: Any, begin: float) -> Task:
        button, slider = served.panel.free_drive._impl.uuid, served.lab.force._impl.uuid
        act = now + BEFORE / 2.0 + (ENTRY if role == "meddler" else 0.0)  # whoever acts first becomes the operator
        return Task(url, role, begin, act, end, end + AFTER, f"/arm/{PART}", (x, y, z), button, slider)

    tasks = {
        "operator": task("operator", now),
        "meddler": task("meddler", now + 0.5),
        "reader": task("reader", now),
        "late joiner": task("reader", start + seconds / 2.0),
    }
    with viewers(tasks) as seen:
        window = observe(loop, start, seconds)
        time.sleep(0.5)
        loop.paused = True  # the last picture holds: the viewers can be compared
    _fill(report, window, seen)
    found = latencies(ledger.used, frames, seen["operator"]["positions"], window)
    expected = HOLD_RATE * (seconds - 0.5)
    report.row("drag messages followed to a picture, of those due", len(found) / expected, "", at_least=0.95, n=round(expected))
    for percent, limit in ((50, None), (95, 0.06), (99, None)):
        value = 1000.0 * float(np.percentile(found, percent)) if found.size else float("nan")
        at_most = None if limit is None else 1000.0 * limit
        report.row(f"drag to picture, p{percent}", value, "ms", at_most=at_most, n=len(found))
    refused = ", ".join(f"{reason} {count}" for reason, count in sorted(served.guard.refused.items()))
    report.notes.append(f"{seconds:g} s measured; refused messages: {refused or 'none'}")


def _pace(report: Report, window: Window, where: str, bars: bool) -> None:
    factor, n = window.ticks * TICK / window.seconds, window.lateness.size
    report.row(f"{where}real-time factor", factor, "", at_least=0.99 if bars else None, at_most=1.01 if bars else None)
    report.row(f"{where}debt dropped", 1000.0 * window.dropped, "ms")
    for percent, limit in ((50.0, None), (99.0, 3.0), (99.9, 10.0)):
        late = 1000.0 * float(np.percentile(window.lateness, percent))
        report.row(f"{where}lateness of ticks, p{percent:g}", late, "ms", at_most=limit if bars else None, n=n)
    report.row(f"{where}lateness of ticks, worst", 1000.0 * float(window.lateness.max()), "ms", n=n)
    report.row(f"{where}CPU of the app, of one core", window.cpu / window.seconds)


def _fill(report: Report, window: Window, seen: dict[str, dict[str, Any]]) -> None:
    _pace(report, window, "", bars=True)
    guided = window.modes[Mode.FREE_DRIVE] / window.modes.total()
    report.row("share of the time in FREE_DRIVE", guided, "", at_least=1.0)
    end = window.start + window.seconds
    for name, each in seen.items():
        late = name == "late joiner"
        begin = window.start + window.seconds / 2.0 + JOINING if late else window.start
        report.row(f"stream to the {name}", rate(each, begin, end), "kB/s", at_most=300.0)
        if late:
            first = sum(size for at, size in each["received"] if at < begin)
            report.row("first picture of the late joiner", first / 1e6, "MB")
    absent, differing = missing(seen["late joiner"], [seen["meddler"], seen["reader"]])
    report.row("nodes and controls that the late joiner lacks", absent, "", at_most=0)
    report.row("nodes and controls that it shows differently at the end", differing, "", at_most=0)


if __name__ == "__main__":
    main("realtime", measure)
