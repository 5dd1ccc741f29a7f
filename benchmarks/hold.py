"""Holding: drift in NORMAL and FREE_DRIVE, stops out of free-drive, pushes and releases at each link.

Over arms, mountings and postures, mismatch on; the nominal arm beside it. Truth is read for scoring alone.
"""

from typing import Literal, NamedTuple

import numpy as np

from app.files.library import load_arm
from benchmarks.common import Report, main, spread
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import JointMove, Program, ProgramState
from pendant.tick.modes import Mode
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.exchange.desk import Wishes
from sim.plant.touch import Pull, Push, Touch
from sim.rigid_body.dynamics import Dynamics
from sim.simulation import Simulation

ARMS = ("ur3e", "ur5e", "ur10e", "ur16e")
MOUNTINGS = {"floor": (0.0, 0.0, 0.0), "wall": (0.0, np.pi / 2, 0.0), "ceiling": (np.pi, 0.0, 0.0), "tilted": (0.6, 0.4, 0.0)}
IDLE = Wishes(NOTHING, (), ())
HOLD = Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())
RELEASE = Wishes(Inputs(released=frozenset({Button.FREE_DRIVE})), (), ())
SMALLEST_SINGULAR = 0.1  # postures nearer to a singularity are drawn again; the share is printed
SETTLE = 1.0  # [s] for which nobody does anything
LOOK_AHEAD = 0.1  # so far on is looked which way leads away from singularities [m]
Mismatch = Literal["on", "nominal"]


class Case(NamedTuple):
    """One arm in one posture."""

    arm: str
    mounting: str
    number: int
    seed: int
    mismatch: Mismatch


class Result(NamedTuple):
    """Displacements of the flange [mm]."""

    case: Case
    normal: float
    free: float
    entered: bool
    stop: float
    stop_speed: float  # [m/s]
    stop_hold: float
    push_back: float
    push_back_part: str
    redrawn: int


def flange(simulation: Simulation) -> np.ndarray:
    """True flange position [mm]."""
    plant = simulation.plant
    return 1000.0 * plant.data.xpos[plant.model.body("flange").id]


def lift(simulation: Simulation, mass: float) -> np.ndarray:
    """The force (3,) in W that carries a mass [N]."""
    return -np.array(simulation.plant.model.opt.gravity) * mass


def enter(device: Simulation, touches: tuple[Touch, ...] = ()) -> bool:
    """Hold the button until free-drive is on, then let go, with hands on the arm."""
    for _ in range(1000):
        if device.tick(Wishes(HOLD.inputs, touches, ())).mode is Mode.FREE_DRIVE:
            return device.tick(Wishes(RELEASE.inputs, touches, ())).mode is Mode.FREE_DRIVE
    return False


def travel(simulation: Simulation, seconds: float, start: np.ndarray) -> float:
    """Largest distance of the flange from `start` while nobody does anything [mm]."""
    worst = 0.0
    for _ in range(round(500 * seconds)):
        simulation.tick(IDLE)
        worst = max(worst, float(np.linalg.norm(flange(simulation) - start)))
    return worst


def settle(device: Simulation) -> None:
    """Nobody does anything for `SETTLE`."""
    for _ in range(round(500 * SETTLE)):
        device.tick(IDLE)


def go(device: Simulation, *postures: np.ndarray) -> None:
    """A program moves the joints there, one after the other, and the arm settles."""
    moves = Program(steps=tuple(JointMove(q=tuple(posture.tolist())) for posture in postures))
    device.tick(Wishes(Inputs(program=moves), (), ()))
    device.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))
    while device.tick(IDLE).program is ProgramState.RUNNING:
        pass
    settle(device)


def smallest_singular(arm: Arm) -> float:
    """`SMALLEST_SINGULAR` of a UR5e; of an arm of another reach as much more or less."""
    return SMALLEST_SINGULAR * arm.reach / 0.85


def singular(dynamics: Dynamics, arm: Arm, q: np.ndarray) -> bool:
    """These joint angles are next to a singularity."""
    return bool(np.linalg.svd(dynamics.update(q)[2], compute_uv=False)[-1] <= smallest_singular(arm))


def posture(arm_name: str, rng: np.random.Generator) -> tuple[list[float], int]:
    """A random posture away from singularities, and how many were thrown away before."""
    arm = load_arm(arm_name)
    probe = Simulation(arm, Scenario(mismatch="nominal"), Settings())
    redrawn = 0
    while True:
        q = rng.uniform(-2.6, 2.6, arm.n)
        if not singular(probe.dynamics, arm, q):
            return q.tolist(), redrawn
        redrawn += 1


def easiest(simulation: Simulation) -> np.ndarray:
    """Direction in W (3,) in which the flange is easiest to move, the way that leads away from singularities."""
    q = simulation.plant.q
    jacobian = simulation.dynamics.update(q)[2][:3]
    mobility = jacobian @ np.linalg.solve(simulation.dynamics.mass(q), jacobian.T)
    along = np.linalg.eigh(mobility)[1][:, -1]
    step = np.linalg.pinv(jacobian) @ along * LOOK_AHEAD
    there, behind = (np.linalg.svd(simulation.dynamics.update(q + way)[2], compute_uv=False)[-1] for way in (step, -step))
    base = simulation.plant.data.xmat[simulation.plant.model.body("foot").id].reshape(3, 3)
    return base @ (along if there >= behind else -along)


def speed_up(simulation: Simulation) -> float:
    """Guide the flange by a hand along its easiest direction until it moves at 250 mm/s; returns the speed reached [m/s]."""
    direction = easiest(simulation)
    before = flange(simulation)
    target, pace, speed = before / 1000.0, 0.0, 0.0
    for _ in range(1500):
        pace = min(pace + 0.002 * 0.4, 0.27)  # a hand takes most of a second to get there
        target = target + 0.002 * pace * direction
        simulation.tick(Wishes(NOTHING, (Pull("flange", (0.0, 0.0, 0.0), tuple(target), 100.0),), ()))
        now = flange(simulation)
        speed = float(np.linalg.norm(now - before)) * 0.5
        before = now
        if speed >= 0.25:
            break
    return speed


def measure_case(case: Case) -> Result:
    """All figures of one case."""
    arm = load_arm(case.arm)
    rng = np.random.default_rng([case.seed, case.number])
    q, redrawn = posture(case.arm, rng)
    scenario = Scenario(mounting=list(MOUNTINGS[case.mounting]), posture=q, seed=case.seed + case.number, mismatch=case.mismatch)
    settings = apply(Settings(), {"free_drive.period": 30.0})
    simulation = Simulation(arm, scenario, settings)
    start = flange(simulation)
    normal = travel(simulation, 10.0, start)
    back, part = push_each_link(simulation)
    entered = enter(simulation)
    free = travel(simulation, 10.0, flange(simulation))
    reached = speed_up(simulation)
    point = flange(simulation)
    simulation.tick(Wishes(Inputs(commands=(Command.EMERGENCY_STOP,)), (), ()))
    stop = travel(simulation, 1.0, point)
    hold = travel(simulation, 2.0, flange(simulation))
    return Result(case, normal, free, entered, stop, reached, hold, back, part, redrawn)


def push_each_link(simulation: Simulation) -> tuple[float, str]:
    """50 N for 1 s on every part, across its way to the base; largest distance [mm] 2 s after the release, and the part."""
    worst, where = 0.0, ""
    for part in simulation.plant.parts[1:-1]:
        start = flange(simulation)
        body = simulation.plant.model.body(part).id
        outward = simulation.plant.data.xipos[body] - simulation.plant.data.xpos[simulation.plant.model.body("foot").id]
        across = np.cross(outward, [0.3, 0.4, 0.866])
        push = Push(part, (0.0, 0.0, 0.0), tuple(50.0 * across / np.linalg.norm(across)))
        for _ in range(500):
            simulation.tick(Wishes(NOTHING, (push,), ()))
        for _ in range(1000):
            simulation.tick(IDLE)
        back = float(np.linalg.norm(flange(simulation) - start))
        if back > worst:
            worst, where = back, part
    return worst, where


def measure(report: Report) -> None:
    """Fill the report."""
    full = report.options.full
    plans: tuple[tuple[Mismatch, int, tuple[str, ...]], ...] = (
        ("on", 25 if full else 1, ARMS),
        ("nominal", 3 if full else 1, ARMS if full else ("ur5e",)),
    )
    for mismatch, count, arms in plans:
        cases = [
            Case(arm, mounting, 100 * m + k, report.options.seed, mismatch)
            for arm in arms
            for m, mounting in enumerate(MOUNTINGS)
            for k in range(count)
        ]
        results = spread(measure_case, cases)
        for arm in arms:
            mine = [result for result in results if result.case.arm == arm]
            label, n = f"{arm}, mismatch {mismatch}", len(mine)
            report.row(f"{label}: drift in NORMAL, 10 s, worst", max(r.normal for r in mine), "mm", at_most=0.2, n=n)
            report.share(f"{label}: free-drive entered", sum(r.entered for r in mine), n, at_least=1.0)
            report.row(f"{label}: drift in FREE_DRIVE, 10 s, worst", max(r.free for r in mine), "mm", at_most=2.0, n=n)
            fast = [r for r in mine if r.stop_speed >= 0.25]
            report.share(f"{label}: guided to 250 mm/s", len(fast), n, at_least=0.9)
            stopped = max((r.stop for r in fast), default=0.0)
            report.row(f"{label}: stop from 250 mm/s, worst", stopped, "mm", at_most=15.0, n=len(fast))
            report.row(f"{label}: hold after the stop, worst", max(r.stop_hold for r in mine), "mm", at_most=0.2, n=n)
            worst = max(mine, key=lambda r: r.push_back)
            report.row(f"{label}: 50 N push, back to", worst.push_back, "mm", at_most=0.3, n=n)
            report.notes.append(f"{label}: 50 N push, worst on {worst.push_back_part}")
        redrawn = sum(r.redrawn for r in results)
        report.notes.append(
            f"mismatch {mismatch}: {redrawn} postures near a singularity drawn again for {len(results)} cases; "
            f"worst drift in FREE_DRIVE: {max(results, key=lambda r: r.free).case}"
        )


if __name__ == "__main__":
    main("hold", measure)
