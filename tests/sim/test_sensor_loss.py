"""Joint sensors fail in the middle of things: control goes on with what is left, or the arm comes to rest."""

import numpy as np
import pytest

from pendant.all_settings import FedBackTorque, Settings, apply
from pendant.events.event import Kind
from pendant.program.steps import JointMove
from pendant.tick.modes import Mode
from sim.arm.scenario import Scenario
from sim.estimation.transmission_torque import MOTOR
from sim.plant.changes import SensorFault
from tests.sim.arms import UR5E
from tests.sim.bench import Bench, push

HOME = np.array(UR5E.chain.home)
STEPS = [JointMove(q=tuple(HOME + sign * 0.35), speed=0.3, acceleration=0.5) for sign in (1, -1, 1, -1)]


def lose(bench: Bench, sensor: str, channel: int | None) -> None:
    bench.change(SensorFault(sensor=sensor, channel=channel, outage=True))
    bench.run(0.004)


def missed(bench: Bench) -> float:
    """Largest distance of a joint from its reference [rad]."""
    reference = bench.simulation.controller.references.now
    assert reference is not None
    return float(np.abs(bench.plant.q - reference.q).max())


def pushed(bench: Bench, force: float, seconds: float) -> float:
    """How far a push downwards moves the flange [m]."""
    start, far = bench.flange, 0.0
    for _ in range(round(500 * seconds)):
        bench.run(0.002, push("flange", (0.0, 0.0, -force)))
        far = max(far, float(np.linalg.norm(bench.flange - start)))
    return far


@pytest.mark.parametrize("sensor", ["output_encoder", "current"])
@pytest.mark.parametrize("channel", [1, None])
def test_a_program_goes_on_without_output_encoders_or_currents(sensor: str, channel: int | None) -> None:
    bench = Bench(Scenario(seed=4))
    bench.start(*STEPS)
    bench.run(0.7)
    lose(bench, sensor, channel)
    worst = 0.0
    for _ in range(1000):
        bench.tick()
        worst = max(worst, missed(bench))
    assert bench.mode is Mode.RUN
    assert worst < 0.003
    assert bench.estimate.degraded
    assert not bench.estimate.joints_valid
    lost = [event for event in bench.events if event.kind is Kind.JOINT_SENSOR_LOST]
    assert len(lost) == (6 if channel is None else 1)
    bench.change(SensorFault(sensor=sensor, channel=channel))
    bench.run(0.5)
    assert bench.estimate.joints_valid
    assert bench.estimate.lost == ()
    assert missed(bench) < 0.003


def test_friction_is_not_learned_without_its_current() -> None:
    bench = Bench(Scenario(seed=4))
    bench.plant.wear(slice(None), 1.4)
    bench.start(*STEPS)
    lose(bench, "current", 0)
    terms = bench.simulation.estimator.friction.terms
    before = terms.copy()
    bench.run(2.0)
    assert (terms[0] == before[0]).all()
    assert (terms[1:, 0] != before[1:, 0]).all()
    estimate = bench.estimate
    assert np.isfinite(estimate.tau_ways).all()
    assert estimate.tau_ways[MOTOR, 0] == pytest.approx(estimate.tau_J[0])


@pytest.mark.parametrize("sensor", ["output_encoder", "current", "motor_encoder"])
def test_free_drive_ends_and_is_refused(sensor: str) -> None:
    """Fail closed: it lets an arm go, and so wants to know all of it."""
    bench = Bench(Scenario(seed=4))
    bench.enter()
    bench.run(0.3, push("flange", (0.0, 20.0, 0.0)))
    lose(bench, sensor, 2)
    assert bench.mode is Mode.STOP
    bench.run(1.5)
    assert np.abs(bench.plant.qd).max() < 0.01


@pytest.mark.parametrize("channel", [1, None])
def test_without_a_motor_angle_the_program_stops_and_the_arm_comes_to_rest(channel: int | None) -> None:
    bench = Bench(Scenario(seed=4))
    bench.start(*STEPS)
    bench.run(0.7)
    assert np.abs(bench.plant.qd).max() > 0.25
    lose(bench, "motor_encoder", channel)
    assert bench.mode is Mode.STOP
    bench.run(1.5)
    rest = bench.flange
    assert bench.drift(1.0, rest) < 1e-3
    bench.change(SensorFault(sensor="motor_encoder", channel=channel))
    assert bench.drift(1.0, rest) < 1e-3


def test_a_joint_without_any_angle_stops_all_of_it() -> None:
    bench = Bench(Scenario(seed=4))
    bench.start(*STEPS)
    bench.run(0.7)
    bench.change(
        SensorFault(sensor="motor_encoder", channel=1, outage=True), SensorFault(sensor="output_encoder", channel=1, outage=True)
    )
    bench.run(2.0)
    assert bench.mode is Mode.STOP
    assert not bench.estimate.degraded
    assert np.abs(bench.plant.qd).max() < 0.01


def test_a_held_posture_is_kept_whatever_is_lost() -> None:
    for sensor in ("output_encoder", "current", "motor_encoder"):
        bench = Bench(Scenario(seed=4))
        bench.run(0.3)
        start = bench.flange
        lose(bench, sensor, None)
        assert bench.drift(1.0, start) < 0.5e-3


@pytest.mark.parametrize("sensor", [None, "output_encoder"])
@pytest.mark.parametrize("fed_back", [FedBackTorque.FUSED, FedBackTorque.DEFLECTION, FedBackTorque.MOTOR])
def test_every_torque_fed_back_takes_up_a_push_with_the_deflection_lost_or_not(
    fed_back: FedBackTorque, sensor: str | None
) -> None:
    moved = []
    for on in (True, False):
        use = {"joint_control.fed_back": fed_back.value, "joint_control.torque_feedback": on}
        bench = Bench(Scenario(seed=4), apply(Settings(), use))
        bench.run(0.3)
        if sensor is not None:
            lose(bench, sensor, None)
        moved.append(pushed(bench, 50.0, 0.15))
    assert moved[0] < 0.7 * moved[1]


@pytest.mark.parametrize("held", [True, False])
def test_the_brakes_hold_an_arm_whose_motor_angles_are_lost(held: bool) -> None:
    bench = Bench(Scenario(seed=4))
    if not held:
        bench.start(*STEPS)
    bench.run(0.7)
    lose(bench, "motor_encoder", 1)
    bench.run(1.5)
    assert bench.mode is Mode.STOP
    assert pushed(bench, 80.0, 1.0) < 5e-3
    kinds = [event.kind for event in bench.events]
    assert (Kind.MOTOR_ANGLE_LOST in kinds) or not held


def test_a_gap_of_the_bus_stops_no_held_arm() -> None:
    bench = Bench(Scenario(seed=4))
    bench.run(0.3)
    lose(bench, "motor_encoder", 1)
    bench.run(0.05)
    bench.change(SensorFault(sensor="motor_encoder", channel=1))
    bench.run(0.3)
    assert bench.mode is not Mode.STOP
