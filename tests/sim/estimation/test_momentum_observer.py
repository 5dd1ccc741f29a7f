"""The generalised-momentum observer: against the equations of motion, and against known forces on the true arm."""

from typing import Literal

import numpy as np
import pinocchio as pin
import pytest

from app.files.library import load_arm, load_tool
from pendant.all_settings import Settings
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.tick.modes import TICK
from sim.arm.chain import NOTHING as NO_BODY
from sim.arm.scenario import Load, Scenario
from sim.estimation.momentum_observer import BANDWIDTH, READY, MomentumObserver
from sim.exchange.desk import Wishes
from sim.plant.touch import Push
from sim.simulation import Simulation

ARM, TOOL = load_arm("ur5e"), load_tool("sphere")
IDLE = Wishes(NOTHING, (), ())
NONE, ALL = np.zeros(6), np.ones((3, 6), dtype=bool)


def simulation(true: float = 2.0, mismatch: Literal["on", "nominal"] = "on") -> Simulation:
    """2 kg are configured."""
    load = Load(mass=2.0, com=[0.05, -0.03, 0.06])
    heavy = Load(mass=true, com=load.com)
    return Simulation(
        ARM, Scenario(tool=TOOL, payload_true=heavy, payload_configured=load, seed=3, mismatch=mismatch), Settings()
    )


@pytest.mark.parametrize("with_sensor", [False, True])
def test_an_arm_that_moves_as_its_torques_say_feels_nothing(with_sensor: bool) -> None:
    """Pinocchio's torques of a motion with 20 rad/s²; with the sensor it is told what the load needs, and 30 N·m of a hand."""
    sim = simulation(mismatch="nominal")
    dynamics, load, hand = sim.dynamics, sim.dynamics.load, np.array([30.0, -20.0, 10.0, 3.0, 0.0, 0.0])
    observer, found = MomentumObserver(ARM, dynamics), []
    for k in range(300):
        phase = np.arange(6) + 9.0 * k * TICK
        q, qd, qdd = 0.25 * np.sin(phase), 2.25 * np.cos(phase), -20.25 * np.sin(phase)
        whole = dynamics.inverse(q, qd, qdd)
        dynamics.set_load(NO_BODY)
        bare = dynamics.inverse(q, qd, qdd)
        dynamics.set_load(load)
        dynamics.recursion.run(q, np.stack([q, qd, qdd]), np.zeros(3))
        # J^T w = what of the torque the load takes, in a frame at the flange.
        w = np.linalg.solve(dynamics.recursion.jacobian.T, whole - bare)
        R = dynamics.recursion.R
        wrench = np.concatenate([R.T @ w[:3], R.T @ w[3:]]) if with_sensor else NONE
        touched = hand if k > 150 else NONE
        observer.update(
            (q, whole - touched, NONE, NONE, NONE, NONE, ALL, wrench), with_sensor=with_sensor, valid=True, learn=False
        )
        found.append(observer.residual.copy())
    assert np.abs(np.array(found[2 * READY : 150])).max() < 0.3  # of torques up to 60 N·m: what a tick of 2 ms leaves
    assert found[299] == pytest.approx(hand, abs=0.3)
    lag = 2.0 / (2.0 * np.pi * BANDWIDTH)  # of both filters
    assert np.array(found[151 + round(lag / TICK)])[0] == pytest.approx(0.6 * 30.0, abs=6.0)


def test_momentum_and_its_drive_are_those_of_the_equations_of_motion() -> None:
    """p = M q', and what drives it beside the torques is C^T q' - g; three constant speeds, no torque: p' - drive is left."""
    sim = simulation(mismatch="nominal")
    dynamics = sim.dynamics
    for seed in range(3):
        observer, rng = MomentumObserver(ARM, dynamics), np.random.default_rng(seed)
        q, v = rng.uniform(-2, 2, 6), rng.uniform(-1, 1, 6)
        for _ in range(2):
            dynamics.recursion.run(q, np.stack([q, v, NONE]), np.zeros(3))
            observer.update((q, NONE, NONE, NONE, NONE, NONE, ALL, NONE), with_sensor=False, valid=True, learn=False)
            q = q + TICK * v
        q = q - TICK * v
        own = observer.record[0]
        M = pin.crba(dynamics.model, dynamics.data, q)
        C, g = pin.computeCoriolisMatrix(dynamics.model, dynamics.data, q, v), dynamics.gravity(q)
        assert own["p"] == pytest.approx(M @ v, abs=1e-9)
        assert own["drive"] == pytest.approx(C.T @ v - g, abs=1e-9)


def held(sim: Simulation, ticks: int, wishes: Wishes = IDLE) -> np.ndarray:
    """Mean of the last half."""
    rows = []
    for _ in range(ticks):
        sim.tick(wishes)
        rows.append(sim.estimator.momentum.residual.copy())
    return np.mean(rows[ticks // 2 :], axis=0)


@pytest.mark.parametrize("true", [2.0, 3.5])
def test_a_known_force_on_a_link_turns_the_joints_by_its_lever(true: float) -> None:
    """60 N along y at the elbow of the standing arm, with the payload right and 1.5 kg wrong; sign and size of each joint."""
    sim = simulation(true, mismatch="nominal")
    before = held(sim, 200)
    assert before == pytest.approx(NONE, abs=2.5)  # what the gears' hysteresis leaves
    body = sim.plant.model.body("shoulder").id
    point, force = np.array([-0.425, 0.0, 0.138]), np.array([0.0, 60.0, 0.0])
    p = sim.plant.data.xpos[body] + sim.plant.data.xmat[body].reshape(3, 3) @ point
    rigid = sim.dynamics.recursion
    expected = [rigid.jacobian[3:, i] @ np.cross(p - rigid.origins[i], force) if i < 2 else 0.0 for i in range(6)]
    after = held(sim, 300, Wishes(NOTHING, (Push("shoulder", tuple(point.tolist()), (0.0, 60.0, 0.0)),), ()))
    assert max(map(abs, expected)) > 8.0
    assert after - before == pytest.approx(np.array(expected), abs=0.8)


def moved(sim: Simulation, ticks: int = 1500) -> list[tuple[np.ndarray, ...]]:
    """To and fro at full speed, then torque, causes, shares and misfit of each tick."""
    home = np.array(ARM.chain.home)
    steps = tuple(JointMove(q=tuple((home + way).tolist())) for way in ([1.0, 0.4, -0.6, 1.0, 0.5, 1.0], NONE) * (ticks // 700))
    sim.tick(Wishes(Inputs(program=Program(steps=steps)), (), ()))
    rows = []
    for k in range(ticks):
        sim.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()) if k == 150 else IDLE)
        observer, errors = sim.estimator.momentum, sim.estimator.momentum.errors
        rows.append(tuple(each.copy() for each in (observer.residual, errors.causes, errors.shares, errors.misfit)))
    return rows


def test_a_payload_that_is_wrong_is_no_torque_of_a_link_and_stiffness_is_learned() -> None:
    """2.4 kg where 2 are configured move at full speed: no joint feels as much as a hand, once its gear is known."""
    sim = simulation(2.4)
    residual, causes, shares, misfit = map(np.array, zip(*moved(sim)[200:], strict=True))
    left = residual - np.vecdot(shares[-1], causes)
    smooth = np.array([left[k : k + 10].mean(axis=0) for k in range(0, len(left) - 10, 10)])
    change = np.abs(smooth[15:] - smooth[:-15])  # over 0.3 s
    assert change[:, :3].max() < 8.0
    assert change[:, 3:].max() < 1.5
    assert misfit[-1, 1, 0] < 0.12  # the shoulder is bent most; it was 0.22 at first
    assert abs(shares[-1, 1, 0] - (1.0 / sim.calibration.stiffness[1] - 1.0)) < misfit[-1, 1, 0]


def test_without_deflection_the_motors_torque_is_taken_and_doubted() -> None:
    sim = simulation(mismatch="nominal")
    observer, use = MomentumObserver(ARM, sim.dynamics), ALL.copy()
    use[1, 1] = False
    q, friction, stiction = np.array(ARM.chain.home), np.full(6, 2.0), np.full(6, 4.0)
    gravity = sim.dynamics.gravity(q)
    sim.dynamics.recursion.run(q, np.stack([q, NONE, NONE]), np.zeros(3))
    for _ in range(60):
        driven = (q, gravity, gravity - 7.0, NONE, friction, stiction, use, NONE)
        observer.update(driven, with_sensor=False, valid=True, learn=False)
    assert observer.ready
    assert observer.residual == pytest.approx([0.0, 7.0, 0.0, 0.0, 0.0, 0.0], abs=1e-6)
    assert observer.doubt[1] > 2.0 > 1.5 * observer.doubt[0]
    assert observer.held.tolist() == [0.0, 4.0, 0.0, 0.0, 0.0, 0.0]  # a bound, which is no deviation
    assert observer.errors.causes[1, 0] == pytest.approx(gravity[1])  # a push is no error of its own
    observer.forget()
    assert not observer.ready
