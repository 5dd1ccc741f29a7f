"""Speed of the tick: headless times real time, the whole tick over bare physics, what each stage of it costs.

In NORMAL, in RUN and in FREE_DRIVE guided by a hand, mismatch on. The clock is the CPU time of this process, all its threads
together: what one core would need, whatever else runs on the machine.
"""

import copy
import itertools
import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import mujoco
import numpy as np

from app.files.checked import load
from app.files.library import load_arm
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session, find
from benchmarks.common import Report, main
from pendant.all_settings import Settings
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.tick.modes import TICK, Mode
from sim.arm.scenario import Scenario
from sim.exchange.desk import Wishes
from sim.plant.touch import Pull
from sim.simulation import Simulation

BLOCKS = 9
SLICES = 10  # of a block: tick and bare physics take turns in each, so that a busy machine slows both
SPEED = 10.0  # times real time, at least
RATIO = 3.0  # of the whole tick to bare physics, at most
STAGES = (("sensors", "read"), ("estimator", "update"), ("supervisor", "step"), ("controller", "update"), ("plant", "advance"))


class Scene(NamedTuple):
    """A simulation in the mode to be measured, and what everybody wants of it from there on."""

    simulation: Simulation
    mode: Mode
    wishes: Iterator[Wishes]


class Block(NamedTuple):
    """CPU time of a control tick [s]."""

    whole: float
    bare: float
    in_mode: float  # share of its ticks


def normal(arm: str, seed: int) -> Scene:
    """Holding still."""
    simulation = Simulation(load_arm(arm), Scenario(seed=seed), Settings())
    simulation.tick(Wishes(Inputs(commands=(Command.NORMAL,)), (), ()))
    return Scene(simulation, Mode.NORMAL, itertools.repeat(Wishes(NOTHING, (), ())))


def program(arm: str, seed: int) -> Scene:
    """Joint moves to and fro, all joints at once."""
    simulation = Simulation(load_arm(arm), Scenario(seed=seed), Settings())
    home = np.array(simulation.arm.chain.home)
    ends = (tuple((home + 0.6).tolist()), tuple((home - 0.6).tolist()))
    moves = Program(steps=tuple(JointMove(q=ends[k % 2], speed=0.5) for k in range(500)))
    simulation.tick(Wishes(Inputs(program=moves), (), ()))
    for _ in range(200):
        simulation.tick(Wishes(NOTHING, (), ()))
    simulation.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))
    return Scene(simulation, Mode.RUN, itertools.repeat(Wishes(NOTHING, (), ())))


def guided(arm: str, seed: int) -> Scene:
    """The button held, a hand leading the flange round a circle."""
    simulation = Simulation(load_arm(arm), Scenario(seed=seed), Settings())
    held = Inputs(held=frozenset({Button.FREE_DRIVE}))
    for _ in range(1200):
        simulation.tick(Wishes(held, (), ()))
    x, y, z = simulation.plant.poses()[-1, :3].tolist()

    def wishes() -> Iterator[Wishes]:
        for k in itertools.count():
            turn = 2.0 * math.pi * k * TICK / 5.0
            target = (x, y + 0.06 * math.sin(turn), z + 0.06 * (1.0 - math.cos(turn)))
            yield Wishes(held, (Pull("flange", (0.0, 0.0, 0.0), target, 50.0),), ())

    return Scene(simulation, Mode.FREE_DRIVE, wishes())


SCENES: dict[str, Callable[[str, int], Scene]] = {"NORMAL": normal, "RUN": program, "FREE_DRIVE guided": guided}


def block(scene: Scene, ticks: int) -> Block:
    """`ticks` whole ticks and as many of bare physics, in turns; bare physics goes on from the same state, on a copy."""
    simulation, mode, wishes = scene
    model, substeps = simulation.plant.model, simulation.plant.step.substeps
    whole = bare = 0.0
    in_mode, count = 0, max(1, ticks // SLICES)
    for _ in range(SLICES):
        begun = time.process_time()
        for _ in range(count):
            in_mode += simulation.tick(next(wishes)).mode is mode
        whole += time.process_time() - begun
        data = copy.copy(simulation.plant.data)
        begun = time.process_time()
        for _ in range(count):
            mujoco.mj_step(model, data, nstep=substeps)
        bare += time.process_time() - begun
    total = count * SLICES
    return Block(whole / total, bare / total, in_mode / total)


def stages(scene: Scene, ticks: int) -> dict[str, float]:
    """Median time of each stage of a tick [µs], on the wall clock: a stage is too short for the other one."""
    times: defaultdict[str, list[int]] = defaultdict(list)

    def timed(owner: Any, method: str, name: str) -> None:
        inner = getattr(owner, method)

        def outer(*values: Any, **named: Any) -> Any:
            begun = time.perf_counter_ns()
            result = inner(*values, **named)
            times[name].append(time.perf_counter_ns() - begun)
            return result

        setattr(owner, method, outer)

    simulation = scene.simulation
    for name, method in STAGES:
        timed(getattr(simulation, name), method, name)
    timed(simulation, "tick", "whole")
    timed(simulation, "snapshot", "a snapshot, every 8th tick of the paced loop")
    for k in range(ticks):
        simulation.tick(next(scene.wishes))
        if k % 8 == 0:
            simulation.snapshot()
    return {name: float(np.median(values)) / 1000.0 for name, values in times.items()}


def sessions(report: Report, runs: int) -> None:
    """Sessions of every mode, as `pendant run` takes them: with time line, expectations and the events file.

    Their median is reported, for the first run loads what is compiled.
    """
    for name in ("hold", "free-drive", "program"):
        session = load(find(name), Session)
        prepared = prepare(session, name)
        speeds: list[float] = []
        for _ in range(runs):
            simulation = simulate(prepared)
            with TemporaryDirectory() as out:
                begun = time.process_time()
                run(session, prepared, simulation, Path(out))
                speeds.append(session.duration / (time.process_time() - begun))
        what = f"session {name}, {session.duration:g} s, median"
        report.row(what, float(np.median(speeds)), "x real time", at_least=SPEED, n=runs)


def measure(report: Report, arms: tuple[str, ...] = ("ur5e",), ticks: int = 500, runs: int = 5) -> None:
    """Fill the report; `ticks` in a block, ten times as many in the full size, which takes all arms; `runs` of a session."""
    if report.options.full:
        arms, ticks = ("ur3e", "ur5e", "ur10e", "ur16e"), 10 * ticks
    for arm in arms:
        for name, make in SCENES.items():
            scene = make(arm, report.options.seed)
            block(scene, ticks)  # warms caches up
            blocks = [block(scene, ticks) for _ in range(BLOCKS)]
            ratio = [each.whole / each.bare for each in blocks]
            label = f"{arm}, {name}"
            speed = [TICK / each.whole for each in blocks]
            report.row(f"{label}: headless, median", float(np.median(speed)), "x real time", at_least=SPEED, n=BLOCKS)
            report.row(f"{label}: headless, best block", max(speed), "x real time", n=BLOCKS)
            report.row(f"{label}: tick over bare physics, median", float(np.median(ratio)), "", at_most=RATIO, n=BLOCKS)
            bare = 1e6 * float(np.median([each.bare for each in blocks]))
            report.row(f"{label}: bare physics, median", bare, "µs a tick", n=BLOCKS)
            in_mode = min(each.in_mode for each in blocks)
            report.row(f"{label}: share of ticks in that mode", in_mode, "", at_least=1.0, n=BLOCKS)
            costs = stages(scene, 4 * ticks)
            whole = costs.pop("whole")
            shares = ", ".join(f"{stage} {cost:.1f} ({100 * cost / whole:.0f} %)" for stage, cost in costs.items())
            report.notes.append(f"{label}: median tick {whole:.1f} µs on the wall clock, of which {shares}")
    sessions(report, runs)


if __name__ == "__main__":
    main("tick", measure)
