"""Blends: one motion goes over into the next without a stop, on no more than the joints' speeds. Circles."""

import numpy as np
import pytest

from pendant.motion.script_requests import ScriptedArc, ScriptedJoints, ScriptedLine
from pendant.program.steps import LinearMove
from sim.arm.frames import quaternion_from_matrix
from sim.motion.blend import Blended
from sim.motion.moves import MoveRefused, Reference
from sim.motion.planned import JointTrajectory
from sim.motion.tool_trajectory import ToolTrajectory, planned_line
from sim.paths.tool_point import ToolPoint
from tests.sim.arms import load_arm
from tests.sim.laws import dynamics
from tests.sim.motion.test_moves import HOME, LIMITS, TCP, TICK, check_consistency, model, play, tool

NEXT = np.add(HOME, [0.4, 0.0, 0.0, 0.0, 0.0, 0.0])
LAST = np.add(HOME, [0.4, 0.3, 0.0, 0.0, 0.0, 0.0])


def joints(q: np.ndarray, goal: np.ndarray, time: float = 0.0, speed: float = 1.0) -> JointTrajectory:
    return JointTrajectory(q, ScriptedJoints(q=tuple(goal.tolist()), acceleration=1.4, speed=speed, time=time), LIMITS)


def circular(via: list[float], end: list[float], *, fixed: bool = False, speed: float = 0.1) -> ToolTrajectory:
    """Along the circle through where the tool is, and points so far from there."""
    p, R = tool(HOME)
    move = ScriptedArc(
        position=tuple(p + end),
        quaternion=tuple(quaternion_from_matrix(R)),
        via=tuple((p + via).tolist()),
        fixed=fixed,
        speed=speed,
        acceleration=0.5,
    )
    return planned_line(HOME, move, ToolPoint(model(), TCP), R_FT=np.eye(3), limits=LIMITS)


def begun(motion: JointTrajectory) -> list[Reference]:
    """Until it slows down."""
    rows = []
    while not motion.slowing:
        rows.append(motion.step())
    return rows


def test_a_blend_does_not_stop_and_ends_where_the_second_motion_does() -> None:
    first = joints(HOME, NEXT)
    rows = begun(first)
    both = Blended(first, joints(NEXT, LAST), NEXT, LIMITS)
    assert not both.done
    rows += play(both)  # type: ignore[arg-type]
    check_consistency(rows, HOME)
    moving = [float(np.abs(row.qd).max()) for row in rows[100:-150]]
    assert min(moving) > 0.1
    np.testing.assert_allclose(rows[-1].q, LAST, atol=1e-9)
    np.testing.assert_allclose(both.goal, LAST)
    assert both.remaining <= 0.0
    apart = len(play(joints(HOME, NEXT))) + len(play(joints(NEXT, LAST)))
    assert len(rows) < apart - 50


def test_where_a_joint_would_get_too_fast_the_second_waits() -> None:
    speed = np.full(6, 0.5)
    first = joints(HOME, NEXT, speed=0.5)
    rows = begun(first)
    both = Blended(first, joints(NEXT, np.add(NEXT, [0.4, 0.0, 0.0, 0.0, 0.0, 0.0]), speed=0.5), NEXT, (0.4 * speed, *LIMITS[1:]))
    assert both.remaining > first.remaining
    rows += play(both)  # type: ignore[arg-type]
    assert max(float(np.abs(row.qd).max()) for row in rows) <= 0.5 * (1.0 + 1e-6)
    assert min(float(np.abs(row.qd).max()) for row in rows[50:-100]) < 0.02


def test_it_slows_down_when_its_second_motion_does() -> None:
    first = joints(HOME, NEXT)
    begun(first)
    both = Blended(first, joints(NEXT, LAST), NEXT, LIMITS)
    seen = []
    while not both.done:
        both.step()
        seen.append(both.slowing)
    assert not seen[0]
    assert seen[-1]


@pytest.mark.parametrize("time", [2.0, 5.0])
def test_a_motion_takes_the_time_it_is_given(time: float) -> None:
    p, R = tool(HOME)
    line = ScriptedLine(
        position=tuple((np.add(p, [0.0, 0.1, 0.0])).tolist()), quaternion=tuple(quaternion_from_matrix(R)), time=time
    )
    for motion in (
        joints(HOME, NEXT, time),
        planned_line(HOME, line, ToolPoint(model(), TCP), R_FT=np.eye(3), limits=LIMITS),
    ):
        assert TICK * len(play(motion)) == pytest.approx(time, abs=0.02)


def test_a_time_that_is_too_short_is_refused() -> None:
    with pytest.raises(MoveRefused, match=r"joint move: it needs \d\.\d+ s, not 0\.100 s"):
        joints(HOME, NEXT, 0.1)


def test_a_joint_motion_of_a_script_is_straight_in_joint_angles() -> None:
    goal = np.add(HOME, [0.4, -0.2, 0.1, 0.0, 0.3, -0.4])
    for row in play(joints(HOME, goal)):
        share = (row.q - HOME)[0] / 0.4
        np.testing.assert_allclose(row.q - HOME, share * (goal - HOME), atol=1e-9)


@pytest.mark.parametrize("fixed", [False, True])
def test_a_circle_goes_through_its_points(fixed: bool) -> None:
    p, R = tool(HOME)
    rows = play(circular([0.0, 0.05, 0.05], [0.0, 0.1, 0.0], fixed=fixed))
    check_consistency(rows, HOME)
    places = np.array([tool(row.q)[0] for row in rows])
    np.testing.assert_allclose(places[-1], np.add(p, [0.0, 0.1, 0.0]), atol=2e-4)
    radii = np.linalg.norm(places - (np.add(p, [0.0, 0.05, 0.0])), axis=1)
    np.testing.assert_allclose(radii, 0.05, atol=3e-4)
    assert places[:, 2].max() == pytest.approx(p[2] + 0.05, abs=3e-4)
    turned = tool(rows[-1].q)[1]
    half = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])  # about the circle's axis
    np.testing.assert_allclose(turned, half @ R if fixed else R, atol=3e-3)


def test_a_circle_of_more_than_half_a_turn_goes_the_long_way() -> None:
    p, _ = tool(HOME)
    places = np.array([tool(row.q)[0] for row in play(circular([0.0, 0.1, 0.0], [0.0, 0.05, -0.05]))])
    assert places[:, 2].max() > p[2] + 0.045


@pytest.mark.parametrize(
    ("via", "end", "said"),
    [
        ([0.0, 0.05, 0.0], [0.0, 0.1, 0.0], "on a line"),
        ([0.0, 0.0, 0.0], [0.0, 0.1, 0.0], "two of its three points are the same"),
        ([0.0, 0.1, 0.0], [0.0, 0.1, 0.0], "two of its three points are the same"),
    ],
)
def test_three_points_that_make_no_circle_are_refused(via: list[float], end: list[float], said: str) -> None:
    with pytest.raises(MoveRefused, match=said):
        circular(via, end)


def test_where_a_joint_would_be_accelerated_more_than_it_may_the_second_waits() -> None:
    """There and back as hard as one joint can: both accelerations have the same sign."""
    for hard, waits in ((0.4, False), (0.9, True)):
        most = hard * float(LIMITS[1][0])
        there, back = (ScriptedJoints(q=tuple(q.tolist()), acceleration=most, speed=1.0) for q in (NEXT, HOME))
        first = JointTrajectory(HOME, there, LIMITS)
        rows = begun(first)
        both = Blended(first, JointTrajectory(NEXT, back, LIMITS), NEXT, LIMITS)
        before = len(rows)
        while not both.first.done:
            rows.append(both.step())
        assert bool(abs(rows[-1].qd[0]) < 0.05) is waits, "it is at rest where the second waited"
        rows += play(both)  # type: ignore[arg-type]
        jump = np.abs(np.diff([row.qd for row in rows[before - 1 :]], axis=0)) / TICK
        assert (jump <= LIMITS[1] * 1.01).all()


def test_where_a_joint_would_leave_its_range_the_second_waits() -> None:
    end = np.add(HOME, [0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    limits = (LIMITS[0], LIMITS[1], np.outer([-1.0, 1.0], np.add(np.abs(end), [1e-6, 7.0, 7.0, 7.0, 7.0, 7.0])))
    first, second = joints(end, HOME, speed=0.3), joints(HOME, end, speed=3.0)
    rows = begun(first)
    both = Blended(first, second, HOME, limits)
    rows += play(both)  # type: ignore[arg-type]
    assert max(float(row.q[0]) for row in rows) <= end[0] + 1e-6


@pytest.mark.parametrize("rate", [1.0, 0.37])
def test_seven_joints_end_where_it_was_planned_however_fast_they_went(rate: float) -> None:
    """The tool's pose leaves one of them free: how it comes to its end must not depend on the ticks in which it went there."""
    arm = load_arm("iiwa7")
    at_tcp = ToolPoint(dynamics(arm=arm), TCP)
    home = np.add(arm.chain.home, 0.2)
    p, R = at_tcp.pose(home)
    move = LinearMove(position=tuple(np.add(p, [0.05, 0.15, -0.1])), quaternion=tuple(quaternion_from_matrix(R)), speed=0.25)
    limits = (np.array(arm.limits.speed), np.array(arm.limits.acceleration), np.array(arm.limits.ends).T)
    motion = planned_line(home, move, at_tcp, R_FT=np.eye(3), limits=limits)
    rows = [motion.step(rate)]
    while not motion.done:
        rows.append(motion.step(rate))
    np.testing.assert_allclose(rows[-1].q, motion.goal, atol=1e-9)
    way = np.diff([row.q for row in rows], axis=0)
    mean = 0.5 * TICK * np.add([row.qd for row in rows[1:]], [row.qd for row in rows[:-1]])
    np.testing.assert_allclose(way, mean, atol=2e-7)
