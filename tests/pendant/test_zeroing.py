"""The sensor's zero in the running robot: every state x the command, the program's step, and who must not notice it."""

from collections.abc import Callable

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.equipment.load import Load
from pendant.event_table import render
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.limits.validity import WINDOW
from pendant.program.sequencer import PATIENCE
from pendant.program.steps import ApplyForce, JointMove, Program, ProgramState, SwitchTool, Wait, ZeroSensor
from pendant.sensor.taring import WINDOWS
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase, Safety
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import Wrench
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO
from tests.pendant.telling import whole

ZERO = Inputs(commands=(Command.ZERO_SENSOR,))
READY = (WINDOWS + 2) * WINDOW
"""Ticks after which the arm has stood for long enough, whatever moved it before: it counts as still 50 ticks later."""

TORN = "more than on the untouched arm: let go of it"
OFFSET = (1.0, -2.0, 2.0, 0.01, 0.02, -0.03)
"""F_user of the untouched arm, axes of F, which are those of B."""


def command(*commands: Command) -> Inputs:
    return Inputs(commands=commands)


class Robot:
    """A supervisor whose sensor obeys its zero, from the next tick on."""

    def __init__(self, *steps: Wait | ZeroSensor | JointMove | ApplyForce | SwitchTool, **changes: float | bool) -> None:
        names = {name.replace("__", "."): value for name, value in {"sequence__on": False, **changes}.items()}
        self.supervisor = Supervisor(apply(Settings(), names), 6)
        self.tick, self.offset, self.events = 0, np.array(OFFSET), list[Event]()
        self.qd, self.valid, self.done = 0.0, True, 0
        self.decision = self.supervisor.step(self.value(), NOTHING)
        if steps:
            self.run(1, Inputs(program=Program(name="p", steps=steps)))
        self.run(READY)

    def value(self) -> Estimate:
        value = estimate(self.tick, qd=self.qd, wrench_valid=self.valid)
        value.F_user = self.offset + np.array(self.supervisor.zero) if self.valid else np.zeros(6)
        return value

    def run(self, ticks: int, inputs: Inputs = NOTHING) -> "Robot":
        for _ in range(ticks):
            self.tick += 1
            self.decision = self.supervisor.step(self.value(), inputs, MotionStatus(self.done))
            self.events += whole(self.decision.events, self.tick)
        return self

    def zero(self) -> str:
        """Why not, or "" where it was done."""
        before = self.decision.estimator.zero
        self.events.clear()
        self.run(1, ZERO)
        (told,) = [event for event in self.events if event.kind in (Kind.SENSOR_ZEROED, Kind.ZERO_REFUSED)]
        if told.kind is Kind.SENSOR_ZEROED:
            assert self.decision.estimator.zero == pytest.approx([-each for each in OFFSET])
            assert self.run(1).value().F_user == pytest.approx(np.zeros(6))
            return ""
        assert self.decision.estimator.zero is before
        return str(told.values["reason"])

    def kinds(self) -> list[Kind]:
        return [event.kind for event in self.events]


def held(robot: Robot) -> Robot:
    return robot.run(600, HOLD)


def free(robot: Robot) -> Robot:
    robot.run(600, HOLD).run(1, LET_GO)
    assert robot.decision.phase is Phase.PERIOD
    return robot


def refused(robot: Robot) -> Robot:
    """A check that an offset fails."""
    robot.run(700, HOLD).run(1, LET_GO)
    assert Kind.REFUSED_PAYLOAD in robot.kinds()
    return robot


def paused(robot: Robot) -> Robot:
    robot.run(1, command(Command.START_PROGRAM)).run(5).run(1, command(Command.PAUSE_PROGRAM)).run(5)
    assert robot.decision.program is ProgramState.PAUSED
    return robot


MODES: dict[str, tuple[Callable[[], Robot], str]] = {
    "TEACH": (Robot, ""),
    "NORMAL": (lambda: Robot().run(1, command(Command.NORMAL)), ""),
    "REMOTE": (lambda: Robot().run(1, command(Command.REMOTE)), ""),
    "RUN": (lambda: Robot(Wait(duration=9.0)).run(1, command(Command.START_PROGRAM)), "a program runs: pause or stop it first"),
    "RUN moving": (
        lambda: Robot(JointMove(q=(0.1,) * 6)).run(1, command(Command.START_PROGRAM)),
        "a program runs: pause or stop it first",
    ),
    "RUN paused": (lambda: paused(Robot(Wait(duration=9.0))), ""),
    "program stopped": (lambda: paused(Robot(Wait(duration=9.0))).run(1, command(Command.STOP_PROGRAM)), ""),
    "emergency stop": (lambda: Robot().run(1, command(Command.EMERGENCY_STOP)), ""),
    "safeguard stop": (lambda: Robot().run(1, command(Command.SAFEGUARD_OPEN)), ""),
    "reduced": (lambda: Robot().run(1, command(Command.REDUCED_ON)), ""),
    "activation": (lambda: Robot().run(100, HOLD), "free-drive is being tried"),
    "sequence": (lambda: Robot(sequence__on=True).run(501, HOLD), "free-drive is being tried"),
    "held": (lambda: held(Robot()), "free-drive is on"),
    "period": (lambda: free(Robot()), "free-drive is on"),
    "left": (lambda: free(Robot()).run(1, command(Command.LEAVE_FREE_DRIVE)), "the arm must stand untouched for 1.1 s: wait"),
}


@pytest.mark.parametrize("name", MODES)
def test_in_every_state_it_is_done_or_refused_with_the_reason(name: str) -> None:
    make, why_not = MODES[name]
    assert make().zero() == why_not


def test_the_states_are_all_there_are() -> None:
    robots = [make() for make, _ in MODES.values()]
    assert {robot.decision.mode for robot in robots} == set(Mode)
    assert {robot.decision.safety for robot in robots} >= {Safety.NORMAL, Safety.REDUCED, Safety.EMERGENCY_STOP}


def test_an_arm_that_moves_is_refused_and_has_to_stand_for_a_second_afterwards() -> None:
    robot = Robot()
    robot.qd = 0.02
    assert robot.zero() == "the arm moves"
    robot.qd = 0.0
    assert robot.run(WINDOW - 2).zero() == "the arm moves"
    for _ in range(WINDOWS - 1):
        assert robot.run(WINDOW - 1).zero() == "the arm must stand untouched for 1.1 s: wait"
    assert robot.run(WINDOW - 2).zero() == "the arm must stand untouched for 1.1 s: wait"
    assert robot.zero() == ""


def test_without_a_valid_sensor_it_is_refused() -> None:
    robot = Robot()
    robot.valid = False
    assert robot.zero() == "the flange force sensor is not valid"
    robot.valid = True
    assert "must stand untouched" in robot.zero()
    assert robot.run(READY).zero() == ""


def test_while_the_payload_changes_it_is_refused() -> None:
    robot = Robot().run(1, Inputs(load=Load(mass=1.0)))
    assert robot.zero() == "the payload is being changed"
    robot.run(500 + WINDOW)
    assert "must stand untouched" in robot.zero(), "what the arm feels with this payload is learned again"
    assert robot.run(READY).zero() == ""


def test_while_a_posture_is_measured_it_is_refused() -> None:
    robot = Robot().run(1, command(Command.WIZARD_MEASURE))
    assert robot.zero() == "the payload is being measured"
    assert robot.run(READY).zero() == ""


def test_while_haptic_feedback_shakes_the_arm_it_is_refused() -> None:
    robot = free(Robot(haptics__on=True)).run(1, command(Command.LEAVE_FREE_DRIVE))
    robot.run(1)
    assert robot.decision.shake is not None
    assert robot.zero() == "haptic feedback shakes the arm"
    assert robot.run(READY + 500).zero() == ""


@pytest.mark.parametrize("size", [5.0, 30.0])
def test_a_hand_that_rests_on_the_arm_is_refused_however_it_came(size: float) -> None:
    robot = Robot()
    robot.offset[1] += size
    assert robot.run(READY).zero() == f"{size:.1f} N {TORN}"
    free(robot).run(1, command(Command.LEAVE_FREE_DRIVE))
    assert TORN in robot.run(READY).zero(), "also after it has guided the arm"
    robot.offset[1] -= size
    assert robot.run(READY).zero() == ""


def test_no_push_and_no_signal_is_felt_and_no_mode_changes() -> None:
    robot = Robot(signals__push__on=True, signals__push__reported=True, signals__push__threshold=5.0)
    robot.valid = False
    robot.run(1)
    robot.valid, robot.offset[:] = True, (4.0, -4.0, 4.0, 0.0, 0.0, 0.0)
    robot.run(READY).events.clear()
    mode = robot.decision.mode
    robot.run(1, ZERO).run(1000)
    assert robot.kinds() == [Kind.SENSOR_ZEROED]
    assert robot.decision.mode is mode
    robot.offset[2] -= 8.0
    robot.run(100)
    assert Kind.PUSHED in robot.kinds(), "a hand is felt as before"


def test_a_stored_state_is_of_the_sensor_before() -> None:
    robot = Robot(sequence__on=True, sequence__stored=True, sequence__age=2.0, activation__period=0.0)
    robot.run(1000)
    assert robot.zero() == ""
    robot.run(500).run(1, HOLD)
    assert robot.kinds()[-1] is Kind.REFUSED_NOT_STORED
    assert (
        Robot(sequence__on=True, sequence__stored=True, sequence__age=2.0).run(1000).run(510, HOLD).kinds()[-1]
        is not Kind.REFUSED_NOT_STORED
    )


def test_a_refusal_is_not_told_to_have_been_a_push_when_the_sensor_is_zeroed() -> None:
    robot = Robot(sequence__on=True, limits__activation__payload_force__max=1.5)
    refused(robot)
    robot.run(620)
    assert robot.zero() == ""
    robot.run(1500)
    assert robot.kinds() == [Kind.SENSOR_ZEROED]


def test_postures_of_the_wizard_are_as_if_measured_with_the_new_zero() -> None:
    robot = Robot()
    robot.run(1, command(Command.WIZARD_MEASURE)).run(READY)
    wizard = robot.supervisor._tooling.wizard
    (before,) = wizard._postures
    assert robot.zero() == ""
    (after,) = wizard._postures
    assert np.subtract(after.force, before.force) == pytest.approx(OFFSET[:3])
    assert np.subtract(after.torque, before.torque) == pytest.approx(OFFSET[3:])


def run_program(*steps: Wait | ZeroSensor | JointMove | ApplyForce | SwitchTool) -> Robot:
    robot = Robot(*steps)
    robot.events.clear()
    return robot.run(1, command(Command.START_PROGRAM))


def test_a_step_zeroes_the_sensor_at_once_where_the_arm_has_stood() -> None:
    robot = run_program(ZeroSensor(), SwitchTool(on=True))
    assert robot.kinds() == [Kind.PROGRAM_STARTED, Kind.SENSOR_ZEROED]
    assert robot.decision.estimator.zero == pytest.approx([-each for each in OFFSET])
    robot.run(1)
    assert robot.kinds()[2:] == [Kind.TOOL_SWITCHED, Kind.PROGRAM_FINISHED]


def test_as_the_last_step_it_ends_the_program() -> None:
    robot = run_program(ZeroSensor())
    assert robot.kinds() == [Kind.PROGRAM_STARTED, Kind.SENSOR_ZEROED, Kind.PROGRAM_FINISHED]
    assert (robot.decision.mode, robot.decision.program) == (Mode.TEACH, ProgramState.STOPPED)


def test_after_a_motion_it_waits_until_the_arm_has_stood_for_a_second() -> None:
    robot = run_program(JointMove(q=(0.1,) * 6), ZeroSensor(), Wait(duration=0.02))
    robot.qd = 0.3
    robot.run(300)
    robot.qd, robot.done = 0.0, 1
    robot.run(1)
    begun = robot.tick
    while Kind.SENSOR_ZEROED not in robot.kinds():
        robot.run(1)
    assert WINDOWS * WINDOW <= robot.tick - begun <= READY
    robot.run(9)
    assert robot.decision.program is ProgramState.RUNNING, "the wait lasts as long as it should"
    assert robot.run(2).kinds()[-1] is Kind.PROGRAM_FINISHED


def test_a_wait_is_time_in_which_the_arm_stands() -> None:
    robot = run_program(JointMove(q=(0.1,) * 6), Wait(duration=2.0), ZeroSensor())
    robot.qd = 0.3
    robot.run(300)
    robot.qd, robot.done = 0.0, 1
    assert robot.run(1000).kinds()[1:] == []
    robot.run(1)
    assert robot.kinds()[1:] == [Kind.SENSOR_ZEROED, Kind.PROGRAM_FINISHED]


def test_with_a_hand_on_the_arm_the_program_stops_with_the_reason() -> None:
    robot = run_program(Wait(duration=2.0), ZeroSensor(), Wait(duration=1.0))
    robot.offset[0] += 5.0
    robot.run(1001).events.clear()
    robot.run(PATIENCE - 3)
    assert robot.kinds() == []
    robot.run(1)
    (event,) = robot.events
    assert event.kind is Kind.PROGRAM_FAILED
    assert event.values == {"name": "p", "step": 2, "reason": f"force sensor not zeroed, 4.9 N {TORN}"}
    assert (robot.decision.mode, robot.decision.program) == (Mode.TEACH, ProgramState.STOPPED)


def test_who_lets_go_in_time_lets_it_go_on() -> None:
    robot = run_program(Wait(duration=2.0), ZeroSensor())
    robot.offset[0] += 5.0
    robot.run(1001 + PATIENCE - 600)
    robot.offset[0] -= 5.0
    robot.run(600)
    assert robot.kinds()[1:] == [Kind.SENSOR_ZEROED, Kind.PROGRAM_FINISHED]


def test_a_paused_step_begins_to_wait_again() -> None:
    robot = run_program(Wait(duration=0.1), ZeroSensor())
    robot.offset[0] += 5.0
    robot.run(51 + PATIENCE - 10).run(1, command(Command.PAUSE_PROGRAM)).run(100)
    robot.events.clear()
    robot.run(1, command(Command.RESUME_PROGRAM)).run(PATIENCE - 10)
    assert robot.kinds() == [Kind.PROGRAM_RESUMED]
    robot.run(20)
    assert robot.kinds()[1:] == [Kind.PROGRAM_FAILED]


def test_a_force_that_a_program_applies_is_measured_with_the_new_zero() -> None:
    robot = run_program(ZeroSensor(), ApplyForce(force=(0.0, 0.0, -10.0)))
    robot.run(2)
    move = robot.decision.move
    assert isinstance(move, ApplyForce)
    assert move.untouched == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize(("force", "zero"), [(4.9, True), (5.1, False)])
def test_a_refused_payload_names_the_zero_where_it_explains_the_force_as_well(force: float, zero: bool) -> None:
    robot = Robot(sequence__on=True, limits__activation__payload_force__max=4.5)
    robot.offset[:] = (0.0, 0.0, -force, 0.0, 0.0, 0.0)
    refused(robot.run(READY))
    (event,) = [event for event in robot.events if event.kind is Kind.REFUSED_PAYLOAD]
    assert event.values["zero"] is zero
    mass = f"{force / 9.81:+.1f} kg"
    assert render(event)[1] == (
        f"5 N: {mass}, the sensor's zero, or a push down. Let go; zero it with nothing touching."
        if zero
        else f"Consistent with {mass}, or a steady 5 N push down; let go, or turn the wrist, to decide."
    )
    robot.run(1200)
    (event,) = [event for event in robot.events if event.kind is Kind.RESIDUAL_STAYED]
    assert event.values["zero"] is zero
    assert ("zero" in render(event)[1]) is zero


def test_that_zeroing_is_due_is_told_and_shown() -> None:
    robot = Robot()
    assert not robot.decision.zero_due
    robot.offset[:] = (0.0, 0.0, 4.3, 0.0, 0.0, 0.0)
    robot.valid = False
    robot.run(1)
    robot.valid = True
    robot.run(READY)
    assert robot.decision.zero_due
    assert robot.kinds() == [Kind.ZERO_DUE]
    robot.run(1, ZERO)
    assert not robot.decision.zero_due


def test_equal_states_decide_equally() -> None:
    one, other = Robot(), Robot()
    assert one.supervisor.state == other.supervisor.state
    one.run(1, ZERO)
    other.run(1)
    assert one.supervisor.state != other.supervisor.state


def test_the_zero_is_the_same_object_until_it_changes() -> None:
    robot = Robot()
    seen: list[Wrench] = [robot.supervisor.zero]
    for inputs in (NOTHING, ZERO, NOTHING, NOTHING):
        robot.run(1, inputs)
        if robot.supervisor.zero is not seen[-1]:
            seen.append(robot.supervisor.zero)
    assert len(seen) == 2


READING = command(Command.ZERO_READING)


@pytest.mark.parametrize("name", MODES)
def test_the_reading_is_zeroed_at_once_in_every_state_and_free_drive_does_not_go_by_it(name: str) -> None:
    robot = MODES[name][0]()
    before = robot.decision.estimator.zero
    robot.events.clear()
    robot.run(1, READING)
    assert Kind.READING_ZEROED in robot.kinds()
    assert robot.decision.reading_zero == pytest.approx(OFFSET)
    assert robot.decision.estimator.zero is before


def test_while_a_hand_pulls_the_reading_is_zeroed_and_the_hand_is_told() -> None:
    robot = Robot()
    robot.offset[1] += 20.0
    robot.run(2 * WINDOW).events.clear()
    robot.run(1, READING)
    (told,) = [event for event in robot.events if event.kind is Kind.READING_ZEROED_PULLED]
    assert told.values["reason"] == "20.0 N more than on the untouched arm"
    assert robot.decision.reading_zero[1] == pytest.approx(OFFSET[1] + 20.0)


def test_a_reading_that_no_bias_explains_is_zeroed_and_told() -> None:
    """It was there from the first tick on, so that nothing is known of an arm without it."""
    robot = Robot()
    robot.supervisor, robot.tick = Supervisor(Settings(), 6), 0
    robot.offset = np.array((0.0, 0.0, -90.0, 0.0, 0.0, 0.0))
    robot.run(READY).events.clear()
    robot.run(1, READING)
    (told,) = [event for event in robot.events if event.kind is Kind.READING_ZEROED_PULLED]
    assert str(told.values["reason"]).startswith("90.0 N is more than its zero can be off")


def test_without_a_valid_sensor_the_reading_is_not_zeroed() -> None:
    robot = Robot()
    robot.valid = False
    robot.run(2).events.clear()
    robot.run(1, READING)
    assert Kind.ZERO_REFUSED in robot.kinds()
    assert robot.decision.reading_zero == (0.0,) * 6


def test_what_is_read_stays_when_the_sensor_is_zeroed_afterwards() -> None:
    robot = Robot().run(1, READING)
    robot.offset[0] += 0.5

    def read() -> np.ndarray:
        return robot.value().F_user - np.array(robot.decision.reading_zero)

    robot.run(READY)
    before = read()
    robot.events.clear()
    robot.run(1, ZERO).run(1)
    assert Kind.SENSOR_ZEROED in robot.kinds()
    assert read() == pytest.approx(before)


def test_a_zeroed_sensor_alone_changes_no_reading_zero() -> None:
    robot = Robot().run(1, ZERO)
    assert robot.decision.reading_zero == (0.0,) * 6
