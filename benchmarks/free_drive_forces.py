"""Free-drive: what a hand needs to lead, turn, start and stop a UR5e, with and without friction taken off.

Random postures, mismatch on, 1 kg of payload configured right. A virtual hand (spring and damper) leads the flange at 0.1 m/s
along six directions, turns it at 0.3 rad/s, pushes the elbow, starts it from rest, and lets go. Truth is read for scoring alone.
"""

from typing import Literal, NamedTuple

import numpy as np

from app.library import load_arm
from benchmarks.common import Report, main, spread
from pendant.inputs import NOTHING, Button, Inputs
from pendant.modes import TICK, TICK_RATE, Mode
from pendant.settings import Settings, apply
from sim.desk import Wishes
from sim.scenario import Load, Scenario
from sim.simulation import Simulation
from sim.touch import Pull, Push, Touch

Array = np.ndarray
CENTRE = (0.0, 0.0, 0.0)
IDLE = Wishes(NOTHING, (), ())
HOLD = Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())
RELEASE = Wishes(Inputs(released=frozenset({Button.FREE_DRIVE})), (), ())
LOW = np.array([-3.0, -2.5, 0.5, -2.6, -2.4, -3.0])  # postures in which people work: elbow bent, wrist not stretched [rad]
HIGH = np.array([3.0, -0.6, 2.4, 0.2, -0.7, 3.0])
SMALLEST_SINGULAR = 0.1
PACE, TURN = 0.1, 0.3  # [m/s], [rad/s]
TURN_STIFFNESS, TURN_DAMPING = 40.0, 1.0  # of the turning hand [N·m/rad], [N·m·s/rad]
PAYLOAD = Load(mass=1.0, com=[0.0, 0.0, 0.05])
SETTINGS = {"free_drive.period": 30.0, "free_drive.restart_period": 30.0, "limits.operation.user_force.on": False}
LEVER = 0.2  # of the elbow about the base [m]
HUM = 0.005  # joint speed that counts as a limit cycle [rad/s]; a tenth of a millimetre at 10 Hz
OVER = 1.2  # times the true friction
Mismatch = Literal["on", "nominal"]


class Case(NamedTuple):
    """One posture."""

    number: int
    seed: int
    helped: bool = True  # friction is taken off
    over: bool = False  # by 20 % too much
    mismatch: Mismatch = "on"


class Result(NamedTuple):
    """What the hand needed in one posture, a value a direction."""

    entered: bool
    lead: list[float]  # [N]
    turn: list[float]  # [N·m]
    elbow: list[float]  # [N]
    breakaway: list[float]  # [N]
    rest: float  # time to rest after letting go [s]
    drift: float  # hands off, 10 s [mm]
    last: float  # speed of the fastest joint in the last second of that, RMS [rad/s]
    hum: float  # RMS of the fastest joint's speed while a hand holds on, still [rad/s]


def posture(rng: np.random.Generator, probe: Simulation) -> tuple[list[float], int]:
    """A random posture away from singularities, and how many were thrown away before."""
    for thrown in range(1000):
        q = rng.uniform(LOW, HIGH) * np.array([1.0, 1.0, rng.choice([-1.0, 1.0]), 1.0, rng.choice([-1.0, 1.0]), 1.0])
        if np.linalg.svd(probe.dynamics.update(q)[2], compute_uv=False)[-1] > SMALLEST_SINGULAR:
            return q.tolist(), thrown
    raise RuntimeError("no posture away from singularities in 1000")


class Hand:
    """A simulation in free-drive, and a hand on it."""

    def __init__(self, case: Case) -> None:
        arm = load_arm("ur5e")
        probe = Simulation(arm, Scenario(mismatch="nominal"), Settings())
        q, self.thrown = posture(np.random.default_rng([case.seed, case.number]), probe)
        scenario = Scenario(
            posture=q, seed=case.seed + case.number, mismatch=case.mismatch, payload_true=PAYLOAD, payload_configured=PAYLOAD
        )
        settings = apply(Settings(), {**SETTINGS, "joint_control.friction": case.helped})
        self.simulation = Simulation(arm, scenario, settings)
        if case.over:
            self.simulation.controller.free_drive.share = OVER
        self.plant = self.simulation.plant
        for _ in range(round(TICK_RATE * (settings.activation.period + settings.sequence.period)) + 50):
            self.simulation.tick(HOLD)
        self.entered = self.simulation.tick(RELEASE).mode is Mode.FREE_DRIVE

    def place(self, part: str = "flange") -> Array:
        """True position of a part in W [m]."""
        return self.plant.data.xpos[self.plant.model.body(part).id].copy()

    def rotation(self) -> Array:
        """True orientation of the flange in W."""
        return self.plant.data.xmat[self.plant.model.body("flange").id].reshape(3, 3).copy()

    def tick(self, *touches: Touch) -> Array:
        """One tick; the force (3,) of the first touch, in W [N]."""
        self.simulation.tick(Wishes(NOTHING, touches, ()))
        return np.array(self.plant.hands.touched[0][2]) if touches else np.zeros(3)

    def wait(self, seconds: float) -> None:
        """Hands off."""
        for _ in range(round(seconds * TICK_RATE)):
            self.simulation.tick(IDLE)

    def lead(self, direction: Array, part: str = "flange", seconds: float = 1.0) -> float:
        """Lead a part along a line at `PACE`; mean force along it in the second half [N]."""
        target, forces = self.place(part), []
        for k in range(round(seconds * TICK_RATE)):
            target = target + direction * PACE * TICK * min(k / 100.0, 1.0)
            forces.append(float(self.tick(Pull(part, CENTRE, tuple(target), 300.0)) @ direction))
        self.wait(0.3)
        return float(np.mean(forces[len(forces) // 2 :]))

    def turn(self, axis: Array, seconds: float = 1.0) -> float:
        """Turn the flange in place at `TURN` about an axis in W; mean torque about it in the second half [N·m]."""
        start, place, torques, angle, before = self.rotation(), self.place(), [], 0.0, 0.0
        for k in range(round(seconds * TICK_RATE)):
            angle += TURN * TICK * min(k / 100.0, 1.0)
            turned = self.rotation() @ start.T
            vee = 0.5 * np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
            error = angle * axis - vee
            rate = (float(vee @ axis) - before) / TICK
            before = float(vee @ axis)
            torque = TURN_STIFFNESS * error + TURN_DAMPING * (TURN - rate) * axis
            self.tick(Pull("flange", CENTRE, tuple(place), 300.0), Push("flange", CENTRE, CENTRE, tuple(torque)))
            torques.append(float(torque @ axis))
        self.wait(0.3)
        return float(np.mean(torques[len(torques) // 2 :]))

    def breakaway(self, direction: Array) -> float:
        """Force that grows from nothing by 20 N/s; where the flange has moved 2 mm [N]."""
        start, force = self.place(), 0.0
        while force < 150.0:
            force += 20.0 * TICK
            self.tick(Push("flange", CENTRE, tuple(force * direction)))
            if float(np.linalg.norm(self.place() - start)) > 0.002:
                break
        self.wait(0.4)
        return force

    def let_go(self, direction: Array) -> tuple[float, float, float]:
        """Lead at 0.25 m/s, then let go: time until every joint is slower than 10 mrad/s for good [s], drift [mm], last speed."""
        target = self.place()
        for k in range(400):
            target = target + direction * 0.25 * TICK * min(k / 200.0, 1.0)
            self.tick(Pull("flange", CENTRE, tuple(target), 300.0))
        moving = 0
        for k in range(500):
            self.simulation.tick(IDLE)
            if float(np.abs(self.plant.qd).max()) > 0.01:
                moving = k + 1
        start, drift, speeds = self.place(), 0.0, []
        for k in range(10 * TICK_RATE):
            self.simulation.tick(IDLE)
            if k >= 9 * TICK_RATE:
                speeds.append(self.plant.qd.copy())
            drift = max(drift, float(np.linalg.norm(self.place() - start)))
        return moving * TICK, 1000.0 * drift, float(np.sqrt(np.mean(np.square(speeds), axis=0)).max())

    def hum(self) -> float:
        """A hand that holds on, still: RMS of the fastest joint's speed after 1 s [rad/s]."""
        place, speeds = self.place() + np.array([0.005, 0.005, 0.005]), []
        for k in range(1000):
            self.tick(Pull("flange", CENTRE, tuple(place), 300.0))
            if k >= 500:
                speeds.append(self.plant.qd.copy())
        return float(np.sqrt(np.mean(np.square(speeds), axis=0)).max())


def directions() -> Array:
    """Both ways along each axis of W, there and back again (6, 3)."""
    return np.array([sign * row for row in np.eye(3) for sign in (1.0, -1.0)])


def elbow_directions(hand: Hand) -> Array:
    """Both ways the elbow can go: about the shoulder and, unless it is within `LEVER` of its axis, about the base (k, 3)."""
    elbow = hand.place("elbow") - np.array([0.0, 0.0, load_arm("ur5e").chain.d[0]])
    round_base = np.cross([0.0, 0.0, 1.0], elbow)
    up = np.cross(round_base, elbow)
    axes = [up / np.linalg.norm(up)]
    if float(np.linalg.norm(round_base)) > LEVER:
        axes.append(round_base / np.linalg.norm(round_base))
    return np.array([sign * row for row in axes for sign in (1.0, -1.0)])


def measure_case(case: Case) -> tuple[Result, int]:
    """All figures of one posture, and how many postures were thrown away before it."""
    hand = Hand(case)
    lead, turn, elbow, breakaway = [], [], [], []
    if not case.over:
        lead = [hand.lead(direction) for direction in directions()]
        turn = [hand.turn(axis) for axis in directions()]
        elbow = [hand.lead(direction, "elbow") for direction in elbow_directions(hand)]
        breakaway = [hand.breakaway(direction) for direction in directions()]
    rest, drift, last = hand.let_go(directions()[case.number % 6])
    return Result(hand.entered, lead, turn, elbow, breakaway, rest, drift, last, hand.hum()), hand.thrown


FORCES = (
    ("lead", "force to keep 0.1 m/s", "N", 12.0),
    ("turn", "torque to keep turning at 0.3 rad/s", "N·m", 2.0),
    ("elbow", "force at the elbow to keep 0.1 m/s", "N", 30.0),
    ("breakaway", "force that starts it from rest", "N", 15.0),
)


def measure(report: Report) -> None:
    """Fill the report."""
    count, seed = (50 if report.options.full else 6), report.options.seed
    rows = {}
    for helped in (True, False):
        rows[helped] = spread(measure_case, [Case(k, seed, helped) for k in range(count)])
    helped, plain = [row for row, _ in rows[True]], [row for row, _ in rows[False]]
    thrown = sum(number for _, number in rows[True])
    report.row("postures near a singularity thrown away", 100.0 * thrown / (thrown + count), "%", at_most=15.0)
    report.row("free-drive entered", sum(row.entered for row in helped) / count, "", at_least=1.0)
    for name, what, unit, bar in FORCES:
        values = np.concatenate([getattr(row, name) for row in helped])
        others = np.concatenate([getattr(row, name) for row in plain])
        p95 = float(np.percentile(values, 95))
        report.row(f"{what}, p95 of {values.size}", p95, unit, at_most=bar)
        report.row(f"{what}, median", float(np.median(values)), unit)
        report.row(f"{what}, largest", float(values.max()), unit)
        report.row(f"{what}, p95 without compensation", float(np.percentile(others, 95)), unit)
        report.row(f"{what}, without over with compensation", float(np.percentile(others, 95)) / p95, "times")
    report.row("rest after letting go, worst", max(row.rest for row in helped), "s", at_most=0.3)
    report.row("drift hands off, 10 s, worst", max(row.drift for row in helped), "mm", at_most=2.0)
    report.row("speed while a hand holds on, RMS, worst", max(row.hum for row in helped), "rad/s", at_most=HUM)
    over = [row for row, _ in spread(measure_case, [Case(k, seed, over=True) for k in range(count)])]
    report.row("20 % too much: fastest joint 11 s after letting go, worst", max(row.last for row in over), "rad/s", at_most=HUM)
    report.row("20 % too much: speed while a hand holds on, RMS, worst", max(row.hum for row in over), "rad/s", at_most=HUM)
    report.row("20 % too much: drift hands off, 10 s, worst", max(row.drift for row in over), "mm")


if __name__ == "__main__":
    main("free_drive_forces", measure)
