"""References: stops, joint moves and lines stay within limits, on their way, and end where they should."""

import numpy as np
import pytest
from numpy.typing import NDArray

from pendant.program.steps import JointMove, LinearMove
from sim.arm.chain import Body, chain
from sim.arm.frames import joint_frames, quaternion_from_matrix, rotation, rotation_from_rpy
from sim.motion.moves import (
    BRAKING_SHARE,
    MOVING_SHARE,
    SHORTEST_STOP,
    MoveRefused,
    Reference,
    Stop,
    Strength,
    stop_room,
    stop_time,
)
from sim.motion.planned import JERK_TIME, JointTrajectory
from sim.motion.tool_trajectory import ToolTrajectory, planned_line
from sim.paths.tool_point import ToolPoint
from sim.rigid_body.dynamics import Dynamics
from tests.sim.arms import UR5E

Array = NDArray[np.float64]

Limits = tuple[Array, Array, Array]

TICK = 0.002
HOME = np.array(UR5E.chain.home)
SPEED, ACCELERATION, POSITION = (
    np.array(values) for values in (UR5E.limits.speed, UR5E.limits.acceleration, UR5E.limits.position)
)
RANGE = np.array([-POSITION, POSITION])
LIMITS = (SPEED, ACCELERATION, RANGE)
TCP = np.array([0.01, -0.02, 0.15])


def play(motion: JointTrajectory | ToolTrajectory | Stop, ticks: int = 20000) -> list[Reference]:
    """All references until the motion is done, and three more."""
    rows = []
    for _ in range(ticks):
        rows.append(motion.step())
        if motion.done:
            return rows + [motion.step() for _ in range(3)]
    raise AssertionError("it never ends")


def check_consistency(rows: list[Reference], start: Array, speed: Array | float = 0.0) -> None:
    """Positions are the integral of the speeds, speeds that of the accelerations: no jump anywhere."""
    q = np.array([start, *(row.q for row in rows)])
    qd = np.array([np.broadcast_to(speed, start.shape), *(row.qd for row in rows)])
    assert np.abs(np.diff(q, axis=0) - TICK * (qd[1:] + qd[:-1]) / 2.0).max() < 2e-5
    jump = np.abs(np.diff(qd, axis=0)) / TICK
    assert (jump <= ACCELERATION * 1.02).all(), "no step in speed"


# Stop


@pytest.mark.parametrize("scale", [0.001, 0.05, 0.3, 1.0])
def test_a_stop_keeps_direction_and_ends_at_rest(scale: float) -> None:
    qd = scale * np.array([2.0, -3.0, 1.0, 0.5, 0.0, -2.5])
    rows = play(Stop(HOME, qd, 0.4))
    check_consistency(rows, HOME, qd)
    last = 1.0
    for row in rows:
        share = float(row.qd @ qd / (qd @ qd))
        assert np.allclose(row.qd, share * qd, atol=1e-12), "all joints slow down together"
        assert 0.0 <= share <= last + 1e-12
        way = row.q - HOME
        assert np.allclose(way, (way @ qd) / (qd @ qd) * qd, atol=1e-12), "on the line it was on"
        last = share
    assert not rows[-1].qd.any()
    assert not rows[-1].qdd.any()
    assert (rows[-1].q == rows[-3].q).all()


@pytest.mark.parametrize(
    "qd", [[2.0, -3.0, 1.0, 0.5, 0.0, -2.5], [0.8, 1.5, -1.5, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 3.0, 3.0, 3.0]]
)
def test_a_stop_uses_a_share_of_some_joint_s_torque_and_no_joint_more(qd: list[float]) -> None:
    """The torque of the whole motion, by inverse dynamics with the rotors, against the limits."""
    links, rotor, limit = (
        chain(UR5E).links,
        np.array(UR5E.motors.rotor_inertia),
        np.array(UR5E.limits.torque),
    )
    dynamics = Dynamics(
        chain(UR5E), links, Body(3.0, np.array([0.0, 0.0, 0.1]), np.zeros((3, 3))), mounting=[0.0, 0.0, 0.0], elbow=2
    )
    speed = np.array(qd)
    length = stop_time(dynamics, HOME, speed, rotor=rotor, torque=limit)
    half_way = -0.5 * np.pi / length * speed
    torque = dynamics.inverse(HOME, np.zeros(6), half_way) + rotor * half_way
    assert (np.abs(torque) <= BRAKING_SHARE * limit + 1e-9).all()
    fall = dynamics.gravity(HOME)
    share = (np.abs(torque - fall) + np.abs(fall)) / limit
    assert share.max() == pytest.approx(BRAKING_SHARE, rel=1e-6)


def test_a_joint_that_gravity_loads_fully_still_brakes() -> None:
    """A limit that the arm's own weight reaches leaves a tenth of it, not nothing and not a negative time."""
    dynamics = Dynamics(
        chain(UR5E), chain(UR5E).links, Body(0.0, np.zeros(3), np.zeros((3, 3))), mounting=[0.0, 0.0, 0.0], elbow=2
    )
    limit = np.abs(dynamics.gravity(HOME)) + 1.0
    assert 0.0 < stop_time(dynamics, HOME, np.full(6, 0.5), rotor=np.zeros(6), torque=limit) < np.inf


def test_a_slow_stop_is_not_shorter_than_the_arm_can_follow() -> None:
    assert TICK * len(play(Stop(HOME, np.full(6, 0.01)))) == pytest.approx(SHORTEST_STOP + 3 * TICK, abs=TICK)


def test_a_stop_at_rest_is_a_posture_kept() -> None:
    motion = Stop(HOME, np.zeros(6))
    assert motion.done
    for _ in range(3):
        row = motion.step()
        assert (row.q == HOME).all()
        assert not row.qd.any()
        assert not row.qdd.any()


def test_a_stop_does_not_hold_on_to_the_arrays_it_was_given() -> None:
    q, qd = HOME.copy(), np.full(6, 0.5)
    motion, twin = Stop(q, qd), Stop(HOME, np.full(6, 0.5))
    q[:], qd[:] = 9.0, 9.0
    assert (motion.step().q == twin.step().q).all()


def test_a_stop_before_the_end_of_a_range_is_short_enough_to_end_within_it() -> None:
    near = HOME.copy()
    near[0] = POSITION[0] - 0.01
    now = Reference(near, np.array([0.5, -0.1, 0.0, 0.0, 0.0, 0.0]), np.zeros(6))
    room = stop_room(now, RANGE)
    assert room == pytest.approx(2.0 * 0.01 / 0.5)
    rows = play(Stop(now.q, now.qd, 0.0, room))
    assert rows[-1].q[0] == pytest.approx(POSITION[0])
    assert stop_room(Reference(near, np.zeros(6), np.zeros(6)), RANGE) == np.inf
    assert len(play(Stop(now.q, now.qd, 0.2, room))) > 100, "no more torque than there is"


# Joint moves


@pytest.mark.parametrize("fraction", [0.1, 0.5, 1.0])
def test_a_joint_move_is_within_limits_at_every_tick_and_ends_on_target(fraction: float) -> None:
    target = np.add(HOME, [0.9, -0.4, 0.3, 1.5, -0.01, -2.0])
    rows = play(JointTrajectory(HOME, JointMove(q=tuple(target), speed=fraction, acceleration=fraction), LIMITS))
    check_consistency(rows, HOME)
    for row in rows:
        assert (np.abs(row.qd) <= fraction * SPEED * (1 + 1e-9)).all()
        assert (np.abs(row.qdd) <= fraction * ACCELERATION * (1 + 1e-9)).all()
    assert np.abs(rows[-1].q - target).max() < 1e-9
    assert np.abs(rows[-1].qd).max() < 1e-9
    assert np.abs(rows[-1].qdd).max() < 1e-6


def test_all_joints_of_a_joint_move_arrive_together() -> None:
    target = np.add(HOME, [1.5, -0.2, 0.1, 0.4, 0.05, -0.6])
    rows = play(JointTrajectory(HOME, JointMove(q=tuple(target), speed=0.5, acceleration=0.5), LIMITS))
    late = rows[int(0.95 * len(rows))]
    assert (np.abs(late.qd) > 0.0).all(), "shortly before the end every joint still moves"


def test_a_joint_move_to_where_the_arm_is_ends_at_once() -> None:
    rows = play(JointTrajectory(HOME, JointMove(q=tuple(HOME)), LIMITS))
    assert len(rows) <= 4 + 1
    assert np.abs(rows[-1].q - HOME).max() < 1e-12


@pytest.mark.parametrize(("joint", "angle"), [(0, 6.3), (4, -7.0)])
def test_a_joint_move_beyond_a_limit_is_refused(joint: int, angle: float) -> None:
    target = HOME.copy()
    target[joint] = angle
    with pytest.raises(MoveRefused, match=rf"joint move: joint {joint + 1} would reach {angle:.4f} rad, allowed ±6.2832"):
        JointTrajectory(HOME, JointMove(q=tuple(target)), LIMITS)


# Lines


def model() -> Dynamics:
    rigid = chain(UR5E)
    return Dynamics(
        rigid, rigid.links, Body(0.0, np.zeros(3), np.zeros((3, 3))), mounting=[0.0, 0.0, 0.0], elbow=UR5E.chain.elbow
    )


def tool(q: Array) -> tuple[Array, Array]:
    """Tool centre point and orientation in B, from the frames alone."""
    flange = joint_frames(UR5E, q)[-1]
    return flange[:3, :3] @ TCP + flange[:3, 3], flange[:3, :3]


def line(
    way: list[float], turn: Array | None = None, q: Array = HOME, limits: Limits = LIMITS, **speeds: float
) -> ToolTrajectory:
    p, R = tool(q)
    goal = R if turn is None else R @ turn
    move = LinearMove(position=tuple(p + way), quaternion=tuple(quaternion_from_matrix(goal)), **speeds)
    return planned_line(q, move, ToolPoint(model(), TCP), R_FT=np.eye(3), limits=limits)


def test_a_line_ends_with_the_tools_own_frame_where_it_was_told() -> None:
    p, R = tool(HOME)
    R_FT, goal = rotation_from_rpy([0.0, 0.4, 1.2]), R @ rotation_from_rpy([0.2, 0.0, 0.3])
    move = LinearMove(position=tuple(np.add(p, [0.0, 0.1, 0.05])), quaternion=tuple(quaternion_from_matrix(goal @ R_FT)))
    rows = play(planned_line(HOME, move, ToolPoint(model(), TCP), R_FT=R_FT, limits=LIMITS))
    end, flange = tool(rows[-1].q)
    assert np.linalg.norm(end - p - [0.0, 0.1, 0.05]) < 1.5e-4
    assert angle_between(flange @ R_FT, goal @ R_FT) < 1e-3


def angle_between(a: Array, b: Array) -> float:
    return float(np.linalg.norm(a - b)) / np.sqrt(2.0)


TURN = rotation_from_rpy([0.3, -0.4, 0.5])


@pytest.mark.parametrize("turn", [np.eye(3), TURN], ids=["straight", "turning"])
@pytest.mark.parametrize("way", [[0.1, 0.15, 0.2], [-0.05, 0.2, -0.1], [0.0, 0.0, -0.15], [0.0, 0.002, 0.0]])
@pytest.mark.parametrize("speed", [0.1, 1.0])
def test_a_line_is_straight_and_ends_at_its_pose_at_rest(way: list[float], turn: Array, speed: float) -> None:
    p, R = tool(HOME)
    rows = play(line(way, turn, speed=speed, acceleration=1.0))
    check_consistency(rows, HOME)
    length = float(np.linalg.norm(way))
    along = np.array(way) / length
    span = max(length, 0.3 * np.arccos((np.trace(turn) - 1.0) / 2.0))
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    before, fastest = p, 0.0
    for row in rows[::10]:
        point, orientation = tool(row.q)
        off = point - p
        done = float(off @ along)
        assert np.linalg.norm(off - done * along) < 1e-4, "less than 0.1 mm off the line"
        fastest = max(fastest, float(np.linalg.norm(point - before)) / (10 * TICK))
        before = point
        turned = R.T @ orientation
        rest = np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
        assert np.linalg.norm(np.cross(rest, axis)) < 1e-3, "turning about one axis"
        if length > 0.1:
            share = np.arccos(np.clip((np.trace(turned) - 1.0) / 2.0, -1, 1)) / max(1e-9, np.arccos((np.trace(turn) - 1.0) / 2.0))
            assert turn is not TURN or abs(share - done / length) < 0.01, "in step with its way"
    assert fastest <= speed * length / span * 1.01
    end, orientation = tool(rows[-1].q)
    assert np.linalg.norm(end - p - way) < 1.5e-4
    assert angle_between(orientation, R @ turn) < 1e-3
    assert not rows[-1].qd.any()


def test_a_line_reaches_the_speed_that_was_asked_for() -> None:
    points = [tool(row.q)[0] for row in play(line([0.1, 0.2, 0.2], speed=0.1, acceleration=1.0))]
    speeds = np.linalg.norm(np.diff(points, axis=0), axis=1) / TICK
    assert np.median(speeds) == pytest.approx(0.1, rel=0.01)


def test_a_pure_turn_keeps_the_tool_centre_point() -> None:
    p, R = tool(HOME)
    turn = rotation(2, 2.5)
    rows = play(line([0.0, 0.0, 0.0], turn, speed=0.3))
    assert max(float(np.linalg.norm(tool(row.q)[0] - p)) for row in rows) < 1e-4
    assert angle_between(tool(rows[-1].q)[1], R @ turn) < 1e-3


def test_a_line_to_where_the_tool_is_ends_at_once() -> None:
    motion = line([0.0, 0.0, 0.0])
    assert motion.done
    assert (motion.step().q == HOME).all()


def test_a_line_slows_down_when_a_joint_would_be_too_fast() -> None:
    slow = (np.array([0.2, 9.0, 9.0, 9.0, 9.0, 9.0]), ACCELERATION, RANGE)
    way = [0.0, 0.3, 0.0]
    free, held = (play(line(way, limits=limits, speed=0.5, acceleration=2.0)) for limits in (LIMITS, slow))
    assert max(abs(row.qd[0]) for row in free) > 0.4, "without the limit the base turns faster"
    assert max(abs(row.qd[0]) for row in held) < 0.2 * 1.03
    assert max(abs(row.qd[0]) for row in held) > 0.2 * 0.8, "not slower than it must"
    check_consistency(held, HOME)


def test_a_fast_line_keeps_joint_accelerations() -> None:
    rows = play(line([0.1, 0.15, 0.2], speed=3.0, acceleration=50.0))
    assert max(float((np.abs(row.qdd) / ACCELERATION).max()) for row in rows) < 1.0
    assert max(float((np.abs(row.qd) / SPEED).max()) for row in rows) < 1.0


@pytest.mark.parametrize("speed", [0.001, 0.25, 3.0])
@pytest.mark.parametrize("way", [[0.0, 0.0, 0.9], [-0.9, 0.2, 0.0]])
def test_a_line_out_of_reach_is_refused(way: list[float], speed: float) -> None:
    with pytest.raises(MoveRefused, match=r"linear move: out of reach or singular \d+ mm on its way"):
        line(way, speed=speed)


def test_a_line_through_a_singularity_is_refused_and_told_where() -> None:
    """Straight over the base: the wrist passes the shoulder's singular cylinder, although both ends are in reach."""
    p, _ = tool(HOME)
    with pytest.raises(MoveRefused, match=r"out of reach or singular (\d+) mm") as refusal:
        line([0.8, 0.0, 0.0])
    told = float(str(refusal.value).split("singular ")[1].split(" mm")[0]) / 1000.0
    assert told == pytest.approx(-p[0], abs=0.06), "close to above the base axis"


def test_a_line_from_a_singular_posture_is_refused() -> None:
    aligned = HOME.copy()
    aligned[4] = 0.0
    with pytest.raises(MoveRefused, match="singular 0 mm"):
        line([0.05, 0.0, 0.0], q=aligned)


def test_a_line_beyond_a_joint_limit_is_refused() -> None:
    wound = HOME.copy()
    wound[5] = 6.1
    with pytest.raises(MoveRefused, match=r"linear move: joint 6 would reach 6\.\d+ rad, allowed ±6\.2832"):
        line([0.0, 0.0, 0.0], rotation(2, 0.6), q=wound)
    assert len(play(line([0.0, 0.0, 0.0], rotation(2, -0.6), q=wound))) > 10, "the other way is open"


@pytest.mark.parametrize("acceleration", [0.5, 1.0, 1.2, 2.5])
def test_a_line_whose_length_lies_on_the_border_of_two_profiles_is_planned(acceleration: float) -> None:
    """Its length is 2 a t², t the time in which the acceleration is reached: a search for roots fails for most of the starts."""
    length = 2.0 * acceleration * JERK_TIME**2
    for k in range(20):
        q = HOME + 0.01 * k
        rows = play(line([0.0, 0.0, length], q=q, speed=1.0, acceleration=acceleration))
        assert np.linalg.norm(tool(rows[-1].q)[0] - tool(q)[0] - [0.0, 0.0, length]) < 1e-4


def test_a_move_that_needs_more_torque_than_there_is_is_accelerated_less() -> None:
    stretched = np.array([0.0, -0.1, 0.0, 0.0, 0.0, 0.0])
    move = JointMove(q=tuple((stretched - [0.0, 1.2, 0.0, 0.0, 0.0, 0.0]).tolist()))
    rigid = chain(UR5E)
    loads = [Body(mass, np.array([0.0, 0.0, 0.1]), np.eye(3) * 0.01 * mass) for mass in (0.0, 5.0)]
    nothing, heavy = (Dynamics(rigid, rigid.links, load, mounting=[0.0, 0.0, 0.0], elbow=UR5E.chain.elbow) for load in loads)
    rotor, torque = np.array(UR5E.motors.rotor_inertia), np.array(UR5E.limits.torque)

    def needed(dynamics: Dynamics, rows: list[Reference]) -> float:
        return max(float(np.abs((dynamics.inverse(*row) + rotor * row.qdd) / torque).max()) for row in rows)

    plain = play(JointTrajectory(stretched, move, LIMITS))
    eased = play(JointTrajectory(stretched, move, LIMITS, Strength(heavy, rotor, torque)))
    assert needed(heavy, plain) > MOVING_SHARE + 0.05
    assert needed(heavy, eased) <= MOVING_SHARE + 0.02
    assert 1.0 < len(eased) / len(plain) < 2.0
    assert np.allclose(eased[-1].q, move.q)
    light = np.array([0.0, -1.57, 1.57, 0.0, 0.0, 0.0])
    small = JointMove(q=tuple((light + 0.1).tolist()))
    strong = play(JointTrajectory(light, small, LIMITS, Strength(nothing, rotor, torque)))
    assert len(strong) == len(play(JointTrajectory(light, small, LIMITS)))


def test_a_line_on_which_a_joint_turns_round_outside_its_range_is_refused() -> None:
    """Between two places that are looked at, both in range."""
    rows = play(line([0.0, 0.2, 0.0]))
    angles = np.array([row.q for row in rows])
    turns = [j for j in range(6) if angles[:, j].max() > max(angles[0, j], angles[-1, j]) + 1e-4]
    assert turns, "some joint goes out and comes back"
    joint = turns[0]
    for beyond, refused in ((-1e-5, True), (1e-5, False)):
        position = POSITION.copy()
        position[joint] = angles[:, joint].max() + beyond
        if position[joint] < abs(angles[:, joint]).max() - 2e-5:
            continue
        limits = (SPEED, ACCELERATION, np.array([-position, position]))
        if refused:
            with pytest.raises(MoveRefused, match=f"joint {joint + 1} would reach"):
                line([0.0, 0.2, 0.0], limits=limits)
        else:
            line([0.0, 0.2, 0.0], limits=limits)
