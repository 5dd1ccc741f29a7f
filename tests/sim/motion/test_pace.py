"""In REDUCED a program runs slowly enough, along the same path (FD-1)."""

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.inputs import Command
from pendant.program.steps import JointMove, LinearMove
from pendant.safety.robot_limits import SPEED_TOLERANCE, SpeedLimits
from pendant.tick.modes import TICK, Mode, Safety
from sim.arm.frames import quaternion_from_matrix
from sim.motion.pace import RAMP, Pace
from sim.motion.planned import JointTrajectory
from sim.motion.tool_trajectory import ToolTrajectory, planned_line
from sim.paths.tool_point import ToolPoint
from tests.sim.arms import UR5E
from tests.sim.bench import Bench
from tests.sim.laws import dynamics, meter

HOME = np.array(UR5E.chain.home)
MODEL = dynamics()
TCP = np.array([0.0, 0.0, 0.1])
LIMITS = (np.array(UR5E.limits.speed), np.array(UR5E.limits.acceleration), np.array(UR5E.limits.ends).T.copy())
REDUCED = SpeedLimits(0.25, 0.25, (1.0,) * 6)
SLOW = apply(Settings(), {f"robot_limits.reduced.{part}_speed": 0.25 for part in ("tool", "elbow")})
FAST = JointMove(id=1, q=tuple((np.add(HOME, [1.2, 0.2, -0.3, 0.3, 0.4, 1.5])).tolist()), speed=0.5, acceleration=0.5)


def joint_move() -> JointTrajectory:
    return JointTrajectory(HOME, FAST, LIMITS)


def line() -> ToolTrajectory:
    p, R, _ = MODEL.update(HOME)
    place = p + R @ TCP + [0.0, 0.25, -0.1]
    move = LinearMove(id=1, position=tuple(place.tolist()), quaternion=tuple(quaternion_from_matrix(R)), speed=1.0)
    return planned_line(HOME, move, ToolPoint(MODEL, TCP), R_FT=np.eye(3), limits=LIMITS)


def speeds(before: np.ndarray, after: np.ndarray) -> tuple[float, float, float]:
    """Of tool, elbow and fastest joint from one tick to the next, by the model's places."""
    (p, R, elbow), (q, S, now) = MODEL.places(before), MODEL.places(after)
    tcp = float(np.linalg.norm(q + S @ TCP - p - R @ TCP))
    return tcp * 500.0, float(np.linalg.norm(now - elbow)) * 500.0, float(np.abs(after - before).max()) * 500.0


@pytest.mark.parametrize("made", [joint_move, line])
def test_a_move_keeps_below_every_limit_and_on_its_path(made: type) -> None:
    full, motion, pace = made(), made(), Pace(meter(MODEL, TCP))
    path = []
    while not full.done:
        path.append(full.step().q)
    pace.begin(motion, REDUCED, 1.0)
    assert pace.rate < 1.0
    worst = np.zeros(3)
    q, count = motion.step(pace.step(motion, REDUCED, 1.0)).q, 1
    while not motion.done:
        now = motion.step(pace.step(motion, REDUCED, 1.0)).q
        worst = np.maximum(worst, speeds(q, now))
        q, count = now, count + 1
    shares = worst / [REDUCED.tcp, REDUCED.elbow, min(REDUCED.joints)]
    assert 0.97 < shares.max() < 1.001
    np.testing.assert_allclose(q, path[-1], atol=2e-4)
    assert count == pytest.approx(len(path) / pace.rate, abs=1.0 / pace.rate + 1.0)  # each ends within a tick


def test_a_slow_move_is_left_alone() -> None:
    motion = JointTrajectory(HOME, JointMove(id=1, q=tuple((HOME + 0.1).tolist()), speed=0.02, acceleration=0.1), LIMITS)
    pace = Pace(meter(MODEL, TCP))
    pace.begin(motion, REDUCED, 1.0)
    assert pace.rate == 1.0


def test_reduced_comes_and_goes_by_a_ramp_and_speeds_belong_to_the_way() -> None:
    motion, pace = joint_move(), Pace(meter(MODEL, TCP))
    pace.begin(motion, None, 1.0)
    before = None
    rates = []
    for tick in range(500):
        reference = motion.step(pace.step(motion, REDUCED if 200 <= tick < 350 else None, 1.0))
        rates.append(pace.rate)
        if before is not None:
            np.testing.assert_allclose(reference.q - before.q, (reference.qd + before.qd) / 1000.0, atol=2e-5)
            np.testing.assert_allclose(reference.qd - before.qd, (reference.qdd + before.qdd) / 1000.0, atol=0.03)
        before = reference
    assert rates[199] == rates[-1] == 1.0
    assert rates[349] < 0.6
    assert float(np.abs(np.diff(rates)).max()) == pytest.approx(0.002 / RAMP)


def test_a_program_in_reduced_is_not_stopped_and_is_as_fast_as_allowed() -> None:
    bench = Bench(settings=SLOW)
    bench.do(Command.REDUCED_ON)
    bench.run(0.6)
    bench.start_joint_move(np.add(HOME, [0.8, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.5)
    fastest = 0.0
    for _ in range(700):
        bench.tick()
        fastest = max(fastest, bench.estimate.v_tcp)
    assert bench.mode is Mode.RUN
    assert 0.95 * 0.25 < fastest < 0.25 + SPEED_TOLERANCE


def test_reduced_in_the_middle_of_a_fast_program_slows_it_down_in_time() -> None:
    bench = Bench(settings=SLOW)
    bench.start_joint_move(np.add(HOME, [1.5, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.4)
    bench.run(0.6)
    assert bench.estimate.v_tcp > 0.4
    decision = bench.do(Command.REDUCED_ON)
    bench.run(1.2)
    assert (bench.mode, decision.safety) == (Mode.RUN, Safety.REDUCED)
    assert bench.estimate.v_tcp < 0.25 + SPEED_TOLERANCE


def test_a_share_of_the_speed_stretches_the_time_and_keeps_the_path() -> None:
    full, half, pace = joint_move(), joint_move(), Pace(meter(MODEL, TCP))
    pace.begin(half, None, 0.5)
    ticks = 0
    while not half.done:
        half.step(pace.step(half, None, 0.5))
        ticks += 1
    assert abs(ticks - 2 * full.remaining / TICK) <= 2


def test_a_share_of_none_halts_the_motion_and_it_goes_on_later() -> None:
    motion, pace = joint_move(), Pace(meter(MODEL, TCP))
    pace.begin(motion, None, 1.0)
    for _ in range(100):
        motion.step(pace.step(motion, None, 1.0))
    for _ in range(200):
        motion.step(pace.step(motion, None, 0.0))
    assert np.all(motion.step(pace.step(motion, None, 0.0)).qd == 0.0)
    left = motion.remaining
    while not motion.done:
        motion.step(pace.step(motion, None, 1.0))
    assert left > 0.0
