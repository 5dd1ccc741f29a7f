"""Learned errors of the joints' external torques: by gears, output encoders, zero of the flange sensor.

Three kinds of constants of an arm make torques without a contact. Each has its own shape. The error
of a gear's stiffness makes a share of the gear's load. The ripple of an output encoder enters by
the deflection; it follows the first and the second harmonic of the angle (a disc off its centre,
and one that is not round). The zero of the flange sensor, fixed in the flange, makes torques by the
levers of the posture. So the torques without a contact are a linear function of known causes with
constant shares. A share that is known badly gives an uncertainty, which grows as its cause changes.
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
"""Number of constants of all joints together (zero of the flange sensor), and of each joint (gear, then encoder)."""
CAUSES = OWN + ZERO
"""Causes of a joint's torque: load of its gear, levers of the sensor's zero, cosine and sine of the
angle and of twice the angle."""
STIFFNESS_WALK = 2e-3  # of the stiffness error [1/sqrt(s)]
RIPPLE_WALK = 0.01  # of each harmonic, relative to the ripple's torque [1/sqrt(s)]
FORCE_WALK, TORQUE_WALK = 0.1, 0.04
"""Walk of the flange sensor's zero [N/sqrt(s)], [N·m/sqrt(s)]. It is enough to follow a faulty
sensor that drifts by 0.02 N and 0.02 N·m a second (bench `false_contacts`); a sensor that warms up
drifts by 0.013 N and 0.001 N·m (assets/robots/)."""
CORRELATED = 100.0  # ticks over which errors of the torques are correlated
CARRIED = 0.15
"""Error of the gears' load by a wrong payload, relative to that load. It is used only without the
flange sensor. The payload may be wrong by a fifth, and makes most of the load."""
SMOOTH = 0.02
"""Smoothing factor per tick (0.1 s) of the torque that shows a contact; an arm's swing on its gears
averages out over that time."""
FOLLOW = 0.0066
"""Smoothing factor per tick (0.3 s) of the torque without a contact; the watch on links has the same."""
WAIT = 60
"""Ticks until a torque is learned from: by then a hand that comes is noticed, and not learned."""
SURE = 3.0  # standard deviations that a learned constant may be wrong by


class TorqueErrors:
    """Constants of n joints and of the flange sensor, by a Kalman filter over all of them.

    Attributes:
        causes: causes of each joint's torque in this tick (n, CAUSES) [N·m], [m], [1], [1].
        shares: learned constants, one for each cause (n, CAUSES) [1], [N], [N·m], [N·m].
        misfit: possible error of each share (n, CAUSES).

    Args:
        arm: the arm's numbers.
    """

    def __init__(self, arm: Arm) -> None:
        n = arm.n
        size = ZERO + OWN * n
        self.record = record(
            motor_constant=(),  # its largest relative error
            link_mass=(),  # the same
            softest=(),  # least relative error of the springs' stiffness
            stiffest=(),  # largest
            causes=(n, CAUSES),
            shares=(n, CAUSES),
            misfit=(n, CAUSES),
            known=(size,),  # the constants
            covariance=(size, size),
            most=(size,),  # largest size of each
            walk=(size,),  # variance that a tick adds
            felt=(n, 1 + CAUSES),  # torque and causes, smoothed
            rest=(n, 1 + CAUSES),  # the same, as they were without a contact
            waiting=(WAIT, 2 + CAUSES),  # torque, variance, causes of a joint a tick, to be learned
            joint=f"{WAIT}i8",  # the joint of each of these
            at="i8",  # place of the next one
            count="i8",  # number of these
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
        """The flange sensor has another zero from now on."""
        own = self._own
        own["known"][:ZERO] = 0.0
        own["covariance"][:ZERO] = own["covariance"][:, :ZERO] = 0.0
        own["covariance"][np.arange(ZERO), np.arange(ZERO)] = own["most"][:ZERO] ** 2 / 3.0


@kernel
def look(errors, rigid, bears, state) -> None:
    """Compute the causes of this tick, and their shares as known.

    Args:
        errors: `TorqueErrors.record`.
        rigid: row of the rigid model's recursion.
        bears: torques through the gears and residuals (n,) [N·m].
        state: output angles (n,) [rad], joints whose torque comes from the deflection (n,), and
            whether the sensor is used.
    """
    own = errors[0]
    borne, residual = bears
    q, by_deflection, with_sensor = state
    R, jacobian = rigid.R, rigid.jacobian
    # The uncertainty of each constant grows in every tick, at most to its first value. Otherwise an
    # error that looks like a contact would stay for ever, because nothing is learned in a contact.
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
            # This sum is the load without the contact, as the model has it: a push adds no error.
            causes[0] = borne[i] + residual[i]
            shares[0], misfit[0] = 0.0, own.motor_constant
        misfit[0] += own.link_mass + (0.0 if with_sensor else CARRIED)


@kernel
def _place(i, k):
    """Place of the constant of cause k of joint i among all."""
    if k == 0:
        return ZERO + OWN * i
    return k - 1 if k <= ZERO else ZERO + OWN * i + k - ZERO


@kernel
def noise(own, doubt, borne):
    """Variance of a joint's torque by errors of links' masses, in proportion to the load, and by the rest [N²·m²]."""
    masses = own.link_mass * borne
    return doubt * doubt + masses * masses


@kernel
def left_over(shares, torque, causes):
    """A joint's torque, minus the torques of its causes [N·m]."""
    for k in range(CAUSES):
        torque -= shares[k] * causes[k]
    return torque


@kernel
def variance(own, i, causes):
    """Variance of joint i's torque by these causes, as their shares are uncertain [N²·m²].

    The covariance is symmetric, so half of it is read: joint's own causes, the zero's, and both.
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
    """The part of joint i's torque beyond its possible error [N·m]; 0 if the error may be all of it.

    `what`: the torque minus its causes' torques, and the causes; or the change of both. `doubt`:
    variance of the rest [N²·m²], and the number of deviations that count as an error. If this
    variance explains the torque, that of the causes is not computed.
    """
    (left, causes), (rest, deviations) = what, doubt
    if left * left <= deviations**2 * rest:
        return 0.0
    size = abs(left) - deviations * np.sqrt(variance(own, i, causes) + rest)
    return np.copysign(size, left) if size > 0.0 else 0.0


@kernel
def _feels(own, i, felt, rest) -> bool:
    """Whether a torque of joint i, or its change, is beyond the possible error; `felt`: torque, causes."""
    causes = felt[1:]
    return beyond(own, i, (left_over(own.shares[i], felt[0], causes), causes), (rest, CONTACT)) != 0.0


@kernel
def begin(errors, residual) -> None:
    """Take the torques of now as those without a contact, because nothing better is known."""
    own = errors[0]
    for i in range(residual.size):
        own.felt[i, 0], own.felt[i, 1:] = residual[i], own.causes[i]
    own.rest[:] = own.felt


@kernel
def touched(errors, residual, doubt, by_deflection) -> bool:
    """True if, at some joint, the torque or its change is beyond the possible error.

    A badly known share can make a large error, but that changes only with its cause. Another change
    shows a hand.
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
        waiting[2:] = 0.0  # nothing is learned from it


@kernel
def forget(errors) -> None:
    """Something is touched: nothing is learned from the last torques."""
    errors[0].count = 0


@kernel
def _learn(own, i, felt, n) -> None:
    """A Kalman filter step for joint i, in one tick of n: torque = sum of causes times shares."""
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
