"""Learning: how much faster eight environments step on two cores than one does, and what an episode and a picture cost.

Each ratio is of two measurements of one run, one right after the other, several times; the best pair counts, as others who use
the machine make a pair worse. What the machine itself gives two bare loops at once stands beside it: no vector can reach more.
"""

import multiprocessing
import os
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import gymnasium
import numpy as np

from app.learning.environments import GUIDE_TO_POINT
from app.learning.in_processes import InProcesses
from benchmarks.common import Report, main
from pendant_sim import Push, session, step, stepped

COUNT = 8
AT_LEAST = 1.8
STEPS = 60
"""Steps of one environment that are timed, 3 s; those of the vector are as many for each of its own."""

TICKS = 2000

BESIDE = 5.0
"""What handing actions out and observations in may cost, of all computing time [%]."""


def _seconds(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def _step(envs: gymnasium.Env | gymnasium.vector.VectorEnv, rng: np.random.Generator) -> None:
    space = envs.action_space
    for _ in range(STEPS):
        envs.step(rng.uniform(-8.0, 8.0, space.shape).astype(np.float32))


def _used(envs: InProcesses) -> tuple[float, float]:
    """Computing time so far [s]: of this process, and of those of the environments."""
    tick = os.sysconf("SC_CLK_TCK")
    stats = [Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split() for pid in envs.pids]
    return time.process_time(), sum(int(stat[11]) + int(stat[12]) for stat in stats) / tick  # user and system time


def _loop(start: "multiprocessing.synchronize.Barrier", told: "multiprocessing.Queue[float]") -> None:  # type: ignore[name-defined]
    """A bare loop of ticks; says how many a second."""
    simulation = stepped(session({"title": "bare", "duration": 1.0}))
    step(simulation, 200)
    push = [Push("flange", (0.0, 0.0, 0.0), (0.0, 5.0, 0.0))]
    start.wait()
    told.put(TICKS / _seconds(lambda: step(simulation, TICKS, touches=push)))


def bare(count: int) -> float:
    """Ticks a second of so many bare loops at once, all together."""
    context = multiprocessing.get_context("spawn")
    start, told = context.Barrier(count), context.Queue()
    loops = [context.Process(target=_loop, args=(start, told)) for _ in range(count)]
    for loop in loops:
        loop.start()
    total = sum(told.get() for _ in loops)
    for loop in loops:
        loop.join()
    return total


def measure(report: Report) -> None:
    """Fill the report."""
    tries, seed = 9 if report.options.full else 4, report.options.seed
    rng = np.random.default_rng(seed)
    endless = {"max_episode_steps": 10**6, "setup": {"settings": {"free_drive.ends_by_period": False}}}
    one = gymnasium.make(GUIDE_TO_POINT, **endless)
    eight = gymnasium.make_vec(GUIDE_TO_POINT, num_envs=COUNT, **endless)
    assert isinstance(eight, InProcesses)
    one.reset(seed=seed)
    eight.reset(seed=seed)
    ratios, shares, machine, singles = [], [], [], []
    for _ in range(tries):
        single = STEPS / _seconds(lambda: _step(one, rng))
        before = _used(eight)
        together = COUNT * STEPS / _seconds(lambda: _step(eight, rng))
        own, others = (after - first for after, first in zip(_used(eight), before, strict=True))
        shares.append(own / (own + others))
        ratios.append(together / single)
        singles.append(single)
        machine.append(bare(2) / bare(1))
    eight.close()
    report.row("steps a second: eight environments over one, best", max(ratios), at_least=AT_LEAST, n=tries)
    report.row("steps a second: eight environments over one, median", median(ratios), n=tries)
    report.row("ticks a second: two bare loops at once over one, best", max(machine), n=tries)
    report.row("ticks a second: two bare loops at once over one, median", median(machine), n=tries)
    report.row("computing time beside the environments' own, median", 100.0 * median(shares), "%", at_most=BESIDE, n=tries)
    report.row("steps a second of one environment, median", median(singles), "1/s", n=tries)
    report.row("load of the machine at the end", os.getloadavg()[0])
    resets = [_seconds(lambda k=k: one.reset(seed=seed + k)) for k in range(2 * tries)]
    report.row("a reset, over a step, median", median(resets) * median(singles), n=len(resets))
    report.row("a reset, median", 1000.0 * median(resets), "ms", n=len(resets))
    one.close()
    seen = gymnasium.make(GUIDE_TO_POINT, render_mode="rgb_array")
    seen.reset(seed=seed)
    seen.render()
    report.row("a picture of 640 by 480, median", 1000.0 * median(_seconds(seen.render) for _ in range(5)), "ms", n=5)
    seen.close()


if __name__ == "__main__":
    main("learning", measure)
