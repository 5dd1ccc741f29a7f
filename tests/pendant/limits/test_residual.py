"""The payload-like residual: against a least-squares fit, and as statistics of sensor offsets."""

import numpy as np
import pytest
from msgspec.structs import astuple

from pendant.all_settings import Settings
from pendant.limits.residual import mass_error, split, upward

G = 9.81


def fitted(wrench: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The best payload error (dm, dm·c) by least squares: its wrench and what is left."""
    matrix = np.zeros((6, 4))
    matrix[:3, 0] = g
    for k in range(3):
        matrix[3:, 1 + k] = np.cross(np.eye(3)[k], g)
    best = np.linalg.lstsq(matrix, wrench, rcond=None)[0]
    return matrix @ best, wrench - matrix @ best


@pytest.mark.parametrize("seed", range(40))
def test_it_is_the_best_fitting_payload_error(seed: int) -> None:
    rng = np.random.default_rng(seed)
    g = rng.normal(size=3)
    g *= G / np.linalg.norm(g)
    wrench = rng.normal(size=6) * 10.0
    payload, user = fitted(wrench, g)
    parts = split(wrench.tolist(), upward(g.tolist()))
    assert parts.payload_force == pytest.approx(-payload[:3] @ g / G, abs=1e-9)
    assert parts.payload_torque == pytest.approx(np.linalg.norm(payload[3:]), abs=1e-9)
    assert parts.user_force == pytest.approx(np.linalg.norm(user[:3]), abs=1e-9)
    assert parts.user_torque == pytest.approx(np.linalg.norm(user[3:]), abs=1e-9)


@pytest.mark.parametrize("mass", [-4.0, -0.2, 0.0, 1.8, 5.0])
def test_a_payload_error_leaves_nothing_to_the_user_and_has_its_mass(mass: float) -> None:
    g = np.array([3.0, -5.0, 7.896543])
    g *= G / np.linalg.norm(g)
    centre = np.array([0.02, -0.03, 0.11])
    wrench = np.concatenate([mass * g, np.cross(centre, mass * g)])
    parts = split(wrench.tolist(), upward(g.tolist()))
    assert mass_error(parts.payload_force) == pytest.approx(mass, abs=1e-12)
    assert parts.user_force == pytest.approx(0.0, abs=1e-9)
    assert parts.user_torque == pytest.approx(0.0, abs=1e-9)


def test_no_rounding_error_becomes_a_force() -> None:
    parts = split([0.0, 0.0, 1e6, 0.0, 0.0, 0.0], (0.0, 0.0, 1.0))
    assert astuple(parts) == (1e6, 0.0, 0.0, 0.0)


def measured_force(rng: np.random.Generator, error: np.ndarray, count: int) -> np.ndarray:
    """Along gravity: a payload error seen by a sensor with ±4 N of offset a channel, ±1 % of gain, a mean of 50 noisy values.

    Postures are random, so that gravity has any direction in the sensor; the true payload is 0 to 5 kg.
    """
    up = rng.normal(size=(count, 3))
    up /= np.linalg.norm(up, axis=1)[:, None]
    offset = (rng.uniform(-4.0, 4.0, (count, 3)) * up).sum(axis=1)
    gain = rng.uniform(-0.01, 0.01, count) * rng.uniform(0.0, 5.0, count) * G
    return error * -G + offset + gain + rng.normal(0.0, 0.15 / np.sqrt(50), count)


def test_the_shipped_limit_lets_a_right_payload_in_and_keeps_a_kilogram_out() -> None:
    """Errors as drawn when true and configured payload are each 0 to 5 kg, and at least 1 kg apart."""
    rng = np.random.default_rng(1)
    count = 400_000
    limit = Settings().limits.activation.payload_force.max
    right = measured_force(rng, np.zeros(count), count)
    assert (np.abs(right) <= limit).mean() > 0.9997
    true, configured = rng.uniform(0.0, 5.0, (2, count))
    error = (true - configured)[np.abs(true - configured) >= 1.0]
    wrong = measured_force(rng, error, error.size)
    assert (np.abs(wrong) > limit).mean() > 0.9975
    least = measured_force(rng, np.where(rng.random(count) < 0.5, 1.0, -1.0), count)
    assert 0.93 < (np.abs(least) > limit).mean() < 0.95
