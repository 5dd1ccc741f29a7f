"""Locked axes and joints of free-drive: a stiff, damped constraint that holds them and leaves all others alone (FD-4).

What is locked is a function c(q) that is to stay 0: of the pose a way along an axis, a tilt of the only free axis, a turn about
an axis; of the joints the turn of one since it was locked. With its Jacobian G and the mobility A = G W G' of the rotors, W =
diag(1 / inertia), the constraint force is A^-1 (w² c + 2 z w c'): in every posture the stiffness that holding still has, with the
same margins. A little is added to A: where the arm can hardly move along an axis, near a singularity, the force ends instead of
growing without bound.

What else the law asks of the motors is projected, so that it moves the rotors along no locked axis.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.limits.axis_locks import AxisLocks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.control.feedback import BANDWIDTH, DAMPING_RATIO
from sim.control.pose_constraint import constraint
from sim.rigid_body.cholesky import factor, solve

Array = NDArray[np.float64]

HEAVIEST = 50.0
"""Inertia of the rotors beyond which an axis is held no stiffer [kg]; turns as ways."""

FURTHEST = 0.02
"""A tool forced further along a locked axis takes the lock along [m]; turns as ways. A joint that is locked does so at as many
radians, where holding it takes about `MOST`: its spring has the rotor's inertia times w²."""

MOST = 0.5
"""Torque of the constraint at most, of the rated one."""


class Bending(NamedTuple):
    """Where joints and motors are, and what bends the springs between them, n joints."""

    theta: Array  # motor angle (n,) [rad]
    theta_d: Array  # motor speed (n,) [rad/s]
    q: Array  # output angle (n,) [rad]
    static: Array  # torque (n,) [N·m]


class AxisConstraint:
    """Holds locked axes, from the moment they are locked.

    The spring gives back no more energy than was put into it: its stiffness changes with the posture, and what the change would
    add is taken out by letting it return more weakly.

    Args:
        arm: the arm's numbers.
        constants: those that the controller uses.
        tcp: tool centre point in F (3,) [m].
        R_FT: its orientation in F (3, 3).
    """

    def __init__(self, arm: Arm, constants: JointConstants, tcp: Array, R_FT: Array) -> None:
        spring = arm.transmissions
        stiffness = (np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * constants.stiffness
        rotor = np.array(arm.motors.rotor_inertia) * constants.rotor_inertia
        n = arm.n
        self._record = record(
            compliance=(n,),
            rotor=(n,),
            most=(n,),  # torque
            locked="6i8",
            joints=(n,),  # not 0 for one that is locked
            start=(n,),  # angles of the joints when they were locked [rad]
            frame=(3, 3),  # axes of the tool at the beginning, in B
            turn=(3, 3),  # its orientation then
            place=(3,),  # and place [m]
            bent=(n,),  # motors ahead of the joints, unexplained [rad]
            slipped=(6 + n,),  # the lock has been taken along so far [m]
            m="i8",  # locked axes and joints
            rows=(6 + n, n),  # the constraint's Jacobian
            values=(6 + n,),
            speed=(6 + n,),  # of the values
            mobility=(6 + n, 6 + n),  # its factor
            energy=(),  # in the spring [J]
        )
        own = self._own = self._record[0]
        own["compliance"], own["rotor"], own["most"] = 1.0 / stiffness, rotor, MOST * np.array(arm.limits.torque)
        self._tcp, self._R_FT = tcp, R_FT
        self._locks: AxisLocks | None = None

    def release(self) -> None:
        """Nothing is locked; what is locked next starts again."""
        self._locks = None

    def prepare(self, estimate: Estimate, locks: AxisLocks, jacobian: Array, static: Array) -> None:
        """Begin a tick.

        Args:
            estimate: this tick's.
            locks: what is locked.
            jacobian: of the flange (6, n), linear first, axes of B.
            static: torque (n,) [N·m] by which the joints' springs are bent: gravity, walls, ends of ranges.
        """
        if locks != self._locks:
            self._begin(estimate, locks, static)
        pose = (estimate.p_BF, estimate.R_BF, self._tcp, jacobian)
        _prepare(self._record, pose, (estimate.theta, estimate.theta_d, estimate.q, static))

    def project(self, asked: Array, gain: float, torque: Array) -> None:
        """Take from what the hand asks of the joints (n,) [N·m] what would move the rotors along locked axes, in place.

        Args:
            asked: changed in place.
            gain: with which it has been added to `torque`.
            torque: (n,) [N·m] changed in place.
        """
        _project(self._record, asked, gain, torque)

    def hold(self, torque: Array) -> None:
        """Add the constraint to `torque` (n,) [N·m]."""
        _hold(self._record, torque)

    def _begin(self, estimate: Estimate, locks: AxisLocks, static: Array) -> None:
        self._locks = locks
        own, R = self._own, estimate.R_BF
        own["locked"] = locks.locked
        own["joints"] = locks.joints[: estimate.q.size] or 0.0
        own["start"] = estimate.q
        own["frame"] = R @ self._R_FT if locks.tool else np.reshape(locks.R_BU, (3, 3))
        own["turn"] = R
        own["place"] = estimate.p_BF + R @ self._tcp
        own["bent"] = estimate.theta - estimate.q - own["compliance"] * static
        own["slipped"], own["energy"] = 0.0, 0.0


@kernel
def _prepare(held, pose, bending) -> None:
    bending = Bending(*bending)
    own = held[0]
    theta, theta_d, q, static = bending
    G, bent, slipped, compliance, rotor = own.rows, own.bent, own.slipped, own.compliance, own.rotor
    n = q.size
    values, speed, mobility = own.values, own.speed, own.mobility
    own.m = constraint(own, pose)
    for i in range(n):
        if own.joints[i] != 0.0:
            G[own.m, :] = 0.0
            G[own.m, i] = 1.0
            values[own.m] = q[i] - own.start[i]
            own.m += 1
    m = own.m
    for r in range(m):
        speed[r] = 0.0
        for i in range(n):
            # By the motors' angles, less what the load bends the joints: only what the motors do can be damped.
            values[r] += G[r, i] * (theta[i] - q[i] - compliance[i] * static[i] - bent[i])
            speed[r] += G[r, i] * theta_d[i]
        beyond = values[r] - slipped[r]
        if abs(beyond) > FURTHEST:
            slipped[r] = values[r] - math.copysign(FURTHEST, beyond)
        values[r] -= slipped[r]
        for s in range(r + 1):
            mobility[r, s] = 1.0 / HEAVIEST if r == s else 0.0
            for i in range(n):
                mobility[r, s] += G[r, i] * G[s, i] / rotor[i]
    factor(mobility, m)


@kernel
def _project(held, asked, gain, torque) -> None:
    own = held[0]
    m, G, rotor = own.m, own.rows, own.rotor
    force = np.zeros(own.values.size)
    for r in range(m):
        for i in range(asked.size):
            force[r] += G[r, i] * asked[i] / rotor[i]
    solve(own.mobility, force, m)
    for i in range(asked.size):
        for r in range(m):
            asked[i] -= G[r, i] * force[r]
            torque[i] -= gain * G[r, i] * force[r]


@kernel
def _hold(held, torque) -> None:
    own = held[0]
    m, G, most = own.m, own.rows, own.most
    spring, damper = np.zeros(own.values.size), np.zeros(own.values.size)
    for r in range(m):
        spring[r] = (2.0 * math.pi * BANDWIDTH) ** 2 * own.values[r]
        damper[r] = 4.0 * math.pi * BANDWIDTH * DAMPING_RATIO * own.speed[r]
    solve(own.mobility, spring, m)
    solve(own.mobility, damper, m)
    share = _returned(own, spring)
    scale = 1.0
    force = np.zeros(torque.size)
    for i in range(torque.size):
        for r in range(m):
            force[i] += G[r, i] * (share * spring[r] + damper[r])
        if abs(force[i]) > most[i]:
            scale = min(scale, most[i] / abs(force[i]))
    for i in range(torque.size):
        torque[i] -= scale * force[i]


@kernel
def _returned(own, spring) -> float:
    """Share of the spring's force, so that it never gives back more than was put into it."""
    power, stored = 0.0, 0.0
    for r in range(own.m):
        power += spring[r] * own.speed[r]
        stored += 0.5 * spring[r] * own.values[r]
    share = 1.0
    if power < 0.0:
        share = min(own.energy / (-power * TICK), 1.0)
    own.energy = min(max(own.energy + share * power * TICK, 0.0), stored)
    return share
