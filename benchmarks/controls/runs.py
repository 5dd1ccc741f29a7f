"""One run of a program under one of the laws that are compared, and its errors against the truth."""

from collections import deque
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from msgspec.structs import replace

from app.files.library import load_arm
from pendant.all_settings import JointControl, Settings
from pendant.decision import Decision
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import JointMove, Program, Wait
from pendant.tick.modes import TICK_RATE, Mode
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load, Scenario
from sim.control.feedback import Feedback
from sim.exchange.desk import Wishes
from sim.motion.references import DELAY
from sim.plant.touch import Push, Touch
from sim.simulation import Simulation

Array = np.ndarray
IDLE = Wishes(NOTHING, (), ())
OURS = JointControl()
FIXED = replace(OURS, adaptive=False)
PD_GRAVITY = replace(OURS, feed_forward=False, friction=False, adaptive=False, torque_feedback=False, q=False)
LAWS = {"ours": OURS, "fixed friction model": FIXED, "PD + gravity": PD_GRAVITY}
PROGRAMS = ("excitation", "pick and place", "slow reversing")
SLOWEST = 0.05  # friction is scored above this speed [rad/s]
Mismatch = Literal["on", "nominal"]
LEARNING, UNLEARNING, SCORED = 10.0, 3.0, 4.0  # before friction that is learned, and that is not, is scored; and how long [s]
FULL_LOAD = Load(mass=5.0, com=[0.0, 0.0, 0.06])


class Case(NamedTuple):
    """One run."""

    program: str
    celsius: float
    payload: bool
    factor: float  # true friction over the filed one
    mismatch: Mismatch
    seed: int
    law: str = "ours"
    bandwidth: float = 12.0  # of the feedback's position loop [Hz]
    stiffness: float = 1.0  # factors on the arm's assumed values
    rotor: float = 1.0


class Result(NamedTuple):
    """Squares of one run, each (n,), and what follows from them."""

    case: Case
    friction: Array  # sum of its errors [N·m]²
    true_friction: Array
    inside: float  # share of samples within the stated uncertainty
    missed: Array  # of each joint's tracking error, RMS and peak (2, n) [mrad]
    torques: Array  # (4, n) mean error of the three ways and the fusion [N·m]²
    running: float  # share of the ticks in RUN

    @property
    def tracking(self) -> float:
        """Tracking error, RMS over all joints [mrad]."""
        return float(np.sqrt(np.mean(self.missed[0] ** 2)))

    @property
    def peak(self) -> float:
        """Largest tracking error [mrad]."""
        return float(self.missed[1].max())


def steps(name: str, arm: Arm, rng: np.random.Generator) -> tuple[JointMove | Wait, ...]:
    """A program of more than any run needs."""
    home = np.array(arm.chain.home)
    if name == "excitation":
        spans = [rng.uniform(-0.6, 0.6, arm.n) for _ in range(30)]
        paces = rng.uniform(0.15, 0.5, 30)
        return tuple(JointMove(q=tuple(home + s), speed=float(p), acceleration=0.5) for s, p in zip(spans, paces, strict=True))
    if name == "slow reversing":
        ends = [home + sign * 0.12 for sign in (1.0, -1.0)]
        return tuple(JointMove(q=tuple(ends[k % 2]), speed=0.05, acceleration=0.1) for k in range(60))
    pick, place = home + np.array([0.5, 0.25, 0.1, -0.35, 0.0, 0.5]), home + np.array([-0.5, 0.25, 0.1, -0.35, 0.0, -0.5])
    up = np.array([0.0, -0.3, 0.1, 0.2, 0.0, 0.0])
    above = [place + up, pick + up]
    cycle = [(above[0], 0.4), (place, 0.15), (above[0], 0.15), (above[1], 0.4), (pick, 0.15), (above[1], 0.15)]
    moves = [JointMove(q=tuple(q), speed=pace, acceleration=0.5) for q, pace in cycle]
    return (*moves[:2], Wait(duration=0.2), *moves[2:5], Wait(duration=0.2), moves[5]) * 6


def begin(case: Case, use: JointControl | None = None) -> Simulation:
    """The arm of a case, its program just started, with the joint control of the case's law or another one."""
    arm = load_arm("ur5e")
    spring, motors = arm.transmissions, arm.motors
    scaled = {name: [case.stiffness * x for x in getattr(spring, name)] for name in ("stiffness", "stiffening")}
    scaled["hysteresis_stiffness"] = [case.stiffness * x for x in spring.hysteresis_stiffness]
    rotor = [case.rotor * x for x in motors.rotor_inertia]
    arm = replace(arm, transmissions=replace(spring, **scaled), motors=replace(motors, rotor_inertia=rotor))
    load = FULL_LOAD if case.payload else Load(mass=0.0)
    scenario = Scenario(seed=case.seed, mismatch=case.mismatch, payload_true=load, payload_configured=load)
    simulation = Simulation(arm, scenario, Settings(joint_control=use or LAWS[case.law]))
    controller, friction = simulation.controller, simulation.plant.friction
    controller.feedback = Feedback(arm, simulation.calibration, simulation.dynamics, simulation.tcp, bandwidth=case.bandwidth)
    rng = np.random.default_rng(case.seed)
    if case.mismatch == "on":
        friction.per_kelvin *= 1.0 + 0.5 * rng.choice([-1.0, 1.0])
        friction.load *= 1.0 + 0.5 * rng.choice([-1.0, 1.0], arm.n)
    friction.factor[:] = case.factor
    simulation.plant.temperature[:] = case.celsius
    simulation.tick(Wishes(Inputs(program=Program(steps=steps(case.program, arm, rng))), (), ()))
    for _ in range(150):
        simulation.tick(IDLE)
    simulation.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))
    return simulation


def run(simulation: Simulation, seconds: float, look: Callable[[Decision], None] | None = None, *touches: Touch) -> None:
    """So many seconds of the program."""
    wishes = Wishes(NOTHING, touches, ())
    for _ in range(round(seconds * TICK_RATE)):
        decision = simulation.tick(wishes)
        if look is not None:
            look(decision)


class Score:
    """Gathers a run's errors, tick by tick."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._truth: deque[tuple[Array, Array, Array]] = deque(maxlen=DELAY + 1)
        self.friction: list[Array] = []
        self.true: list[Array] = []
        self.inside: list[Array] = []
        self.missed: list[Array] = []
        self.torques: list[Array] = []
        self.modes: list[bool] = []

    def look(self, decision: Decision) -> None:
        """Take the last tick."""
        simulation, plant = self._simulation, self._simulation.plant
        self._truth.append((plant.sliding_friction(), np.abs(plant.theta_d) > SLOWEST, plant.tau_J.copy()))
        reference = simulation.controller.references.now
        assert reference is not None
        self.missed.append(plant.q - reference.q)
        self.modes.append(decision.mode is Mode.RUN)
        if len(self._truth) <= DELAY:
            return
        true, moving, tau_J = self._truth[0]
        friction, transmission = simulation.estimator.friction, simulation.estimator.transmission
        error = np.where(moving, friction.total - true, np.nan)
        self.friction.append(error)
        self.true.append(np.where(moving, true, np.nan))
        self.inside.append(np.where(moving, np.abs(error) <= friction.deviation, np.nan))
        self.torques.append(np.vstack([transmission.ways, transmission.fused]) - tau_J)

    def result(self, case: Case) -> Result:
        """All of it."""
        missed = 1000.0 * np.array(self.missed)
        return Result(
            case,
            np.nansum(np.square(self.friction), axis=0),
            np.nansum(np.square(self.true), axis=0),
            float(np.nanmean(self.inside)),
            np.stack([np.sqrt(np.mean(missed**2, axis=0)), np.abs(missed).max(axis=0)]),
            np.mean(np.square(self.torques), axis=0),
            float(np.mean(self.modes)),
        )


def measure_case(case: Case) -> Result:
    """One run, scored after the time to learn."""
    simulation = begin(case)
    run(simulation, LEARNING if case.law == "ours" else UNLEARNING)
    score = Score(simulation)
    run(simulation, SCORED, score.look)
    return score.result(case)


class Step(NamedTuple):
    """One run in which something happens; friction errors relative to the true friction, over all joints."""

    case: Case
    after: float  # 15 to 20 s after all joints got 15 K warmer
    contact: float  # largest change of the friction estimate at 0.2 rad/s by a contact of 50 N for 5 s


def measure_step(case: Case) -> Step:
    """A step of the temperature, then a contact."""
    simulation = begin(case)
    run(simulation, 12.0)
    simulation.plant.temperature += 15.0
    run(simulation, 15.0)
    score = Score(simulation)
    run(simulation, 5.0, score.look)
    recovered = relative([score.result(case)])
    friction = simulation.estimator.friction
    speed, load = np.full(simulation.arm.n, 0.2), np.zeros(simulation.arm.n)
    before = friction.at(speed, load)
    run(simulation, 5.0, None, Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, -50.0)))
    return Step(case, recovered, float(np.abs(friction.at(speed, load) / before - 1.0).max()))


def relative(results: list[Result], joint: int | slice = slice(None)) -> float:
    """RMS of the friction error over RMS of the true friction."""
    error = np.nansum([np.nansum(result.friction[joint]) for result in results])
    return float(np.sqrt(error / np.nansum([np.nansum(result.true_friction[joint]) for result in results])))
