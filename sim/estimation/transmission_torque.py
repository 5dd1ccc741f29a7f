"""Transmission torque module: what passes through each gear, estimated three ways and fused (AF-3)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.sensing.calibration import ENCODER_RIPPLE, LINK_MASS, MOTOR_CONSTANT, STIFFNESS

Array = NDArray[np.float64]

WAYS = ("dynamics", "deflection", "motor")
"""From q and the rigid model; from theta and q; from theta and the motor torque, with the friction estimate."""

DYNAMICS, DEFLECTION, MOTOR = range(3)

MODEL_FLOOR = 0.004  # what the rigid model misses at least, relative to the torque limit: centres of mass, output friction
ACCELERATION_FLOOR = 0.1  # deviation of the output's acceleration at rest [rad/s²]
ACCELERATION_SHARE = 0.15  # and of the largest acceleration lately: links swing on their springs faster than the filter sees
LATELY = math.exp(-TICK / 0.3)
SOFTEST, STIFFEST = 1.0 / (1.0 + STIFFNESS) - 1.0, 1.0 / (1.0 - STIFFNESS) - 1.0  # the springs, against what is believed
STIFFNESS_WALK = 2e-3  # random walk of the learned stiffness error [1/sqrt(s)]
OFFSET_WALK = 0.05  # of the deflection's offset, relative to the ripple's torque [1/sqrt(s)]
RIPPLE_LEFT = 0.25  # share of the ripple that a learned offset leaves
CORRELATED = 100.0  # ticks over which the deflection's error stays alike
CONTACT = 2.5  # deviations between two ways that count as a contact
CONTACT_FLOOR = 0.012  # and the least such difference, relative to the torque limit
SLOWLY = TICK / 0.3  # where two ways differ for longer than this [s], it is the deflection's error
REMEMBERED = 1500  # ticks of motion over which it is remembered how much they differed; before so many it does not count
SETTLE_TICKS = 100  # after a contact, before its end is believed


class TransmissionTorque:
    """Transmission torque of n joints [N·m], three ways, and their fusion by inverse variances.

    The rigid model is right up to masses and centres while nothing is touched, and wrong by the external torque in contact.
    The deflection feels contacts, but its stiffness is known to a fifth and the output encoder's ripple counts in full: the
    stiffness error and an offset are learned from the rigid model while nothing is touched. The motor's way is uncertain by
    the friction estimate, and by the whole stiction while the joint stands. A contact is where the rigid model differs from
    the deflection, or without it from the motor's way, by more than both allow.

    The model's errors change fast, with accelerations that it does not see in time; the deflection's slowly, with the angle.
    So the deflection is trusted as far as the two have agreed lately, in the mean over a third of a second, more or less than was
    believed of it, and as far as the model explains how much they differ now; the model as far as the rest of their difference
    was small (innovation-based adaptive estimation: Mehra, 1970). That is for the fusion alone: agreement at the angles of now
    says little of the next ones, and what tells a hand from an error must not count on it.

    Attributes:
        ways, deviations: each way (3, n), and its standard deviation.
        fused, deviation: their fusion (n,), and its standard deviation; a joint without any way keeps its last value.
        external_deviation: standard deviation of `external` at rest (n,): errors of the deflection and of the model's masses.
        external: model minus the deflection, or without it minus the motor's way (n,): the external torque; 0 without both.
        stiffer: learned error of the springs' believed stiffness (n,), relative to it.
        offset: learned error of what the deflection is believed to bear at rest (n,) [N·m].
        contact: some joint feels a contact.
    """

    def __init__(self, arm: Arm, inertia: Array) -> None:
        """`inertia` (n,) is what a joint usually has to move [kg·m²]."""
        n, spring = arm.n, arm.transmissions
        limit = np.array(arm.limits.torque)
        stiffness = np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)
        ripple = ENCODER_RIPPLE * stiffness
        self._constants = np.stack([MODEL_FLOOR * limit, ripple, CONTACT_FLOOR * limit, inertia])
        self._swing = np.zeros(1)  # the largest acceleration lately [rad/s²]
        self.correction = np.zeros((2, n))
        self.stiffer, self.offset = self.correction
        self._covariance = np.zeros((n, 2, 2))
        # Model from deflection, slowly [N·m]; mean squares of that, and of the rest; ticks over which they were compared.
        self._differ = np.zeros((4, n))
        self.forget()
        self._walk = np.column_stack([np.full(n, STIFFNESS_WALK), OFFSET_WALK * ripple]) ** 2 * TICK
        # One block for all that a tick brings: each array that is handed to a kernel costs as much as a joint's arithmetic.
        self._outcome = np.zeros((11, n))
        self.ways, self.deviations = self._outcome[:3], self._outcome[3:6]
        # The last but one is the standard deviation of the rigid model where nothing is touched.
        self.fused, self.deviation, self.external, self.external_deviation, self._model = self._outcome[6:]
        self.contact = False
        self._quiet = SETTLE_TICKS

    def forget(self) -> None:
        """Begin to learn anew: the rigid model has another load, and what was learned from it may have been its error."""
        self.correction[:] = 0.0
        self._covariance[:] = 0.0
        self._covariance[:, 0, 0] = STIFFNESS**2 / 3.0  # of a uniform error
        self._covariance[:, 1, 1] = self._constants[1] ** 2
        self._differ[:] = 0.0

    def update(
        self, friction_deviation: Array, stiction: Array, acceleration: Array, *, moving: bool, use: NDArray[np.bool_]
    ) -> None:
        """One tick, on the raw values that the caller has put into `ways`.

        These are: torque of the rigid model and of the output side's friction; stiffness as believed times the deflection;
        tau_m - J theta_dd - friction of the input side.

        Args:
            friction_deviation: of that friction (n,) [N·m].
            stiction: what a standing joint may hold besides (n,) [N·m], 0 for one that moves.
            acceleration: of the motors (n,) [rad/s²].
            moving: some joint moves; at rest nothing is learned, for a wrong payload would pass for a soft spring.
            use: which of `WAYS` may be used, of which joint (3, n).
        """
        self._quiet = _update(
            self._outcome, friction_deviation, stiction, acceleration, self._constants, self._swing, self.correction,
            self._covariance, self._walk, self._differ, use, moving, self._quiet,
        )  # fmt: skip
        self.contact = self._quiet < SETTLE_TICKS


@numba.njit(cache=True)
def _update(
    outcome, friction_deviation, stiction, acceleration, constants, swing, correction, covariance, walk, differ, use, moving,
    quiet,
) -> int:  # fmt: skip
    """Compare, then fuse. Returns for how many ticks nothing has been touched."""
    rubbing, learned = (friction_deviation, stiction), (correction, covariance, walk, differ)
    ways, deviations, model = outcome[:3], outcome[3:6], outcome[10]
    fused, deviation, external, external_deviation = outcome[6], outcome[7], outcome[8], outcome[9]
    learn = moving and quiet >= SETTLE_TICKS
    touched = _compare(
        ways, deviations, rubbing, acceleration, constants, swing, learned, use, learn, model, external, external_deviation
    )  # fmt: skip
    quiet = 0 if touched else quiet + 1
    _fuse(ways, deviations, (model, constants[0], differ), external, quiet < SETTLE_TICKS, use, fused, deviation)
    return quiet


@numba.njit(cache=True)
def _compare(
    ways, deviations, rubbing, acceleration, constants, swing, learned, use, learn, model, external, external_deviation
) -> bool:  # fmt: skip
    """Correct the deflection, find what the rigid model does not explain, learn the correction from it unless touched."""
    correction, covariance, walk, differ = learned
    friction_deviation, stiction = rubbing
    n = external.size
    swing[0] *= LATELY
    for i in range(n):
        swing[0] = max(swing[0], abs(acceleration[i]))
    shaking = ACCELERATION_FLOOR + ACCELERATION_SHARE * swing[0]
    touched = False
    for i in range(n):
        floor, ripple, least, inertia = constants[0, i], constants[1, i], constants[2, i], constants[3, i]
        P, x, dynamics = covariance[i], ways[1, i], ways[0, i]
        ways[1, i] += x * correction[0, i] + correction[1, i]
        rigid = (LINK_MASS * dynamics) ** 2 + floor**2
        model[i] = np.sqrt(rigid + (shaking * inertia) ** 2)
        known = max(x * x * P[0, 0] + 2.0 * x * P[0, 1] + P[1, 1], 0.0)
        gear, noise = known + (RIPPLE_LEFT * ripple) ** 2, (0.3 * floor) ** 2
        external_deviation[i] = np.sqrt(gear + noise + rigid)
        if use[0, i] and differ[3, i] == REMEMBERED:
            gear = max(differ[1, i], differ[0, i] ** 2 - rigid)
        deviations[1, i] = np.sqrt(gear + noise)
        rubs = friction_deviation[i] ** 2 + stiction[i] ** 2
        deviations[2, i] = np.sqrt((MOTOR_CONSTANT * ways[2, i]) ** 2 + rubs + floor**2)
        external[i] = 0.0
        if not use[0, i] or not (use[1, i] or use[2, i]):
            continue
        other = 1 if use[1, i] else 2
        external[i] = dynamics - ways[other, i]
        allowed = known + (0.5 * ripple) ** 2 if other == 1 else deviations[2, i] ** 2
        if abs(external[i]) > max(CONTACT * np.sqrt(allowed + model[i] ** 2), least):
            touched = True
    if touched or not learn:
        return touched
    for i in range(n):
        if not (use[0, i] and use[1, i]):
            continue
        P, ripple = covariance[i], constants[1, i]
        x = (ways[1, i] - correction[1, i]) / (1.0 + correction[0, i])
        error = external[i]
        differ[3, i] = min(differ[3, i] + 1.0, REMEMBERED)
        differ[0, i] += SLOWLY * (error - differ[0, i])
        differ[1, i] += (differ[0, i] ** 2 - differ[1, i]) / differ[3, i]
        differ[2, i] += ((error - differ[0, i]) ** 2 - differ[2, i]) / differ[3, i]
        # What nothing bends tells nothing of its stiffness: it may drift, but never beyond what was believed at first.
        P[0, 0] = min(P[0, 0] + walk[i, 0], STIFFNESS**2 / 3.0)
        P[1, 1] = min(P[1, 1] + walk[i, 1], ripple**2)
        g0, g1 = P[0, 0] * x + P[0, 1], P[0, 1] * x + P[1, 1]
        spread = g0 * x + g1 + (0.5 * ripple) ** 2 * CORRELATED
        P[0, 0] -= g0 * g0 / spread
        P[1, 1] -= g1 * g1 / spread
        P[0, 1] -= g0 * g1 / spread
        P[1, 0] = P[0, 1]
        stiffer = correction[0, i] + g0 * error / spread
        correction[0, i] = min(max(stiffer, SOFTEST), STIFFEST)
        # The offset was learned together with a stiffness that cannot be: it is what goes with the bound.
        offset = correction[1, i] + g1 * error / spread + (correction[0, i] - stiffer) * P[0, 1] / P[0, 0]
        correction[1, i] = min(max(offset, -ripple), ripple)
    return False


@numba.njit(cache=True)
def _fuse(ways, deviations, errors, external, contact, use, fused, deviation) -> None:
    model, floor, differ = errors
    for i in range(fused.size):
        outside = external[i] if contact else 0.0
        variance = model[i] ** 2
        if use[1, i] and differ[3, i] == REMEMBERED:
            # Without an output angle, though, the model's acceleration is made of this torque itself.
            variance = min(variance, (LINK_MASS * ways[0, i]) ** 2 + floor[i] ** 2 + differ[2, i])
        deviations[0, i] = np.sqrt(variance + outside**2)
        weight, total = 0.0, 0.0
        for k in range(3):
            if use[k, i]:
                w = 1.0 / deviations[k, i] ** 2
                weight += w
                total += w * ways[k, i]
        if weight > 0.0:
            fused[i] = total / weight
            deviation[i] = np.sqrt(1.0 / weight)
