"""Which posture is measured next."""

from itertools import pairwise

import numpy as np
import pytest

from pendant.equipment.payload_fit import LEAST, least_angle
from pendant.tooling.wrist_postures import FINE, STEPS, SWING, WANTED, best_first, candidates
from tests.pendant.tooling.wrists import HOME, wrist_arm

DOWN = np.array([0.0, 0.0, -9.81])
BEGIN = np.array(HOME)


def gravity(q: np.ndarray) -> np.ndarray:
    """Specific force in F, of length 1."""
    return wrist_arm().places(q[None])[1][0, -1].T @ [0.0, 0.0, 1.0]


def test_only_the_wrist_is_turned_and_no_farther_than_the_swing() -> None:
    postures = candidates(BEGIN)
    assert postures.shape == (STEPS**3, 6)
    assert len(np.unique(postures, axis=0)) == STEPS**3
    np.testing.assert_array_equal(postures[:, :3], np.tile(BEGIN[:3], (STEPS**3, 1)))
    assert np.abs(postures - BEGIN).max() == pytest.approx(SWING)


def test_the_first_is_farthest_from_all_that_is_measured() -> None:
    measured = [tuple(9.81 * gravity(BEGIN))]
    for _ in range(WANTED - 1):
        ordered = best_first(wrist_arm(), candidates(BEGIN), BEGIN, DOWN, measured=measured)
        away = [min(np.arccos(np.clip(gravity(q) @ np.array(a) / 9.81, -1.0, 1.0)) for a in measured) for q in ordered]
        assert all(b <= a + FINE for a, b in pairwise(away))
        assert min(away) >= least_angle(WANTED)
        assert max(away) <= away[0] + FINE
        measured.append(tuple(9.81 * gravity(ordered[0])))
    assert len(measured) == WANTED > LEAST
    unit = np.array(measured) / 9.81
    assert np.linalg.matrix_rank(unit - unit.mean(axis=0), tol=0.3) == 3


def test_of_equally_good_ones_the_nearest_comes_first() -> None:
    measured = [tuple(9.81 * gravity(BEGIN))]
    ordered = best_first(wrist_arm(), candidates(BEGIN), BEGIN, DOWN, measured=measured)
    away = np.array([np.arccos(np.clip(gravity(q) @ gravity(BEGIN), -1.0, 1.0)) for q in ordered])
    ways = np.abs(ordered - BEGIN).max(axis=1)
    same = np.round(away / FINE)
    for k in range(len(ordered) - 1):
        assert same[k] > same[k + 1] or ways[k] <= ways[k + 1] + 1e-12


def test_what_is_like_a_measured_one_is_left_out() -> None:
    """A turn of wrist 3 under a flange that points down is none to gravity."""
    level = np.array([0.0, -np.pi / 2, np.pi / 2, -np.pi / 2, -np.pi / 2, 0.0])
    ordered = best_first(wrist_arm(), candidates(level), level, DOWN, measured=[tuple(9.81 * gravity(level))])
    assert 0 < len(ordered) < STEPS**3
    assert not np.any(np.all(np.abs(ordered[:, 3:5] - level[3:5]) < 1e-9, axis=1))
