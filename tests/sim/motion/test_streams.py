"""servoj, servoc, speedj, speedl: what is asked for is followed within all limits, and comes to rest without a new command."""

import math

import numpy as np
import pytest

from pendant.motion.script_requests import ServoJoints, ServoTool, SpeedJoints, SpeedTool
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import TICK
from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy
from sim.motion.moves import DELAY, MoveRefused, Reference
from sim.motion.pace import Pace
from sim.motion.streams import GRACE, JointStream, ServoStream, SpeedStream, ToolStream
from sim.paths.tool_point import ToolPoint
from tests.sim.laws import meter
from tests.sim.motion.test_moves import ACCELERATION, HOME, LIMITS, POSITION, SPEED, TCP, model, tool

MODEL = model()
PACE = Pace(meter(MODEL, TCP))
REST = Reference(HOME, np.zeros(6), np.zeros(6))


def servo(ahead: float = 0.1, gain: float = 300.0, q: np.ndarray = HOME, time: float = 0.002) -> ServoJoints:
    return ServoJoints(q=tuple(q.tolist()), time=time, lookahead=ahead, gain=gain)


def tool_stream(move: SpeedTool | ServoTool, now: Reference = REST) -> ToolStream:
    return ToolStream(now, move, ToolPoint(MODEL, TCP), R_FT=np.eye(3), limits=LIMITS, pace=PACE)


def play(stream: JointStream, ticks: int, limits: SpeedLimits | None = None, share: float = 1.0) -> list[Reference]:
    """References of so many ticks; none asks more of a joint than it can."""
    rows, before = [], np.zeros(6)
    for k in range(ticks):
        row = stream.step(share, limits)
        assert (np.abs(row.qd) <= SPEED * (1.0 + 1e-9)).all()
        if k > 0:
            assert (np.abs(row.qd - before) <= ACCELERATION * TICK * (1.0 + 1e-9)).all()
        before = row.qd
        rows.append(row)
    return rows


@pytest.mark.parametrize("gain", [100.0, 300.0, 2000.0])
@pytest.mark.parametrize("ahead", [0.03, 0.1, 0.2])
def test_an_angle_that_goes_on_evenly_is_followed_the_look_ahead_later(gain: float, ahead: float) -> None:
    stream, target, rate = ServoStream(REST, servo(ahead, gain), LIMITS, PACE), HOME.copy(), 0.2
    for _ in range(4000):
        target[0] += rate * TICK
        stream.renew(servo(ahead, gain, target))
        reference = stream.step(1.0, None)
    assert reference.qd[0] == pytest.approx(rate, rel=1e-3)
    behind = rate * (ahead - DELAY * TICK)  # and the arm behind its reference by the rest
    assert target[0] - reference.q[0] == pytest.approx(behind, abs=0.01 * rate * TICK)


def test_a_step_is_made_up_for_without_swinging_over_where_gain_and_look_ahead_say_so() -> None:
    """K T² of 4 and more is damped critically or more."""
    goal = np.add(HOME, [0.05, 0.0, 0.0, 0.0, 0.0, 0.0])
    for ahead, gain, over in ((0.2, 300.0, False), (0.03, 300.0, True)):
        stream = ServoStream(REST, servo(ahead, gain), LIMITS, PACE)
        angles = []
        for _ in range(1500):
            stream.renew(servo(ahead, gain, goal))
            angles.append(stream.step(1.0, None).q[0] - HOME[0])
        assert angles[-1] == pytest.approx(0.05, abs=1e-4)
        assert bool(max(angles) > 0.0505) is over


def test_a_servo_command_that_is_out_of_date_comes_to_rest() -> None:
    stream, target = ServoStream(REST, servo(), LIMITS, PACE), HOME.copy()
    for _ in range(500):
        target[0] += 0.001
        stream.renew(servo(q=target))
        before = stream.step(1.0, None)
    assert before.qd[0] > 0.4
    rows = play(stream, 500)
    late = round((0.002 + GRACE) / TICK)
    assert rows[late - 2].qd[0] >= before.qd[0] - 1e-9 or rows[late - 2].q[0] > before.q[0]
    assert not rows[-1].qd.any()
    assert rows[-1].q[0] - before.q[0] < 0.1


def test_a_servo_target_out_of_range_is_refused() -> None:
    with pytest.raises(MoveRefused, match=r"servoj: joint 1 would reach 9\.0000 rad"):
        ServoStream(REST, servo(q=np.array([9.0, *HOME[1:]])), LIMITS, PACE)


def test_a_joint_speed_is_reached_with_its_acceleration_and_kept_for_its_time() -> None:
    move = SpeedJoints(qd=(0.2, -0.1, 0.0, 0.0, 0.0, 0.0), acceleration=0.5, time=1.0)
    stream = SpeedStream(REST, move, LIMITS, PACE)
    rows = play(stream, 1000)
    assert rows[99].qd[0] == pytest.approx(0.1, rel=0.02)  # 0.5 rad/s² for 0.2 s
    assert rows[300].qd[:2] == pytest.approx([0.2, -0.1])
    assert stream.done
    assert not rows[-1].qd.any()  # its time is over


def test_without_a_time_a_joint_speed_is_kept_until_something_else_is_asked_for() -> None:
    stream = SpeedStream(REST, SpeedJoints(qd=(0.1, 0.0, 0.0, 0.0, 0.0, 0.0), acceleration=1.0), LIMITS, PACE)
    assert not stream.done
    assert play(stream, 2000)[-1].qd[0] == pytest.approx(0.1)
    stream.renew(SpeedJoints(qd=(0.0,) * 6, acceleration=1.0))
    assert not stream.done
    assert not play(stream, 200)[-1].qd.any()


def test_the_end_of_a_joints_range_is_approached_slowly_and_not_passed() -> None:
    near = HOME.copy()
    near[0] = POSITION[0] - 0.3
    stream = SpeedStream(
        Reference(near, np.zeros(6), np.zeros(6)), SpeedJoints(qd=(1.0, *(0.0,) * 5), acceleration=2.0), LIMITS, PACE
    )
    rows = [stream.step(1.0, None) for _ in range(2000)]
    assert max(row.q[0] for row in rows) <= POSITION[0]
    assert stream.problem == f"joint 1 is at the end of its range, {rows[-1].q[0]:.3f} rad"


def test_a_tool_speed_moves_the_tool_straight() -> None:
    move = SpeedTool(speed=(0.0, 0.05, -0.05), turning=(0.0,) * 3, acceleration=0.5, turning_acceleration=0.5, time=1.0)
    stream = tool_stream(move)
    start, R = tool(HOME)
    rows = play(stream, 800)
    end, turned = tool(rows[-1].q)
    way = end - start
    assert stream.done
    assert way[1] == pytest.approx(-way[2], abs=1e-4)
    assert abs(way[0]) < 1e-4
    assert 0.04 < way[1] < 0.056  # 1 s of 50 mm/s, less the ramp, and the way to rest
    assert np.abs(turned - R).max() < 1e-3
    assert not rows[-1].qd.any()


def test_a_turn_of_the_tool_leaves_its_centre_where_it_is() -> None:
    move = SpeedTool(speed=(0.0,) * 3, turning=(0.0, 0.0, 0.3), acceleration=1.0, turning_acceleration=1.0, time=1.0)
    start, R = tool(HOME)
    rows = play(tool_stream(move), 500)
    end, turned = tool(rows[-1].q)
    assert np.linalg.norm(end - start) < 5e-4
    angle = math.acos(min(1.0, (np.trace(turned @ R.T) - 1.0) / 2.0))
    assert angle == pytest.approx(0.3 * (1.0 - 0.15), abs=0.01)  # 1 s, less half of a ramp of 0.3 s


def test_a_pose_is_approached_at_the_speed_asked_for_and_reached() -> None:
    p, R = tool(HOME)
    goal, orientation = np.add(p, [0.0, 0.1, 0.05]), R @ rotation_from_rpy([0.1, 0.0, 0.2])
    move = ServoTool(position=tuple(goal), quaternion=tuple(quaternion_from_matrix(orientation)), speed=0.1, acceleration=0.5)
    rows = play(tool_stream(move), 2000)
    places = np.array([tool(row.q)[0] for row in rows])
    assert np.linalg.norm(places[-1] - goal) < 1e-3
    assert np.abs(tool(rows[-1].q)[1] - orientation).max() < 5e-3
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / TICK < 0.101


def test_a_tool_stream_that_is_out_of_date_comes_to_rest_and_takes_another_command() -> None:
    move = SpeedTool(speed=(0.0, 0.1, 0.0), turning=(0.0,) * 3, acceleration=1.0, turning_acceleration=1.0, time=0.2)
    stream = tool_stream(move)
    assert not play(stream, 400)[-1].qd.any()
    stream.renew(move)
    assert play(stream, 90)[-1].qd.any()


def test_a_singular_posture_is_refused_and_one_ahead_is_a_problem() -> None:
    stretched = HOME.copy()
    stretched[2] = 0.0
    move = SpeedTool(speed=(0.1, 0.0, 0.0), turning=(0.0,) * 3, acceleration=1.0, turning_acceleration=1.0)
    with pytest.raises(MoveRefused, match="singular here"):
        tool_stream(move, Reference(stretched, np.zeros(6), np.zeros(6)))
    p, _ = tool(HOME)
    outwards = p / np.linalg.norm(p)
    stream = tool_stream(SpeedTool(speed=tuple(0.2 * outwards), turning=(0.0,) * 3, acceleration=1.0, turning_acceleration=1.0))
    for _ in range(5000):
        stream.step(1.0, None)
        if stream.problem:
            break
    assert stream.problem == "singular ahead; use a joint motion"


def test_a_lower_share_of_the_speed_and_reduced_are_kept() -> None:
    move = SpeedTool(speed=(0.0, 0.3, 0.0), turning=(0.0,) * 3, acceleration=1.0, turning_acceleration=1.0)
    for limits, share, most in ((None, 0.5, 0.15), (SpeedLimits(0.1, 0.1, (1.0,) * 6), 1.0, 0.1)):
        places = np.array([tool(row.q)[0] for row in play(tool_stream(move), 500, limits, share)])
        assert 0.8 * most < np.linalg.norm(np.diff(places[300:], axis=0), axis=1).max() / TICK <= 1.01 * most


def test_on_the_way_to_another_pose_the_speed_stays_and_the_way_is_a_circle() -> None:
    p, R = tool(HOME)
    first, second = (
        ServoTool(position=tuple(np.add(p, way)), quaternion=tuple(quaternion_from_matrix(R)), speed=0.1, acceleration=0.5)
        for way in ([0.0, 0.2, 0.0], [0.0, 0.1, 0.1])
    )
    stream = tool_stream(first)
    rows = play(stream, 300)
    turning = tool(rows[-1].q)[0]
    stream.renew(second)
    rows += play(stream, 1500)
    places = np.array([tool(row.q)[0] for row in rows])
    moving = np.linalg.norm(np.diff(places[280:], axis=0), axis=1) / TICK
    slow = np.linalg.norm(places[280:-1] - second.position, axis=1) < 0.025  # it slows down to stand there
    assert moving[~slow] == pytest.approx(0.1, rel=0.02)
    assert np.linalg.norm(places[-1] - second.position) < 1e-3
    radius = 0.1**2 / 0.5  # of the circle, which begins where the pose was given
    centre = np.add(turning, [0.0, 0.0, radius])
    arc = places[302:330]
    assert np.linalg.norm(arc - centre, axis=1) == pytest.approx(radius, abs=1e-3)


def test_as_reduced_begins_the_joints_slow_down_within_their_accelerations() -> None:
    stream = SpeedStream(REST, SpeedJoints(qd=(2.0, -1.0, 0.0, 0.0, 0.0, 0.0), acceleration=10.0), LIMITS, PACE)
    before = play(stream, 150)[-1]
    rows = [before, *(stream.step(1.0, SpeedLimits(0.1, 0.1, (0.2,) * 6)) for _ in range(300))]
    change = np.abs(np.diff([row.qd for row in rows], axis=0))
    assert (change <= ACCELERATION * TICK * (1.0 + 1e-9)).all()
    assert 0.1 < float(np.abs(rows[-1].qd).max()) <= 0.2


def test_a_joint_at_the_end_of_its_range_stops_a_faster_one_without_a_step() -> None:
    near = HOME.copy()
    near[0] = POSITION[0] - 0.05
    move = SpeedJoints(qd=(0.02, 2.5, 0.0, 0.0, 0.0, 0.0), acceleration=10.0)
    stream = SpeedStream(Reference(near, np.zeros(6), np.zeros(6)), move, LIMITS, PACE)
    rows = play(stream, 3000)
    assert stream.problem.startswith("joint 1 is at the end of its range")
    assert max(float(row.qd[1]) for row in rows) > 1.0
    assert max(float(row.q[0]) for row in rows) <= POSITION[0]
    assert not rows[-1].qd.any()


def test_what_another_joint_wants_does_not_keep_one_from_its_stop() -> None:
    """Joint 2 turns round as hard as it can, again and again, while joint 1 comes to the end of its range."""
    near = HOME.copy()
    near[0] = POSITION[0] - 0.4
    stream = SpeedStream(
        Reference(near, np.zeros(6), np.zeros(6)), SpeedJoints(qd=(1.5, 0.0, 0.0, 0.0, 0.0, 0.0), acceleration=50.0), LIMITS, PACE
    )
    rows = []
    for k in range(400):
        other = 3.0 if k // 20 % 2 else -3.0
        stream.renew(SpeedJoints(qd=(1.5, other, 0.0, 0.0, 0.0, 0.0), acceleration=1000.0))
        rows += play(stream, 5) if k == 0 else [stream.step(1.0, None) for _ in range(5)]
    assert max(float(row.q[0]) for row in rows) <= POSITION[0]
    change = np.abs(np.diff([row.qd for row in rows], axis=0))
    assert (change <= ACCELERATION * TICK * (1.0 + 1e-9)).all()


def test_a_servo_target_at_the_very_end_of_a_range_is_reached() -> None:
    near, target = HOME.copy(), HOME.copy()
    near[0], target[0] = POSITION[0] - 0.1, POSITION[0]
    stream = ServoStream(Reference(near, np.zeros(6), np.zeros(6)), servo(q=target, gain=200.0, time=10.0), LIMITS, PACE)
    rows = play(stream, 2000)
    assert not stream.problem
    assert rows[-1].q[0] == pytest.approx(POSITION[0], abs=1e-6)
