"""A fit of an arm to runs of it: least squares with what was known before, uncertainty, and what the runs could not tell."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2
from scipy.linalg import cho_factor, cho_solve, cholesky, solve_triangular
from scipy.optimize import lsq_linear

from sim.identification.body_parameters import is_body
from sim.identification.torque_model import FitPlaces, LoggedRun, TorqueModel

Array = NDArray[np.float64]
Rows = Sequence[tuple[Array, Array]]

GATE = 0.03
"""Speed from which on what is left is counted [rad/s]."""
ROUNDS = 5
"""Of weights and of the load's friction, each of which follows from the last fit; the last changes no digit that is shown."""
LONGEST_LAG = 50
"""Samples over which errors may stay alike [2 s]."""
LEAST_COUNT = 100
"""Samples from which on the size of what is left is known."""
BLOCKS, SPEED_BLOCKS = 30, 8
"""Groups of like postures, and of like speeds, of which the uncertainty is made."""
TOLD = 0.9
"""A number whose deviation is still this share of what it was without a log has not been told by it."""
STAYS = 1e6
"""Times as sure as before is a number that no run has told: it stays as filed."""
MOST_TIMES_CLOSER = 64.0
"""A link that is expected so many times closer to the file's than others is the file's."""


@dataclass(frozen=True, slots=True)
class ArmFit:
    """All numbers of an arm as fitted, and how sure they are. p numbers, n joints."""

    model: TorqueModel
    x: Array  # (p,)
    deviation: Array  # (p,) standard deviation
    before: Array  # (p,) what was expected without a log
    deviation_before: Array  # (p,) and how sure that was
    noise: Array  # (n,) standard deviation of what is left [N·m]
    held: tuple[int, ...]  # links that had to be held closer to the file's to be bodies

    @property
    def places(self) -> FitPlaces:
        """Where each number stands."""
        return self.model.places

    def left(self, run: LoggedRun, x: Array | None = None) -> tuple[Array, NDArray[np.bool_]]:
        """What of the motor torques (n, k) [N·m] the numbers x do not explain, and where the joint moves (n, k).

        Args:
            run: k samples.
            x: the numbers; None: as fitted.
        """
        x = self.x if x is None else x
        A, y = self.model.rows(run)
        _, predicted = self.model.linearise(A, run, y, x)
        return run.samples.torque.T - predicted, run.samples.moves.T & (np.abs(run.samples.qd.T) > GATE)


def fit(model: TorqueModel, runs: Sequence[LoggedRun], mass: float | None = None) -> ArmFit:
    """Fit an arm's numbers to runs.

    The most likely numbers minimise the squares of what is left, over its variance, plus those of the step from what was known:

        sum_i |A_i x - y_i|² / (s_i² a_i) + (x - x0)' K (x - x0)

    where what is left of joint i stays alike over a_i samples, so that so many count as one.

    How sure they are: the model is not perfect, and its errors repeat where the arm comes by again, and at the same speed; noise
    that is independent in each sample would make the numbers look 5 to 50 times too sure. Samples are therefore put into blocks,
    whenever they were, and the spread of the fits that leave out one block each is the uncertainty (delete-a-block jackknife);
    what was known before adds its own share:

        C = H^-1 K P K H^-1 + (B - 1) / B sum_b d_b d_b',    H = sum A' A / (s² a) + K,    d_b = x_(-b) - x

    There are blocks of like postures, which show what friction and gears do at one place, and blocks of like speeds, which show
    what the form of the curve cannot follow; of both, the larger spread counts for each number. Blocks of time would not do: a
    motion that is repeated has the same errors in each of them. P is the covariance of what was known before. A number that no
    run tells is kept as filed by a K that is larger than P^-1: what it may be off by then still counts in all others.

    Sources: Künsch, The jackknife and the bootstrap for general stationary observations, Annals of Statistics 17(3), 1989
    (blocks); Roberts et al., Cross-validation strategies for data with temporal, spatial, hierarchical, or phylogenetic
    structure, Ecography 40(8), 2017 (blocks where errors are alike); MacKinnon, Nielsen, Webb, Cluster-robust inference: a guide
    to empirical practice, Journal of Econometrics 232(2), 2023 (the jackknife is the most reliable with few blocks).

    Args:
        model: of the arm.
        runs: with at least one sample in which a joint moves.
        mass: of the load that the loaded runs carry, weighed [kg]; None: unknown.
    """
    rows = [model.rows(run) for run in runs]
    free = np.zeros(model.places.size, dtype=bool)
    found = _fit(model, rows, runs, mass=mass, untold=free)
    untold = ~told(found) & model.places.filed
    return _fit(model, rows, runs, mass=mass, untold=untold) if untold.any() else found


def told(found: ArmFit) -> NDArray[np.bool_]:
    """Which numbers (p,) the runs have told: those of which they know more than was known before."""
    return found.deviation < TOLD * found.deviation_before


def _fit(model: TorqueModel, rows: Rows, runs: Sequence[LoggedRun], *, mass: float | None, untold: NDArray[np.bool_]) -> ArmFit:
    n, constants = model.arm.n, model.places.constant
    nearness, stated = np.ones(n), model.arm.accuracy.motor_constant
    x0, expected = model.prior(mass, nearness, stated)
    known = expected
    noise, alike, spread = 0.02 * np.array(model.arm.limits.torque), np.full(n, 5.0), stated
    x, straight = x0, rows
    while True:
        for _ in range(ROUNDS):
            x0, expected = model.prior(mass, nearness, spread)
            known = expected.copy()
            known[untold, untold] *= STAYS
            straight = [(A, model.linearise(A, run, y, x)[0]) for (A, y), run in zip(rows, runs, strict=True)]
            H, g = _normal(straight, [run.samples.moves for run in runs], noise**2 * alike)
            x = _most_likely(model, H + known, g + known @ x0)
            noise, alike = _what_is_left(x, straight, runs, (noise, alike))
            # Constants of one arm may all be off by more than its file states: then less is expected of each.
            left = np.linalg.inv(H + known).diagonal()[constants]
            spread = max(stated, float(np.sqrt(np.mean(x[constants] ** 2 + left))))
        broken = [k for k in range(n) if not is_body(model.link(x, k)) and nearness[k] < MOST_TIMES_CLOSER]
        if not broken:
            break
        nearness[broken] *= 2.0
    sure = _deviation(straight, runs, noise**2 * alike, (x0, known, expected))
    deviation = np.sqrt(np.linalg.inv(expected).diagonal())
    return ArmFit(model, x, sure, x0, deviation, noise, tuple(np.flatnonzero(nearness > 1.0).tolist()))


def _normal(rows: Rows, chosen: Sequence[NDArray[np.bool_]], variance: Array) -> tuple[Array, Array]:
    """The normal equations H x = g of the samples that are chosen (k, n) in each run, with the variance of each joint (n,)."""
    size = rows[0][0].shape[2]
    H, g = np.zeros((size, size)), np.zeros(size)
    for (A, y), which in zip(rows, chosen, strict=True):
        for i, each in enumerate(variance):
            part = A[i][which[:, i]]
            H += part.T @ part / each
            g += part.T @ y[i][which[:, i]] / each
    return H, g


def _most_likely(model: TorqueModel, H: Array, g: Array) -> Array:
    """The numbers that solve H x = g, or come nearest within their bounds."""
    # Numbers of very different size: each is counted in what it is uncertain by.
    unit = 1.0 / np.sqrt(H.diagonal())
    scaled = H * unit[:, None] * unit[None, :]
    x = cho_solve(cho_factor(scaled), g * unit) * unit
    low = model.lowest()
    if (x >= low).all():
        return x
    root = cholesky(scaled)
    wanted = solve_triangular(root.T, g * unit, lower=True)
    return lsq_linear(root, wanted, (low / unit, np.full(len(unit), np.inf)), tol=1e-10).x * unit


def _what_is_left(x: Array, rows: Rows, runs: Sequence[LoggedRun], before: tuple[Array, Array]) -> tuple[Array, Array]:
    """Standard deviation of what is left, and over how many samples it stays alike (n,) each."""
    noise, alike = before[0].copy(), before[1].copy()
    for i in range(len(noise)):
        parts = [(A[i] @ x - y[i])[run.samples.moves[:, i]] for (A, y), run in zip(rows, runs, strict=True)]
        count = sum(map(len, parts))
        if count < LEAST_COUNT:
            continue
        power = sum(float(part @ part) for part in parts) / count
        noise[i] = np.sqrt(max(power, 1e-12))
        total = 1.0
        for lag in range(1, LONGEST_LAG):
            likeness = sum(float(part[lag:] @ part[:-lag]) for part in parts if len(part) > lag) / count / max(power, 1e-12)
            if likeness < 0.05:
                break
            total += 2.0 * likeness
        alike[i] = total
    return noise, alike


def _deviation(rows: Rows, runs: Sequence[LoggedRun], variance: Array, prior: tuple[Array, Array, Array]) -> Array:
    """Standard deviation of each number (p,); `prior`: what was expected, the precision the fit gave it, and the one it has."""
    x0, known, expected = prior
    lengths = np.cumsum([len(run.samples.t) for run in runs])[:-1]
    labels = (_like_postures, BLOCKS), (_like_speeds, SPEED_BLOCKS)
    spreads, share = list[Array](), known
    for label, count in labels:
        which = np.split(label(runs, count), lengths)
        chosen = [[run.samples.moves & (part == block) for run, part in zip(runs, which, strict=True)] for block in range(count)]
        parts = [_normal(rows, each, variance) for each in chosen]
        H, g = known + sum(part[0] for part in parts), known @ x0 + sum(part[1] for part in parts)
        x = _solved(H, g)
        steps = np.array([_solved(H - part, g - other) - x for part, other in parts])
        spreads.append((count - 1) / count * (steps**2).sum(axis=0))
        share = _solved(H, known)
    before = np.einsum("ij,jk,ik->i", share, np.linalg.inv(expected), share)
    return np.sqrt(before + np.maximum(*spreads))


def _like_postures(runs: Sequence[LoggedRun], count: int) -> NDArray[np.intp]:
    """Blocks (k, 1) of samples whose joint angles are alike."""
    postures = np.concatenate([run.samples.q for run in runs])
    return kmeans2(postures, count, minit="++", rng=np.random.default_rng(0))[1][:, None]


def _like_speeds(runs: Sequence[LoggedRun], count: int) -> NDArray[np.intp]:
    """Blocks (k, n) of samples in which a joint is as fast, each joint for itself, as many in each."""
    speeds = np.abs(np.concatenate([run.samples.qd for run in runs]))
    return speeds.argsort(axis=0).argsort(axis=0) * count // len(speeds)


def _solved(H: Array, right: Array) -> Array:
    unit = 1.0 / np.sqrt(H.diagonal())
    scale = unit if right.ndim == 1 else unit[:, None]
    return scale * cho_solve(cho_factor(H * unit[:, None] * unit), scale * right)
