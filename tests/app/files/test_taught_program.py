"""What is taught: waypoints, steps, and the program that they make."""

import pytest

from app.files.checked import BadInput, convert
from app.files.taught_program import Lesson, TaughtStep, Waypoint, program
from pendant.program.steps import JointMove, LinearMove, SwitchTool, Wait, WaitForContact, ZeroSensor


def waypoint(name: str, first: float = 0.0) -> Waypoint:
    return Waypoint(name=name, q=[first, -1.2, 1.5, -1.87, -1.57, 0.0], position=[0.1, 0.2, 0.3], quaternion=[0.0, 1.0, 0.0, 0.0])


LESSON = Lesson(waypoints=[waypoint("P1"), waypoint("P2", 0.5), waypoint("P3", 1.0)])


def test_without_steps_the_program_visits_the_waypoints() -> None:
    moves = program(LESSON, LESSON.plan, 0.5).steps
    assert [type(move) for move in moves] == [JointMove] * 3
    assert [move.q[0] for move in moves if isinstance(move, JointMove)] == [0.0, 0.5, 1.0]
    assert {move.speed for move in moves if isinstance(move, JointMove)} == {0.2}


def test_every_kind_of_step_becomes_a_move() -> None:
    steps = [
        TaughtStep(do="line", to="P1"),
        TaughtStep(do="touch", to="P2"),
        TaughtStep(do="wait"),
        TaughtStep(do="contact"),
        TaughtStep(do="tool on"),
    ]
    line, touch, wait, contact, tool, zero = program(LESSON, [*steps, TaughtStep(do="zero")], 1.0).steps
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
    assert [step.to for step in renamed.steps] == ["above", None, "P1"]
    assert [w.name for w in renamed.moved("above", -1).waypoints] == ["above", "P1", "P3"]
    assert [w.name for w in renamed.moved("P1", -1).waypoints] == ["P1", "above", "P3"]
    left = renamed.without("above")
    assert ([w.name for w in left.waypoints], [step.text for step in left.steps]) == (["P1", "P3"], ["Wait 1 s", "Move to P1"])
    assert left.free_name() == "P2"


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        ({"steps": [{"do": "joint", "to": "P9"}]}, "no waypoint 'P9'"),
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
