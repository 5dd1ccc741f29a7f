"""Joint sensors that go and come back: one event each, and what goes on without them."""

from pendant.all_settings import Settings
from pendant.event_table import render
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.limits.validity import joints_ok, motion_ok
from pendant.program.steps import JointMove, Program
from pendant.robot.joint_sensors import JointSensors
from pendant.supervisor import Supervisor
from pendant.tick.modes import Mode
from tests.pendant.estimates import estimate

JOINTS = ("base", "elbow")


def test_each_loss_and_return_is_told_once() -> None:
    sensors, seen = JointSensors(), estimate(7)
    assert sensors.step(seen, JOINTS) == []
    seen.lost = (("output_encoder", 1),)
    (event,) = sensors.step(seen, JOINTS)
    left = "Its angle comes from the motor, its torque from model and motor"
    assert event == Event(Kind.JOINT_SENSOR_LOST, 7, {"sensor": "output encoder", "joint": "elbow", "left": left})
    assert render(event)[0] == "Lost: output encoder of elbow"
    assert sensors.step(seen, JOINTS) == []
    seen.lost = (("output_encoder", 1), ("current", 0))
    (event,) = sensors.step(seen, JOINTS)
    assert render(event)[0] == "Lost: current sensor of base"
    assert "not learned" in render(event)[1]
    seen.lost = (("current", 0),)
    (event,) = sensors.step(seen, JOINTS)
    assert event == Event(Kind.JOINT_SENSOR_BACK, 7, {"sensor": "output encoder", "joint": "elbow"})
    assert render(event)[0] == "Back: output encoder of elbow"


def test_a_motion_goes_on_with_the_motor_angles_but_nothing_else_does() -> None:
    seen = estimate(joints_valid=False).copy()
    assert not motion_ok(seen)
    seen.degraded = True
    assert motion_ok(seen)
    assert not joints_ok(seen)
    seen.q[0] = float("nan")
    assert not motion_ok(seen)


def test_a_program_goes_on_degraded_and_stops_without_a_motor_angle() -> None:
    supervisor = Supervisor(Settings(), 6)
    move = JointMove(q=(0.0,) * 6)
    for _ in range(100):
        supervisor.step(estimate(), NOTHING)
    supervisor.step(estimate(), Inputs(program=Program(steps=(move,))))
    assert supervisor.step(estimate(), Inputs(commands=(Command.START_PROGRAM,))).mode is Mode.RUN
    worse = estimate(joints_valid=False)
    worse.degraded, worse.lost = True, (("current", 2),)
    decision = supervisor.step(worse, NOTHING)
    assert decision.mode is Mode.RUN
    assert [event.kind for event in decision.events] == [Kind.JOINT_SENSOR_LOST]
    worse.degraded = False
    assert supervisor.step(worse, NOTHING).mode is Mode.STOP


def test_a_copy_keeps_what_was_lost() -> None:
    seen = estimate(joints_valid=False).copy()
    seen.degraded, seen.lost = True, (("current", 2),)
    kept = seen.copy()
    seen.degraded, seen.lost = False, ()
    seen.q[:] = 1.0
    assert kept.degraded
    assert kept.lost == (("current", 2),)
    assert (kept.q == 0.0).all()
    assert kept.theta_dd.size == 0
