"""What recording costs: its share of a tick on the simulation's thread and in all, and headless speed with it.

Speed with recording is what a user waits for, so the wall clock measures it: the log is packed, compressed and written on a
thread of its own, beside the simulation. What both would need of one core together stands beside it.
"""

import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from app.files.checked import load
from app.log.recorder import Recorder
from app.runs.runner import record, simulate
from app.session.prepare import prepare
from app.session.session_file import Session, find
from benchmarks.common import Report, main
from pendant.inputs import NOTHING
from pendant.tick.modes import TICK
from sim.exchange.desk import Wishes

SHARE = 0.15
"""Recording costs at most this share of a tick."""

SPEED = 8.0
"""Headless speed with recording is at least this on the wall clock [x real time]."""

SESSIONS = ("free-drive", "hold", "program")
IDLE = Wishes(NOTHING, (), ())


def clocked(clock: Callable[[], float], ticks: int, turns: int) -> tuple[list[float], list[float], list[float]]:
    """Seconds a tick bare and recorded, in turns on one simulation, and of them what the recorder adds to its thread."""
    simulation = simulate(prepare(load(find("hold"), Session), "hold"))
    bare, recorded, seen = [], [], []
    for _ in range(turns):
        begun = clock()
        for _ in range(ticks):
            simulation.tick(IDLE)
        bare.append((clock() - begun) / ticks)
        with TemporaryDirectory() as out:
            recorder = Recorder(Path(out) / "log.mcap", simulation, "bench")
            begun, inside = clock(), 0
            for _ in range(ticks):
                decision = simulation.tick(IDLE)
                start = time.thread_time_ns()
                recorder.see(simulation, decision)
                inside += time.thread_time_ns() - start
            recorder.close()
            recorded.append((clock() - begun) / ticks)
            seen.append(inside / 1e9 / ticks)
    return bare, recorded, seen


def measure(report: Report, ticks: int = 2000, turns: int = 5) -> None:
    """Fill the report; in the full size with five times the turns."""
    turns = 5 * turns if report.options.full else turns
    clocked(time.process_time, 300, 1)  # compiles and warms caches up
    bare, recorded, seen = clocked(time.process_time, ticks, turns)
    base = float(np.median(bare))
    report.row("a tick without recording, median", 1e6 * base, "µs", n=turns)
    report.row("recording on the simulation's thread, median", 1e6 * float(np.median(seen)), "µs a tick", n=turns)
    report.row("its share of a tick", float(np.median(seen)) / base, "", at_most=SHARE, n=turns)
    both = [a / b - 1.0 for a, b in zip(recorded, bare, strict=True)]
    what = "with packing, compressing and writing on the recorder's thread: share of a tick's processor time"
    report.row(what, float(np.median(both)), n=turns)
    for name in SESSIONS:
        session = load(find(name), Session)
        prepared = prepare(session, name)
        speeds: list[tuple[float, float]] = []  # on the wall clock, in processor time
        size = 0
        for _ in range(turns):
            with TemporaryDirectory() as out:
                begun, spent = time.perf_counter(), time.process_time()
                record(session, prepared, Path(out))
                took, spent = time.perf_counter() - begun, time.process_time() - spent
                speeds.append((session.duration / took, session.duration / spent))
                size = (Path(out) / "log.mcap").stat().st_size
        speed, on_one = np.median(speeds, axis=0).tolist()  # the first run loads what is compiled
        report.row(f"session {name} with recording, median", speed, "x real time", at_least=SPEED, n=turns)
        report.row(f"session {name} with recording, in processor time of all threads", on_one, "x real time", n=turns)
        report.row(f"session {name}: log", size / 1e6 / session.duration, "MB a second")
    report.notes.append(f"processor time of all threads, but for speed: the wall clock; a tick is {1000 * TICK:g} ms")


if __name__ == "__main__":
    main("recording", measure)
