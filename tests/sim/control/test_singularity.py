"""Distance from a singularity against a singular value decomposition, its gradient, and the resistance (FD-4)."""

import math

import numpy as np

from sim.control.singularity import LENGTH, Singularity
from tests.sim.arms import UR5E
from tests.sim.laws import N, dynamics

MODEL = dynamics()
ROTOR = np.array(UR5E.motors.rotor_inertia)
SCALE = np.diag([1.0, 1.0, 1.0, LENGTH, LENGTH, LENGTH])
HOME = np.array(UR5E.chain.home)
NEARLY = np.array([0.3, -1.2, 1.5, -1.87, -0.25, 0.4])  # wrist_2 nearly straight


def smallest(q: np.ndarray) -> float:
    return float(np.linalg.svd(SCALE @ MODEL.update(q)[2], compute_uv=False)[-1])


def found(q: np.ndarray, ticks: int = 10) -> Singularity:
    module = Singularity(ROTOR)
    for _ in range(ticks):
        module.update(MODEL.update(q)[2])
    return module


def test_it_finds_the_smallest_singular_value_and_its_gradient() -> None:
    rng = np.random.default_rng(5)
    for _ in range(100):
        q = rng.uniform(-3.0, 3.0, N)
        module = found(q)
        assert abs(module.value - smallest(q)) < 0.01 * smallest(q) + 1e-5
        if smallest(q) > 0.01:
            steps = 1e-5 * np.eye(N)
            gradient = [(smallest(q + step) - smallest(q - step)) / 2e-5 for step in steps]
            np.testing.assert_allclose(module.gradient, gradient, atol=0.03)


def test_it_follows_a_moving_arm() -> None:
    rng = np.random.default_rng(6)
    for _ in range(5):
        q, qd = rng.uniform(-3.0, 3.0, N), rng.normal(size=N)
        module = found(q)
        for k in range(300):
            now = q + 0.002 * k * qd
            module.update(MODEL.update(now)[2])
            assert module.value < smallest(now) + 0.003


def test_where_it_is_merely_told_every_fifth_tick_is_enough() -> None:
    """At 1 rad/s of a joint it is that of 8 ms ago at most; before the first look nothing is known."""
    module, q = Singularity(ROTOR), HOME.copy()
    told = []
    for tick in range(1, 201):
        q[4] -= 0.002
        module.watch(MODEL.update(q)[2], tick)
        told.append(module.value - smallest(q))
    assert told[:4] == [math.inf] * 4
    assert np.abs(told[20:]).max() < 0.003
    assert len(set(np.diff(told[20:]) > 0.0)) == 2, "it stands between two looks"
    module.forget()
    assert module.value == math.inf


def test_in_a_singularity_nothing_blows_up() -> None:
    for q in (np.zeros(N), np.array([0.0, -1.2, 0.0, 0.0, -1.57, 0.0]), np.array([0.0, -1.2, 1.5, -1.87, 0.0, 0.0])):
        module = found(q)
        assert module.value < 1e-4
        torque = np.full(N, 5.0)
        module.resist(0.04, 0.01, speed=np.ones(N), static=np.zeros(N), torque=torque)
        assert np.isfinite(torque).all()
        assert np.abs(torque).max() < 100.0


def test_arms_of_fewer_joints_are_told_nothing() -> None:
    module = Singularity(ROTOR[:4])
    module.update(np.zeros((6, 4)))
    assert module.value == math.inf


def test_motion_towards_it_is_resisted_and_the_way_back_is_free() -> None:
    module = found(NEARLY)
    near, too_near = 2.0 * module.value, 0.5 * module.value
    towards, still, nothing = -module.gradient / np.linalg.norm(module.gradient), np.zeros(N), np.zeros(N)
    resisted, back = np.zeros(N), np.zeros(N)
    module.resist(near, too_near, speed=towards, static=nothing, torque=resisted)
    assert resisted @ towards < -0.1
    module.resist(near, too_near, speed=-towards, static=nothing, torque=back)
    assert not back.any()
    far = np.zeros(N)
    module.resist(0.9 * module.value, too_near, speed=towards, static=nothing, torque=far)
    assert not far.any()
    # What drives it on is taken away: a part of it near, all of it too near.
    for limits, left in (((near, too_near), 1.0 / 3.0), ((4.0 * module.value, 1.5 * module.value), 0.0)):
        driven = towards.copy()
        module.resist(*limits, speed=still, static=nothing, torque=driven)
        before, after = module.gradient @ (towards / ROTOR), module.gradient @ (driven / ROTOR)
        np.testing.assert_allclose(after, left * before, rtol=1e-9, atol=1e-9)
    driven = -towards
    module.resist(4.0 * module.value, 1.5 * module.value, speed=still, static=nothing, torque=driven)
    np.testing.assert_array_equal(driven, -towards)


def test_in_the_singularity_the_resistance_has_ended() -> None:
    """There the way on is the way back, and its direction jumps: what jumps with it must be nothing."""
    module = found(NEARLY)
    towards, whole, ended = -module.gradient, np.zeros(N), np.zeros(N)
    module.resist(4.0 * module.value, 2.0 * module.value, speed=towards, static=np.zeros(N), torque=whole)
    module.resist(4e4 * module.value, 2e4 * module.value, speed=towards, static=np.zeros(N), torque=ended)
    assert np.abs(ended).max() < 1e-3 * np.abs(whole).max()


def test_it_only_ever_takes_energy() -> None:
    rng = np.random.default_rng(7)
    module = found(NEARLY)
    for _ in range(200):
        speed, torque = rng.normal(size=N), np.zeros(N)
        module.resist(0.1, 0.001, speed=speed, static=np.zeros(N), torque=torque)
        assert torque @ speed <= 0.0
