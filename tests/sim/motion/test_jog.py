"""Jogging: a length is kept, limits hold, the end of a range and a singularity stop it."""

import numpy as np
import pytest

from pendant.program.jog_move import JogMove
from pendant.robot.reduced import SpeedLimits
from pendant.tick.modes import TICK
from sim.motion.jog import JOINT_SHARE, MANUAL, JogTrajectory
from sim.motion.moves import MoveRefused
from tests.sim.arms import UR5E
from tests.sim.laws import dynamics

HOME = np.array(UR5E.chain.home)
MODEL = dynamics()
TCP = np.array([0.0, 0.0, 0.1])
LIMITS = (np.array(UR5E.limits.speed), np.array(UR5E.limits.acceleration), np.array(UR5E.limits.position))


def jog(frame: str, axis: int, sign: int, length: float = 0.0, q: np.ndarray = HOME) -> JogTrajectory:
    move = JogMove(id=-1, frame=frame, axis=axis, sign=sign, length=length)  # type: ignore[arg-type]
    return JogTrajectory(q, move, MODEL, tcp=TCP, R_FT=np.eye(3), limits=LIMITS)


def tool(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    p, R, _ = MODEL.places(q)
    return p + R @ TCP, R.copy()


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("frame", ["base", "tool"])
def test_fifty_millimetres_along_an_axis_are_fifty_millimetres(frame: str, sign: int) -> None:
    start, R = tool(HOME)
    motion = jog(frame, 2, sign, 0.05)
    now = motion.step()
    fastest = 0.0
    for _ in range(1000):
        now = motion.step()
        fastest = max(fastest, float(np.linalg.norm(tool(now.q)[0] - tool(now.q - TICK * now.qd)[0])) / TICK)
        if motion.done:
            break
    assert motion.done
    end, S = tool(now.q)
    along = R[:, 2] if frame == "tool" else np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(end - start, sign * 0.05 * along, atol=1e-4)
    np.testing.assert_allclose(S, R, atol=1e-4)
    assert np.abs(now.qd).max() < 0.01  # what the line still makes good
    assert 0.1 < fastest <= 1.001 * MANUAL


def test_about_an_axis_of_the_base_the_tool_turns_on_the_spot() -> None:
    start, R = tool(HOME)
    motion = jog("base", 5, 1, 0.2)
    now = motion.step()
    for _ in range(1000):
        now = motion.step()
    end, S = tool(now.q)
    np.testing.assert_allclose(end, start, atol=1e-4)
    c, s = np.cos(0.2), np.sin(0.2)
    np.testing.assert_allclose(S @ R.T, [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], atol=1e-4)


def test_the_speed_share_slows_it_down_and_zero_halts_it() -> None:
    motion = jog("joint", 5, 1)
    now = motion.step()
    for _ in range(500):
        now = motion.step(0.5)
    assert now.qd[5] == pytest.approx(0.5 * JOINT_SHARE * LIMITS[0][5])
    for _ in range(500):
        now = motion.step(0.0)
    assert now.qd[5] == 0.0


def test_in_reduced_tool_elbow_and_joints_stay_below_its_limits() -> None:
    motion = jog("joint", 1, 1)
    limits, speed = SpeedLimits(0.1, 0.1, 0.2), 0.0
    for _ in range(300):
        now = motion.step(1.0, limits)
        speed = float(np.linalg.norm(tool(now.q)[0] - tool(now.q - TICK * now.qd)[0])) / TICK
        assert speed <= limits.tcp
    assert speed > 0.05


def test_before_the_end_of_its_range_a_joint_comes_to_rest() -> None:
    q = HOME.copy()
    q[5] = LIMITS[2][5] - 0.3
    motion = jog("joint", 5, 1, q=q)
    now = motion.step()
    for _ in range(2000):
        now = motion.step()
        assert now.q[5] <= LIMITS[2][5]
        if motion.problem:
            break
    assert "joint 6 is at the end of its range" in motion.problem
    assert abs(now.qd[5]) < 0.01


def test_where_the_tool_cannot_go_everywhere_only_joints_are_jogged() -> None:
    stretched = np.array([0.0, -1.57, 0.0, 0.0, 1.57, 0.0])
    with pytest.raises(MoveRefused, match="singular here"):
        jog("base", 0, 1, q=stretched)
    assert not jog("joint", 2, 1, q=stretched).problem
