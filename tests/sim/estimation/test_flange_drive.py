"""Who moves whom at the flange: the sign of the work of a change, against mass matrices, and within noise (CD-0)."""

import numpy as np
import pytest

from app.files.library import load_arm
from pendant.contact.contact_limits import OLDER
from pendant.contact.contact_rules import LATE
from sim.compiled.record import Record
from sim.estimation.flange_drive import driven, flange_drive

SMOOTHING = 0.85
FORCE, TORQUE, ACCELERATION, TURNING = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)


def before() -> Record:
    """After `OLDER` ticks in which nothing changed: a force and a gravity."""
    kept = flange_drive(load_arm("ur5e").sensors, SMOOTHING)
    for _ in range(OLDER):
        step(kept, np.zeros(12))
    return kept


def step(kept: Record, change: np.ndarray) -> float:
    now = np.array([3.0, -2.0, 20.0, 0.1, 0.2, -0.3, 0.5, 0.0, 9.8, 0.0, 0.0, 0.0]) + change
    return float(driven(kept[0], now[:6], now[ACCELERATION], now[TURNING]))


def drawn(rng: np.random.Generator, masses: tuple[float, float]) -> np.ndarray:
    """A mass matrix (6, 6) at the flange: of a body or an arm, whose centre is off it."""
    root = rng.normal(size=(6, 6)) * np.repeat([1.0, 0.15], 3)[:, None]
    return rng.uniform(*masses) * (root @ root.T + 0.05 * np.diag([1.0, 1.0, 1.0, 0.02, 0.02, 0.02]))


def test_a_contact_of_the_load_moves_the_arm_and_a_push_on_the_arm_moves_the_load() -> None:
    """-M^-1 w behind the sensor where w comes from outside; w = L·a where the arm's side moves the load."""
    rng = np.random.default_rng(1)
    aside = 0
    for _ in range(200):
        w = rng.normal(size=6) * np.repeat([15.0, 2.0], 3)
        a = -np.linalg.solve(drawn(rng, (1.0, 8.0)), w)
        assert step(before(), np.concatenate([w, a])) <= 0.0
        aside += float(w[:3] @ a[:3]) > 0.0
        a = rng.normal(size=6) * np.repeat([5.0, 20.0], 3)
        assert step(before(), np.concatenate([drawn(rng, (0.5, 5.0)) @ a, a])) >= 0.0
    assert aside > 3  # force and linear acceleration alone would say the opposite


def test_a_clear_push_is_far_beyond_the_noise() -> None:
    """2 kg moved by 10 m/s²: 200 N·m/s²; its noise is that of the sensors, 0.15 N and 0.1 m/s²."""
    noise = ((1.0 + 1.0 / OLDER) * ((0.15 * 10.0) ** 2 + (0.1 * 20.0) ** 2)) ** 0.5
    change = np.zeros(12)
    change[0], change[6] = 20.0, 10.0
    assert step(before(), change) == pytest.approx(200.0 / noise, rel=0.02)


def test_noise_alone_is_seldom_taken_for_a_motion() -> None:
    kept, rng = before(), np.random.default_rng(2)
    noise = kept[0]["noise"].copy()
    assert noise == pytest.approx(np.repeat([0.15, 0.006, 0.1, 1.2], 3), rel=0.02)  # of the arm's file, 0.003 rad/s of a gyro
    told = [step(kept, noise * rng.normal(size=12)) for _ in range(4000)]
    assert np.mean(np.array(told) > 3.0) < 0.005
    assert np.mean(np.array(told) < -1.0) > 0.02


def test_a_turning_that_is_known_late_counts_as_it_will_be() -> None:
    """A torque turns the arm and moves the flange along the force; half of the turning is known in its first tick.

    20 N·4 m/s² - 2 N·m·30 rad/s² is above 0; with the turning a tick and a half later, -75 rad/s², it is not.
    """
    change = np.zeros(12)
    change[0], change[6], change[4], change[10] = 20.0, 4.0, 2.0, -30.0
    assert step(before(), change) < 0.0
    change[10] = -12.0  # it would become -30 rad/s²
    assert LATE == 1.5
    assert step(before(), change) > 2.0
    kept = before()
    change[6], change[10] = 0.0, -30.0
    step(kept, change)
    change[6] = 4.0
    assert step(kept, change) > 1.0, "it goes on no more"


def test_as_long_as_little_is_known_nothing_is_said() -> None:
    kept, change = flange_drive(load_arm("ur5e").sensors, SMOOTHING), np.zeros(12)
    change[0], change[6] = 20.0, 10.0
    told = [step(kept, change * (k % 2)) for k in range(OLDER + 2)]
    assert told[:OLDER] == [0.0] * OLDER
    assert told[OLDER + 1] > 3.0
    kept[0]["count"] = 0
    assert step(kept, -change) == 0.0
