"""Adaptive friction module: friction of each joint, learned while the arm works, with its uncertainty (AF-2)."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.compiled.record import record

Array = NDArray[np.float64]

TERMS = 6
"""Coulomb, saturating, viscous, load friction; then two that are not friction: error of the model's gain, bias of the model."""

KNEE = 0.25  # speed of the saturating term's half [rad/s]
SIGN_SPEED = 0.01  # the sign of the speed is blurred over this [rad/s]
GATE = 0.03  # nothing is learned below this speed: a stuck joint says nothing of its sliding friction [rad/s]
PRIOR = np.array([0.5, 0.5, 0.5, 1.0])  # relative standard deviation of the friction terms before anything is learned
WALK = np.array([0.05, 0.05, 0.05, 0.02])  # relative random walk of the friction terms [1/sqrt(s)]: warmth and wear
GAIN_PRIOR, GAIN_WALK = 0.05, 0.002  # of the model's gain error
BIAS_PRIOR, BIAS_WALK = 0.015, 0.006  # of its bias, relative to the torque limit (prior) and per sqrt(s)
NOISE = 0.006  # of one measurement, relative to the torque limit
CORRELATED = 60.0  # ticks over which measurement errors are correlated: so many measurements count as one
MISFIT = 0.05  # relative error of the terms' shapes that remains when all is learned


class Turning(NamedTuple):
    """Motion and torques of the joints in a tick, from which friction is learned."""

    speed: Array  # of the motors (n,) [rad/s]
    surplus: Array  # tau_m - J theta_dd - tau_dyn, or the same by the deflection (n,) [N·m]; NaN where tau_m is unknown
    tau_dyn: Array  # torque that was subtracted, of the rigid model or of the deflection (n,) [N·m]
    tau_J: Array  # transmission torque (n,) [N·m], for the load term


@lru_cache(maxsize=16)
def _fitted(speeds: tuple[float, ...], torques: tuple[tuple[float, ...], ...], scale: float) -> Array:
    """Constant, saturating and viscous term of each joint (n, 3) [N·m], nearest to its filed curve; the same for all its arms."""
    speed = np.linspace(0.02, max(speeds), 200)
    basis = np.stack([np.ones_like(speed), speed / (speed + KNEE), speed], axis=1)
    curves = [np.interp(np.sqrt(speed), np.sqrt(speeds), torque) for torque in torques]
    return np.array([np.linalg.lstsq(basis, scale * curve, rcond=None)[0] for curve in curves], dtype=np.float64)


class AdaptiveFriction:
    """One Kalman filter for each joint over the terms of its friction, n joints.

    The measurement is the motor torque, minus the rotor's inertia, minus the rigid model,
        tau_m - J theta_dd - tau_dyn = f_in + f_out - tau_ext + (gain error) tau_dyn + bias,
    with the model f = (c0 + c1 |v|/(|v| + knee) + c2 |v| + c3 |tau_J|) sign(v). All terms but the last fall with temperature in a
    known way. Friction changes its sign with the speed, the model's errors do not: motion in both directions tells them apart.

    A joint learns when its motor torque is known, its speed is above `GATE`, and no contact torque is larger than friction could
    be. Else the estimate stays, and its uncertainty grows. One side of the gear does not tell output friction from an external
    torque, so the share of the output side is taken from the arm's file.

    With `joint_control.friction_from` the deflection replaces the rigid model. The deflection also contains the torque of
    contacts, so friction is learned in contact, too. What remains is the friction of the input side only; the friction of both
    sides is this, divided by the share of the input side:
        (tau_m - J theta_dd - tau_deflection) / (1 - output share) = f_in + f_out + (gain error) tau_deflection + bias.
    """

    def __init__(self, arm: Arm, scale: float = 1.0) -> None:
        """
        Args:
            arm: the arm's numbers; its friction curve is the prior.
            scale: factor on the prior, for an arm whose friction is not what its file says.
        """
        n, filed = arm.n, arm.frictions
        self.record = record(
            terms=(n, TERMS),
            covariance=(n, TERMS, TERMS),
            walk=(n, TERMS),  # variance that a tick adds
            ceiling=(n, TERMS),  # variance at first
            noise=(n,),  # variance of a measurement
            total=(n,),
            deviation=(n,),
            warmth=(n,),
            temperature=(),  # of reference [°C]
            per_kelvin=(),
            output_share=(),
        )
        own = self.record[0]
        self.terms, self.covariance = own["terms"], own["covariance"]
        self.total, self.deviation, self.warmth = own["total"], own["deviation"], own["warmth"]
        self.terms[:, :3] = _fitted(tuple(filed.speed), tuple(map(tuple, filed.torque)), scale)
        self.terms[:, 3] = scale * np.array(filed.load)
        limit = np.array(arm.limits.torque)
        size = np.abs(self.terms[:, :4])
        size[:, :3] = np.maximum(size[:, :3], 0.05 * self.terms[:, :1])
        deviation = np.column_stack([PRIOR * size, np.full(n, GAIN_PRIOR), BIAS_PRIOR * limit])
        walk = np.column_stack([WALK * size, np.full(n, GAIN_WALK), BIAS_WALK * limit])
        self.covariance[:] = [np.diag(row**2) for row in deviation]
        own["walk"], own["ceiling"], own["noise"] = walk**2 * TICK, deviation**2, (NOISE * limit) ** 2 * CORRELATED
        self.output_share = filed.output_share
        own["temperature"], own["per_kelvin"], own["output_share"] = filed.temperature, filed.per_kelvin, filed.output_share
        self.warmth[:] = 1.0

    @property
    def breakaway(self) -> Array:
        """Torque that a standing joint may hold by friction (n,) [N·m]."""
        return self.terms[:, 0] * self.warmth

    def at(self, speed: Array, tau_J: Array) -> Array:
        """Sliding friction (n,) [N·m] of both sides at a given speed and load, at the last temperature.

        A speed of 0 counts as a very slow forward motion.
        """
        total = np.empty_like(speed)
        slide(self.record, speed, tau_J, total)
        return total

    def parts(self, speed: Array, tau_J: Array) -> tuple[Array, Array]:
        """Friction at a speed: the part that does not depend on the speed, and the part that grows with it, each (n,) [N·m]."""
        coulomb, viscous = np.empty_like(speed), np.empty_like(speed)
        _part(self.record, (speed, tau_J), coulomb, viscous)
        return coulomb, viscous


@kernel
def rub(friction, turning, temperature, free) -> None:
    """One tick.

    Args:
        friction: `AdaptiveFriction.record`.
        turning: what the joints do, as `Turning`.
        temperature: measured (n,) [°C].
        free: no contact, so that the surplus is friction.
    """
    turning = Turning(*turning)
    own = friction[0]
    warmth = own.warmth
    for i in range(warmth.size):
        warmth[i] = max(1.0 + own.per_kelvin * (temperature[i] - own.temperature), 0.2)
    _learn(own, turning, free)
    _evaluate(own, turning)


@kernel
def _friction_terms(speed, tau_J, warmth, row) -> None:
    sign = np.tanh(speed / SIGN_SPEED) * warmth
    size = abs(speed)
    row[0] = sign
    row[1] = sign * size / (size + KNEE)
    row[2] = sign * size
    row[3] = sign * abs(tau_J) / warmth  # load friction is of the teeth, not of the grease


@kernel
def _learn(own, turning, free) -> None:
    speed, surplus, tau_dyn, tau_J = turning
    warmth, walk, ceiling, noise = own.warmth, own.walk, own.ceiling, own.noise
    row, gain = np.empty(TERMS), np.empty(TERMS)
    for i in range(speed.size):
        P, w = own.covariance[i], own.terms[i]
        for k in range(TERMS):
            # The uncertainty of a term grows while nothing is learned, but at most to its first value.
            P[k, k] = min(P[k, k] + walk[i, k], max(ceiling[i, k], P[k, k]))
        if not free or abs(speed[i]) < GATE or math.isnan(surplus[i]):
            continue
        _friction_terms(speed[i], tau_J[i], warmth[i], row)
        row[4] = tau_dyn[i]
        row[5] = 1.0
        spread, predicted = noise[i], 0.0
        for k in range(TERMS):
            gain[k] = 0.0
            for m in range(TERMS):
                gain[k] += P[k, m] * row[m]
            spread += row[k] * gain[k]
            predicted += row[k] * w[k]
        error = surplus[i] - predicted
        for k in range(TERMS):
            w[k] += gain[k] * error / spread
            for m in range(TERMS):
                P[k, m] -= gain[k] * gain[m] / spread
        for k in range(4):
            w[k] = max(w[k], 0.0)  # friction never drives


@kernel
def _evaluate(own, turning) -> None:
    speed, tau_J = turning.speed, turning.tau_J
    warmth, terms, covariance, total, deviation = own.warmth, own.terms, own.covariance, own.total, own.deviation
    row = np.empty(TERMS)
    for i in range(speed.size):
        _friction_terms(speed[i], tau_J[i], warmth[i], row)
        value, variance = 0.0, 0.0
        for k in range(4):
            value += row[k] * terms[i, k]
            for m in range(4):
                variance += row[k] * covariance[i, k, m] * row[m]
        total[i] = value
        deviation[i] = np.sqrt(max(variance, 0.0)) + MISFIT * abs(value)


@kernel
def slide(friction, speed, tau_J, total) -> None:
    """Friction (n,) of both sides, as `AdaptiveFriction.at` gives it."""
    own = friction[0]
    warmth, terms = own.warmth, own.terms
    for i in range(speed.size):
        size, w = abs(speed[i]), terms[i]
        value = warmth[i] * (w[0] + w[1] * size / (size + KNEE) + w[2] * size) + w[3] * abs(tau_J[i])
        total[i] = value if speed[i] >= 0.0 else -value


@kernel
def _part(friction, moving, coulomb, viscous) -> None:
    own = friction[0]
    speed, tau_J = moving
    warmth, terms = own.warmth, own.terms
    for i in range(speed.size):
        size, w = abs(speed[i]), terms[i]
        coulomb[i] = warmth[i] * w[0] + w[3] * abs(tau_J[i])
        viscous[i] = warmth[i] * (w[1] * size / (size + KNEE) + w[2] * size)
