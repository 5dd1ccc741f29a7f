"""movep: lines that circles join are gone at one speed, and the joints keep their limits."""

import math

import numpy as np
import pytest

from pendant.motion.script_requests import ScriptedLine, ScriptedProcess
from pendant.tick.modes import TICK
from sim.arm.frames import quaternion_from_matrix, rotation_by, rotation_from_rpy, rotation_vector
from sim.motion.blend import Blended, leaves, lengthened
from sim.motion.moves import MoveRefused, Reference, Stop
from sim.motion.planned import JERK_TIME
from sim.motion.process import ProcessTrajectory
from sim.motion.tool_trajectory import planned_line
from sim.paths.tool_point import ToolPoint
from tests.sim.motion.test_moves import HOME, LIMITS, SPEED, TCP, check_consistency, model, tool

ASIDE, UP, BACK = [0.0, 0.1, 0.0], [0.0, 0.1, 0.1], [0.0, 0.0, 0.1]
EVEN = 0.01
"""By which a speed that is kept may differ, as a share."""


def line(
    where: list[float],
    blend: float = 0.02,
    *,
    speed: float = 0.1,
    acceleration: float = 0.5,
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> ScriptedProcess:
    """To a place so far from where the tool is at first."""
    p, R = tool(HOME)
    return ScriptedProcess(
        position=tuple((p + where).tolist()),
        quaternion=tuple(quaternion_from_matrix(R @ rotation_from_rpy(rpy))),
        speed=speed,
        acceleration=acceleration,
        blend=blend,
    )


def begun(move: ScriptedProcess) -> ProcessTrajectory:
    return ProcessTrajectory(HOME, move, ToolPoint(model(), TCP), R_FT=np.eye(3), limits=LIMITS)


def gone(*moves: ScriptedProcess, rate: float = 1.0) -> tuple[ProcessTrajectory, list[Reference]]:
    """One line after the other, each as soon as it is asked for; in the end all joints are within their limits."""
    motion, rows, k = begun(moves[0]), [], 1
    while not motion.done:
        rows.append(motion.step(rate))
        if k < len(moves) and motion.nearing(moves[k - 1].blend):
            assert motion.goes_on(moves[k], moves[k - 1].blend)
            k += 1
    assert k == len(moves)
    if rate == 1.0:
        check_consistency(rows, HOME)
    assert all((np.abs(row.qd) <= SPEED * 1.001).all() for row in rows)
    return motion, rows


def places(rows: list[Reference]) -> np.ndarray:
    """Of the tool, from its first, (k, 3) [m]."""
    return np.array([tool(row.q)[0] for row in rows]) - tool(HOME)[0]


def speeds(rows: list[Reference]) -> np.ndarray:
    """Of the tool [m/s]."""
    return np.linalg.norm(np.diff(places(rows), axis=0), axis=1) / TICK


@pytest.mark.parametrize("blend", [0.005, 0.02, 0.05])
def test_the_speed_stays_through_a_blend_and_the_way_is_a_circle(blend: float) -> None:
    motion, rows = gone(line(ASIDE, blend), line(UP, blend), line(BACK, 0.0))
    way = places(rows)
    reached = np.flatnonzero(np.linalg.norm(way, axis=1) > 0.02)[0]
    leaving = np.flatnonzero(np.linalg.norm(way - BACK, axis=1) > 0.02)[-1]
    assert speeds(rows[reached:leaving]) == pytest.approx(0.1, rel=EVEN)
    for corner in (ASIDE, UP):  # of a right angle: a circle of the blend's radius passes it at sqrt(2) - 1 radii
        nearest = np.linalg.norm(way - corner, axis=1).min()
        assert nearest == pytest.approx(blend * (math.sqrt(2.0) - 1.0), abs=2e-4)
    first = way[way[:, 1] < 0.1 - blend - 1e-3]
    assert np.abs(first[first[:, 2] < 0.05][:, [0, 2]]).max() < 2e-4
    np.testing.assert_allclose(way[-1], BACK, atol=2e-4)
    np.testing.assert_allclose(motion.goal, rows[-1].q, atol=2e-3)
    assert motion.remaining == 0.0
    assert motion.slowing
    assert not motion.step().qd.any()


def test_the_tool_turns_evenly_through_a_blend() -> None:
    """`check_consistency` sees a step in the angular velocity as one in the joints' speeds."""
    _, rows = gone(line(ASIDE, 0.03, rpy=(0.2, 0.0, 0.0)), line(UP, 0.03, rpy=(0.2, -0.2, 0.1)), line(BACK, 0.0))
    np.testing.assert_allclose(tool(rows[-1].q)[1], tool(HOME)[1], atol=2e-3)
    corner = np.linalg.norm(places(rows) - ASIDE, axis=1).argmin()
    turned = rotation_vector(tool(HOME)[1].T @ tool(rows[corner].q)[1])
    assert 0.12 < turned[0] < 0.22


@pytest.mark.parametrize("vector", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.9), (1e-9, 0.0, 0.0), (0.0, 3.0, 0.0)])
def test_a_rotation_and_its_vector(vector: tuple[float, float, float]) -> None:
    R = rotation_by(np.array(vector))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(rotation_vector(R), vector, atol=1e-9)


def test_a_corner_too_sharp_for_its_speed_is_gone_more_slowly() -> None:
    _, rows = gone(line(ASIDE, 0.002, speed=0.5, acceleration=2.5), line(UP, 0.0, speed=0.5, acceleration=2.5))
    fast, corner = speeds(rows).max(), np.linalg.norm(places(rows) - ASIDE, axis=1).argmin()
    assert 0.0 < speeds(rows)[corner - 1] < 0.7 * fast
    np.testing.assert_allclose(places(rows)[-1], UP, atol=2e-4)


def test_lines_of_one_direction_are_one_line() -> None:
    _, rows = gone(line([0.0, 0.05, 0.0]), line(ASIDE, 0.0))
    way = places(rows)
    assert speeds(rows[200:-200]) == pytest.approx(0.1, rel=EVEN)
    assert np.abs(way[:, [0, 2]]).max() < 2e-4


def test_another_speed_is_reached_on_the_way() -> None:
    _, rows = gone(line(ASIDE, 0.02, speed=0.1), line([0.0, 0.1, 0.2], 0.0, speed=0.2))
    assert speeds(rows).max() == pytest.approx(0.2, rel=EVEN)
    _, rows = gone(line(ASIDE, 0.02, speed=0.2), line(UP, 0.0, speed=0.05))
    late = places(rows)[:, 2] > 0.03
    assert speeds(rows)[late[:-1]].max() == pytest.approx(0.05, rel=EVEN)


def test_at_half_the_rate_it_is_as_long_on_its_way_twice() -> None:
    moves = line(ASIDE), line(UP, 0.0)
    assert len(gone(*moves, rate=0.5)[1]) == pytest.approx(2 * len(gone(*moves)[1]), abs=8)


@pytest.mark.parametrize(
    ("next_", "radius"),
    [
        (line([0.0, 0.0, 0.0], 0.0), 0.02),  # straight back
        (line(ASIDE, 0.0, rpy=(0.5, 0.0, 0.0)), 0.02),  # a turn on the spot
        (line(UP, 0.0), 0.0),  # without a blend
        (line(UP, 0.0, acceleration=0.01), 0.02),  # it could not stop in time
    ],
)
def test_a_line_that_no_circle_leads_to_is_not_taken_and_the_motion_ends_where_it_would_have(
    next_: ScriptedProcess, radius: float
) -> None:
    motion = begun(line(ASIDE))
    rows = [motion.step()]
    while not motion.nearing(0.02):
        rows.append(motion.step())
    assert motion.moving
    assert not motion.goes_on(next_, radius)
    while not motion.done:
        rows.append(motion.step())
    np.testing.assert_allclose(places(rows)[-1], ASIDE, atol=2e-4)
    assert not motion.goes_on(line(UP), 0.02)


def test_what_is_out_of_reach_is_refused_and_changes_nothing() -> None:
    with pytest.raises(MoveRefused, match=r"process move: (out of reach or singular|joint \d would reach)"):
        begun(line([2.0, 0.0, 0.0]))
    motion = begun(line(ASIDE))
    while not motion.nearing(0.02):
        motion.step()
    with pytest.raises(MoveRefused, match="process move"):
        motion.goes_on(line([0.0, 0.1, 2.0]), 0.02)
    rows = []
    while not motion.done:
        rows.append(motion.step())
    np.testing.assert_allclose(places(rows)[-1], ASIDE, atol=2e-4)


def test_no_way_at_all_is_done_at_once() -> None:
    motion = begun(line([0.0, 0.0, 0.0]))
    assert motion.done
    assert not motion.moving
    assert not motion.goes_on(line(UP), 0.02)
    np.testing.assert_array_equal(motion.step().q, HOME)


def test_another_kind_of_motion_begins_when_the_line_slows_down() -> None:
    first = begun(line(ASIDE, 0.02))
    rows = [first.step()]
    while not leaves(first, 0.02, 1.0):
        rows.append(first.step())
    straight = ScriptedLine(position=line(UP).position, quaternion=line(UP).quaternion, speed=0.1, acceleration=0.5, blend=0.0)
    assert lengthened(first, straight, 0.02) is None
    assert lengthened(Stop(HOME, np.zeros(6)), line(UP), 0.02) is None
    second = planned_line(first.goal, straight, ToolPoint(model(), TCP), R_FT=np.eye(3), limits=LIMITS)
    both = Blended(first, second, first.goal, LIMITS)
    while not both.done:
        rows.append(both.step())
    check_consistency(rows, HOME)
    assert speeds(rows).max() < 0.1 * (1.0 + EVEN)
    np.testing.assert_allclose(places(rows)[-1], UP, atol=3e-4)


def test_a_line_after_a_motion_of_another_kind_takes_the_next_one_too() -> None:
    first = planned_line(
        HOME,
        ScriptedLine(position=line(ASIDE).position, quaternion=line(ASIDE).quaternion, speed=0.1, acceleration=0.5, blend=0.02),
        ToolPoint(model(), TCP),
        R_FT=np.eye(3),
        limits=LIMITS,
    )
    rows = [first.step()]
    while not first.slowing:
        rows.append(first.step())
    second = ProcessTrajectory(first.goal, line([0.0, 0.1, 0.2]), ToolPoint(model(), TCP), R_FT=np.eye(3), limits=LIMITS)
    both = Blended(first, second, first.goal, LIMITS)
    while not leaves(both, 0.02, 1.0):
        rows.append(both.step())
    assert lengthened(both, line([0.0, 0.0, 0.2], 0.0), 0.02) is both
    while not both.done:
        rows.append(both.step())
    np.testing.assert_allclose(places(rows)[-1], [0.0, 0.0, 0.2], atol=3e-4)


@pytest.mark.parametrize("acceleration", [0.4, 0.5, 1.0, 1.2])
def test_a_process_line_whose_length_lies_on_the_border_of_two_profiles_is_planned(acceleration: float) -> None:
    """As for a linear move, and where another line is put at its end."""
    length = 2.0 * acceleration * JERK_TIME**2
    for height in np.linspace(0.0, 0.05, 20):
        up = line([0.0, height, length], speed=1.0, acceleration=acceleration)
        start = line([0.0, height, 0.0], speed=1.0, acceleration=acceleration)
        motion, _ = gone(start, up) if height else gone(up)
        p, _ = tool(motion.goal)
        assert np.linalg.norm(p - tool(HOME)[0] - [0.0, height, length]) < 1e-4
