"""What the external torques of the joints are wrong by: gears, output encoders, the zero of the flange sensor. It is learned.

Three constants of an arm make torques where nothing is touched, each with a shape of its own: the error of a gear's stiffness
makes a share of what the gear bears; the ripple of an output encoder, which is the deflection's, goes with the first and the
second harmonic of its angle (a disc off its centre, and one that is not round); the zero of the flange sensor, fixed in the
flange, makes torques by the levers of the posture. So the torques without a contact are a linear function of known causes with
constant shares; shares that are known little make a doubt that grows with their causes' change.
"""

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import ripple_torque
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.transmission_torque import CONTACT, stiffness_range

Array = NDArray[np.float64]

ZERO, OWN = 6, 5
"""Constants that all joints share: the zero of the flange sensor; and those of each: of its gear, then of its encoder."""
CAUSES = OWN + ZERO
"""Of a joint's torque: what its gear bears, the levers of the sensor's zero, cosine and sine of angle and of twice the angle."""
STIFFNESS_WALK = 2e-3  # of the stiffness error [1/sqrt(s)]
RIPPLE_WALK = 0.01  # of each harmonic, relative to the ripple's torque [1/sqrt(s)]
FORCE_WALK, TORQUE_WALK = 0.1, 0.04
"""Of the flange sensor's zero [N/sqrt(s)], [N·m/sqrt(s)]: enough to follow a faulty one that drifts by 0.02 N and 0.02 N·m a
second (bench `false_contacts`); one that warms up: 0.013 N and 0.001 N·m (assets/robots/)."""
CORRELATED = 100.0  # ticks over which errors of the torques stay alike
CARRIED = 0.15
"""Share of what the gears bear that a payload may be wrong by: up to a fifth of a payload, which is most of what they bear. It
counts without the flange sensor alone."""
SMOOTH = 0.02
"""Share a tick by which what is felt is smoothed, to tell a contact: a tenth of a second, over which an arm's swing on its
gears is little."""
FOLLOW = 0.0066
"""Share a tick by which what is felt while nothing is touched follows: a time constant of 0.3 s, as the links' watch has it."""
WAIT = 60
"""Ticks until a torque is learned from: a hand that comes is known by then, and not learned."""
SURE = 3.0  # deviations of a constant that is learned


class TorqueErrors:
    """Constants of n joints and of the flange sensor, by a Kalman filter over all of them.

    Attributes:
        causes: of each joint's torque in this tick (n, CAUSES) [N·m], [m], [1], [1].
        shares: constants that they come with, as learned (n, CAUSES) [1], [N], [N·m], [N·m].
        misfit: by how much each share may still be wrong (n, CAUSES).

    Args:
        arm: the arm's numbers.
    """

    def __init__(self, arm: Arm) -> None:
        n = arm.n
        size = ZERO + OWN * n
        self.record = record(
            motor_constant=(),  # what it may be wrong by, relative to it
            link_mass=(),  # the same
            softest=(),  # springs, against what is believed, at least
            stiffest=(),
            causes=(n, CAUSES),
            shares=(n, CAUSES),
            misfit=(n, CAUSES),
            known=(size,),  # the constants
            covariance=(size, size),
            most=(size,),  # what each may be
            walk=(size,),  # variance that a tick adds
            felt=(n, 1 + CAUSES),  # torque and causes, smoothed
            rest=(n, 1 + CAUSES),  # the same, as they were while nothing was touched
            waiting=(WAIT, 2 + CAUSES),  # torque, its variance and causes of one joint a tick, yet to be learned from
            joint=f"{WAIT}i8",  # whose they are
            at="i8",  # where the next one goes
            count="i8",  # so many are there
        )
        own = self._own = self.record[0]
        self.causes, self.shares, self.misfit = own["causes"], own["shares"], own["misfit"]
        ripple = ripple_torque(arm)
        most, walk, accuracy = own["most"], own["walk"], arm.accuracy
        own["motor_constant"], own["link_mass"] = accuracy.motor_constant, accuracy.link_mass
        own["softest"], own["stiffest"] = stiffness_range(accuracy.stiffness)
        most[:3], most[3:ZERO], walk[:3], walk[3:ZERO] = accuracy.force_offset, accuracy.torque_offset, FORCE_WALK, TORQUE_WALK
        most[ZERO:], walk[ZERO:] = np.repeat(ripple, OWN), np.repeat(RIPPLE_WALK * ripple, OWN)
        most[ZERO::OWN], walk[ZERO::OWN] = accuracy.stiffness, STIFFNESS_WALK
        walk[:] = walk * walk * TICK
        np.fill_diagonal(own["covariance"], most * most / 3.0)  # of a uniform error

    def forget_zero(self) -> None:
        """The flange sensor tells something else from now on."""
        own = self._own
        own["known"][:ZERO] = 0.0
        own["covariance"][:ZERO] = own["covariance"][:, :ZERO] = 0.0
        own["covariance"][np.arange(ZERO), np.arange(ZERO)] = own["most"][:ZERO] ** 2 / 3.0


@kernel
def look(errors, rigid, bears, state) -> None:
    """Causes of this tick, and what is known of their shares.

    Args:
        errors: `TorqueErrors.record`.
        rigid: row of the rigid model's recursion.
        bears: torques through the gears and residuals (n,) [N·m].
        state: output angles (n,) [rad], which joints' torques come from the deflection (n,), and whether the sensor is there.
    """
    own = errors[0]
    borne, residual = bears
    q, by_deflection, with_sensor = state
    R, jacobian = rigid.R, rigid.jacobian
    # All drift, whether there is something to learn from or not, but never beyond what was believed at first: else an error that
    # is taken for a touch, of which nothing is learned, would stay for good.
    for at in range(own.known.size):
        P = own.covariance[at, at]
        own.covariance[at, at] = P + min(own.walk[at], max(own.most[at] ** 2 / 3.0 - P, 0.0))
    for i in range(q.size):
        causes, shares, misfit = own.causes[i], own.shares[i], own.misfit[i]
        causes[0] = borne[i]
        for k in range(3):
            causes[1 + k] = causes[4 + k] = 0.0
            if with_sensor:
                for r in range(3):
                    causes[1 + k] += R[r, k] * jacobian[r, i]
                    causes[4 + k] += R[r, k] * jacobian[3 + r, i]
        ripples = 1.0 if by_deflection[i] else 0.0
        c, s = np.cos(q[i]), np.sin(q[i])
        causes[7], causes[8], causes[9], causes[10] = ripples * c, ripples * s, ripples * (c * c - s * s), ripples * 2.0 * c * s
        for k in range(CAUSES):
            at = _place(i, k)
            shares[k] = own.known[at]
            misfit[k] = min(own.most[at], SURE * np.sqrt(own.covariance[at, at]))
        if not by_deflection[i]:
            # Without a contact it bears what the model says: a push makes no error of its own.
            causes[0] = borne[i] + residual[i]
            shares[0], misfit[0] = 0.0, own.motor_constant
        misfit[0] += own.link_mass + (0.0 if with_sensor else CARRIED)


@kernel
def _place(i, k):
    """Where the constant of cause k of joint i stands among all."""
    if k == 0:
        return ZERO + OWN * i
    return k - 1 if k <= ZERO else ZERO + OWN * i + k - ZERO


@kernel
def noise(own, doubt, borne):
    """Variance of what is not explained of a joint: of links' masses, which go with what is borne, and of all else [N²·m²]."""
    masses = own.link_mass * borne
    return doubt * doubt + masses * masses


@kernel
def left_over(shares, torque, causes):
    """What the causes leave of a joint's torque [N·m]."""
    for k in range(CAUSES):
        torque -= shares[k] * causes[k]
    return torque


@kernel
def variance(own, i, causes):
    """Of what these causes make of joint i's torque, as well as their shares are known [N²·m²].

    The covariance is symmetric, so half is read: of the joint's own causes, the zero's, and both.
    """
    P, first, known = own.covariance, ZERO + OWN * i, 0.0
    for k in range(OWN):
        cause, row = causes[0 if k == 0 else ZERO + k], 0.0
        for m in range(k):
            row += P[first + k, first + m] * causes[0 if m == 0 else ZERO + m]
        for m in range(ZERO):
            row += P[first + k, m] * causes[1 + m]
        known += cause * (2.0 * row + P[first + k, first + k] * cause)
    for k in range(ZERO):
        row = 0.0
        for m in range(k):
            row += P[k, m] * causes[1 + m]
        known += causes[1 + k] * (2.0 * row + P[k, k] * causes[1 + k])
    return max(known, 0.0)


@kernel
def beyond(own, i, what, doubt):
    """How much of a torque of joint i is more than its causes and the rest may be wrong by [N·m]: 0 where nothing is.

    `what` is what the causes leave of the torque, and the causes, or the change of both; `doubt` is the variance of what they do
    not explain [N²·m²], and how many deviations of both count as an error. Where it alone is as large, theirs is not asked for.
    """
    (left, causes), (rest, deviations) = what, doubt
    if left * left <= deviations**2 * rest:
        return 0.0
    size = abs(left) - deviations * np.sqrt(variance(own, i, causes) + rest)
    return np.copysign(size, left) if size > 0.0 else 0.0


@kernel
def _feels(own, i, felt, rest) -> bool:
    """Joint i feels such a torque, with its causes, or such a change of both."""
    causes = felt[1:]
    return beyond(own, i, (left_over(own.shares[i], felt[0], causes), causes), (rest, CONTACT)) != 0.0


@kernel
def begin(errors, residual) -> None:
    """What is felt now is what is felt where nothing is touched, as far as is known."""
    own = errors[0]
    for i in range(residual.size):
        own.felt[i, 0], own.felt[i, 1:] = residual[i], own.causes[i]
    own.rest[:] = own.felt


@kernel
def touched(errors, residual, doubt, by_deflection) -> bool:
    """Some joint feels more than causes and the rest may be wrong by, or such a change.

    What is known little may be large, but changes no more than its causes: that shows a hand.
    """
    own, found, change = errors[0], False, np.empty(1 + CAUSES)
    for i in range(residual.size):
        own.felt[i, 0] += SMOOTH * (residual[i] - own.felt[i, 0])
        for k in range(CAUSES):
            own.felt[i, 1 + k] += SMOOTH * (own.causes[i, k] - own.felt[i, 1 + k])
        if by_deflection[i] and not found:
            rest = noise(own, doubt[i], own.causes[i, 0])
            for k in range(1 + CAUSES):
                change[k] = own.felt[i, k] - own.rest[i, k]
            found = _feels(own, i, own.felt[i], rest) or _feels(own, i, change, rest)
    if not found:
        own.rest += FOLLOW * (own.felt - own.rest)
    return found


@kernel
def learn(errors, residual, doubt, by_deflection) -> None:
    """Take one joint's torque of this tick, and learn from the one of `WAIT` ticks ago."""
    own = errors[0]
    n, at = residual.size, own.at
    full = own.count == WAIT
    if full:
        _learn(own, own.joint[at], own.waiting[at], n)
    i = (own.joint[at - 1] + 1) % n
    own.joint[at], own.at, own.count = i, (at + 1) % WAIT, min(own.count + 1, WAIT)
    waiting = own.waiting[at]
    waiting[0], waiting[1], waiting[2:] = residual[i], noise(own, doubt[i], own.causes[i, 0]), own.causes[i]
    if not by_deflection[i]:
        waiting[2:] = 0.0  # it tells nothing


@kernel
def forget(errors) -> None:
    """Something is touched: what was felt lately is not learned from."""
    errors[0].count = 0


@kernel
def _learn(own, i, felt, n) -> None:
    """A Kalman filter's step of joint i on torque = sum of causes times shares: one tick in n."""
    P, size, causes = own.covariance, own.known.size, felt[2:]
    gains = np.zeros(size)
    for k in range(CAUSES):
        for at in range(size):
            gains[at] += P[at, _place(i, k)] * causes[k]
    spread, left = felt[1] * CORRELATED / n, felt[0]
    for k in range(CAUSES):
        spread += causes[k] * gains[_place(i, k)]
        left -= own.known[_place(i, k)] * causes[k]
    for a in range(size):
        own.known[a] += gains[a] * left / spread
        for b in range(a + 1):
            P[a, b] -= gains[a] * gains[b] / spread
            P[b, a] = P[a, b]
    gear = ZERO + OWN * i
    own.known[gear] = min(max(own.known[gear], own.softest), own.stiffest)
