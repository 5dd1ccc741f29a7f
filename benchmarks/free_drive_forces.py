"""Free-drive: what a hand needs to lead, turn, start and stop an arm, with and without friction taken off.

Random postures (`benchmarks.postures`), mismatch on, 1 kg of payload configured right. A virtual hand (spring and damper) leads
the flange at 0.1 m/s along six directions, turns it at 0.3 rad/s, pushes the elbow, starts it from rest, and lets go. Each begins
in the posture as drawn, free-drive just entered: an arm that was pushed about stands elsewhere, often next to a singularity.
Besides, one long free-drive is measured: the arm is led and turned along all directions, pushed at the elbow, and let go. Truth
is read for scoring alone.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.arms import USUAL, load
from benchmarks.common import NO_CASE, Report, main, spread
from benchmarks.postures import posture
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING, Button, Inputs
from pendant.tick.modes import TICK, TICK_RATE, Mode
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.touch import Pull, Push, Touch
from sim.simulation import Simulation

Array = np.ndarray
CENTRE = (0.0, 0.0, 0.0)
IDLE = Wishes(NOTHING, (), ())
HOLD = Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())
RELEASE = Wishes(Inputs(released=frozenset({Button.FREE_DRIVE})), (), ())
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
    rest: float = 10.0  # hands off after letting go [s]
    mismatch: Mismatch = "on"
    arm: str = USUAL


class Result(NamedTuple):
    """What the hand needed in one posture."""

    entered: bool
    forces: dict[str, list[float]]  # of `PUSHES`, a value a direction [N], [N·m]; not a number where free-drive ended meanwhile
    rest: float = 0.0  # time to rest after letting go [s]
    drift: float = 0.0  # hands off [mm]
    long: tuple[float, float, float] = (0.0, 0.0, 0.0)  # in one long free-drive: share of it after its end, rest [s], drift [mm]
    last: float = 0.0  # speed of the fastest joint in the last second of that, RMS [rad/s]
    hum: float = 0.0  # RMS of a joint's speed about its mean while a hand holds on, still [rad/s]


class Hand:
    """A simulation in free-drive, and a hand on it."""

    def __init__(self, case: Case) -> None:
        arm = load(case.arm)
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
        self.entered = self.free = self.simulation.tick(RELEASE).mode is Mode.FREE_DRIVE

    def place(self, part: str = "flange") -> Array:
        """True position of a part in W [m]."""
        return self.plant.data.xpos[self.plant.model.body(part).id].copy()

    def rotation(self) -> Array:
        """True orientation of the flange in W."""
        return self.plant.data.xmat[self.plant.model.body("flange").id].reshape(3, 3).copy()

    def tick(self, *touches: Touch) -> Array:
        """One tick; the force (3,) of the first touch, in W [N]."""
        self.free = self.simulation.tick(Wishes(NOTHING, touches, ())).mode is Mode.FREE_DRIVE
        return np.array(self.plant.hands.touched[0][2]) if touches else np.zeros(3)

    def wait(self, seconds: float) -> None:
        """Hands off."""
        for _ in range(round(seconds * TICK_RATE)):
            self.tick()

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

    def let_go(self, direction: Array, seconds: float) -> tuple[float, float, float]:
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
        for k in range(round(seconds * TICK_RATE)):
            self.simulation.tick(IDLE)
            if k >= (seconds - 1.0) * TICK_RATE:
                speeds.append(self.plant.qd.copy())
            drift = max(drift, float(np.linalg.norm(self.place() - start)))
        return moving * TICK, 1000.0 * drift, float(np.sqrt(np.mean(np.square(speeds), axis=0)).max())

    def hum(self) -> float:
        """A hand that holds on, still: RMS of the speed about its mean, of the joint that shakes most, after 1 s [rad/s].

        About its mean: a joint that goes on to where the hand pulls it does not hum.
        """
        place, speeds = self.place() + np.array([0.005, 0.005, 0.005]), []
        for k in range(1000):
            self.tick(Pull("flange", CENTRE, tuple(place), 300.0))
            if k >= 500:
                speeds.append(self.plant.qd.copy())
        return float(np.std(speeds, axis=0).max())


def directions() -> Array:
    """Both ways along each axis of W, there and back again (6, 3)."""
    return np.array([sign * row for row in np.eye(3) for sign in (1.0, -1.0)])


def elbow_directions(hand: Hand) -> Array:
    """Both ways the elbow can go: about the shoulder and, unless it is within `LEVER` of its axis, about the base (k, 3)."""
    elbow = hand.place("elbow") - np.array([0.0, 0.0, hand.simulation.arm.chain.d[0]])
    round_base = np.cross([0.0, 0.0, 1.0], elbow)
    up = np.cross(round_base, elbow)
    axes = [up / np.linalg.norm(up)]
    if float(np.linalg.norm(round_base)) > LEVER:
        axes.append(round_base / np.linalg.norm(round_base))
    return np.array([sign * row for row in axes for sign in (1.0, -1.0)])


PUSHES: dict[str, Callable[[Hand, Array], float]] = {
    "lead": Hand.lead,
    "turn": Hand.turn,
    "elbow": lambda hand, direction: hand.lead(direction, "elbow"),
    "breakaway": Hand.breakaway,
}


def ways(name: str, hand: Hand) -> Array:
    """Directions (k, 3) of one of `PUSHES`, from where the arm is now."""
    return elbow_directions(hand) if name == "elbow" else directions()


def measure_case(case: Case) -> tuple[Result, int]:
    """All figures of one posture, and how many postures were thrown away before it."""
    hand = Hand(case)
    forces: dict[str, list[float]] = {name: [] for name in PUSHES}
    if not hand.entered:
        return Result(False, forces), hand.thrown
    for name, push in PUSHES.items() if not case.over else ():
        for direction in ways(name, hand):
            fresh = Hand(case)
            force = push(fresh, direction)
            forces[name].append(force if fresh.free else np.nan)
    result = Result(hand.entered, forces)
    if not case.helped:
        return result, hand.thrown
    rest, drift, last = hand.let_go(directions()[case.number % 6], case.rest)
    result = result._replace(rest=rest, drift=drift, last=last, hum=hand.hum())
    return (result if case.over else result._replace(long=long_free_drive(case))), hand.thrown


def long_free_drive(case: Case) -> tuple[float, float, float]:
    """Led, turned, pushed at the elbow, let go: share of pushes from when free-drive had ended; rest [s], drift [mm]."""
    hand, stayed = Hand(case), []
    for name in ("lead", "turn", "elbow"):
        for direction in ways(name, hand):
            PUSHES[name](hand, direction)
            stayed.append(hand.free)
    rest, drift, _ = hand.let_go(directions()[case.number % 6], case.rest)
    return 1.0 - float(np.mean(stayed)), rest, drift


FORCES = (
    ("lead", "force to keep 0.1 m/s", "N", 12.0),
    ("turn", "torque to keep turning at 0.3 rad/s", "N·m", 2.0),
    ("elbow", "force at the elbow to keep 0.1 m/s", "N", 30.0),
    ("breakaway", "force that starts it from rest", "N", 15.0),
)


def measure(report: Report) -> None:
    """Fill the report."""
    count, seed, arm = (50 if report.options.full else 6), report.options.seed, report.options.arm
    cases = [Case(k, seed, helped=on, arm=arm) for on in (True, False) for k in range(count)]
    cases += [Case(k, seed, over=True, rest=10.0 if report.options.full else 4.0, arm=arm) for k in range(count)]
    rows = spread(measure_case, cases)
    helped, plain = [row for row, _ in rows[:count]], [row for row, _ in rows[count : 2 * count]]
    thrown = sum(number for _, number in rows[:count])
    report.share("postures near a singularity thrown away", thrown, thrown + count, at_most=0.15)
    # A right payload's acceptance has its bar in the payload bench; a posture that was refused has no forces.
    report.share("refused at entry", sum(not row.entered for row in helped), count)
    helped, plain = [row for row in helped if row.entered], [row for row in plain if row.entered]
    for name, what, unit, bar in FORCES:
        values, others = (np.concatenate([row.forces[name] for row in side]) for side in (helped, plain))
        ended = np.isnan(values)
        report.share(f"{what}: free-drive ended meanwhile", int(ended.sum()), ended.size, at_most=0.0)
        values, others = values[~ended], others[~np.isnan(others)]
        if not (values.size and others.size):
            report.row(f"{what}, p95", NO_CASE, unit, at_most=bar, n=0)
            continue
        report.row(f"{what}, p95", p95 := float(np.percentile(values, 95)), unit, at_most=bar, n=values.size)
        for part, value in (("median", np.median(values)), ("largest", values.max())):
            report.row(f"{what}, {part}", float(value), unit, n=values.size)
        report.row(f"{what}, p95 without compensation", float(np.percentile(others, 95)), unit, n=others.size)
        report.row(f"{what}, without over with compensation", float(np.percentile(others, 95)) / p95, "times", n=values.size)
    n = len(helped)
    report.row("rest after letting go, worst", max(row.rest for row in helped), "s", at_most=0.3, n=n)
    report.row("drift hands off, 10 s, worst", max(row.drift for row in helped), "mm", at_most=2.0, n=n)
    report.row("speed while a hand holds on, RMS, worst", max(row.hum for row in helped), "rad/s", at_most=HUM, n=n)
    ended, rest, drift = np.array([row.long for row in helped]).T
    report.share("a long free-drive: ended meanwhile", int(np.sum(ended > 0.0)), n, at_most=0.0)
    report.row("a long free-drive: rest after it, worst", float(rest.max()), "s", at_most=0.3, n=n)
    report.row("a long free-drive: drift after it, hands off, worst", float(drift.max()), "mm", at_most=2.0, n=n)
    over = [row for row, _ in rows[2 * count :] if row.entered]
    n = len(over)
    what = "20 % too much: fastest joint long after letting go, worst"
    report.row(what, max(row.last for row in over), "rad/s", at_most=HUM, n=n)
    what = "20 % too much: speed while a hand holds on, RMS, worst"
    report.row(what, max(row.hum for row in over), "rad/s", at_most=HUM, n=n)
    report.row("20 % too much: drift hands off, worst", max(row.drift for row in over), "mm", n=n)


if __name__ == "__main__":
    main("free_drive_forces", measure)
