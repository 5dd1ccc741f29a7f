"""What is taught: waypoints, steps, and the program that they make."""

import pytest

from app.files.checked import BadInput, convert
from app.files.taught_program import JOINT_SPEED, Lesson, TaughtStep, Waypoint, program
from pendant.program.reaction import Until
from pendant.program.steps import (
    ContactMove,
    InputLevel,
    JointMove,
    LinearMove,
    SetOutput,
    SwitchTool,
    Tell,
    Wait,
    WaitForContact,
    WaitForInput,
    ZeroSensor,
)


def waypoint(name: str, first: float = 0.0) -> Waypoint:
    return Waypoint(name=name, q=[first, -1.2, 1.5, -1.87, -1.57, 0.0], position=[0.1, 0.2, 0.3], quaternion=[0.0, 1.0, 0.0, 0.0])


LESSON = Lesson(waypoints=[waypoint("P1"), waypoint("P2", 0.5), waypoint("P3", 1.0)])


def test_without_steps_the_program_visits_the_waypoints() -> None:
    moves = program(LESSON, LESSON.plan).steps
    assert [type(move) for move in moves] == [JointMove] * 3
    assert [move.q[0] for move in moves if isinstance(move, JointMove)] == [0.0, 0.5, 1.0]
    assert {move.speed for move in moves if isinstance(move, JointMove)} == {JOINT_SPEED}


def test_every_kind_of_step_becomes_a_move() -> None:
    steps = [
        TaughtStep(do="line", to="P1"),
        TaughtStep(do="touch", to="P2"),
        TaughtStep(do="wait"),
        TaughtStep(do="contact"),
        TaughtStep(do="tool on"),
    ]
    line, touch, wait, contact, tool, zero = program(LESSON, [*steps, TaughtStep(do="zero")]).steps
    assert isinstance(line, LinearMove)
    assert isinstance(touch, LinearMove)
    assert (line.position, line.quaternion, line.speed, line.until) == ((0.1, 0.2, 0.3), (0.0, 1.0, 0.0, 0.0), 0.25, None)
    assert touch.speed == 0.05
    assert touch.until is not None
    assert touch.until.then == "retract"
    assert wait == Wait(duration=1.0)
    assert contact == WaitForContact()
    assert tool == SwitchTool(on=True)
    assert zero == ZeroSensor()


def test_waypoints_are_renamed_moved_and_deleted_with_their_steps() -> None:
    lesson = LESSON.with_steps([TaughtStep(do="joint", to="P2"), TaughtStep(do="wait"), TaughtStep(do="joint", to="P1")])
    renamed = lesson.renamed("P2", "above")
    assert renamed.steps is not None
    assert [step.to for step in renamed.steps] == ["above", None, "P1"]
    assert [w.name for w in renamed.moved("above", -1).waypoints] == ["above", "P1", "P3"]
    assert [w.name for w in renamed.moved("P1", -1).waypoints] == ["P1", "above", "P3"]
    left = renamed.without("above")
    assert ([w.name for w in left.waypoints], [step.text for step in left.plan]) == (["P1", "P3"], ["Wait 1 s", "Move to P1"])
    assert left.free_name() == "P2"


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        ({"steps": [{"do": "joint", "to": "P9"}]}, "no waypoint 'P9'"),
        ({"steps": [{"do": "until contact", "distance": 1.5}]}, "distance"),
        ({"steps": [{"do": "output on", "number": 8}]}, "number"),
        ({"repeat": -1}, "repeat"),
        ({"steps": [{"do": "joint"}]}, "'joint' needs waypoint"),
        ({"steps": [{"do": "wait", "to": "P1"}]}, "has no waypoint"),
        ({"waypoints": [{"name": "", "q": [], "position": [0, 0, 0], "quaternion": [1, 0, 0, 0]}]}, "name"),
        ({"waypoints": [{"name": "a", "q": [float("nan")], "position": [0, 0, 0], "quaternion": [1, 0, 0, 0]}]}, "finite"),
    ],
)
def test_a_file_that_makes_no_sense_is_refused_in_a_line(raw: object, said: str) -> None:
    with pytest.raises(BadInput) as refused:
        convert(raw, Lesson, "taught.yaml")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_steps_that_need_no_waypoint_say_what_they_do_and_become_it() -> None:
    steps = [
        TaughtStep(do="until contact"),
        TaughtStep(do="until contact", frame="tool", along="x", distance=0.05, speed=0.01, then="retreat", back=0.02),
        TaughtStep(do="until contact", then="go on"),
        TaughtStep(do="wait", seconds=2.5),
        TaughtStep(do="input", number=3, high=False),
        TaughtStep(do="output on", number=7),
        TaughtStep(do="output off", number=0, when=InputLevel(input=2, high=False)),
        TaughtStep(do="tell", says="Turn the part"),
    ]
    assert [step.text for step in steps] == [
        "Until contact, base -Z, 200 mm, stay",
        "Until contact, tool +X, 50 mm, retreat 20 mm",
        "Until contact, base -Z, 200 mm, go on",
        "Wait 2.5 s",
        "Wait until input 3 is low",
        "Output 7 on",
        "Output 0 off if input 2 is low",
        "Tell “Turn the part”",
    ]
    made = program(Lesson(), steps, repeat=0)
    assert made.repeat == 0
    assert made.steps == (
        ContactMove(),
        ContactMove(
            frame="tool", along="x", distance=0.05, speed=0.01, until=Until(change="gained", then="retract", distance=0.02)
        ),
        ContactMove(until=Until(change="gained", then="stop")),
        Wait(duration=2.5),
        WaitForInput(level=InputLevel(input=3, high=False)),
        SetOutput(output=7, on=True),
        SetOutput(output=0, on=False, when=InputLevel(input=2, high=False)),
        Tell(text="Turn the part"),
    )


def test_a_waypoint_goes_to_the_end_of_the_program_and_an_empty_program_stays_empty() -> None:
    own = LESSON.with_steps([TaughtStep(do="wait")])
    assert [step.text for step in own.with_waypoint(waypoint("P4")).plan] == ["Wait 1 s", "Move to P4"]
    assert LESSON.with_steps([]).plan == []
    assert LESSON.with_waypoint(waypoint("P4")).steps is None


def test_a_waypoint_is_taught_again_and_steps_change_places() -> None:
    again = LESSON.taught_again("P2", waypoint("new", 0.9))
    assert [(one.name, one.q[0]) for one in again.waypoints] == [("P1", 0.0), ("P2", 0.9), ("P3", 1.0)]
    for at, by, order in ((0, 1, "P2 P1 P3"), (2, -1, "P1 P3 P2"), (0, -1, "P1 P2 P3"), (2, 1, "P1 P2 P3")):
        assert [step.to for step in LESSON.with_step_moved(at, by).plan] == order.split()
