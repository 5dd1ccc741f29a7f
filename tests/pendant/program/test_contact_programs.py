"""Programs that go on until a contact, and contacts that the supervisor tells (CD-1, CD-15, CD-16)."""

from collections.abc import Iterator

import msgspec
import pytest

from pendant.contact.contact_change import ArmPose, Change, Contact
from pendant.contact.contact_monitor import ContactMonitor
from pendant.contact.settings import ContactUse
from pendant.event_table import render
from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.program.reaction import REACTION_SPEED, Until, goal
from pendant.program.steps import (
    AnyStep,
    ContactMove,
    GentleStop,
    JointMove,
    LinearMove,
    Program,
    ProgramState,
    SetOutput,
    SwitchTool,
    Tell,
    Wait,
    WaitForContact,
)
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import UNTURNED
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

BEGUN = ArmPose((0.0,) * 6, (0.0, 0.0, 0.5), UNTURNED)
POSE = ArmPose((0.2,) * 6, (0.0, 0.0, 0.3), UNTURNED)
GAINED = Contact(0, Change.GAINED, "difference", "tool", "sensor", (2.0, 3.0, -6.0), (-1.0, -4.0, 8.0), -1.4, 3, POSE)
DOWN = LinearMove(position=(0.0, 0.0, 0.1), quaternion=(1.0, 0.0, 0.0, 0.0))
NEXT = JointMove(q=(0.5,) * 6)


class Told(ContactMonitor):
    """A monitor that finds what a test says, in the tick in which it is said."""

    def __init__(self) -> None:
        super().__init__()
        self.coming: Iterator[Contact] = iter(())
        self.was_on = False
        self.at = BEGUN

    def step(self, estimate: Estimate, use: ContactUse, mode: Mode, on: bool) -> tuple[Contact, ...]:
        self.was_on = on
        return tuple(self.coming)

    def now(self) -> ArmPose:
        return self.at


def running(*steps: AnyStep) -> tuple[Bench, Told]:
    bench, told = Bench(), Told()
    bench.supervisor._monitor = told
    bench.run(60)
    bench.step(Inputs(program=Program(steps=steps)))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.step()
    bench.events.clear()
    return bench, told


def done(bench: Bench) -> None:
    """The law has finished the move that it was given."""
    move = bench.last.move
    assert move is not None
    bench.step(status=MotionStatus(move.id))


def until(then: str) -> LinearMove:
    return LinearMove(position=DOWN.position, quaternion=DOWN.quaternion, until=Until(then=then, distance=0.02))  # type: ignore[arg-type]


def test_a_contact_is_told_with_its_numbers() -> None:
    bench, told = Bench(), Told()
    bench.supervisor._monitor = told
    told.coming = iter((GAINED,))
    decision = bench.step()
    (event,) = decision.events
    assert event.kind is Kind.CONTACT_GAINED
    assert decision.contacts == (GAINED,)
    assert event.values == {
        "part": "tool", "source": "sensor", "rule": "difference", "force": 7.0, "fx": 2.0, "fy": 3.0, "fz": -6.0,
        "acceleration": 9.0, "ax": -1.0, "ay": -4.0, "az": 8.0, "ratio": -1.4, "steps": 3, "speed": 0.0,
        "x": 0.0, "y": 0.0, "z": 0.3, "action": "none",
        "posture": "0.2000 0.2000 0.2000 0.2000 0.2000 0.2000",
    }  # fmt: skip
    assert render(event) == ("Touched at 7 N: tool", "The force changed by 7.0 N, seen by the rule difference. The arm goes on.")
    assert bench.step().contacts == ()


@pytest.mark.parametrize("change", list(Change))
def test_every_change_has_its_event(change: Change) -> None:
    bench, told = Bench(), Told()
    bench.supervisor._monitor = told
    told.coming = iter((GAINED._replace(change=change),))
    assert bench.step().events[0].kind == f"contact_{change.value}"


def test_detection_is_on_by_the_control_or_by_a_step() -> None:
    bench, told = Bench(), Told()
    bench.supervisor._monitor = told
    bench.step()
    assert not told.was_on
    bench.step(Inputs(commands=(Command.DETECTION,)))
    bench.step()
    assert told.was_on
    assert bench.supervisor.settings.contact.on
    bench.step(Inputs(commands=(Command.DETECTION,)))
    bench.step()
    assert not told.was_on
    bench, told = running(until("stop"), Wait(duration=1.0))
    assert told.was_on
    told.coming = iter((GAINED,))
    bench.run(60)
    assert not told.was_on


def test_a_move_until_contact_brakes_rests_and_goes_on() -> None:
    bench, told = running(until("stop"), NEXT)
    bench.run(20, value=estimate(qd=0.3))
    assert bench.last.law is Law.FOLLOW
    told.coming = iter((GAINED,))
    decision = bench.step(value=estimate(qd=0.3))
    assert (decision.law, decision.mode, decision.program) == (Law.BRAKE, Mode.RUN, ProgramState.RUNNING)
    assert bench.events[-1].values["action"] == "stop"
    bench.run(49)
    assert bench.last.law is Law.BRAKE
    bench.step()
    assert bench.last.law is Law.FOLLOW
    assert isinstance(bench.last.move, JointMove)
    assert bench.last.step == 2


@pytest.mark.parametrize("then", ["retract", "contact_pose", "reverse", "turn"])
def test_the_reaction_is_a_move_of_its_own(then: str) -> None:
    bench, told = running(until(then), NEXT)
    assert bench.last.move is not None
    number = bench.last.move.id
    told.coming = iter((GAINED,))
    bench.step(value=estimate(qd=0.3))
    told.at = POSE
    bench.run(50)
    move = bench.last.move
    assert bench.last.step == 1
    if then in ("contact_pose", "reverse"):
        assert isinstance(move, JointMove)
        assert move.q == (POSE.q if then == "contact_pose" else BEGUN.q)
    else:
        assert isinstance(move, LinearMove)
        assert move.position == pytest.approx((0.0, 0.0, 0.32 if then == "retract" else 0.3))
        assert move.speed == REACTION_SPEED
    assert move.id == number + 1
    assert (bench.last.mode, bench.last.program) == (Mode.RUN, ProgramState.RUNNING)
    done(bench)
    assert bench.last.step == 2


def test_a_stop_at_the_end_of_a_program_finishes_it() -> None:
    bench, told = running(until("stop"))
    told.coming = iter((GAINED,))
    bench.run(60)
    assert bench.events[-1].kind is Kind.PROGRAM_FINISHED
    assert bench.last.mode is Mode.TEACH


def test_a_move_that_touches_nothing_fails() -> None:
    bench, _ = running(until("stop"), NEXT)
    done(bench)
    assert bench.events[-1].kind is Kind.PROGRAM_FAILED
    assert bench.events[-1].values["reason"] == "it ended without a contact"


def test_waiting_for_a_contact_lasts_until_the_right_one() -> None:
    bench, told = running(WaitForContact(until=Until(change="lost")), NEXT)
    done(bench)
    bench.run(500)
    assert bench.last.step == 1
    told.coming = iter((GAINED, GAINED._replace(change=Change.LOST)))
    bench.run(60)
    assert [event.values["action"] for event in bench.events] == ["none", "stop"]
    assert bench.last.step == 2


def test_the_tool_is_switched_by_steps() -> None:
    bench, _ = running(SwitchTool(on=True), NEXT)
    assert bench.last.tool_on
    assert bench.last.step == 2
    done(bench)
    bench, _ = running(SwitchTool(on=True), SwitchTool(on=False), NEXT)
    assert bench.last.tool_on
    bench.step()
    assert not bench.last.tool_on
    assert bench.events[-1].values == {"state": "off"}


def test_a_stop_while_it_brakes_ends_the_program() -> None:
    bench, told = running(until("retract"))
    told.coming = iter((GAINED,))
    bench.step(value=estimate(qd=0.3))
    bench.step(Inputs(commands=(Command.EMERGENCY_STOP,)))
    bench.run(100)
    assert bench.last.mode is Mode.STOP
    assert bench.last.law is Law.OFF
    assert bench.last.program is ProgramState.STOPPED


def test_a_pause_while_it_brakes_begins_the_step_again() -> None:
    bench, told = running(until("retract"))
    told.coming = iter((GAINED,))
    bench.step(value=estimate(qd=0.3))
    bench.step(Inputs(commands=(Command.PAUSE_PROGRAM,)))
    bench.run(100)
    assert bench.last.move is None
    bench.step(Inputs(commands=(Command.RESUME_PROGRAM,)))
    assert isinstance(bench.last.move, LinearMove)
    assert bench.last.move.until is not None


def test_sensors_lost_while_it_brakes_are_a_protective_stop() -> None:
    bench, told = running(until("retract"))
    told.coming = iter((GAINED,))
    bench.step(value=estimate(qd=0.3))
    bench.step(value=estimate(joints_valid=False))
    assert bench.last.mode is Mode.STOP


def test_without_a_program_a_contact_changes_nothing() -> None:
    bench, told = running(NEXT)
    told.coming = iter((GAINED,))
    bench.step()
    assert bench.last.law is Law.FOLLOW
    assert bench.events[-1].values["action"] == "none"


def test_a_retreat_leads_back_along_the_way_with_the_tool_as_it_was() -> None:
    """CD-15: 0.05 m of the 0.3 m from the contact back to where the move began."""
    begun, there = BEGUN._replace(p_BT=(0.1, -0.3, 0.5)), POSE._replace(p_BT=(0.3, -0.1, 0.4))
    back = goal(Until(then="retract", distance=0.05), GAINED._replace(pose=there), begun=begun, now=BEGUN, R_FT=ABOUT_Z)
    assert back is not None
    assert back.position == pytest.approx((0.3 - 0.1 / 3.0, -0.1 - 0.1 / 3.0, 0.4 + 0.05 / 3.0))
    assert back.quaternion == pytest.approx((0.5**0.5, 0.0, 0.0, 0.5**0.5))


ABOUT_Z = (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def test_the_tools_orientation_in_the_flange_is_kept_by_a_reaction() -> None:
    """CD-15: a tool that is mounted turned stays so."""
    bench, told = running(until("retract"), NEXT)
    bench.supervisor._robot.sequencer.R_FT = ABOUT_Z
    told.coming = iter((GAINED,))
    bench.step(value=estimate(qd=0.3))
    bench.run(50)
    assert isinstance(bench.last.move, LinearMove)
    assert bench.last.move.quaternion == pytest.approx((0.5**0.5, 0.0, 0.0, 0.5**0.5))


DOWN_HERE = ContactMove(distance=0.2, speed=0.05, until=Until(change="gained", then="retract", distance=0.02))


@pytest.mark.parametrize(
    ("frame", "along", "way"),
    [
        ("base", "-z", (0.0, 0.0, -0.2)),
        ("base", "x", (0.2, 0.0, 0.0)),
        ("tool", "x", (0.0, 0.2, 0.0)),
        ("tool", "-y", (0.2, 0.0, 0.0)),
        ("tool", "z", (0.0, 0.0, 0.2)),
    ],
)
def test_a_move_until_contact_is_a_line_from_where_the_arm_stands(frame: str, along: str, way: tuple[float, ...]) -> None:
    """CD-15: the tool stands turned by a quarter about z, so its x is the base's y."""
    step = ContactMove(frame=frame, along=along, distance=0.2, speed=0.05)  # type: ignore[arg-type]
    bench, told = running(step)
    bench.supervisor._robot.sequencer.R_FT = ABOUT_Z
    bench.step(Inputs(commands=(Command.STOP_PROGRAM,)))
    bench.run(60)
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.step()
    assert told.was_on  # detection is on for the step
    move = bench.last.move
    assert isinstance(move, LinearMove)
    assert move.position == pytest.approx(tuple(a + b for a, b in zip(BEGUN.p_BT, way, strict=True)))
    assert move.quaternion == pytest.approx((0.5**0.5, 0.0, 0.0, 0.5**0.5))
    assert (move.speed, move.until) == (0.05, step.until)


def test_a_move_until_contact_ends_at_it_and_goes_back() -> None:
    bench, told = running(DOWN_HERE, NEXT)
    bench.step(value=estimate(qd=0.3))
    told.coming = iter((GAINED,))
    assert bench.step(value=estimate(qd=0.3)).law is Law.BRAKE
    told.at = POSE
    bench.run(50)
    assert isinstance(bench.last.move, LinearMove)
    assert bench.last.move.position == pytest.approx((0.0, 0.0, 0.32))
    done(bench)
    assert (bench.last.step, bench.last.program) == (2, ProgramState.RUNNING)


def test_a_move_until_contact_that_meets_nothing_says_how_far_it_went() -> None:
    bench, _ = running(DOWN_HERE, NEXT)
    done(bench)
    assert bench.events[-1].kind is Kind.PROGRAM_FAILED
    assert bench.events[-1].values == {"name": "program", "step": 1, "reason": "no contact within 200 mm"}


def test_a_pause_makes_a_move_until_contact_no_longer() -> None:
    """The way that is left is done after it; each run of the step measures its own way."""
    bench, told = running(DOWN_HERE, DOWN_HERE)
    first = bench.last.move
    assert isinstance(first, LinearMove)
    told.at = POSE
    bench.step(Inputs(commands=(Command.PAUSE_PROGRAM,)))
    bench.run(60)
    bench.step(Inputs(commands=(Command.RESUME_PROGRAM,)))
    bench.step()
    again = bench.last.move
    assert isinstance(again, LinearMove)
    assert again.position == first.position
    assert again.id > first.id
    told.coming = iter((GAINED,))
    bench.step()
    bench.run(60)
    done(bench)
    bench.step()
    assert bench.last.step == 2
    assert isinstance(bench.last.move, LinearMove)
    assert bench.last.move.position == pytest.approx((0.0, 0.0, 0.1))


@pytest.mark.parametrize(
    ("field", "fits", "beyond"), [("distance", (0.001, 1.0), (0.0009, 1.001)), ("speed", (0.001, 0.25), (0.0009, 0.2501))]
)
def test_a_move_until_contact_has_its_distance_and_speed_to_the_ends_of_their_ranges(
    field: str, fits: tuple[float, ...], beyond: tuple[float, ...]
) -> None:
    for value in fits:
        assert getattr(msgspec.convert({"kind": "until_contact", field: value}, ContactMove), field) == value
    for value in beyond:
        with pytest.raises(msgspec.ValidationError, match=field):
            msgspec.convert({"kind": "until_contact", field: value}, ContactMove)


@pytest.mark.parametrize(
    ("how", "deceleration"), [({"within": 0.05}, 0.2 * 3.141592653589793), ({"time": 1.0}, 0.1 * 3.141592653589793)]
)
def test_a_gentle_stop_is_followed_until_the_arm_rests(how: dict[str, float], deceleration: float) -> None:
    """CD-15: at 0.2 m/s; then the step is done."""
    move = LinearMove(position=DOWN.position, quaternion=DOWN.quaternion, until=Until(**how))  # type: ignore[arg-type]
    bench, told = running(move, NEXT)
    moving = estimate(qd=0.3, v_tcp=0.2)
    bench.run(20, value=moving)
    told.coming = iter((GAINED,))
    decision = bench.step(value=moving)
    stop = decision.move
    assert isinstance(stop, GentleStop)
    assert (decision.law, decision.mode, stop.of) == (Law.FOLLOW, Mode.RUN, "tool")
    assert stop.deceleration == pytest.approx(deceleration)
    told.coming = iter((GAINED,))
    assert bench.run(100, value=moving).move is stop
    assert bench.run(49).move is stop
    bench.step()
    assert isinstance(bench.last.move, JointMove)
    assert bench.last.move.id > stop.id


def test_a_step_tells_the_user_once() -> None:
    """CD-15: in its own tick, which it takes."""
    bench, _ = running(Wait(duration=0.02), Tell(text="Hello"), Tell(text="again", tone=False), Wait(duration=1.0))
    bench.run(20)
    events = [event for event in bench.events if event.kind is Kind.PROGRAM_TELLS]
    assert [event.values for event in events] == [
        {"name": "program", "text": "Hello", "tone": True},
        {"name": "program", "text": "again", "tone": False},
    ]
    assert events[1].tick == events[0].tick + 1
    assert render(events[0]) == ("Hello", 'Program "program".')
    assert bench.last.signs == 1


def test_what_the_last_step_tells_and_switches_comes_before_the_end() -> None:
    """CD-15: who reads the events in turn hears it of a program that still runs."""
    for step, kind in (
        (Tell(text="Done"), Kind.PROGRAM_TELLS),
        (SwitchTool(on=True), Kind.TOOL_SWITCHED),
        (SetOutput(output=1, on=True), Kind.OUTPUT_SWITCHED),
    ):
        bench, _ = running(Wait(duration=0.02), step)
        bench.run(20)
        assert [event.kind for event in bench.events[-2:]] == [kind, Kind.PROGRAM_FINISHED]
