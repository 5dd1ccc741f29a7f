"""Locked axes: the constraint and its Jacobian, projection, bounds, energy, and an arm guided with locks (FD-4)."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pendant.all_settings import Settings, apply
from pendant.inputs import Inputs
from pendant.limits.axis_locks import AXES, PRESETS, AxisLocks, freeing, freeing_joints
from pendant.tick.modes import TICK, Mode
from pendant.tick.pose import UNTURNED, from_rpy
from sim.arm.frames import matrix_from_quaternion, rotation
from sim.arm.scenario import Scenario
from sim.control.axis_constraint import FURTHEST, HEAVIEST, MOST, AxisConstraint
from sim.exchange.desk import Wishes
from tests.sim.arms import UR5E
from tests.sim.bench import Bench, push
from tests.sim.laws import EXACT, N, dynamics, estimate

MODEL = dynamics()
HOME = np.array(UR5E.chain.home)
TCP = np.array([0.02, -0.03, 0.15])
TURNED = rotation(0, 0.6)  # orientation of the tool in F
ROTOR, RATED = np.array(UR5E.motors.rotor_inertia), np.array(UR5E.limits.torque)
NOTHING = np.zeros(N)
FLANGE = tuple(MODEL.update(HOME)[1].ravel().tolist())
FRAME = from_rpy(0.3, -0.4, 1.2)


def locks(*free: str, tool: bool = False, R_BU: tuple[float, ...] = FRAME, joints: tuple[int, ...] = ()) -> AxisLocks:
    held = tuple(k in joints for k in range(12))
    return AxisLocks(tuple(axis not in free for axis in AXES), tool, R_BU, 0.04, 0.01, held)  # type: ignore[arg-type]


class Held:
    """A constraint that begins at q, and the arm moved from there as rigid joints move it."""

    def __init__(self, kept: AxisLocks, q: np.ndarray = HOME) -> None:
        self.locks = kept
        self.module = AxisConstraint(UR5E, EXACT, TCP, TURNED)
        self.at(q)

    def at(self, q: np.ndarray, qd: np.ndarray = NOTHING, static: np.ndarray = NOTHING) -> "Held":
        p, R, jacobian = MODEL.update(q)
        compliance = 1.0 / (np.array(UR5E.transmissions.stiffness) + np.array(UR5E.transmissions.hysteresis_stiffness))
        seen = estimate(q=q, theta=q + compliance * static, theta_d=qd, p_BF=p.copy(), R_BF=R.copy())
        self.module.prepare(seen, self.locks, jacobian.copy(), static)
        return self

    @property
    def values(self) -> np.ndarray:
        return self.module._record["values"][0][: self.module._record["m"][0]].copy()

    @property
    def rows(self) -> np.ndarray:
        return self.module._record["rows"][0][: self.module._record["m"][0]].copy()

    @property
    def torque(self) -> np.ndarray:
        torque = np.zeros(N)
        self.module.hold(torque)
        return torque


SETS = [
    PRESETS["plane"], PRESETS["translation"], PRESETS["rotation"], {"x"}, {"z", "rx"}, {"x", "y", "z", "rx", "ry"},
    {"x", "y", "z", "ry", "rz"}, {"rx", "rz"}, set(),
]  # fmt: skip


@pytest.mark.parametrize("free", SETS)
@pytest.mark.parametrize("tool", [False, True])
def test_its_jacobian_is_the_derivative_of_what_is_locked(free: set[str], tool: bool) -> None:
    rng = np.random.default_rng(1)
    held = Held(locks(*free, tool=tool))
    assert np.abs(held.values).max() < 1e-12
    for size in (1e-3, 2e-3):
        q = HOME + size * rng.normal(size=N)
        rows = held.at(q).rows
        for i in range(N):
            step = np.zeros(N)
            step[i] = 1e-6
            slope = (held.at(q + step).values - held.at(q - step).values) / 2e-6
            np.testing.assert_allclose(rows[:, i], slope, atol=1e-5)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_free_turns_may_be_large(axis: int) -> None:
    """The last joint turns the tool about the flange's z: free, it moves nothing that is locked; the others stay locked."""
    held = Held(locks("x", "y", "z", "rz", R_BU=FLANGE))
    for angle in (0.5, 2.0, 3.0, -3.0):
        q = HOME + np.array([0.0, 0.0, 0.0, 0.0, 0.0, angle])
        assert np.abs(held.at(q).values).max() < 1e-9
        tilted = held.at(q + 1e-3 * np.eye(N)[3 + axis % 2]).values
        assert 1e-5 < np.abs(tilted).max() < 1e-3


def test_a_twist_is_told_from_a_swing() -> None:
    """With rz alone locked, swinging about x and y is free, turning about z is not."""
    held = Held(locks("x", "y", "z", "rx", "ry", R_BU=FLANGE))
    angles = (0.3, 1.0, 2.5)
    twists = [held.at(HOME + np.array([0.0, 0.0, 0.0, 0.0, 0.0, angle])).values[0] for angle in angles]
    np.testing.assert_allclose(np.abs(twists), np.minimum(0.2 * np.array(angles), FURTHEST), rtol=1e-6)


def test_equal_locks_go_on_and_others_begin_anew() -> None:
    held = Held(locks("x"))
    moved = HOME + 5e-4
    assert np.abs(held.at(moved).values).max() > 1e-4
    held.locks = locks("x")
    assert np.abs(held.at(moved).values).max() > 1e-4
    held.locks = locks("x", "y")
    assert np.abs(held.at(moved).values).max() < 1e-12
    held.at(HOME)
    held.module.release()
    assert np.abs(held.at(moved).values).max() < 1e-12


def test_what_bends_the_joints_at_rest_is_no_motion() -> None:
    held = Held(locks())
    load = np.array([0.0, 40.0, 20.0, 5.0, 1.0, 0.1])
    assert np.abs(held.at(HOME, static=load).values).max() < 1e-12


@given(st.integers(0, len(SETS) - 1), st.lists(st.floats(-20.0, 20.0), min_size=N, max_size=N))
def test_what_the_hand_asks_moves_the_rotors_along_free_axes_alone(which: int, asked: list[float]) -> None:
    held = Held(locks(*SETS[which]))
    wanted, torque = np.array(asked), np.full(N, 3.0)
    before = held.rows @ (wanted / ROTOR)
    held.module.project(wanted, 1.5, torque)
    after = held.rows @ (wanted / ROTOR)
    mobility = held.rows @ np.diag(1.0 / ROTOR) @ held.rows.T
    left = np.linalg.inv(mobility + np.eye(len(mobility)) / HEAVIEST) @ before / HEAVIEST
    np.testing.assert_allclose(after, left, atol=1e-6)
    np.testing.assert_allclose(torque - 3.0, 1.5 * (wanted - np.array(asked)), atol=1e-9)


def test_it_pulls_back_with_the_stiffness_of_holding() -> None:
    held = Held(locks("y", "z", "rx", "ry", "rz", R_BU=UNTURNED))
    q = HOME + np.linalg.pinv(held.rows) @ np.array([2e-3])
    held.at(q, qd=np.linalg.pinv(held.rows) @ np.array([1.0]))
    held.torque  # noqa: B018 - the spring is loaded on the way out
    held.at(q)
    (row,) = held.rows
    force = (2.0 * math.pi * 12.0) ** 2 * held.values[0] / (row @ (row / ROTOR) + 1.0 / HEAVIEST)
    np.testing.assert_allclose(held.torque, -row * force, rtol=1e-9)
    assert force > 4.0, "2 mm"


@given(st.integers(0, len(SETS) - 1), st.integers(0, 1000))
@settings(max_examples=40)
def test_its_torque_is_bounded_in_any_posture(which: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    held = Held(locks(*SETS[which]), rng.choice([HOME, np.zeros(N), rng.uniform(-3.0, 3.0, N)]))
    torque = held.at(rng.uniform(-3.0, 3.0, N), 3.0 * rng.normal(size=N)).torque
    assert np.isfinite(torque).all()
    assert (np.abs(torque) <= MOST * RATED * (1.0 + 1e-9)).all()


@given(st.integers(0, len(SETS) - 1), st.integers(0, 10000), st.booleans())
@settings(max_examples=40)
def test_it_never_injects_energy(which: int, seed: int, near_singular: bool) -> None:
    """Whatever a hand does to it, the constraint has never given more than it has taken."""
    rng = np.random.default_rng(seed)
    start = np.array([0.2, -1.2, 0.1, -1.87, -0.1, 0.3]) if near_singular else HOME
    held = Held(locks(*SETS[which]), start)
    q, given_back, most = start.copy(), 0.0, 0.0
    frequencies, phases = rng.uniform(0.3, 3.0, (2, N)), rng.uniform(0.0, 6.28, (2, N))
    for k in range(300):
        t = k * TICK
        qd = (
            0.4 * (np.sin(6.28 * frequencies[0] * t + phases[0]) + np.cos(6.28 * frequencies[1] * t + phases[1])) * min(t * 10, 1)
        )
        given_back += float(held.at(q, qd).torque @ qd) * TICK
        most = max(most, given_back)
        q = q + qd * TICK
    assert most <= 1e-9


def test_a_spring_that_stiffens_as_the_arm_moves_gives_back_no_more_than_it_took() -> None:
    """Pushed out of a lock, led along a free axis to where holding is stiffer, and let back in, all of it slowly."""
    kept = locks("x", "y", "rx", "ry", "rz", R_BU=UNTURNED)
    stretched, bent = np.array([0.0, -0.7, 0.6, -1.5, -1.57, 0.0]), np.array([0.0, -1.5, 2.2, -2.3, -1.57, 0.0])

    def height(q: np.ndarray) -> tuple[float, np.ndarray]:
        p, R, jacobian = MODEL.update(q)
        offset = R @ TCP
        return float(p[2] + offset[2]), (jacobian[:3] + np.cross(jacobian[3:].T, offset).T)[2:3]

    def lifted(q: np.ndarray, way: float) -> np.ndarray:
        for _ in range(8):
            z, row = height(q)
            q = q + np.linalg.pinv(row) @ np.array([height(stretched)[0] + way - z])
        return q

    path = [lifted(stretched, 0.008 * k / 1500) for k in range(1501)]
    path += [lifted(stretched + (bent - stretched) * k / 1500, 0.008) for k in range(1, 1501)]
    path += [lifted(bent, 0.008 * (1.0 - k / 1500)) for k in range(1, 1501)]
    held = Held(kept, stretched)
    given_back, most = 0.0, 0.0
    for before, after in itertools.pairwise(path):
        given_back += float(held.at(before, (after - before) / TICK).torque @ (after - before))
        most = max(most, given_back)
    assert most <= 1e-9
    assert -0.03 < given_back < 0.0


def guided(free: set[str] | frozenset[str], force: tuple[float, float, float], posture: list[float] | None = None) -> np.ndarray:
    """Way of the flange [mm] and turn [deg] after each tick of 1.5 s of a push, in B, as (ticks, 6)."""
    changes = {"activation.period": 0.1, "free_drive.period": 30.0}
    bench = Bench(Scenario(seed=5, posture=posture), settings=apply(Settings(), changes))
    bench.enter()
    bench.tick(Wishes(Inputs(settings=freeing(frozenset(free))), (), ()))
    bench.run(0.05)
    start = bench.plant.poses()[-1].copy()
    R = matrix_from_quaternion(start[3:])
    ways: list[np.ndarray] = []
    fastest = 0.0
    for k in range(750):
        share = min(k / 50.0, 1.0)
        bench.run(TICK, push("flange", (share * force[0], share * force[1], share * force[2])))
        now = bench.plant.poses()[-1]
        turn = matrix_from_quaternion(now[3:]) @ R.T
        axis = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        ways.append(np.concatenate([1e3 * (now[:3] - start[:3]), np.degrees(axis)]))
        fastest = max(fastest, float(np.abs(bench.simulation.estimate.qd).max()))
    assert bench.mode is Mode.FREE_DRIVE
    assert fastest < 3.0
    return np.array(ways)


def test_in_a_plane_the_tool_keeps_height_and_tilt() -> None:
    ways = guided(PRESETS["plane"], (0.0, 20.0, 0.0))
    assert np.abs(ways[:, 2]).max() < 3.0
    assert np.abs(ways[:, 3:5]).max() < 1.0
    assert np.hypot(ways[-1, 0], ways[-1, 1]) > 300.0


def test_what_is_locked_holds_against_a_push_of_50_newtons() -> None:
    ways = guided({"x", "y", "rx", "ry", "rz"}, (0.0, 0.0, -50.0))
    assert np.abs(ways[:, 2]).max() < 15.0


def test_a_locked_joint_is_held_like_a_rotor_that_holds_still() -> None:
    """K = J w²: 0.01 rad at a rotor of 0.6 kg·m² and 12 Hz are 34 N·m, less what HEAVIEST softens; the others feel nothing."""
    held = Held(locks(*AXES, joints=(1,)))
    turn = np.array([0.0, 0.01, 0.0, 0.0, 0.0, 0.0])
    held.at(HOME + turn, qd=turn / TICK)
    held.torque  # noqa: B018 - the spring is loaded on the way out
    torque = held.at(HOME + turn + 0.3 * np.eye(N)[3]).torque
    expected = np.zeros(N)
    expected[1] = -0.01 * (2.0 * math.pi * 12.0) ** 2 / (1.0 / ROTOR[1] + 1.0 / HEAVIEST)
    np.testing.assert_allclose(torque, expected, rtol=1e-9)
    assert -34.0 < torque[1] < -33.0
    assert MOST * RATED[1] > 60.0 > abs(torque[1])


def test_what_the_hand_asks_of_a_locked_joint_is_taken_away() -> None:
    held = Held(locks(*AXES, joints=(0, 1, 3, 4, 5)))
    asked, torque = np.full(N, 8.0), np.full(N, 8.0)
    held.module.project(asked, 1.0, torque)
    np.testing.assert_allclose(asked[[0, 1, 3, 4, 5]], 0.0, atol=0.1)  # but for what HEAVIEST leaves
    assert asked[2] == torque[2] == 8.0


def test_axes_and_joints_together_hold_and_stay_bounded() -> None:
    """A joint and a way that are both locked ask for what the others can give; a tool held by six axes and six joints, too."""
    for held in (Held(locks("x", "y", "rx", "ry", "rz", joints=(0, 5))), Held(locks(joints=tuple(range(N))))):
        rng = np.random.default_rng(3)
        for _ in range(50):
            torque = held.at(HOME + 0.02 * rng.normal(size=N), rng.normal(size=N)).torque
            assert np.isfinite(torque).all()
            assert (np.abs(torque) <= MOST * RATED * (1.0 + 1e-9)).all()


def test_only_the_elbow_turns_where_it_alone_is_free() -> None:
    """40 N across the forearm turn the elbow far; the other joints keep within a degree."""
    bench = Bench(Scenario(seed=5), settings=apply(Settings(), {"activation.period": 0.1, "free_drive.period": 30.0}))
    bench.enter()
    bench.tick(Wishes(Inputs(settings=freeing_joints(frozenset({2}), N)), (), ()))
    bench.run(0.05)
    start = bench.plant.q.copy()
    for k in range(750):
        share = min(k / 50.0, 1.0)
        bench.run(TICK, push("flange", (0.0, 0.0, 25.0 * share)))
    turned = np.degrees(np.abs(bench.plant.q - start))
    assert bench.mode is Mode.FREE_DRIVE
    assert turned[2] > 15.0
    assert np.delete(turned, 2).max() < 1.0


@pytest.mark.parametrize("posture", [[0.0, -1.2, 1.5, -1.87, -0.05, 0.0], [0.0, -1.57, 0.1, -1.57, -1.57, 0.0]])
def test_through_a_singularity_nothing_blows_up(posture: list[float]) -> None:
    ways = guided(PRESETS["plane"], (40.0, 0.0, 0.0), posture)
    assert np.abs(ways[:, 2]).max() < 10.0
    assert np.abs(ways[:, 3:5]).max() < 6.0
    assert np.hypot(ways[-1, 0], ways[-1, 1]) > 100.0


@pytest.mark.parametrize("tool", [False, True])
def test_a_turned_frame_locks_its_own_axes(tool: bool) -> None:
    held = Held(locks("x", "z", "rx", "ry", "rz", tool=tool, R_BU=tuple(rotation(2, 0.5).ravel().tolist())))
    _, R, jacobian = MODEL.update(HOME)
    along = (R @ TURNED if tool else rotation(2, 0.5))[:, 1]
    at_tcp = jacobian[:3] + np.cross(jacobian[3:].T, R @ TCP).T
    np.testing.assert_allclose(held.rows[0], along @ at_tcp, atol=1e-9)
