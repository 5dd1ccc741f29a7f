"""What external torques are wrong by: stiffness, ripple and the flange sensor's zero, told apart by their causes."""

import numpy as np
import pytest

from app.files.library import load_arm
from pendant.all_settings import Settings
from pendant.tick.modes import TICK
from sim.arm.chain import NOTHING
from sim.arm.joint_constants import ripple_torque
from sim.arm.scenario import Scenario
from sim.estimation.momentum_observer import MomentumObserver
from sim.estimation.torque_errors import CARRIED, WAIT
from sim.estimation.transmission_torque import SETTLE_TICKS
from sim.simulation import Simulation

ARM = load_arm("ur5e")
LINK_MASS, MOTOR_CONSTANT, STIFFNESS = ARM.accuracy.link_mass, ARM.accuracy.motor_constant, ARM.accuracy.stiffness
FORCE_OFFSET, TORQUE_OFFSET = ARM.accuracy.force_offset, ARM.accuracy.torque_offset
NONE, ALL = np.zeros(6), np.ones((3, 6), dtype=bool)
STIFFER = np.array([0.15, -0.1, 0.12, -0.12, 0.05, 0.1])
ZERO = np.array([3.0, -2.0, 2.5, 0.2, -0.1, 0.15])
"""Of the flange sensor [N, N·m]."""
RIPPLE = ripple_torque(ARM)
"""The most that it makes [N·m]."""
JUMP = 0.6  # of the flange sensor's zero [N·m]
SPEED = np.array([0.7, 1.1, 1.6, 2.3, 2.9, 3.7])  # of each joint's swing [rad/s]


class Swinging:
    """A bare arm whose joints swing by 1.2 rad, exactly as its torques say; gears, encoders and flange sensor are wrong."""

    def __init__(self) -> None:
        self.dynamics = Simulation(ARM, Scenario(mismatch="nominal"), Settings()).dynamics
        self.dynamics.set_load(NOTHING)
        self.observer, self.tick = MomentumObserver(ARM, self.dynamics), 0
        self.errors = self.observer.errors
        self.zero = ZERO  # of the flange sensor (6,) [N, N·m]

    def run(self, ticks: int, hand: np.ndarray = NONE, use: np.ndarray = ALL, with_sensor: bool = True) -> None:
        """A hand (n,) turns the joints."""
        for _ in range(ticks):
            phase = SPEED * self.tick * TICK
            self.tick += 1
            q, qd, qdd = 1.2 * np.sin(phase), 1.2 * SPEED * np.cos(phase), -1.2 * SPEED**2 * np.sin(phase)
            load = self.dynamics.inverse(q, qd, qdd) - hand
            self.dynamics.recursion.run(q, np.stack([q, qd, NONE]), np.zeros(3))
            # A gear is stiffer than believed: it bears more than its bending tells; what an encoder tells too much unbends it.
            told = load / (1.0 + STIFFER) - 0.8 * RIPPLE * np.sin(2.0 * q + 0.5)
            driven = (q, told, load, NONE, NONE, NONE, use, self.zero if with_sensor else NONE)
            self.observer.update(driven, with_sensor=with_sensor, valid=True, learn=True)


@pytest.fixture(scope="module")
def learned() -> Swinging:
    arm = Swinging()
    arm.run(5000)
    return arm


def test_at_first_each_may_be_all_that_is_filed() -> None:
    arm = Swinging()
    arm.run(1)
    assert arm.errors.shares == pytest.approx(0.0)
    expected = [STIFFNESS + LINK_MASS, *[FORCE_OFFSET] * 3, *[TORQUE_OFFSET] * 3, *[RIPPLE[2]] * 4]
    assert arm.errors.misfit[2] == pytest.approx(expected)


def test_gears_encoders_and_the_sensors_zero_are_told_apart(learned: Swinging) -> None:
    shares, misfit = learned.errors.shares, learned.errors.misfit
    assert shares[1:4, 0] == pytest.approx(STIFFER[1:4], abs=0.03)  # the base's load, without weight, goes with its ripple
    assert shares[2, 1:7] == pytest.approx(ZERO, abs=0.4)
    # a sin(2q + 0.5) = a (sin 0.5 cos 2q + cos 0.5 sin 2q)
    expected = np.outer(0.8 * RIPPLE * (1.0 + STIFFER), [0.0, 0.0, np.sin(0.5), np.cos(0.5)])
    assert (np.abs(shares[:, 7:] - expected).max(axis=1) < 0.25 * RIPPLE).all()
    true = np.column_stack([STIFFER, np.tile(ZERO, (6, 1)), expected])
    assert (np.abs(shares - true)[:5] < misfit[:5]).all()  # nothing bends the last joint's gear
    assert (misfit[1:4, 0] < 0.1).all()


def test_what_is_left_is_what_touches_the_arm(learned: Swinging) -> None:
    """It feels 10 N·m of a hand, and without it nothing; of the hand nothing is learned, however long it pushes."""
    errors, hand = learned.errors, np.array([0.0, 10.0, 0.0, 0.0, 0.0, 0.0])

    def left() -> np.ndarray:
        return learned.observer.residual - np.vecdot(errors.shares, errors.causes)

    assert left() == pytest.approx(NONE, abs=0.6)
    learned.run(WAIT, hand)  # meanwhile it learns of what was before
    known = errors.shares.copy()
    learned.run(800, hand)
    assert left() == pytest.approx(hand, abs=0.8)
    assert errors.shares == pytest.approx(known)
    learned.run(SETTLE_TICKS)
    assert errors.shares == pytest.approx(known)
    learned.run(2 * SETTLE_TICKS + WAIT)
    assert not (errors.shares == known).all()
    assert left() == pytest.approx(NONE, abs=0.6)


def test_a_hand_that_comes_before_anything_is_known_is_not_learned() -> None:
    """It changes the torques as no cause of theirs changes."""
    arm = Swinging()
    arm.run(SETTLE_TICKS + WAIT // 2)
    arm.run(100, np.array([0.0, 15.0, 15.0, 0.0, 0.0, 0.0]))
    assert arm.errors.shares == pytest.approx(0.0)


def test_a_new_zero_of_the_sensor_is_learned_again(learned: Swinging) -> None:
    errors = learned.errors
    learned.observer.forget_zero()
    learned.run(1)
    assert errors.shares[:, 1:7] == pytest.approx(0.0)
    assert errors.misfit[0, 1:7] == pytest.approx([FORCE_OFFSET] * 3 + [TORQUE_OFFSET] * 3)
    assert errors.shares[1, 0] == pytest.approx(STIFFER[1], abs=0.03)


def test_a_zero_that_jumped_is_taken_for_a_touch_but_not_for_good() -> None:
    """Nothing is learned while something seems to touch the arm, but what is known grows old meanwhile: then it is learned."""
    arm = Swinging()
    arm.run(4000)
    arm.zero = ZERO + np.array([0.0, 0.0, 0.0, JUMP, 0.0, 0.0])
    arm.run(100)
    known = arm.errors.shares.copy()
    arm.run(2000)
    assert (arm.errors.shares == known).all()
    arm.run(30_000)
    assert arm.errors.shares[2, 4:7] == pytest.approx(arm.zero[3:], abs=0.1)


def test_a_joint_without_deflection_has_no_gear_and_no_ripple_to_learn() -> None:
    arm, use = Swinging(), ALL.copy()
    use[1, 1] = False
    arm.run(1500, use=use)
    assert arm.errors.shares[1, [0, 7, 8, 9, 10]] == pytest.approx(0.0)
    assert arm.errors.causes[1, 7:] == pytest.approx(0.0)
    assert arm.errors.misfit[1, 0] == pytest.approx(MOTOR_CONSTANT + LINK_MASS)
    assert arm.errors.shares[2, 0] == pytest.approx(STIFFER[2], abs=0.1)


def test_without_a_sensor_there_is_no_zero_and_the_payload_is_doubted() -> None:
    arm = Swinging()
    arm.run(1, with_sensor=False)
    assert arm.errors.causes[:, 1:7] == pytest.approx(0.0)
    assert arm.errors.misfit[1, 0] == pytest.approx(STIFFNESS + LINK_MASS + CARRIED)
