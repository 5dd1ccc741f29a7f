"""The one planner: every wish for a motion has a motion for an answer, or a reason."""

from typing import Any

import numpy as np
import pytest

from pendant.motion.script_requests import (
    ScriptedArc,
    ScriptedJoints,
    ScriptedLine,
    ScriptedProcess,
    ServoJoints,
    ServoTool,
    SpeedJoints,
    SpeedTool,
)
from pendant.program.jog_move import JogMove, MoveStraight, MoveThere
from pendant.program.steps import ApplyForce, JointMove, LinearMove, Move, Wait
from sim.arm.frames import quaternion_from_matrix
from sim.motion.blend import Blended
from sim.motion.force_move import ForceTrajectory
from sim.motion.jog import JogTrajectory
from sim.motion.moves import Motion, Reference, Stop, Strength
from sim.motion.pace import Pace
from sim.motion.planned import JointTrajectory
from sim.motion.planner import Planner
from sim.motion.process import ProcessTrajectory
from sim.motion.streams import ServoStream, SpeedStream, ToolStream
from sim.motion.tool_trajectory import ToolTrajectory
from sim.paths.tool_point import ToolPoint
from tests.sim.arms import UR5E
from tests.sim.laws import meter
from tests.sim.motion.test_moves import HOME, LIMITS, TCP, model, tool

STRENGTH = Strength(model(), np.array(UR5E.motors.rotor_inertia), np.array(UR5E.limits.torque))
PLANNER = Planner(ToolPoint(model(), TCP), np.eye(3), limits=LIMITS, strength=STRENGTH, pace=Pace(meter(model(), TCP)))
ZERO = np.zeros(6)
REST = Reference(HOME, ZERO, ZERO)
MOVING = Reference(HOME, np.array([0.5, 0.1, 0.0, 0.0, 0.0, 0.0]), ZERO)


def asked(move: Move, now: Reference = REST, before: Motion | None = None) -> Motion | str:
    return PLANNER.plan(move, now, before or Stop(now.q, now.qd), None)


def pose(way: tuple[float, float, float], **more: Any) -> dict[str, Any]:
    p, R = tool(HOME)
    return {"position": tuple((p + way).tolist()), "quaternion": tuple(quaternion_from_matrix(R).tolist()), **more}


ASIDE = pose((0.0, 0.05, 0.0))
GOAL = tuple((HOME + 0.1).tolist())
MOVES: list[tuple[Move, type]] = [
    (JointMove(q=GOAL), JointTrajectory),
    (MoveThere(q=GOAL), JointTrajectory),
    (ScriptedJoints(q=GOAL, acceleration=1.4, speed=1.05), JointTrajectory),
    (LinearMove(**ASIDE), ToolTrajectory),
    (MoveStraight(**ASIDE), ToolTrajectory),
    (ScriptedLine(**ASIDE), ToolTrajectory),
    (ScriptedArc(**ASIDE, via=tuple((tool(HOME)[0] + [0.0, 0.02, 0.02]).tolist())), ToolTrajectory),
    (ScriptedProcess(**ASIDE), ProcessTrajectory),
    (ServoJoints(q=GOAL, time=0.1), ServoStream),
    (ServoTool(**ASIDE), ToolStream),
    (SpeedJoints(qd=(0.1,) * 6, acceleration=1.0), SpeedStream),
    (SpeedTool(speed=(0.1, 0.0, 0.0), turning=(0.0,) * 3, acceleration=1.0, turning_acceleration=1.0), ToolStream),
    (JogMove(frame="base", axis=0, sign=1), JogTrajectory),
    (ApplyForce(force=(0.0, 0.0, -10.0)), ForceTrajectory),
    (Wait(duration=1.0), Stop),
]


@pytest.mark.parametrize(("move", "kind"), MOVES, ids=[type(move).__name__ for move, _ in MOVES])
def test_every_kind_of_move_is_answered_with_a_motion(move: Move, kind: type) -> None:
    assert type(asked(move)) is kind


@pytest.mark.parametrize(
    ("move", "reason"),
    [
        (JointMove(q=(9.0, *GOAL[1:])), "joint move: joint 1 would reach 9.0000 rad"),
        (LinearMove(**pose((3.0, 0.0, 0.0))), "linear move: out of reach or singular"),
        (ScriptedArc(**ASIDE, via=tool(HOME)[0]), "circular move: two of its three points are the same"),
        (ScriptedLine(**ASIDE, time=0.01), "linear move: it needs"),
        (ScriptedJoints(q=GOAL, acceleration=1.0, speed=1.0, time=0.01), "joint move: it needs"),
        (ServoJoints(q=(9.0, *GOAL[1:]), time=0.1), "servoj: joint 1 would reach"),
    ],
)
def test_what_cannot_be_done_is_answered_with_a_reason(move: Move, reason: str) -> None:
    answer = asked(move)
    assert isinstance(answer, str)
    assert answer.startswith(reason)


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan")])
def test_a_speed_without_a_meaning_is_answered_with_a_reason(speed: float) -> None:
    assert str(asked(ScriptedLine(**{**ASIDE, "speed": speed, "acceleration": 1.0}))).startswith("no motion by")
    assert isinstance(asked(LinearMove(**ASIDE), Reference(np.full(6, np.nan), ZERO, ZERO), Stop(HOME, ZERO)), str)


def test_numbers_that_no_check_has_foreseen_are_a_reason_and_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(PLANNER, "_after", fails)
    assert asked(JointMove(q=GOAL)) == "JointMove: no motion is found (division by zero)"


@pytest.mark.parametrize("move", [JointMove(q=GOAL), LinearMove(**ASIDE), ScriptedLine(**ASIDE), MoveThere(q=GOAL)])
def test_from_a_moving_arm_every_planned_move_begins_as_the_arm_comes_to_rest(move: Move) -> None:
    motion = asked(move, MOVING, Stop(MOVING.q, MOVING.qd, 0.3))
    assert isinstance(motion, Blended)
    before = MOVING
    while not motion.done:
        now = motion.step()
        assert (np.abs(now.qd - before.qd) <= 0.002 * np.maximum(LIMITS[1], 0.5 * np.pi * 0.5 / 0.3) * 1.01).all()
        before = now
    np.testing.assert_allclose(before.q, motion.goal, atol=1e-9)


@pytest.mark.parametrize("move", [JogMove(frame="joint", axis=0, sign=1), ApplyForce(force=(0.0, 0.0, -10.0))])
def test_jogging_and_a_force_begin_at_rest(move: Move) -> None:
    answer = asked(move, MOVING)
    assert isinstance(answer, str)
    assert answer.endswith("the arm still moves")
