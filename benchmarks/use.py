"""Use: a hand guides the flange with 15 to 40 N right after entry; how far it comes in 3 s, and whether anything gets in its way.

A hand is a spring to a point that walks away along a straight line, its force capped; or it pushes with the whole force all the
time, along that line. A hand on another arm is as strong as the payload is heavy; without a flange sensor it is at least as
strong as what the joints may miss needs (`benchmarks.arms`). Counted by themselves are then those that led the arm until they
pulled through its axes, where joints feel little of them, and those that ended where the payload's fall, too, would explain
what the joints felt. Truth is read for scoring alone.
"""

from typing import NamedTuple

import numpy as np

from benchmarks.arms import LEVER, heaviest, missed, senses, strength
from benchmarks.common import Report, main, spread
from benchmarks.guided import levers
from benchmarks.hold import HOLD, IDLE, MOUNTINGS, RELEASE, flange, smallest_singular
from benchmarks.payload import SETTINGS, Case, draw, simulation
from pendant.all_settings import Settings, apply
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import LEAVING
from pendant.tick.estimate import JointsFeel
from pendant.tick.modes import Mode
from sim.exchange.desk import Wishes
from sim.plant.touch import Pull, Push, Touch
from sim.simulation import Simulation

WAY = 0.3  # [m] free of singularities and limits, as a user would choose it
SECONDS = 3.0


class Guiding(NamedTuple):
    """One guided push."""

    case: Case
    force: float  # [N]
    pace: float  # of the hand [m/s]
    walls: bool
    sensor: bool
    steady: bool  # the whole force all the time


class Result(NamedTuple):
    """What came of it."""

    push: Guiding
    entered: bool
    way: float  # of the flange, at most [mm]
    left: str  # kind of an involuntary leaving
    fall: bool  # then, all that the joints felt was what a payload that fell would make them feel
    caught: int  # times that a wall held the arm
    lever: float = np.inf  # largest of a joint that the hand pulls at in the end [m]

    @property
    def far(self) -> bool:
        """It came as far as it should."""
        return self.way >= 200.0


def free_way(device: Simulation, rng: np.random.Generator) -> np.ndarray | None:
    """A direction in W in which the flange can go for `WAY` by the model's kinematics; None when 20 draws found none."""
    dynamics, q0 = device.dynamics, device.plant.q.copy()
    (low, high), smallest = np.array(device.arm.limits.ends).T, smallest_singular(device.arm)
    base = device.plant.data.xmat[device.plant.model.body("foot").id].reshape(3, 3)
    steps = 30
    for _ in range(20):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        q = q0.copy()
        for _ in range(steps):
            jacobian = dynamics.update(q)[2]
            if np.linalg.svd(jacobian, compute_uv=False)[-1] < smallest or np.any((q < low + 0.2) | (q > high - 0.2)):
                break
            q = q + np.linalg.pinv(jacobian[:3]) @ direction * WAY / steps
        else:
            return base @ direction
    return None


def measure_push(push: Guiding) -> Result:
    """Enter, then guide at once."""
    rng = np.random.default_rng([push.case.seed, push.case.number, 9])
    settings: Settings = apply(SETTINGS, {"walls.on": push.walls})
    device = simulation(push.case, settings)
    direction = free_way(device, rng)
    if direction is None:
        return Result(push, False, 0.0, "no way", False, 0)
    for _ in range(1000):
        if device.tick(HOLD).mode is Mode.FREE_DRIVE:
            break
    entered = device.tick(RELEASE).mode is Mode.FREE_DRIVE
    start = flange(device)
    target, pace, way = start / 1000.0, 0.0, 0.0
    left, caught, fall = list[str](), 0, False
    for tick in range(round(500 * SECONDS)):
        pace = min(pace + 0.002 * 1.0, push.pace)  # a quarter of a second to get going
        target = target + 0.002 * pace * direction
        touch: Touch = Pull("flange", (0.0, 0.0, 0.0), tuple(target.tolist()), push.force)
        if push.steady:
            touch = Push("flange", (0.0, 0.0, 0.0), tuple((min(tick / 50.0, 1.0) * push.force * direction).tolist()))
        for event in device.tick(Wishes(IDLE.inputs, (touch,), ())).events:
            caught += event.kind is Kind.WALL_REACHED
            if TABLE[event.kind].effect in LEAVING:
                left.append(event.kind.value)
                fall = device.estimate.whose.joints_feel is JointsFeel.FALL
        way = max(way, float(np.linalg.norm(flange(device) - start)))
    force = device.plant.hands.touched[0][2] if device.plant.hands.touched else np.zeros(3)
    lever = float(np.abs(force @ levers(device, "flange")).max() / max(float(np.linalg.norm(force)), 1e-9))
    return Result(push, entered, way, ", ".join(left), fall, caught, lever)


def pushes(report: Report, sensor: bool, walls: bool, *, count: int, steady: bool = False) -> list[Guiding]:
    """Right payloads of 0 to 5 kg, forces and paces at random."""
    arm = report.options.arm
    cases, _ = draw(report.options.seed + 500, -(-count // len(MOUNTINGS)), "sensor" if sensor else "no sensor", arm)
    rng = np.random.default_rng([report.options.seed, 5])
    least = 15.0 + missed(arm) / LEVER
    made: list[Guiding] = []
    for case in cases[:count]:
        mass = float(rng.uniform(0.0, heaviest(arm)))
        force, pace = float(rng.uniform(least, 40.0)) * strength(arm), float(rng.uniform(0.12, 0.3))
        made.append(Guiding(case._replace(true=mass, configured=mass), force, pace, walls, sensor, steady))
    return made


def measure(report: Report) -> None:
    """Fill the report."""
    count = 500 if report.options.full else 32
    plans = ((True, True, count, False), (True, False, count // 2, False), (True, True, count // 2, True))
    for sensor, walls, number, steady in plans:
        results = [
            r for r in spread(measure_push, pushes(report, sensor, walls, count=number, steady=steady)) if r.left != "no way"
        ]
        label = f"walls {'on' if walls else 'off'}{', whole force all the time' if steady else ''}"
        entered = [r for r in results if r.entered]
        report.share(f"{label}: pushes, entered", len(entered), len(results))
        known = entered
        if not senses(report.options.arm):
            report.share(f"{label}: ended as if the payload fell", sum(r.fall for r in entered), len(entered))
            through = [r for r in entered if not r.far and r.lever < LEVER]
            report.share(f"{label}: pulled through the axes in the end", len(through), len(entered))
            known = [r for r in entered if not (r.fall or r in through)]
        n, at_least = len(known), 0.99 if walls else None
        report.share(f"{label}: pushes, 200 mm or more in 3 s", sum(r.far for r in known), n, at_least=at_least)
        report.share(f"{label}: no involuntary leaving", sum(not r.left for r in known), n, at_least=at_least)
        report.share(f"{label}: pushes in which a wall held the arm", sum(r.caught > 0 for r in entered), len(entered))
        short = sorted((r for r in entered if not r.far or r.left), key=lambda r: r.way)
        for r in short[:6]:
            case = r.push.case
            report.notes.append(
                f"{label}: {r.way:.0f} mm with {r.push.force:.0f} N at {r.push.pace:.2f} m/s, lever {r.lever:.2f} m, "
                f"{case.true:.1f} kg, {case.mounting}, case {case.number}: held {r.caught} times, {r.left or 'stayed'}"
            )


if __name__ == "__main__":
    main("use", measure)
