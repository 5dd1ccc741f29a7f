"""The modes of the robot: what an event does to them, and the control law that follows, tick by tick (FD-1)."""

from collections.abc import Callable
from typing import Any

import pytest

from pendant.events.event import Event, Kind
from pendant.freedrive.state_machine import FreeDrive
from pendant.limits.joint_zones import JointZones
from pendant.program.sequencer import Sequencer
from pendant.program.steps import AnyStep, HandGuide, Program, ProgramState, Wait
from pendant.robot.robot_mode import Robot
from pendant.sensor.sensor_spec import SensorSpec
from pendant.signals.enabling_device import Grip
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.walls.containment import Containment
from tests.pendant.estimates import estimate

JOINTS = tuple(f"joint {number}" for number in range(1, 7))
RATED = (100.0,) * 6
ENTERED, LEFT = Event(Kind.ENTERED, 7), Event(Kind.DEACTIVATED, 8)
PAUSED = Event(Kind.PROGRAM_PAUSED, 7, {"name": "one step", "step": 1})


def robot(step: AnyStep | None = None) -> Robot:
    """One that runs a program of one step, or none."""
    made = Robot(
        FreeDrive(JOINTS, RATED, Containment((), {}), JointZones(RATED, ((-100.0, 100.0),) * 6), sensor=SensorSpec()), Sequencer()
    )
    if step is not None:
        made.sequencer.load(Program(name="one step", steps=(step,)))
        made.sequencer.start()
        made.mode = Mode.RUN
    return made


def told(act: Callable[..., None], event: Event) -> list[Event]:
    events: list[Event] = []
    act(event, events)
    return events


def test_a_new_robot_holds_in_teach() -> None:
    new = robot()
    assert (new.mode, new.safety, new.braking, new.static, new.grip) == (Mode.TEACH, Safety.NORMAL, False, False, None)
    assert (new.law(), new.enabled) == (Law.HOLD, True)


@pytest.mark.parametrize("mode", [Mode.NORMAL, Mode.TEACH, Mode.RUN])
def test_free_drive_returns_to_where_it_was_entered_from(mode: Mode) -> None:
    """FD-1. One that was not entered leaves the mode."""
    arm = robot()
    arm.mode = mode
    for _ in range(2):
        assert told(arm.follow, LEFT) == [LEFT]
        assert arm.mode is mode
        assert told(arm.follow, ENTERED) == [ENTERED]
        assert arm.mode is Mode.FREE_DRIVE
    assert told(arm.follow, LEFT) == [LEFT]
    assert arm.mode is mode


@pytest.mark.parametrize("kind", [Kind.ENTERED, Kind.SEQUENCE_STARTED])
def test_free_drive_pauses_a_program_that_does_not_ask_for_it(kind: Kind) -> None:
    event = Event(kind, 7)
    for step, expected in ((Wait(duration=9.0), [event, PAUSED]), (HandGuide(), [event])):
        arm = robot(step)
        assert told(arm.follow, event) == expected
        assert arm.sequencer.state is (ProgramState.PAUSED if PAUSED in expected else ProgramState.RUNNING)
        assert arm.braking is (PAUSED in expected)


@pytest.mark.parametrize(
    ("kind", "done"),
    [
        (Kind.DEACTIVATED, True),
        (Kind.LEFT_PRESS, True),
        (Kind.LEFT_RELEASE, True),
        (Kind.LEFT_PERIOD, True),
        (Kind.LEFT_RESTART, True),
        (Kind.LEFT_LIMIT, False),
        (Kind.LEFT_ENABLING, False),
    ],
)
def test_after_guiding_a_program_goes_on_only_where_nobody_must_look_first(kind: Kind, done: bool) -> None:
    """CD-15."""
    arm, event = robot(HandGuide()), Event(kind, 7)
    told(arm.follow, ENTERED)
    assert told(arm.follow, event) == ([event] if done else [event, PAUSED])
    assert (arm.mode, arm.sequencer.braked) == (Mode.RUN, done)
    assert arm.sequencer.state is (ProgramState.RUNNING if done else ProgramState.PAUSED)


@pytest.mark.parametrize("kind", [Kind.DEACTIVATED, Kind.LEFT_LIMIT, Kind.LEFT_ENABLING])
def test_letting_go_of_the_enabling_device_is_a_stop_that_is_measured(kind: Kind) -> None:
    """It alone of what leaves free-drive without STOP: category 2, its cause told."""
    arm = robot()
    told(arm.follow, ENTERED)
    told(arm.follow, Event(kind, 7))
    values: dict[str, Any] = {"time": 0.0, "distance": 0.0, "category": 2, "cause": "left_enabling"}
    stops = [Event(Kind.STOPPED, 0, values)] if kind is Kind.LEFT_ENABLING else []
    assert arm.stopping.step(estimate(), 50, 50) == stops


@pytest.mark.parametrize("kind", [Kind.EMERGENCY_STOP, Kind.SAFEGUARD_STOP, Kind.SENSORS_LOST, Kind.STOPPED_LIMIT])
def test_a_stop_brakes_and_ends_the_program(kind: Kind) -> None:
    arm = robot(Wait(duration=9.0))
    told(arm.follow, Event(kind, 7))
    assert (arm.mode, arm.braking, arm.sequencer.state, arm.law()) == (Mode.STOP, True, ProgramState.STOPPED, Law.BRAKE)
    arm.static = True
    arm.reset(Safety.NORMAL)
    assert (arm.mode, arm.safety, arm.law(), arm.braking) == (Mode.TEACH, Safety.NORMAL, Law.HOLD, False)


@pytest.mark.parametrize("sequence", [True, False])
def test_a_freed_arm_is_braked_until_it_stands_then_held(sequence: bool) -> None:
    arm = robot()
    if sequence:
        arm.free.phase = Phase.SEQUENCE
    else:
        told(arm.follow, ENTERED)
    assert [arm.law() for _ in range(3)] == [Law.FREE] * 3
    arm.free.phase = Phase.OFF
    told(arm.follow, LEFT)
    assert [(arm.law(), arm.braking) for _ in range(3)] == [(Law.BRAKE, True)] * 3
    arm.static = True
    assert (arm.law(), arm.braking) == (Law.HOLD, False)
    arm.static = False  # it is held now, whatever moves it
    assert [(arm.law(), arm.braking) for _ in range(3)] == [(Law.HOLD, False)] * 3


def test_an_arm_that_a_wall_keeps_is_held_in_free_drive() -> None:
    """VW-6."""

    class Caught(FreeDrive):
        caught = True  # type: ignore[assignment]

    arm = robot()
    arm.free = Caught(JOINTS, RATED, Containment((), {}), JointZones(RATED, ((-100.0, 100.0),) * 6), sensor=SensorSpec())
    told(arm.follow, ENTERED)
    assert arm.law() is Law.HOLD
    told(arm.follow, LEFT)
    assert arm.law() is Law.BRAKE


def test_a_move_that_follows_ends_the_braking() -> None:
    arm = robot(Wait(duration=9.0))
    assert (arm.law(), arm.braking) == (Law.FOLLOW, False)
    told(lambda event, events: arm.pause_program(event.tick, events), ENTERED)
    assert (arm.law(), arm.braking) == (Law.BRAKE, True)
    arm.sequencer.resume()
    assert (arm.law(), arm.braking) == (Law.FOLLOW, False)
    arm.sequencer.stop()
    assert (arm.law(), arm.braking) == (Law.HOLD, False)


@pytest.mark.parametrize("grip", [None, *Grip])
def test_only_the_middle_of_an_enabling_device_enables(grip: Grip | None) -> None:
    arm = robot()
    arm.grip = grip
    assert arm.enabled is (grip in (None, Grip.MIDDLE))
