"""Transmission torque module: what passes through each gear, estimated three ways and fused (AF-3)."""

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.modes import TICK
from sim.arm import Arm
from sim.calibration import ENCODER_RIPPLE, LINK_MASS, MOTOR_CONSTANT, STIFFNESS

Array = NDArray[np.float64]

WAYS = ("dynamics", "deflection", "motor")
"""From q and the rigid model; from theta and q; from theta and the motor torque, with the friction estimate."""

DYNAMICS, DEFLECTION, MOTOR = range(3)

MODEL_FLOOR = 0.008  # what the rigid model misses at least, relative to the torque limit: centres of mass, output friction
STIFFNESS_WALK = 2e-3  # random walk of the learned stiffness error [1/sqrt(s)]
OFFSET_WALK = 0.05  # of the deflection's offset, relative to the ripple's torque [1/sqrt(s)]
CORRELATED = 100.0  # ticks over which the deflection's error stays alike
CONTACT = 2.5  # deviations between deflection and dynamics that count as a contact
CONTACT_FLOOR = 0.012  # and the least such difference, relative to the torque limit
SETTLE_TICKS = 100  # after a contact, before its end is believed


class TransmissionTorque:
    """Transmission torque of n joints [N·m], three ways, and their fusion by inverse variances.

    The rigid model is right up to masses and centres while nothing is touched, and wrong by the external torque in contact.
    The deflection feels contacts, but its stiffness is known to a fifth and the output encoder's ripple counts in full: the
    stiffness error and an offset are learned from the rigid model while nothing is touched. The motor's way is uncertain by
    the friction estimate, and by the whole stiction while the joint stands. A contact is where deflection and model differ
    by more than both allow.
    """

    def __init__(self, arm: Arm) -> None:
        n, spring = arm.n, arm.transmissions
        limit = np.array(arm.limits.torque)
        stiffness = np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)
        self._floor = MODEL_FLOOR * limit
        self._ripple = ENCODER_RIPPLE * stiffness
        self._least = CONTACT_FLOOR * limit
        self.correction = np.zeros((n, 2))  # stiffness error, offset [N·m]
        self._covariance = np.zeros((n, 2, 2))
        self._covariance[:, 0, 0] = STIFFNESS**2 / 3.0  # of a uniform error
        self._covariance[:, 1, 1] = self._ripple**2
        self._walk = np.column_stack([np.full(n, STIFFNESS_WALK), OFFSET_WALK * self._ripple]) ** 2 * TICK
        self.ways, self.deviations = np.zeros((2, 3, n))
        self.fused, self.deviation = np.zeros((2, n))
        self.difference = np.zeros(n)  # model minus corrected deflection: the external torque [N·m]
        self.contact = False
        self._quiet = SETTLE_TICKS

    def update(
        self,
        dynamics: Array,
        deflection: Array,
        motor: Array,
        friction_deviation: Array,
        stiction: Array,
        moving: bool,
        use: Array,
    ) -> None:
        """One tick.

        Args:
            dynamics: torque of the rigid model and of the output side's friction (n,) [N·m].
            deflection: stiffness as believed times the deflection (n,) [N·m].
            motor: tau_m - J theta_dd - friction of the input side (n,) [N·m].
            friction_deviation: of that friction (n,) [N·m].
            stiction: what a standing joint may hold besides (n,) [N·m], 0 for one that moves.
            moving: some joint moves; at rest nothing is learned, for a wrong payload would pass for a soft spring.
            use: which of `WAYS` may be used (3,), bool.
        """
        touched = _compare(
            dynamics, deflection, self._floor, self._ripple, self._least, self.correction, self._covariance, self._walk, use,
            moving and self._quiet >= SETTLE_TICKS, self.difference,
        )  # fmt: skip
        self._quiet = 0 if touched else self._quiet + 1
        self.contact = self._quiet < SETTLE_TICKS
        _fuse(
            dynamics, deflection, motor, friction_deviation, stiction, use, self.contact, self._floor, self._ripple,
            self.correction, self._covariance, self.difference, self.ways, self.deviations, self.fused, self.deviation,
        )  # fmt: skip


@numba.njit(cache=True)
def _compare(dynamics, deflection, floor, ripple, least, correction, covariance, walk, use, learn, difference) -> bool:
    """Difference of model and corrected deflection; learn the correction unless touched. Returns whether it looks touched."""
    if not (use[0] and use[1]):
        difference[:] = 0.0
        return False
    touched = False
    for i in range(difference.size):
        P = covariance[i]
        x = deflection[i]
        difference[i] = dynamics[i] - x * (1.0 + correction[i, 0]) - correction[i, 1]
        known = x * x * P[0, 0] + 2.0 * x * P[0, 1] + P[1, 1]
        model = (LINK_MASS * dynamics[i]) ** 2 + floor[i] ** 2
        if abs(difference[i]) > max(CONTACT * np.sqrt(known + model + 0.25 * ripple[i] ** 2), least[i]):
            touched = True
    if touched or not learn:
        return touched
    for i in range(difference.size):
        P = covariance[i]
        x = deflection[i]
        P[0, 0] += walk[i, 0]
        P[1, 1] = min(P[1, 1] + walk[i, 1], ripple[i] ** 2)
        g0, g1 = P[0, 0] * x + P[0, 1], P[0, 1] * x + P[1, 1]
        spread = g0 * x + g1 + (0.5 * ripple[i]) ** 2 * CORRELATED
        correction[i, 0] += g0 * difference[i] / spread
        correction[i, 1] += g1 * difference[i] / spread
        correction[i, 0] = min(max(correction[i, 0], -STIFFNESS), STIFFNESS)
        correction[i, 1] = min(max(correction[i, 1], -ripple[i]), ripple[i])
        P[0, 0] -= g0 * g0 / spread
        P[1, 1] -= g1 * g1 / spread
        P[0, 1] -= g0 * g1 / spread
        P[1, 0] = P[0, 1]
    return False


@numba.njit(cache=True)
def _fuse(
    dynamics, deflection, motor, friction_deviation, stiction, use, contact, floor, ripple,
    correction, covariance, difference, ways, deviations, fused, deviation,
) -> None:  # fmt: skip
    for i in range(fused.size):
        P, x = covariance[i], deflection[i]
        ways[0, i] = dynamics[i]
        ways[1, i] = x * (1.0 + correction[i, 0]) + correction[i, 1]
        ways[2, i] = motor[i]
        outside = difference[i] ** 2 if contact else 0.0
        deviations[0, i] = np.sqrt((LINK_MASS * dynamics[i]) ** 2 + floor[i] ** 2 + outside)
        known = x * x * P[0, 0] + 2.0 * x * P[0, 1] + P[1, 1]
        deviations[1, i] = np.sqrt(known + 0.25 * ripple[i] ** 2 + (0.3 * floor[i]) ** 2)
        rubbing = friction_deviation[i] ** 2 + stiction[i] ** 2
        deviations[2, i] = np.sqrt((MOTOR_CONSTANT * motor[i]) ** 2 + rubbing + floor[i] ** 2)
        weight, total = 0.0, 0.0
        for k in range(3):
            if use[k]:
                w = 1.0 / deviations[k, i] ** 2
                weight += w
                total += w * ways[k, i]
        if weight > 0.0:
            fused[i] = total / weight
            deviation[i] = np.sqrt(1.0 / weight)
