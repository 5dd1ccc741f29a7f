"""Active damping: nothing below its onset, the whole resistance at the limit, never a push."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING
from pendant.limits.soft_limits import Damping
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import Mode
from sim.arm.frames import joint_frames
from sim.control.active_damping import FADE, FALL, STEEPEST_JOINT, STEEPEST_TCP, ActiveDamping
from sim.exchange.desk import Wishes
from tests.sim.arms import UR5E
from tests.sim.bench import Bench, push
from tests.sim.laws import N, dynamics, estimate

RATED, ROTOR, ELBOW = np.array(UR5E.limits.torque), np.array(UR5E.motors.rotor_inertia), UR5E.chain.elbow
MODEL = dynamics()
Q = np.array(UR5E.chain.home)
P, R, JACOBIAN = (part.copy() for part in MODEL.update(Q))
TCP = np.array([0.02, -0.01, 0.15, 1.0])
LIMITS = Damping(1.5, 1.5, 3.0, 0.5, 120.0, 0.7)
OFF = math.inf
speeds = st.lists(st.floats(-4.0, 4.0), min_size=N, max_size=N)


def points(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tool centre point and elbow in B [m]."""
    frames = joint_frames(UR5E, q)
    return (frames[-1] @ TCP)[:3], frames[ELBOW][:3, 3]


def moving(
    qd: np.ndarray,
    ticks: int = 1,
    module: ActiveDamping | None = None,
    limits: Damping = LIMITS,
    reduced: SpeedLimits | None = None,
) -> np.ndarray:
    """Torque in the last of these ticks."""
    module = module or ActiveDamping(RATED, ROTOR, ELBOW)
    tcp, elbow = points(Q)
    seen = estimate(
        q=Q, theta_d=np.array(qd, dtype=float), p_BF=P, R_BF=R, tcp=np.append(tcp, [0.0] * 3), elbow=np.append(elbow, [0.0] * 3)
    )
    for _ in range(ticks):
        torque = np.zeros(N)
        module.add(seen, limits, reduced, jacobian=JACOBIAN, torque=torque)
    return torque


def speed_of(point: int, qd: np.ndarray) -> float:
    step = 1e-6 * np.asarray(qd)
    return float(np.linalg.norm(points(Q + step)[point] - points(Q - step)[point])) / 2e-6


def test_a_joint_is_free_up_to_the_onset_and_fully_resisted_at_its_limit() -> None:
    limits = LIMITS._replace(tcp=OFF, elbow=OFF)
    assert not moving(np.full(N, 1.5), limits=limits).any()
    for speed, share in ((3.0, 1.0), (-3.0, -1.0), (2.25, 0.5)):
        wanted = -share * np.minimum(0.7 * RATED, 1.5 * STEEPEST_JOINT * ROTOR)
        np.testing.assert_allclose(moving(np.full(N, speed), limits=limits), wanted)


def test_tool_and_elbow_are_resisted_along_their_motion() -> None:
    """By virtual work: the power of the torque is that of a force against the motion of the point."""
    qd = np.array([0.2, 1.4, -0.3, 0.1, 0.4, 0.2])
    for point, limits in ((0, LIMITS._replace(elbow=OFF, joint=OFF)), (1, LIMITS._replace(tcp=OFF, joint=OFF))):
        fast = speed_of(point, qd)
        at = limits._replace(**{("tcp", "elbow")[point]: 0.8 * fast}, force=10.0)
        force = 10.0 * 0.6 / 0.4  # 0.6 of the way from 0.4 of the speed, where it begins, to 0.8
        assert math.isclose(-moving(qd, limits=at) @ qd, force * fast, rel_tol=1e-6)
        assert not moving(qd, limits=limits._replace(**{("tcp", "elbow")[point]: 2.1 * fast})).any()


@given(speeds)
def test_it_is_never_steeper_than_what_the_rotors_bear(qd: list[float]) -> None:
    """What the torque does to the rotors alone slows a point down by STEEPEST_TCP times its speed at most."""
    low = LIMITS._replace(tcp=1e-6, elbow=OFF, joint=OFF, onset=0.1)
    slowing = speed_of(0, np.array(qd)) - speed_of(0, np.array(qd) + moving(np.array(qd), limits=low) / ROTOR / STEEPEST_TCP)
    assert slowing <= speed_of(0, np.array(qd)) + 1e-5


@given(speeds, st.floats(0.02, 3.0), st.floats(0.1, 0.9))
def test_it_only_ever_takes_energy(qd: list[float], size: float, onset: float) -> None:
    limits = Damping(size, size, 2.0 * size, onset, 300.0, 1.0)
    assert moving(np.array(qd), limits=limits) @ qd <= 0.0


def test_in_reduced_the_lower_limits_hold() -> None:
    qd = np.array([0.4, 0.3, 0.2, 0.6, 0.5, 0.3])
    reduced = SpeedLimits(0.25, 0.2, (1.0,) * N)
    both = moving(qd, reduced=reduced)
    np.testing.assert_array_equal(both, moving(qd, limits=Damping(0.25, 0.2, 1.0, *LIMITS[3:])))
    assert both.any()
    low, high = Damping(0.25, 0.2, 1.0, *LIMITS[3:]), SpeedLimits(9, 9, (9,) * N)
    np.testing.assert_array_equal(moving(qd, limits=low, reduced=high), both)


def test_each_joint_has_a_limit_of_its_own() -> None:
    """Both turn equally fast, and the robot's limit of the second is lower: it alone is resisted, as one with that limit is."""
    qd, free = np.array([0.5, 0.5, 0.0, 0.0, 0.0, 0.0]), LIMITS._replace(tcp=OFF, elbow=OFF)
    torque = moving(qd, limits=free, reduced=SpeedLimits(9, 9, (9.0, 0.6, *[9.0] * (N - 2))))
    assert torque[0] == 0.0
    assert torque[1] == moving(qd, limits=free._replace(joint=0.6))[1] < 0.0


def test_a_limit_falls_smoothly_and_rises_at_once() -> None:
    qd = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    low = Damping(OFF, OFF, 1.2, 0.5, 120.0, 0.1)
    whole = moving(qd, limits=low)[0]
    module = ActiveDamping(RATED, ROTOR, ELBOW)
    moving(qd, 1, module, LIMITS._replace(tcp=OFF, elbow=OFF))
    first = moving(qd, 1, module, low)[0]
    assert abs(first) < 0.05 * abs(whole)
    assert abs(moving(qd, round(6.0 * FALL * 500), module, low)[0] - whole) < 0.02 * abs(whole)
    assert not moving(qd, 1, module, LIMITS._replace(tcp=OFF, elbow=OFF)).any()
    moving(qd, 1, module, low)
    module.start()
    assert moving(qd, 1, module, low)[0] == whole


def pushed(force: float, **changes: float | bool) -> Bench:
    """2 s of a constant push sideways, right after entry."""
    bench = Bench(settings=apply(Settings(), {"activation.period": 0.1, **changes}))
    bench.enter()
    bench.run(2.0, push("flange", (0.0, force, 0.0)))
    return bench


def test_a_constant_push_of_50_newtons_stays_in_free_drive_and_without_it_leaves() -> None:
    guided = pushed(50.0)
    assert guided.mode is Mode.FREE_DRIVE
    assert guided.simulation.tick(Wishes(NOTHING, (), ())).damping is not None
    assert pushed(50.0, **{"soft.on": False}).mode is Mode.TEACH


def test_damped_at_tool_elbow_and_joints_at_once_it_does_not_chatter() -> None:
    low = {f"limits.operation.{name}.max": 0.6 for name in ("tcp_speed", "elbow_speed")}
    slow = {"soft.onset": 0.15, "limits.operation.joint_speed.max": 1.0, "limits.operation.flange_acceleration.on": False}
    bench = Bench(settings=apply(Settings(), {"activation.period": 0.1, **low, **slow}))
    bench.enter()
    speeds: list[np.ndarray] = []
    for k in range(400):
        bench.run(0.002, push("flange", (0.0, 0.0, min(k, 30.0))))
        speeds.append(bench.estimate.theta_d)
    assert bench.mode is Mode.FREE_DRIVE
    assert np.abs(speeds).max() > 0.3
    assert np.abs(np.diff(speeds, 2, axis=0)).max() < 0.02


def test_the_help_for_the_hand_fades_and_comes_back() -> None:
    module = ActiveDamping(RATED, ROTOR, ELBOW)
    limits = LIMITS._replace(tcp=OFF, elbow=OFF)
    moving(np.full(N, 2.25), round(8.0 * FADE * 500), module, limits)
    assert math.isclose(module.help, 0.5, abs_tol=1e-3)
    moving(np.full(N, 9.0), round(8.0 * FADE * 500), module, limits)
    assert math.isclose(module.help, 0.0, abs_tol=1e-3)
    moving(np.zeros(N), round(8.0 * FADE * 500), module, limits)
    assert math.isclose(module.help, 1.0, abs_tol=1e-3)
    moving(np.full(N, 9.0), 50, module, limits)
    module.start()
    assert module.help == 1.0
