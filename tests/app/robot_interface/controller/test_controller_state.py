"""The controller's words for what the pendant decides: every mode with every safety mode and law."""

from itertools import product

from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.controller_state import RUNTIME, SAFETY, UNLOCK_AFTER, ControllerState
from app.robot_interface.controller.robot_words import (
    SAFETY_BITS,
    ControlMode,
    JointMode,
    RobotMode,
    RuntimeState,
    SafetyMode,
)
from pendant.inputs import Command
from pendant.program.steps import ProgramState
from pendant.tick.modes import TICK_RATE, Law, Mode, Safety
from tests.app.robot_interface.robot_bench import RobotBench
from tests.items import each_of


@each_of(product(Safety, Law, [False, True]))
def test_the_drives_are_off_where_no_safety_stop_has_to_be_unlocked(safety: Safety, law: Law, idle: bool) -> None:
    """Client interfaces: after a protective or a safeguard stop a robot stays RUNNING, and its safety mode tells."""
    state = ControllerState(mode=Mode.STOP, safety=safety, law=law, idle=idle, switched_off=True)
    off = law is Law.OFF and safety in (Safety.NORMAL, Safety.REDUCED, Safety.EMERGENCY_STOP)
    wanted = RobotMode.RUNNING if not off else RobotMode.IDLE if idle else RobotMode.POWER_OFF
    assert state.robot_mode is wanted
    joints = {RobotMode.RUNNING: JointMode.RUNNING, RobotMode.IDLE: JointMode.IDLE, RobotMode.POWER_OFF: JointMode.POWER_OFF}
    assert state.joint_mode is joints[wanted]
    assert state.robot_bits & 1 == (wanted is not RobotMode.POWER_OFF)


def test_every_word_of_the_pendant_has_one_of_the_controller() -> None:
    assert SAFETY.keys() == set(Safety)
    assert RUNTIME.keys() == set(ProgramState)
    assert SAFETY_BITS.keys() == set(SafetyMode)


def test_safety_bits_are_those_of_the_rtde_guide() -> None:
    bits = {safety: ControllerState(safety=safety).safety_bits for safety in Safety}
    assert bits == {
        Safety.NORMAL: 1,
        Safety.REDUCED: 2,
        Safety.PROTECTIVE_STOP: 4 + 1024,
        Safety.SAFEGUARD_STOP: 16 + 1024,
        Safety.EMERGENCY_STOP: 64 + 128 + 1024,
    }
    assert ControllerState(failure="x").safety_bits == 512 + 1024
    assert ControllerState(failure="x").safety_mode is SafetyMode.FAULT


def test_status_bits_tell_program_and_free_drive() -> None:
    assert ControllerState().robot_bits == 1
    assert ControllerState(program_state=ProgramState.RUNNING).robot_bits == 1 + 2
    assert ControllerState(program_state=ProgramState.PAUSED).robot_bits == 1
    assert ControllerState(mode=Mode.FREE_DRIVE).robot_bits == 1 + 4
    assert ControllerState(mode=Mode.FREE_DRIVE).control_mode is ControlMode.TEACH
    assert ControllerState(forcing=True).control_mode is ControlMode.FORCE
    assert ControllerState().control_mode is ControlMode.POSITION
    assert ControllerState(program_state=ProgramState.PAUSED).runtime is RuntimeState.PAUSED


def test_who_has_control_follows_the_pendants_mode_and_stays_where_it_says_nothing() -> None:
    bench = RobotBench()
    state = ControllerState(remote=True)
    decision = bench.step()
    for mode, remote in (
        (Mode.STOP, True), (Mode.RUN, True), (Mode.FREE_DRIVE, True), (Mode.NORMAL, False), (Mode.RUN, False),
        (Mode.STOP, False), (Mode.REMOTE, True), (Mode.TEACH, False),
    ):  # fmt: skip
        whole = {name: getattr(decision, name) for name in decision.__struct_fields__}
        state = state.after(1, type(decision)(**{**whole, "mode": mode}))
        assert state.remote is remote


def test_a_protective_stop_is_locked_for_five_seconds_from_its_beginning() -> None:
    state = ControllerState()
    bench = RobotBench()
    decision = bench.step()
    whole = {name: getattr(decision, name) for name in decision.__struct_fields__}
    stopped = type(decision)(**{**whole, "safety": Safety.PROTECTIVE_STOP, "mode": Mode.STOP})
    for tick in range(100, 100 + int(UNLOCK_AFTER * TICK_RATE)):
        state = state.after(tick, stopped)
        assert state.locked_for > 0.0
    state = state.after(100 + int(UNLOCK_AFTER * TICK_RATE), stopped)
    assert state.locked_for == 0.0
    assert UNLOCK_AFTER == 5.0


def test_idle_ends_when_the_drives_work_again() -> None:
    bench = RobotBench()
    bench.step(60)
    bench.ask(Command.POWER_OFF)
    bench.cabinet.ask(Ask(idle=True))
    bench.step()
    assert bench.cabinet.state.robot_mode is RobotMode.IDLE
    bench.ask(Command.RESET)
    bench.step()
    assert not bench.cabinet.state.idle
    assert bench.cabinet.state.robot_mode is RobotMode.RUNNING


@each_of(product(Safety, Mode, [False, True]))
def test_a_stop_of_the_pendants_is_a_protective_stop_to_clients(safety: Safety, mode: Mode, switched_off: bool) -> None:
    """STOP alone, after a dropped payload or a limit, is left by a reset only: what clients know as a protective stop."""
    state = ControllerState(mode=mode, safety=safety, switched_off=switched_off)
    alone = mode is Mode.STOP and safety in (Safety.NORMAL, Safety.REDUCED) and not switched_off
    assert state.stopped is (alone or safety is Safety.PROTECTIVE_STOP)
    assert (state.safety_mode is SafetyMode.PROTECTIVE_STOP) is state.stopped
