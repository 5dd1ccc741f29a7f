"""Balancing a refused arm (FD-10): what it adapts to, what it must not push at, and the whole arm with 2 kg too much."""

import math

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.freedrive.adaptive_gravity import Balance
from pendant.inputs import Button, Inputs
from pendant.tick.modes import TICK
from sim.arm.scenario import Load, Scenario
from sim.control.balancing import ARM, DAMPING, STIFFNESS, TIME, Balancing
from sim.exchange.desk import Wishes
from sim.plant.changes import AttachPayload
from tests.sim.arms import UR5E
from tests.sim.bench import Bench, push
from tests.sim.laws import N, dynamics, estimate

UP = Balance((0.0, 0.0, 1.0), True)
RATED = np.array(UR5E.limits.torque)
ROTOR = np.array(UR5E.motors.rotor_inertia)
_, R, JACOBIAN = (part.copy() for part in dynamics().update(np.array(UR5E.chain.home)))
HEAVIER = np.array([0.0, 0.0, -19.62, 0.0, 0.0, 0.0])
BEARS = 19.62 * JACOBIAN[2]
"""Torque that bears 2 kg at the flange: how far each joint lifts it, by virtual work."""
FALLING = -0.1 * np.sign(BEARS)


def law() -> Balancing:
    return Balancing(RATED, ROTOR, UR5E.payload)


def added(module: Balancing, balance: Balance = UP, static: float = 0.0, **values: object) -> np.ndarray:
    """Torque of one tick beyond `static`."""
    torque = np.full(N, static)
    module.add(estimate(**values), balance, JACOBIAN, torque)
    return torque - static


def test_it_begins_with_what_the_motors_bear() -> None:
    borne = np.array([1.0, 20.0, 10.0, 3.0, -1.0, 0.5])
    np.testing.assert_allclose(added(law(), static=4.0, tau_m=4.0 + borne, F_user=HEAVIER), borne)


def test_a_load_that_moves_the_arm_is_found_with_the_time_constant() -> None:
    module = law()
    for _ in range(round(TIME / TICK)):
        added(module, F_user=HEAVIER, theta_d=FALLING)
    np.testing.assert_allclose(module.torque, (1.0 - math.exp(-1.0)) * BEARS, rtol=0.02, atol=1e-9)
    for _ in range(500):
        added(module, F_user=HEAVIER, theta_d=FALLING)
    np.testing.assert_allclose(module.torque, BEARS, atol=1e-6)


@pytest.mark.parametrize("speed", [np.zeros(N), 0.049 * FALLING, -FALLING])
def test_at_rest_and_against_the_motion_nothing_adapts(speed: np.ndarray) -> None:
    """It may rest on a table, or a hand may hold it: then to push more would never end."""
    module = law()
    for _ in range(100):
        added(module, F_user=HEAVIER, theta_d=speed)
    assert np.abs(module.torque).max() == 0.0


def test_what_it_took_for_a_payload_goes_when_it_moves_the_arm_itself() -> None:
    module = law()
    for _ in range(500):
        added(module, F_user=HEAVIER, theta_d=FALLING)
    for _ in range(250):
        added(module, F_user=np.zeros(6), theta_d=-FALLING)
    assert np.abs(module.torque).max() < 1e-3 * np.abs(BEARS).max()


def test_only_what_a_payload_explains_and_no_more_than_the_largest() -> None:
    """A push across gravity and a torque about it are a hand's; 20 kg cannot be a payload of 5 kg."""
    module = law()
    hand = np.array([30.0, -20.0, 0.0, 0.0, 0.0, 5.0])
    for speed in (FALLING, -FALLING):
        added(module, F_user=hand, theta_d=speed)
    assert np.abs(module.torque).max() < 1e-12
    for _ in range(1000):
        added(module, F_user=np.array([0.0, 0.0, -196.2, 0.0, 0.0, 0.0]), theta_d=FALLING)
    np.testing.assert_allclose(module.torque, 2.5 * BEARS, rtol=1e-6, atol=1e-6)
    module, most = law(), ARM * 5.0 * 9.81
    twist = np.array([0.0, 0.0, 0.0, 100.0, 0.0, 0.0])
    wanted = -most * JACOBIAN[3]
    for _ in range(1000):
        added(module, F_user=twist, theta_d=-0.1 * np.sign(wanted))
    np.testing.assert_allclose(module.torque, wanted, rtol=1e-6, atol=1e-6)


def test_without_the_sensor_it_grows_with_the_way_of_each_joint() -> None:
    """0.1 rad/s for 0.1 s are 0.01 rad; the last joint turns so far that it gives all that it has, 28 N·m."""
    module = law()
    speed = np.array([0.0, 0.1, 0.1, 0.0, 0.0, -500.0])
    for _ in range(50):
        added(module, UP._replace(force=False), theta_d=speed)
    np.testing.assert_allclose(module.torque[:5], -STIFFNESS * ROTOR[:5] * 0.1 * speed[:5], rtol=1e-9)
    assert module.torque[5] == RATED[5]


def test_motion_is_damped() -> None:
    speed = np.array([0.1, -0.2, 0.1, 0.3, 0.0, -0.1])
    module = law()
    torque = added(module, theta_d=speed)
    np.testing.assert_allclose(torque - module.torque, -DAMPING * ROTOR * speed)


def tried(true: float) -> Bench:
    """In the check of an arm that believes to carry nothing, in its 100th tick or refused before."""
    settings = apply(Settings(), {"activation.period": 0.1, "sequence.beyond_limit": "balance"})
    bench = Bench(Scenario(seed=3, payload_true=Load(mass=true, com=[0.0, 0.0, 0.05])), settings=settings)
    bench.run(0.8)
    for _ in range(150):
        bench.tick(Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ()))
    bench.tick(Wishes(Inputs(released=frozenset({Button.FREE_DRIVE})), (), ()))
    return bench


@pytest.mark.parametrize("beforehand", [True, False])
def test_two_kilograms_too_much_are_balanced_and_then_held(beforehand: bool) -> None:
    """Carried from the start they are borne without a stir; hung on while the arm is free they let it sink for a while."""
    bench = tried(2.0 if beforehand else 0.0)
    start = bench.flange
    if not beforehand:
        bench.change(AttachPayload(load=Load(mass=2.0, com=[0.0, 0.0, 0.05])))
    assert bench.drift(0.7, start) < (0.0005 if beforehand else 0.006)
    found = next(event for event in bench.events if event.kind is Kind.LOAD_FOUND)
    assert found.values["mass"] == pytest.approx(2.0, abs=0.3)
    assert bench.drift(0.3, bench.flange) < 0.0005
    assert Kind.ENTERED not in {event.kind for event in bench.events}


def test_a_push_taken_for_a_payload_drives_no_arm_when_it_ends() -> None:
    bench = tried(0.0)
    bench.run(0.4, push("flange", (0.0, 0.0, 20.0)))
    assert Kind.COMPENSATING in {event.kind for event in bench.events}
    start = bench.flange
    assert bench.drift(0.8, start) < 0.003
