"""The cabinet in the loop: clients' wishes come into ticks, and control stays with whoever has it."""

import numpy as np
import pytest

from app.files.library import load_tool
from app.robot_interface.controller.cabinet import MOST_DRIVES
from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.robot_words import RobotMode, SafetyMode
from app.robot_interface.controller.status_fields import (
    FREE_DRIVE,
    PHASE,
    PHASES,
    REFUSED,
    REMAINING,
    RUNNING_OUT,
    TRYING,
    set_outputs,
)
from app.session.actions import DigitalInput, Laboratory, Press, Pushing, Release, Tap
from pendant.events.event import Event, Kind
from pendant.inputs import Command
from pendant.program.steps import JointMove, Program, SetOutput
from pendant.tick.modes import TICK, Law, Mode, Phase, Safety
from sim.arm.scenario import Scenario
from sim.plant.changes import DriveGripper, DropPayload
from tests.app.robot_interface.robot_bench import RobotBench
from tests.sim.arms import UR5E


def test_a_robot_that_is_served_begins_in_remote_control() -> None:
    bench = RobotBench()
    assert bench.step().mode is Mode.REMOTE
    assert bench.cabinet.state.remote


def test_a_wish_is_done_in_the_next_tick_and_answered_with_what_happened() -> None:
    bench = RobotBench()
    bench.step(60)
    events = bench.ask(Command.EMERGENCY_STOP)
    assert [event.kind for event in events] == [Kind.EMERGENCY_STOP]
    assert events[0].tick == bench.simulation.tick_count == 61


def test_a_wish_that_is_withdrawn_is_not_done() -> None:
    bench = RobotBench()
    bench.step(60)
    done = bench.cabinet.ask(Ask((Command.EMERGENCY_STOP,)))
    assert done.cancel()
    assert bench.step().mode is Mode.REMOTE


def test_wishes_of_one_tick_come_together_and_the_last_program_counts() -> None:
    bench = RobotBench()
    bench.step(60)
    for name in ("first", "second"):
        bench.cabinet.ask(Ask(program=Program(name=name, steps=(JointMove(q=(0.0,) * 6),))))
    bench.cabinet.ask(Ask(settings={"program.speed": 0.5}))
    bench.cabinet.ask(Ask(settings={"free_drive.period": 7.0}))
    decision = bench.step()
    assert bench.cabinet.state.program == "second"
    assert decision.speed == 0.5
    assert bench.simulation.settings.free_drive.period == 7.0


def test_a_reset_takes_nobodys_control() -> None:
    bench = RobotBench()
    bench.step(60)
    bench.ask(Command.EMERGENCY_STOP)
    bench.step(60)
    bench.page(Command.RESET)
    bench.step()
    assert (bench.step().mode, bench.cabinet.state.remote) == (Mode.REMOTE, True)
    bench.page(Command.TEACH)
    bench.ask(Command.EMERGENCY_STOP)
    bench.step(60)
    bench.page(Command.RESET)
    assert (bench.step(2).mode, bench.cabinet.state.remote) == (Mode.TEACH, False)


def test_the_clock_never_goes_back_and_who_has_control_keeps_it_through_a_restart() -> None:
    bench = RobotBench()
    bench.step(100)
    before = bench.cabinet.clock
    bench.begin()
    bench.step()
    assert bench.cabinet.clock == pytest.approx(before + TICK)
    assert bench.cabinet.record.get("timestamp") == bench.cabinet.clock
    assert bench.cabinet.state.tick == 1
    assert bench.cabinet.state.mode is Mode.REMOTE
    bench.page(Command.TEACH)
    bench.begin()
    assert bench.step(3).mode is Mode.TEACH


def test_listeners_are_told_every_tick_once_and_no_more_when_they_leave() -> None:
    bench = RobotBench()
    bench.step(5)
    assert bench.watcher.ticks == [1, 2, 3, 4, 5]
    assert [event.kind for event in bench.watcher.events] == [Kind.MODE_CHANGED]
    bench.cabinet.repeat()
    assert bench.watcher.ticks[-1] == -1
    bench.cabinet.forget(bench.watcher)
    bench.step()
    assert len(bench.watcher.ticks) == 6


def test_faults_act_in_the_very_tick_that_was_asked_for() -> None:
    bench = RobotBench()
    bench.step(137)
    begun = bench.cabinet.act([Tap(at=0.0, control="safeguard_open"), Tap(at=0.1, control="emergency_stop")])
    assert not begun.done()
    bench.step(100)
    assert begun.result() == 137
    ticks = {event.kind: event.tick for event in bench.events}
    assert (ticks[Kind.SAFEGUARD_STOP], ticks[Kind.EMERGENCY_STOP]) == (138, 137 + 50)


def test_faults_of_several_requests_go_on_beside_each_other() -> None:
    bench = RobotBench()
    bench.step(60)
    bench.page(Command.TEACH)
    bench.cabinet.act([Press(at=0.0, control="free_drive"), DigitalInput(at=0.0, input=3, high=True)])
    bench.step(10)
    assert bench.cabinet.record.get("actual_digital_input_bits") == 8
    bench.cabinet.act([DigitalInput(at=0.0, input=3, high=False), Release(at=0.02, control="free_drive")])
    bench.step(5)
    assert bench.cabinet.state.phase is Phase.ACTIVATION
    assert bench.cabinet.record.get("actual_digital_input_bits") == 0
    bench.step(10)
    assert bench.cabinet.state.phase is Phase.OFF


def test_faults_of_before_are_over_with_a_restart() -> None:
    bench = RobotBench()
    bench.step(10)
    bench.cabinet.act([Tap(at=1.0, control="emergency_stop")])
    bench.begin()
    bench.step(600)
    assert Kind.EMERGENCY_STOP not in bench.kinds()


def test_free_drive_of_the_remote_controller_is_tried_entered_and_ended_by_its_silence() -> None:
    bench = RobotBench(free_drive__period=30.0)
    bench.step(60)
    get = bench.cabinet.record.get
    bench.cabinet.free_drive_until = bench.cabinet.ticks + 1200
    bench.step(100)
    assert (get(TRYING), get(FREE_DRIVE), get(PHASE)) == (1, 0, PHASES.index(Phase.ACTIVATION))
    assert get(REMAINING) == pytest.approx((500 - 99) * TICK, abs=2 * TICK)
    bench.step(1000)
    assert (get(TRYING), get(FREE_DRIVE), get(RUNNING_OUT)) == (0, 1, 1)
    assert bench.cabinet.state.mode is Mode.FREE_DRIVE
    bench.step(150)
    assert bench.cabinet.state.mode is Mode.REMOTE
    assert Kind.DEACTIVATED in bench.kinds()
    assert get(FREE_DRIVE) == 0


def test_a_wrong_payload_is_refused_and_told() -> None:
    bench = RobotBench(true=2.0, configured=0.0)
    bench.step(60)
    bench.cabinet.free_drive_until = bench.cabinet.ticks + 2000
    bench.step(1500)
    assert Kind.REFUSED_PAYLOAD in bench.kinds()
    assert bench.cabinet.record.get(REFUSED) == 1
    assert "kg" in bench.cabinet.state.refusal


def test_a_dropped_payload_is_a_change_of_the_true_arm_alone() -> None:
    bench = RobotBench(true=2.0, configured=2.0)
    bench.step(60)
    bench.cabinet.act([Laboratory(at=0.0, change=DropPayload())])
    bench.step(2)
    assert bench.simulation.snapshot().truth_payload_mass == 0.0
    assert bench.cabinet.record.get("payload") == 2.0


def test_power_off_brakes_and_brake_release_are_told_as_a_controller_does() -> None:
    bench = RobotBench()
    bench.step(60)
    bench.ask(Command.POWER_OFF)
    assert bench.cabinet.state.robot_mode is RobotMode.POWER_OFF
    assert bench.cabinet.record.get("robot_mode") == 3
    assert bench.step().law is Law.OFF
    bench.ask(Command.RESET)
    assert bench.cabinet.record.get("robot_mode") == 7


def test_nothing_simulated_is_a_fault_that_is_still_told() -> None:
    bench = RobotBench()
    bench.step(10)
    bench.cabinet.note(Event(Kind.BROKEN_DOWN, 10, {"reason": "it broke"}))
    assert bench.watcher.events[-1].kind is Kind.BROKEN_DOWN
    assert bench.cabinet.state.failure == "it broke"
    bench.cabinet.repeat()
    assert bench.cabinet.record.get("safety_mode") == SafetyMode.FAULT
    assert bench.watcher.ticks[-1] == -1


def test_poses_forces_and_speeds_are_those_of_the_estimate() -> None:
    """Forward kinematics by the chain's own frames; the force is that on the robot, in axes of the base."""
    bench = RobotBench(true=1.0, configured=1.0)
    bench.step(200)
    get, estimate = bench.cabinet.record.get, bench.simulation.estimate
    assert get("actual_q") == estimate.q.tolist()
    assert get("target_q") == pytest.approx(UR5E.chain.home, abs=1e-3)
    x, y, z, *turn = get("actual_TCP_pose")  # type: ignore[misc]
    assert (x, y, z) == pytest.approx(estimate.p_BF.tolist(), abs=1e-12)
    angle = float(np.linalg.norm(turn))
    axis = np.array(turn) / angle
    assert estimate.R_BF @ axis == pytest.approx(axis, abs=1e-9)  # what a rotation turns about stays
    assert 1.0 + 2.0 * np.cos(angle) == pytest.approx(float(np.trace(estimate.R_BF)), abs=1e-9)
    assert get("actual_TCP_force")[:3] == pytest.approx(estimate.F_user[:3].tolist())  # type: ignore[index]
    assert get("ft_raw_wrench") == pytest.approx((-estimate.w_sensor).tolist())
    assert get("ft_raw_wrench")[2] == pytest.approx(9.81, abs=3.0)  # type: ignore[index]  # z of F points down, and 1 kg pulls
    assert get("payload") == 1.0
    assert get("payload_cog") == [0.0, 0.0, 0.05]


def test_a_push_is_told_with_its_sign() -> None:
    bench = RobotBench()
    bench.step(100)
    before = np.array(bench.cabinet.record.get("actual_TCP_force"))
    bench.cabinet.act([Pushing(at=0.0, length=0.5, force=[0.0, 20.0, 0.0])])
    bench.step(200)
    change = np.array(bench.cabinet.record.get("actual_TCP_force")) - before
    assert change[:3] == pytest.approx([0.0, 20.0, 0.0], abs=2.0)
    assert bench.cabinet.record.get("tcp_force_scalar") == pytest.approx(20.0, abs=4.0)


@pytest.mark.parametrize(
    ("command", "safety"), [(Command.SAFEGUARD_OPEN, Safety.SAFEGUARD_STOP), (Command.REDUCED_ON, Safety.REDUCED)]
)
def test_levels_of_the_safety_inputs_are_told(command: Command, safety: Safety) -> None:
    bench = RobotBench()
    bench.step(60)
    bench.page(command)
    assert bench.cabinet.state.safety is safety
    assert bench.cabinet.record.get("safety_mode") == {Safety.SAFEGUARD_STOP: 5, Safety.REDUCED: 2}[safety]


def gripping() -> RobotBench:
    return RobotBench(scenario=Scenario(mismatch="nominal", tool=load_tool("two-finger")))


def test_outputs_of_before_are_low_and_close_no_gripper_after_a_restart() -> None:
    bench = gripping()
    bench.step(10)
    set_outputs(bench.cabinet.record, 0x3FFFF, 0x20101)
    bench.step()
    assert bench.cabinet.gripper is not None
    assert bench.cabinet.gripper.closing, "output 0 closes it"
    bench.begin()
    bench.step(5)
    assert bench.cabinet.record.get("actual_digital_output_bits") == 0
    assert bench.cabinet.record.get("actual_configurable_digital_output_bits") == 0
    assert not bench.cabinet.gripper.closing


def test_of_orders_to_a_gripper_that_is_not_simulated_the_last_ones_wait() -> None:
    bench = gripping()
    bench.step(10)
    for k in range(10 * MOST_DRIVES):
        bench.cabinet.drive(DriveGripper(force=20.0 + 0.1 * k))
    changes = bench.cabinet.wishes(11, bench.simulation.snapshot).changes
    assert changes == tuple(DriveGripper(force=20.0 + 0.1 * k) for k in range(9 * MOST_DRIVES, 10 * MOST_DRIVES))


def test_outputs_that_a_program_switches_stand_in_the_image_beside_those_of_clients() -> None:
    bench = RobotBench()
    bench.step(60)
    set_outputs(bench.cabinet.record, 0x0F, 0x05)
    steps = (SetOutput(output=1, on=True), SetOutput(output=0, on=True), SetOutput(output=0, on=False))
    bench.cabinet.ask(Ask((Command.START_REMOTELY,), program=Program(steps=steps)))
    seen = [(bench.step(), bench.cabinet.record.get("actual_digital_output_bits"))[1] for _ in range(6)]
    assert seen[0] == 0x05
    assert seen[-1] == 0x06
