"""What the hand asks of each joint, felt by the flange sensor and by the joints, and the help that it gets (FD-3, AF-7)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.adaptive_friction import AdaptiveFriction

Array = NDArray[np.float64]

INTENT = 0.12  # of the breakaway torque: a hand that asks for this much is helped in full
DEAD_ZONE = 0.05  # of the breakaway torque: less than this is the sensor's noise, no hand
HELP_BANDWIDTH = 12.0  # of that help [Hz]: a hand is slower, the wrists' own modes and the flange sensor's noise are faster
BRAKE, BRAKE_SPEED = 1.5, 0.15  # of the breakaway torque, added to the friction of a joint of which nothing is asked; [rad/s]
PACE_TIME = 0.05
"""Time constant of the speed that a joint had lately [s]: as the help for the hand follows it near a limit."""


class Asking(NamedTuple):
    """What the flange sensor tells of the hand."""

    F_user: Array  # (6,) axes of B [N, N·m]
    baseline: tuple[float, ...]  # of the sensor (6,) axes of F: it turns with the flange
    slack: tuple[float, float]  # so much of force [N] and torque [N·m] may be its drift
    R: Array  # orientation of the flange (3, 3)
    jacobian: Array  # of the flange (6, n), linear first
    cap: float  # largest force that is helped [N]
    gain: float


class FeltByJoints(NamedTuple):
    """What the joints tell of the hand, n joints."""

    tau_hand: Array  # torque of a hand (n,) [N·m]
    tau_certain: Array  # what of it is certain (n,) [N·m]
    sliding: Array  # friction (n,) [N·m]
    speed: Array  # of the motors (n,) [rad/s]
    most: float  # share of the friction that is taken off at most


class HandHelp:
    """Finds what a hand asks of n joints, and takes friction off it.

    Attributes:
        capped: torque (n,) that the flange sensor explains, its force capped [N·m].
    """

    def __init__(self, n: int) -> None:
        self._record = record(
            capped=(n,),  # torque that the flange sensor explains, its force capped
            asked=(n,),  # that, filtered
            felt=(n,),  # by the joints, filtered
            pace=(n,),  # speed lately, filtered [rad/s]
            pace_share=(),  # weight of a tick in it
            smooth=(),  # weight of a tick in both
        )
        own = self._own = self._record[0]
        self.capped = own["capped"]
        own["smooth"] = 1.0 - math.exp(-2.0 * math.pi * HELP_BANDWIDTH * TICK)
        own["pace_share"] = 1.0 - math.exp(-TICK / PACE_TIME)

    def start(self) -> None:
        """Free-drive begins: nothing is asked."""
        self._own["asked"], self._own["felt"], self._own["pace"] = 0.0, 0.0, 0.0

    def ask(
        self, asking: tuple[Array, tuple[float, ...], tuple[float, float], Array, Array, float, float], torque: Array
    ) -> None:
        """Add to `torque` (n,) [N·m] what the hand at the flange asks for; `asking` as `Asking`."""
        _ask(self._record, asking, torque)

    def ask_nothing(self) -> None:
        """The flange sensor is not to be used in this tick."""
        self.capped[:] = 0.0

    def take_off(self, estimate: Estimate, friction: AdaptiveFriction, share: float, torque: Array) -> None:
        """Take at most this share of the friction off the hand; a joint of which nothing is asked is braked."""
        felt = estimate.whose.tau_hand, estimate.whose.tau_certain, estimate.friction, estimate.theta_d, share
        _take_off(self._record, friction.record, felt, torque)


@kernel
def _ask(law, asking, torque) -> None:
    """What the hand asks of each joint. The baseline is an offset of the sensor: it turns with the flange.

    What may be drift asks for nothing. So no drift moves the arm, and who moves it has been felt.
    """
    asking = Asking(*asking)
    own = law[0]
    F_user, baseline, slack, R, jacobian, cap, gain = asking
    wrench = np.empty(6)
    for k in range(3):
        wrench[k], wrench[3 + k] = F_user[k], F_user[3 + k]
        for m in range(3):
            wrench[k] -= R[k, m] * baseline[m]
            wrench[3 + k] -= R[k, m] * baseline[3 + m]
    size = _size(wrench[:3])
    pull, turn = _certain(size, slack[0]), _certain(_size(wrench[3:]), slack[1])
    size *= pull
    share = cap / size if size > cap else 1.0
    for i in range(torque.size):
        pulled = turned = 0.0
        for k in range(3):
            pulled += jacobian[k, i] * wrench[k]
            turned += jacobian[3 + k, i] * wrench[3 + k]
        own.capped[i] = share * (pull * pulled + turn * turned)
        torque[i] += gain * own.capped[i]


@kernel
def _size(value):
    return math.sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2])


@kernel
def _certain(size, slack):
    """The share of a value of this size that is more than may be drift."""
    return max(1.0 - slack / size, 0.0) if size > 0.0 else 0.0


@kernel
def _take_off(law, friction, joints, torque) -> None:
    joints = FeltByJoints(*joints)
    own, terms, warmth = law[0], friction[0].terms, friction[0].warmth
    tau_hand, tau_certain, sliding, speed, most = joints
    for i in range(torque.size):
        breakaway = terms[i, 0] * warmth[i]
        own.asked[i] += own.smooth * (own.capped[i] - own.asked[i])
        own.felt[i] += own.smooth * (tau_certain[i] - own.felt[i])
        ask = own.asked[i] if abs(own.asked[i]) >= abs(own.felt[i]) else own.felt[i]
        size = max(abs(ask) - DEAD_ZONE * breakaway, 0.0)
        share = min(size / (INTENT * breakaway), 1.0) if breakaway > 0.0 else 1.0
        if most == 0.0:
            share = 0.0
        torque[i] += math.copysign(most * share * max(abs(sliding[i]), breakaway), ask)
        # A joint of which nothing is asked comes to rest sooner than by its friction alone, unless a hand may push it on: then it
        # keeps its speed.
        own.pace[i] += own.pace_share * (abs(speed[i]) - own.pace[i])
        along = tau_hand[i] if speed[i] > 0.0 else -tau_hand[i]
        pushed = min(max(along / (INTENT * breakaway), 0.0), 1.0) if breakaway > 0.0 and most > 0.0 else 0.0
        if own.pace[i] > abs(speed[i]):
            pushed *= (speed[i] / own.pace[i]) ** 2
        torque[i] -= (1.0 - share) * (1.0 - pushed) * BRAKE * breakaway * math.tanh(speed[i] / BRAKE_SPEED)
