"""Detectors to compare with, each at its best: fixed force threshold, CUSUM on force, generalized momentum observer (CD-18)."""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.contacts.recording import TICK, Recording

Array = NDArray[np.float64]
GAINS = (10.0, 25.0, 50.0, 100.0, 200.0)  # of the observer [1/s]
ALLOWANCES = (0.5, 1.0, 2.0, 5.0, 10.0)  # of the CUSUM [N]
SLOW = 1.0  # time in which force detectors forget the sensor's bias [s]
WARM = 200  # ticks at the begin in which filters settle, not counted


class Scores(NamedTuple):
    """What each baseline compares with its threshold, (ticks, k) by name; an alarm where any column is beyond its own."""

    by_name: dict[str, Array]


def scores(recording: Recording) -> Scores:
    """All scores of one run; the force detectors know the configured payload's m·A, as the rules do."""
    rows = [signals[0] for signals in recording.signals]
    force = np.array([[s.fx - s.mass * s.ax, s.fy - s.mass * s.ay, s.fz - s.mass * s.az] for s in rows if s is not None])
    change = np.linalg.norm(force - _followed(force, TICK / SLOW), axis=1)
    out = {"force threshold": change[:, None]}
    for allowance in ALLOWANCES:
        out[f"CUSUM, allowance {allowance:g} N"] = _cusum(change, allowance)[:, None]
    momentum = np.array(recording.momentum)
    for gain in GAINS:
        out[f"momentum observer, gain {gain:g}/s"] = np.abs(_observe(momentum[:, :6], momentum[:, 6:], gain))
    return Scores({name: value[WARM:] if len(value) > 2 * WARM else value[20:] for name, value in out.items()})


def thresholds(runs: list[Scores]) -> dict[str, Array]:
    """Thresholds (k,) by name without any alarm in the runs."""
    return {name: 1.001 * np.max([run.by_name[name].max(axis=0) for run in runs], axis=0) for name in runs[0].by_name}


def alarm(score: Array, threshold: Array, length: int) -> int | None:
    """Row of the first alarm in a run of `length` rows, or None."""
    beyond = np.flatnonzero((score > threshold).any(axis=1))
    return int(beyond[0]) + length - len(score) if beyond.size else None


@numba.njit(cache=True)
def _followed(force, share):
    out = np.empty_like(force)
    state = force[0].copy()
    for k in range(force.shape[0]):
        for j in range(3):
            out[k, j] = state[j]
            state[j] += share * (force[k, j] - state[j])
    return out


@numba.njit(cache=True)
def _cusum(change, allowance):
    out = np.empty_like(change)
    total = 0.0
    for k in range(change.size):
        total = max(0.0, total + change[k] - allowance)
        out[k] = total
    return out


@numba.njit(cache=True)
def _observe(p, drive, gain):
    """Residual r = K (p - p0 - integral of (tau + C^T qd - g + r)) (n,), which follows the external torque."""
    out = np.zeros_like(p)
    n = p.shape[1]
    total = np.zeros(n)
    r = np.zeros(n)
    for k in range(p.shape[0]):
        for i in range(n):
            total[i] += 0.002 * (drive[k, i] + r[i])
            r[i] = gain * (p[k, i] - p[0, i] - total[i])
            out[k, i] = r[i]
    return out
