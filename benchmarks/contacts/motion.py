"""Free motion that must stay silent: random programs at full speed, wrong payloads, drift, warm joints, worn friction."""

from typing import NamedTuple

import numpy as np

from app.files.library import load_arm
from benchmarks.contacts.approaches import ARM, IDLE, START, TOOL
from benchmarks.contacts.recording import Recording
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING, Inputs
from pendant.program.steps import JointMove, Program
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import FrictionChange, SensorFault, Temperature
from sim.simulation import Simulation

LOW = np.array([-3.0, -2.7, -2.3, -3.1, -3.1, -3.1])
HIGH = np.array([3.0, -0.4, 2.3, 3.1, 3.1, 3.1])


class Free(NamedTuple):
    """One run."""

    seed: int
    seconds: float
    record: bool  # keep the signals, for the baselines; else only what the detectors found
    arm: str = "ur5e"
    mass: float | None = None  # configured payload; None: drawn [kg]
    soft: bool = False  # the flange sensor's stiffness is the soft one


def program(rng: np.random.Generator, q: np.ndarray, count: int) -> Program:
    """Moves all over the workspace, of the wrist alone, and short ones to and fro."""
    steps = []
    for k in range(count):
        kind = k % 3
        if kind == 0:
            q = rng.uniform(LOW, HIGH)
        else:
            span = np.array([0.0, 0.0, 0.0, 2.0, 2.0, 2.0]) if kind == 1 else np.full(6, 0.4)
            q = np.clip(q + span * rng.uniform(-1, 1, 6), LOW, HIGH)
        speed, acceleration = float(rng.choice([1.0, 1.0, 0.5, 0.1])), float(rng.choice([1.0, 1.0, 0.5]))
        steps.append(JointMove(q=tuple(q.tolist()), speed=speed, acceleration=acceleration))
    return Program(steps=tuple(steps))


def payload(rng: np.random.Generator, seed: int, fixed: float | None = None) -> tuple[Load, Load]:
    """0 to 5 kg, or what is `fixed`, the centre up to 100 mm off the axis, the true mass up to 20 % off."""
    drawn = float(rng.uniform(0.0, 5.0)) if seed % 4 else float(rng.choice([0.0, 5.0]))
    mass = drawn if fixed is None else fixed
    around, far = rng.uniform(0, 2 * np.pi), rng.uniform(0, 0.1)
    com = [float(far * np.cos(around)), float(far * np.sin(around)), float(rng.uniform(0.02, 0.08))]
    return Load(mass=mass, com=com), Load(mass=mass * float(1 + 0.2 * rng.uniform(-1, 1)), com=com)


def free(case: Free) -> Recording:
    """Run one case."""
    rng = np.random.default_rng([case.seed, 77])
    configured, true = payload(rng, case.seed, case.mass)
    arm = ARM if case.arm == "ur5e" else load_arm(case.arm)
    home = np.array(arm.chain.home)
    scenario = Scenario(tool=TOOL, payload_true=true, payload_configured=configured, seed=case.seed, soft_sensor=case.soft)
    simulation = Simulation(arm, scenario, apply(Settings(), {"contact.on": True}))
    simulation.tick(Wishes(Inputs(program=program(rng, home, int(2 * case.seconds))), (), ()))
    for _ in range(150):
        simulation.tick(IDLE)
    recording = Recording()
    changes = (
        FrictionChange(factor=float(rng.uniform(0.8, 1.4))),
        Temperature(celsius=float(rng.uniform(25.0, 60.0))),
        SensorFault(sensor="force_torque", drift=float(rng.uniform(-0.02, 0.02))),
    )
    ticks = int(500 * case.seconds)
    for k in range(ticks):
        wish = START if k == 0 else IDLE
        for j, change in enumerate(changes, 1):
            if k == j * ticks // 4:
                wish = Wishes(NOTHING, (), (change,))
        decision = simulation.tick(wish)
        if case.record:
            recording.add(simulation, decision.contacts)
        else:
            recording.contacts += [(k * 0.002, contact) for contact in decision.contacts]
    return recording
