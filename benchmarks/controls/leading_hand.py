"""A hand that leads, turns, starts and lets go an arm in free-drive. Truth is read for scoring alone."""

from typing import Literal, NamedTuple

import numpy as np

from benchmarks.arms import LEVER, USUAL, load, shoulder_height
from benchmarks.hold import HOLD, IDLE, RELEASE
from benchmarks.postures import REACH, posture
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING
from pendant.tick.estimate import JointsFeel
from pendant.tick.modes import TICK, TICK_RATE, Mode
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.touch import Pull, Push, Touch
from sim.simulation import Simulation

Array = np.ndarray
CENTRE = (0.0, 0.0, 0.0)
PACE, TURN = 0.1, 0.3  # [m/s], [rad/s]
TURN_STIFFNESS, TURN_DAMPING = 40.0, 1.0  # of the turning hand [N·m/rad], [N·m·s/rad]
PAYLOAD = Load(mass=1.0, com=[0.0, 0.0, 0.05])
SETTINGS = {"free_drive.period": 30.0, "free_drive.restart_period": 30.0, "limits.operation.user_force.on": False}
OVER = 1.2  # times the true friction

Mismatch = Literal["on", "nominal"]


class Case(NamedTuple):
    """One posture."""

    number: int
    seed: int
    helped: bool = True  # with friction compensation
    over: bool = False  # which compensates 20 % too much
    rest: float = 10.0  # hands off after letting go [s]
    mismatch: Mismatch = "on"
    arm: str = USUAL


class Hand:
    """A simulation in free-drive, and a hand on it.

    Attributes:
        thrown: postures that were thrown away before this one.
        entered: free-drive was entered.
        free: it is still on.
        fall: it ended as all that the joints felt was what a payload that fell would make them feel.
    """

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
        self.fall = False

    def place(self, part: str = "flange") -> Array:
        """True position of a part in W [m]."""
        return self.plant.data.xpos[self.plant.model.body(part).id].copy()

    def rotation(self) -> Array:
        """True orientation of the flange in W."""
        return self.plant.data.xmat[self.plant.model.body("flange").id].reshape(3, 3).copy()

    def tick(self, *touches: Touch) -> Array:
        """One tick; the force (3,) of the first touch, in W [N]."""
        before, self.free = self.free, self.simulation.tick(Wishes(NOTHING, touches, ())).mode is Mode.FREE_DRIVE
        self.fall = self.fall or (before and not self.free and self.simulation.estimate.whose.joints_feel is JointsFeel.FALL)
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
    """Both ways the elbow can go: about the shoulder and, unless it is too near its axis, about the base (k, 3).

    That is within `LEVER`, which goes with the arm's reach as postures do.
    """
    elbow = hand.place("elbow") - np.array([0.0, 0.0, shoulder_height(hand.simulation.arm)])
    round_base = np.cross([0.0, 0.0, 1.0], elbow)
    up = np.cross(round_base, elbow)
    axes = [up / np.linalg.norm(up)]
    if float(np.linalg.norm(round_base)) > LEVER * hand.simulation.arm.reach / REACH:
        axes.append(round_base / np.linalg.norm(round_base))
    return np.array([sign * row for row in axes for sign in (1.0, -1.0)])
