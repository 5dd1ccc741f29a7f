"""Friction learned while the arm works, and what passes through the gears: against the truth of the plant."""

import numpy as np
import pytest

from pendant.all_settings import FrictionFrom, Settings, apply
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import JointMove, Program
from sim.arm.scenario import Scenario
from sim.estimation.adaptive_friction import AdaptiveFriction, Turning, rub
from sim.estimation.joint_tracking import joint_record, surplus
from sim.estimation.transmission_torque import TransmissionTorque
from sim.exchange.desk import Wishes
from sim.plant.changes import SensorFault
from sim.plant.touch import Push
from sim.simulation import Simulation
from tests.sim.arms import UR5E

IDLE = Wishes(NOTHING, (), ())
HOME = np.array(UR5E.chain.home)


def running(
    wear: float,
    mismatch: str = "on",
    speed: float = 0.3,
    *,
    helped: bool = True,
    learned_from: FrictionFrom = FrictionFrom.DYNAMICS,
) -> Simulation:
    """A UR5e that moves to and fro by a program, its friction `wear` times what its file says, and fed forward if `helped`."""
    settings = apply(Settings(), {"joint_control.friction": helped, "joint_control.friction_from": learned_from.value})
    simulation = Simulation(UR5E, Scenario(seed=1003, mismatch=mismatch), settings)
    simulation.plant.wear(slice(None), wear)
    steps = tuple(JointMove(q=tuple(HOME + sign * 0.35), speed=speed, acceleration=0.5) for sign in (1.0, -1.0) * 12)
    simulation.tick(Wishes(Inputs(program=Program(steps=steps)), (), ()))
    for _ in range(150):
        simulation.tick(IDLE)
    simulation.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))
    return simulation


def true_friction(simulation: Simulation) -> np.ndarray:
    """Friction of both sides (n,), with the sign of the speed [N·m]."""
    plant = simulation.plant
    total = np.zeros(6)
    for i, name in enumerate(UR5E.chain.joints):
        inner, outer = plant.model.actuator(f"friction/theta/{name}").id, plant.model.actuator(f"friction/q/{name}").id
        total[i] = -plant.data.actuator_force[inner] - plant.data.actuator_force[outer]
        total[i] += plant.model.actuator_damping[outer] * plant.qd[i]
    return total


@pytest.mark.parametrize("wear", [0.6, 1.4])
def test_friction_is_learned_within_seconds_and_within_its_own_uncertainty(wear: float) -> None:
    simulation = running(wear)
    for _ in range(3000):
        simulation.tick(IDLE)
    error, truth, inside = [], [], []
    for _ in range(1500):
        simulation.tick(IDLE)
        friction, true = simulation.estimator.friction, true_friction(simulation)
        moving = np.abs(simulation.plant.theta_d) > 0.05
        error.append(np.where(moving, friction.total - true, np.nan))
        truth.append(np.where(moving, true, np.nan))
        inside.append(np.where(moving, np.abs(friction.total - true) <= friction.deviation, np.nan))
    ratio = np.sqrt(np.nanmean(np.square(error), axis=0) / np.nanmean(np.square(truth), axis=0))
    assert (ratio < 0.2).all(), ratio
    assert np.nanmean(inside) >= 0.9


def test_tracking_is_finer_with_the_estimate_than_without() -> None:
    errors = []
    for helped in (True, False):
        simulation = running(1.2, helped=helped)
        missed = []
        for tick in range(3500):
            simulation.tick(IDLE)
            reference = simulation.controller.references.now
            assert reference is not None
            if tick >= 2000:
                missed.append(simulation.plant.q - reference.q)
        errors.append(np.sqrt(np.mean(np.square(missed))))
    assert errors[0] < 0.5 * errors[1], errors
    assert errors[0] < 0.0005, "rad, root mean square"


def test_a_contact_is_never_learned_as_friction() -> None:
    simulation = running(1.0, speed=0.06)
    for _ in range(3000):
        simulation.tick(IDLE)
    friction, speed, load = simulation.estimator.friction, np.full(6, 0.2), np.zeros(6)
    before = friction.at(speed, load)
    for _ in range(2500):
        simulation.tick(Wishes(NOTHING, (Push("wrist_1", (0.0, 0.0, 0.0), (0.0, 0.0, -50.0)),), ()))
    assert simulation.estimator.transmission.contact
    assert np.abs(friction.at(speed, load) / before - 1.0).max() < 0.05


def test_what_the_motor_spends_beyond_what_bends_the_gear_rubs() -> None:
    """tau_m - J theta_dd - tau_deflection is the friction of the input side (AF-2); by hand, for one joint of the six."""
    friction, transmission = AdaptiveFriction(UR5E), TransmissionTorque(UR5E, np.ones(6))
    joints = joint_record(6)
    own = joints[0]
    own["tau_m"], own["rotor"], own["deflection"] = 30.0, 2.0, 20.0
    own["theta"][2] = 1.5
    transmission.stiffer[0], transmission.offset[0] = 0.1, -0.5
    surplus(joints, np.full(6, 15.0), friction.record, transmission.record)
    assert own["surplus"][0] == pytest.approx(30.0 - 2.0 * 1.5 - 15.0)
    assert own["bending"][0] == pytest.approx(20.0 * 1.1 - 0.5)
    assert own["rubbing"][0] == pytest.approx((30.0 - 2.0 * 1.5 - 21.5) / (1.0 - friction.output_share))
    assert own["rubbing"][1] == pytest.approx((30.0 - 2.0 * 1.5 - 20.0) / (1.0 - friction.output_share))


def test_friction_by_the_deflection_is_learned_in_contact_and_by_the_model_where_an_encoder_is_lost() -> None:
    """AF-2; with an output encoder lost nothing is made up of the angle that is."""
    learned = []
    for lost in (False, True):
        simulation = running(1.0, mismatch="on", learned_from=FrictionFrom.DEFLECTION)
        if lost:
            simulation.tick(Wishes(NOTHING, (), (SensorFault(sensor="output_encoder", outage=True),)))
        push = Wishes(NOTHING, (Push("wrist_1", (0.0, 0.0, 0.0), (0.0, 0.0, -60.0)),), ())
        for _ in range(200):
            simulation.tick(push)
        before = simulation.estimator.friction.terms.copy()
        for _ in range(50):
            simulation.tick(push)
        assert simulation.estimator.transmission.contact
        assert np.isfinite(simulation.estimator.friction.total).all()
        learned.append(not np.array_equal(before, simulation.estimator.friction.terms))
    assert learned == [True, False]


def test_nothing_is_learned_at_rest_and_friction_never_drives() -> None:
    friction = AdaptiveFriction(UR5E)
    before = friction.terms.copy()
    loads, warm = np.full(6, 20.0), np.full(6, 44.0)
    for _ in range(500):
        rub(friction.record, Turning(np.full(6, 0.01), np.full(6, 30.0), loads, loads), warm, True)
    assert np.array_equal(friction.terms, before)
    for _ in range(5000):
        rub(friction.record, Turning(np.full(6, 0.5), np.full(6, -50.0), np.zeros(6), loads), warm, True)
    assert (friction.terms[:, :4] >= 0.0).all()
    assert (friction.total >= 0.0).all()


def test_the_prior_is_the_filed_curve_and_falls_with_temperature() -> None:
    friction = AdaptiveFriction(UR5E)
    still = np.zeros(6)
    rub(friction.record, Turning(np.full(6, 0.5), still, still, still), np.full(6, 44.0), False)
    filed = [row[1] for row in UR5E.frictions.torque]
    assert np.allclose(friction.total, filed, rtol=0.06), "its terms follow a root of the speed to a few percent"
    cold = friction.total.copy()
    rub(friction.record, Turning(np.full(6, 0.5), still, still, still), np.full(6, 54.0), False)
    assert np.allclose(friction.total / cold, 1.0 + 10.0 * UR5E.frictions.per_kelvin)
    rub(friction.record, Turning(np.full(6, -0.5), still, still, still), np.full(6, 54.0), False)
    assert (friction.total < 0.0).all()
