"""Jogging: a length is kept, limits hold, the end of a range and a singularity stop it."""

import numpy as np
import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import Inputs
from pendant.program.jog_move import JogMove, MoveStraight, MoveThere
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import TICK
from sim.arm.frames import quaternion_from_matrix
from sim.exchange.desk import Wishes
from sim.motion.jog import JOINT_SHARE, MANUAL, PLANNED_SHARE, JogTrajectory, at_manual_speed
from sim.motion.moves import MoveRefused
from sim.motion.pace import Pace
from sim.paths.tool_point import ToolPoint
from tests.sim.arms import UR5E
from tests.sim.bench import Bench
from tests.sim.laws import dynamics, meter

HOME = np.array(UR5E.chain.home)
MODEL = dynamics()
TCP = np.array([0.0, 0.0, 0.1])
LIMITS = (np.array(UR5E.limits.speed), np.array(UR5E.limits.acceleration), np.array(UR5E.limits.ends).T.copy())


def jog(frame: str, axis: int, sign: int, length: float = 0.0, q: np.ndarray = HOME) -> JogTrajectory:
    move = JogMove(id=-1, frame=frame, axis=axis, sign=sign, length=length)  # type: ignore[arg-type]
    return JogTrajectory(q, move, ToolPoint(MODEL, TCP), R_FT=np.eye(3), limits=LIMITS, pace=Pace(meter(MODEL, TCP)))


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
    limits, speed = SpeedLimits(0.1, 0.1, (0.2,) * 6), 0.0
    for _ in range(300):
        now = motion.step(1.0, limits)
        speed = float(np.linalg.norm(tool(now.q)[0] - tool(now.q - TICK * now.qd)[0])) / TICK
        assert speed <= 1.001 * limits.tcp
    assert speed > 0.05


def test_before_the_end_of_its_range_a_joint_comes_to_rest() -> None:
    q = HOME.copy()
    q[5] = LIMITS[2][1, 5] - 0.3
    motion = jog("joint", 5, 1, q=q)
    now = motion.step()
    for _ in range(2000):
        now = motion.step()
        assert now.q[5] <= LIMITS[2][1, 5]
        if motion.problem:
            break
    assert "joint 6 is at the end of its range" in motion.problem
    assert abs(now.qd[5]) < 0.01


def test_where_the_tool_cannot_go_everywhere_only_joints_are_jogged() -> None:
    stretched = np.array([0.0, -1.57, 0.0, 0.0, 1.57, 0.0])
    with pytest.raises(MoveRefused, match="singular here"):
        jog("base", 0, 1, q=stretched)
    assert not jog("joint", 2, 1, q=stretched).problem


def there(posture: np.ndarray) -> MoveThere:
    return MoveThere(q=tuple(posture.tolist()))


def held(move: MoveThere | MoveStraight, ticks: int) -> tuple[Bench, list[Event], float]:
    """An arm at its home, on which somebody holds the button of a move for so long: what happened, its fastest [m/s]."""
    bench = Bench()
    bench.run(0.1)
    asked = Wishes(Inputs(jog=move), (), ())
    events: list[Event] = []
    fastest = 0.0
    for _ in range(ticks):
        events += bench.tick(asked).events
        seen = bench.simulation.estimate
        fastest = max(fastest, seen.v_tcp, seen.v_elbow)
        if any(event.kind is Kind.JOG_ENDED for event in events):
            break
    return bench, events, fastest


def test_a_posture_is_reached_at_manual_speed_while_the_button_is_held() -> None:
    posture = HOME + np.array([0.0, 0.5, -0.3, 0.0, 0.0, 0.2])
    bench, events, fastest = held(there(posture), 4000)
    assert [event.kind for event in events][-2:] == [Kind.JOG_STARTED, Kind.JOG_ENDED]
    assert (events[-1].values["what"], events[-1].values["reason"]) == ("to the posture", "done")
    np.testing.assert_allclose(bench.estimate.q, posture, atol=2e-3)
    assert 0.15 < fastest <= MANUAL


def test_letting_go_on_the_way_to_a_posture_stops_the_arm() -> None:
    bench, _, _ = held(there(HOME + 0.5), 500)
    events = list(bench.tick(Wishes(Inputs(jog_released=True), (), ())).events)
    assert [event.values["reason"] for event in events if event.kind is Kind.JOG_ENDED] == ["let go"]
    bench.run(0.5)
    stood = bench.estimate.q.copy()
    bench.run(0.5)
    np.testing.assert_allclose(bench.estimate.q, stood, atol=2e-3)
    assert 0.02 < float(np.abs(stood - HOME).max()) < 0.48


def test_reduced_mode_is_slower_than_manual_speed_where_it_asks_for_that() -> None:
    assert at_manual_speed(there(HOME), None) == SpeedLimits(PLANNED_SHARE * MANUAL, PLANNED_SHARE * MANUAL, ())
    assert at_manual_speed(there(HOME), SpeedLimits(0.1, 0.5, (0.3,) * 6)) == SpeedLimits(0.1, PLANNED_SHARE * MANUAL, (0.3,) * 6)
    assert at_manual_speed(None, None) is None


def test_a_pose_is_reached_straight_and_at_manual_speed_while_the_button_is_held() -> None:
    before = Bench()
    before.run(0.1)
    seen = before.estimate
    x, y, z = (seen.tcp[:3] + np.array([0.1, 0.05, 0.1])).tolist()
    w, i, j, k = quaternion_from_matrix(seen.R_BF).tolist()
    bench, events, fastest = held(MoveStraight(position=(x, y, z), quaternion=(w, i, j, k), speed=1.0), 4000)
    assert (events[-1].values["what"], events[-1].values["reason"]) == ("straight to the pose", "done")
    assert events[-1].values["moved"] == "150 of 150 mm"
    np.testing.assert_allclose(bench.estimate.tcp[:3], (x, y, z), atol=1e-3)
    assert 0.1 < fastest <= MANUAL


def test_a_pose_out_of_reach_is_refused() -> None:
    _, events, _ = held(MoveStraight(position=(3.0, 0.0, 0.5), quaternion=(0.0, 1.0, 0.0, 0.0)), 4000)
    assert events[-1].kind is Kind.JOG_ENDED
    assert "linear move" in str(events[-1].values["reason"])
