"""Free-drive law: the arm carries itself and its configured payload, and follows the hand (FD-2, FD-3, AF-7)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.estimate import Estimate
from sim.adaptive_friction import AdaptiveFriction
from sim.dynamics import Dynamics

Array = NDArray[np.float64]

COMPENSATED = 0.85  # share of the friction estimate that is taken off the hand
INTENT = 0.25  # of the breakaway torque: a hand that asks for this much is helped in full
DEAD_ZONE = 0.06  # of the breakaway torque: less than this is sensor drift, no hand
FELT = 0.8  # of the breakaway torque: a push felt by the joints alone must exceed this change, the stiffness is not well known


class FreeDriveLaw:
    """Motor torque = static torque + J^T gain F_user + friction, as far as the hand asks for it.

    Friction is compensated in the direction of what the hand asks of a joint and in proportion to it, never in the
    direction of the motion: without a hand nothing is compensated, the arm's own friction holds it, and even too large an
    estimate neither drives it nor makes it hum.
    """

    def __init__(self, dynamics: Dynamics, n: int) -> None:
        self._dynamics = dynamics
        self._asked = np.zeros(n)
        self._felt_before = np.zeros(n)
        self._turned = np.eye(3)

    def start(self, estimate: Estimate) -> None:
        """Free-drive begins: what the joints feel now is no hand."""
        self._felt_before[:] = estimate.tau_ext
        self._turned[:] = estimate.R_BF

    def torque(
        self, estimate: Estimate, decision: Decision, jacobian: Array, friction: AdaptiveFriction, with_friction: bool
    ) -> Array:
        """Motor torque (n,) [N·m].

        Args:
            estimate: this tick's estimate.
            decision: its gain is 0 while the arm is only freed to see whether it stays; then nothing helps the hand.
            jacobian: of the flange (6, n), linear first, axes of B.
            friction: its estimate.
            with_friction: take friction off the hand.
        """
        torque = self._dynamics.gravity(estimate.q)
        if decision.gain <= 0.0:
            return torque
        asked = self._asked
        asked[:] = 0.0
        if estimate.wrench_valid:
            cap, gain = decision.force_cap, decision.gain
            _ask(estimate.F_user, decision.baseline, estimate.R_BF, self._turned, jacobian, cap, gain, asked, torque)
        if with_friction:
            _take_off(asked, estimate.tau_ext, self._felt_before, estimate.friction, friction.terms, friction.warmth, torque)
        return torque


@numba.njit(cache=True)
def _ask(F_user, baseline, R, R_before, jacobian, cap, gain, asked, torque) -> None:
    """What the hand asks of each joint, its force capped. The baseline is an offset of the sensor: it turns with the flange."""
    wrench = np.empty(6)
    for k in range(3):
        wrench[k], wrench[3 + k] = F_user[k], F_user[3 + k]
        for m in range(3):
            turn = R[k, 0] * R_before[m, 0] + R[k, 1] * R_before[m, 1] + R[k, 2] * R_before[m, 2]
            wrench[k] -= turn * baseline[m]
            wrench[3 + k] -= turn * baseline[3 + m]
    size = math.sqrt(wrench[0] * wrench[0] + wrench[1] * wrench[1] + wrench[2] * wrench[2])
    share = cap / size if size > cap else 1.0
    for i in range(torque.size):
        for j in range(6):
            asked[i] += share * jacobian[j, i] * wrench[j]
        torque[i] += gain * asked[i]


@numba.njit(cache=True)
def _take_off(asked, tau_ext, felt_before, sliding, terms, warmth, torque) -> None:
    for i in range(torque.size):
        breakaway = terms[i, 0] * warmth[i]
        ask, felt = asked[i], tau_ext[i] - felt_before[i]
        over = abs(felt) - FELT * breakaway
        if over > abs(ask):
            ask = math.copysign(over, felt)
        size = abs(ask) - DEAD_ZONE * breakaway
        if size > 0.0:
            share = min(size / (INTENT * breakaway), 1.0) if breakaway > 0.0 else 1.0
            torque[i] += math.copysign(COMPENSATED * share * max(abs(sliding[i]), breakaway), ask)
