"""Kinematics of the tool centre point against frames, finite differences and singular values."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.arm.frames import joint_frames, quaternion_from_matrix, rotation_by, rotation_vector
from sim.paths.curves import Circle, Corner, Path, Piece, Straight, straight_to
from sim.paths.tool_kinematics import SINGULAR
from sim.paths.tool_point import Followed, ToolPoint
from tests.sim.arms import ARMS, UR5E, load_arm
from tests.sim.laws import dynamics

Array = NDArray[np.float64]

HOME = np.array(UR5E.chain.home)
TCP = np.array([0.03, -0.02, 0.15])
TOOL = ToolPoint(dynamics(), TCP)
ASIDE = 1e-5  # [m]


def frames(q: Array) -> tuple[Array, Array]:
    flange = joint_frames(UR5E, q)[-1]
    return flange[:3, :3] @ TCP + flange[:3, 3], flange[:3, :3]


def pieces() -> list[Piece]:
    """One of each kind, all begin where the arm stands."""
    p, R = frames(HOME)
    turn = np.array([0.3, -0.2, 0.4])
    first = Straight(p, R, np.array([0.0, 0.1, 0.02]), turn)
    second = Straight(p + first.way, R @ rotation_by(turn), np.array([0.02, 0.0, 0.1]), -turn)
    circle = Circle(p, via=np.add(p, [0.02, 0.05, 0.0]), end=np.add(p, [0.0, 0.1, 0.05]))
    return [first, circle.turning(R, turn, circle.radius * circle.angle), Corner(first, second, 0.06)]


def test_pose_twist_and_speeds_are_those_of_the_frames() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        q, qd = HOME + rng.uniform(-0.5, 0.5, 6), rng.uniform(-1.0, 1.0, 6)
        p, R = TOOL.pose(q)
        np.testing.assert_allclose(p, frames(q)[0], atol=1e-12)
        np.testing.assert_allclose(R, frames(q)[1], atol=1e-12)
        v, w = TOOL.twist(q, qd)
        h = 1e-6
        (p_0, R_0), (p_1, R_1) = frames(q - h * qd), frames(q + h * qd)
        np.testing.assert_allclose(v, (p_1 - p_0) / (2.0 * h), atol=1e-8)
        np.testing.assert_allclose(w, rotation_vector(R_1 @ R_0.T) / (2.0 * h), atol=1e-8)
        np.testing.assert_allclose(TOOL.speeds(q, v, w), qd, atol=1e-3)
        force = rng.uniform(-10.0, 10.0, 3)
        assert TOOL.torque(q, force) @ qd == pytest.approx(force @ v)


def test_another_tool_is_used_at_once() -> None:
    tcp = TCP.copy()
    tool = ToolPoint(dynamics(), tcp)
    before = tool.pose(HOME)[0]
    tcp[2] += 0.1
    p, R = tool.pose(HOME)
    np.testing.assert_allclose(p - before, 0.1 * R[:, 2], atol=1e-12)


@pytest.mark.parametrize("which", range(3), ids=["line", "circle", "corner"])
def test_joint_angles_follow_a_way_and_their_derivatives_are_those_of_the_angles(which: int) -> None:
    piece = pieces()[which]
    record, length = piece.record, piece.length
    begin = TOOL.follow(record, 0.0, Followed.at(HOME))
    for s in np.linspace(0.05 * length, 0.95 * length, 7):
        joints = TOOL.follow(record, s, begin, s)
        assert joints.reached
        ahead, behind = (TOOL.follow(record, s + h, joints, h) for h in (ASIDE, -ASIDE))
        np.testing.assert_allclose(joints.rate, (ahead.q - behind.q) / (2.0 * ASIDE), atol=1e-4, rtol=1e-4)
        np.testing.assert_allclose(joints.bend, (ahead.rate - behind.rate) / (2.0 * ASIDE), atol=1e-3, rtol=1e-3)
        # Its speed is that of the tool, or of a lever that turns.
        v, w = TOOL.twist(joints.q, joints.rate)
        assert np.linalg.norm(v) <= 1.0 + 1e-4
        assert max(float(np.linalg.norm(v)), 0.3 * float(np.linalg.norm(w))) > 0.5


def test_of_seven_joints_the_bend_is_the_change_of_the_rate_too() -> None:
    """The shortest solution of one place is not that of the next: joints go where the tool does not see it."""
    arm = load_arm("iiwa7")
    tool = ToolPoint(dynamics(arm=arm), TCP)
    home = np.add(arm.chain.home, 0.2)
    p, R = tool.pose(home)
    line = Straight(p, R, np.array([0.1, 0.05, -0.1]), np.array([0.3, -0.2, 0.4]))
    joints = tool.follow(line.record, 0.05, tool.follow(line.record, 0.0, Followed.at(home)), 0.05)
    assert joints.reached
    aside = 10.0 * ASIDE  # the damped inverse rounds to 1e-8 where the tool sees nothing
    ahead, behind = (tool.follow(line.record, 0.05 + h, joints, h) for h in (aside, -aside))
    change = (ahead.rate - behind.rate) / (2.0 * aside)
    np.testing.assert_allclose(joints.bend, change, atol=1e-3, rtol=1e-3)
    unseen = change - np.linalg.pinv(tool_jacobian(tool, joints.q)) @ tool_jacobian(tool, joints.q) @ change
    assert float(np.abs(unseen).max()) > 0.05


def tool_jacobian(tool: ToolPoint, q: Array) -> Array:
    """(6, n)."""
    return np.array([np.concatenate(tool.twist(q, unit)) for unit in np.eye(q.size)]).T


def test_far_away_the_same_posture_of_the_arm_is_found() -> None:
    p, R = frames(HOME)
    line = Straight(p, R, np.array([0.1, 0.25, 0.1]), np.array([0.5, 0.3, 1.0]))
    near = TOOL.follow(line.record, 0.0, Followed.at(HOME))
    for k in range(1, 201):
        near = TOOL.follow(line.record, k / 200 * line.length, near, line.length / 200)
    far = TOOL.follow(line.record, line.length, TOOL.follow(line.record, 0.0, Followed.at(HOME)), line.length)
    assert float(np.abs(near.q - HOME).max()) > 0.6, "several leaps"
    np.testing.assert_allclose(far.q, near.q, atol=1e-9)


def test_out_of_reach_no_joint_angles_are_found() -> None:
    p, R = frames(HOME)
    line = Straight(p, R, np.array([2.0, 0.0, 0.0]), np.zeros(3))
    assert not TOOL.follow(line.record, 1.9, Followed.at(HOME), 1.9).reached
    assert not TOOL.follow(line.record, math.nan, Followed.at(HOME)).reached


def test_singular_is_what_the_smallest_singular_value_says() -> None:
    rng = np.random.default_rng(2)
    seen = set()
    for k in range(300):
        q = rng.uniform(-3.0, 3.0, 6)
        if k % 2:
            q[rng.choice([2, 4])] = rng.uniform(-0.2, 0.2)
        columns = [np.concatenate(TOOL.twist(q, unit)) for unit in np.eye(6)]
        least = float(np.linalg.svd(np.array(columns), compute_uv=False)[-1])
        assert TOOL.singular(q) is (least < SINGULAR)
        seen.add(least < SINGULAR)
    assert seen == {False, True}


def test_a_line_goes_over_into_the_next_without_a_step_in_its_speed() -> None:
    p, R = frames(HOME)
    end, R_end = np.add(p, [0.0, 0.1, 0.0]), R @ rotation_by(np.array([0.2, 0.0, 0.0]))
    first = straight_to(p, R, end, R_end)
    for way in ([0.0, 0.0, 0.1], [0.0, 0.1, 0.0], [1e-6, 0.1, 0.0], [0.001, 0.1, 0.05]):
        path = Path.of(first, end, R_end).goes_on(end + way, R, radius=0.03, s=0.0)
        assert path is not None
        joints = Followed.at(HOME)
        for before, after in zip(path.parts, path.parts[1:], strict=False):
            assert before.end == pytest.approx(after.begin)
            one = TOOL.follow(before.piece.record, before.last, joints, before.end)
            other = TOOL.follow(after.piece.record, after.first, one)
            np.testing.assert_allclose(other.q, one.q, atol=1e-9)
            np.testing.assert_allclose(other.rate, one.rate, atol=2e-4)
            joints = other
        last = path.parts[-1]
        np.testing.assert_allclose(TOOL.pose(TOOL.follow(last.piece.record, last.last, joints).q)[0], end + way, atol=1e-9)


@pytest.mark.parametrize("name", ARMS)
def test_half_a_turn_has_a_vector(name: str) -> None:
    for axis in np.eye(3):
        turned = rotation_by(math.pi * axis)
        np.testing.assert_allclose(np.abs(rotation_vector(turned)), math.pi * axis, atol=1e-9)
        assert quaternion_from_matrix(turned)[0] == pytest.approx(0.0, abs=1e-9), name
