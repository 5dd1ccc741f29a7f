"""Cost of the pure supervisor step: idle, and in the activation sequence with ten parameters and more and two walls.

The estimates are those of a simulated arm at rest, mismatch on, recorded first and given to the supervisor as it gets them in
the loop: in one and the same `Estimate`, whose arrays have just been written. Only `Supervisor.step` is timed, each step alone,
in the CPU time of this thread, so that what else runs on the machine does not count.
"""

import time
from collections.abc import Callable
from dataclasses import fields

import numpy as np

from app.files.library import load_arm
from benchmarks.common import Report, main
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING, Button, Inputs
from pendant.settings.schema import ticks
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Phase
from pendant.walls.definitions import Wall
from pendant.walls.shapes import Box
from sim.arm.scenario import Scenario
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

ALL = ("joint_displacement", "joint_acceleration", "motor_torque")
"""Activation limits that are off as shipped."""

HELD = Inputs(held=frozenset({Button.FREE_DRIVE}))
WALL = Wall(name="box", shape=Box(size=(0.4, 0.4, 0.4)), part="tcp")


def settings() -> Settings:
    """As shipped, with every activation limit on and the longest sequence."""
    changes: dict[str, object] = {f"limits.activation.{name}.on": True for name in ALL}
    return apply(Settings(), {**changes, "sequence.period": 5.0})


def recorded(arm: str, seed: int, count: int, *, inputs: Inputs, used: Settings) -> list[Estimate]:
    """What the controller knows in `count` ticks."""
    simulation = Simulation(load_arm(arm), Scenario(seed=seed, walls=[WALL]), used)
    estimates = []
    for _ in range(count):
        simulation.tick(Wishes(inputs, (), ()))
        estimates.append(simulation.estimate.copy())
    return estimates


def put(given: Estimate, estimate: Estimate) -> None:
    """Write all values of an estimate into another, as the estimator does in every tick."""
    for field in fields(Estimate):
        value = getattr(estimate, field.name)
        if isinstance(value, np.ndarray):
            getattr(given, field.name)[...] = value
        else:
            setattr(given, field.name, value)


def timed(estimates: list[Estimate], inputs: Inputs, used: Settings, counts: Callable[[Supervisor], bool]) -> list[int]:
    """CPU time of each step in which the supervisor is in the state asked for [ns]."""
    arm = load_arm("ur5e")
    joints, rated = tuple(arm.chain.joints), tuple(arm.limits.torque)
    supervisor = Supervisor(used, arm.n, joints=joints, rated=rated, borders=(WALL,))
    times = []
    given = estimates[0].copy()
    for estimate in estimates:
        put(given, estimate)
        begun = time.thread_time_ns()
        supervisor.step(given, inputs)
        took = time.thread_time_ns() - begun
        if counts(supervisor):
            times.append(took)
    return times


def measure(report: Report, rounds: int = 8) -> None:
    """Fill the report; ten times as many rounds in the full size."""
    rounds *= 10 if report.options.full else 1
    used = settings()
    start = ticks(used.activation.period)
    for name, inputs, at_most, count, within in (
        ("idle", NOTHING, 15.0, 2500, lambda supervisor: supervisor._free.phase is Phase.OFF),
        ("in the sequence", HELD, 35.0, start + 2500, lambda supervisor: supervisor._free.phase is Phase.SEQUENCE),
    ):
        estimates = recorded("ur5e", report.options.seed, count, inputs=inputs, used=used)
        times = [took for _ in range(rounds) for took in timed(estimates, inputs, used, within)]
        mean, late = float(np.mean(times)) / 1000.0, float(np.percentile(times, 99)) / 1000.0
        report.row(f"{name}: steps measured", len(times), at_least=rounds * 2000)
        report.row(f"{name}: mean", mean, "µs", at_most=at_most, n=len(times))
        report.row(f"{name}: p99 over the mean", late / mean, at_most=3.0, n=len(times))


if __name__ == "__main__":
    main("supervisor", measure)
