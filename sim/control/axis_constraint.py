"""Locked axes of free-drive: a stiff, damped constraint that holds the tool in them and leaves the other axes alone (FD-4).

What is locked is a function c(q) of the pose that is to stay 0: a way along an axis, a tilt of the only free axis, a turn about
an axis. With its Jacobian G and the mobility A = G W G' of the rotors, W = diag(1 / inertia), the constraint force is
A^-1 (w² c + 2 z w c'): in every posture the stiffness that holding still has, with the same margins. A little is added to A:
where the arm can hardly move along an axis, near a singularity, the force ends instead of growing without bound.

What else the law asks of the motors is projected, so that it moves the rotors along no locked axis.
"""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.limits.axis_locks import AxisLocks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.control.feedback import BANDWIDTH, DAMPING_RATIO
from sim.control.pose_constraint import constraint
from sim.rigid_body.cholesky import factor, solve
from sim.sensing.calibration import Calibration

Array = NDArray[np.float64]

HEAVIEST = 50.0
"""Inertia of the rotors beyond which an axis is held no stiffer [kg]; turns as ways."""

FURTHEST = 0.02
"""A tool forced further along a locked axis takes the lock along [m]; turns as ways."""

MOST = 0.5
"""Torque of the constraint at most, of the rated one."""


class AxisConstraint:
    """Holds locked axes, from the moment they are locked.

    The spring gives back no more energy than was put into it: its stiffness changes with the posture, and what the change would
    add is taken out by letting it return more weakly.

    Args:
        arm: the arm's numbers.
        calibration: error of the constants that the controller uses.
        tcp: tool centre point in F (3,) [m].
        R_FT: its orientation in F (3, 3).
    """

    def __init__(self, arm: Arm, calibration: Calibration, tcp: Array, R_FT: Array) -> None:
        spring = arm.transmissions
        stiffness = (np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * calibration.stiffness
        rotor = np.array(arm.motors.rotor_inertia) * calibration.rotor_inertia
        self._constants = np.stack([1.0 / stiffness, rotor, MOST * np.array(arm.limits.torque)])
        self._tcp, self._R_FT = tcp, R_FT
        self._locks: AxisLocks | None = None
        self._locked = np.zeros(6, dtype=np.bool_)
        self._frame, self._turn = np.eye(3), np.eye(3)  # axes and orientation of the tool at the beginning, in B
        self._place, self._bent = np.zeros(3), np.zeros(arm.n)  # of the tool [m]; motors ahead of the joints, unexplained [rad]
        self._slipped = np.zeros(6)  # the lock has been taken along so far [m]
        self._m = 0  # locked axes
        self._rows = np.zeros((6, arm.n))  # the constraint's Jacobian
        self._state = np.zeros((8, 6))  # of the constraint: its values, their speeds, the factor of the mobility
        self._energy = np.zeros(1)  # in the spring [J]

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
        pose = (estimate.p_BF, estimate.R_BF, self._tcp)
        since = (self._frame, self._turn, self._place, self._bent, self._slipped)
        motion = (estimate.theta, estimate.theta_d, estimate.q)
        self._m = _prepare(self._locked, pose, since, motion, jacobian, static, self._constants, self._rows, self._state)

    def project(self, asked: Array, gain: float, torque: Array) -> None:
        """Take from what the hand asks of the joints (n,) [N·m] what would move the rotors along locked axes, in place.

        Args:
            asked: changed in place.
            gain: with which it has been added to `torque`.
            torque: (n,) [N·m] changed in place.
        """
        _project(self._m, self._rows, self._state, self._constants, asked, gain, torque)

    def hold(self, torque: Array) -> None:
        """Add the constraint to `torque` (n,) [N·m]."""
        _hold(self._m, self._rows, self._state, self._constants, self._energy, torque)

    def _begin(self, estimate: Estimate, locks: AxisLocks, static: Array) -> None:
        self._locks = locks
        self._locked[:] = locks.locked
        R = estimate.R_BF
        self._frame[:] = R @ self._R_FT if locks.tool else np.reshape(locks.R_BU, (3, 3))
        self._turn[:] = R
        self._place[:] = estimate.p_BF + R @ self._tcp
        self._bent[:] = estimate.theta - estimate.q - self._constants[0] * static
        self._slipped[:] = 0.0
        self._energy[0] = 0.0


@numba.njit(cache=True)
def _prepare(locked, pose, since, motion, jacobian, static, constants, G, state) -> int:
    bent, slipped = since[3], since[4]
    theta, theta_d, q = motion
    n = q.size
    values, speed, mobility = state[0], state[1], state[2:]
    m = constraint(locked, pose, since, jacobian, G, values)
    for r in range(m):
        speed[r] = 0.0
        for i in range(n):
            # By the motors' angles, less what the load bends the joints: only what the motors do can be damped.
            values[r] += G[r, i] * (theta[i] - q[i] - constants[0, i] * static[i] - bent[i])
            speed[r] += G[r, i] * theta_d[i]
        beyond = values[r] - slipped[r]
        if abs(beyond) > FURTHEST:
            slipped[r] = values[r] - math.copysign(FURTHEST, beyond)
        values[r] -= slipped[r]
        for s in range(r + 1):
            mobility[r, s] = 1.0 / HEAVIEST if r == s else 0.0
            for i in range(n):
                mobility[r, s] += G[r, i] * G[s, i] / constants[1, i]
    factor(mobility, m)
    return m


@numba.njit(cache=True)
def _project(m, G, state, constants, asked, gain, torque) -> None:
    force = np.zeros(6)
    for r in range(m):
        for i in range(asked.size):
            force[r] += G[r, i] * asked[i] / constants[1, i]
    solve(state[2:], force, m)
    for i in range(asked.size):
        for r in range(m):
            asked[i] -= G[r, i] * force[r]
            torque[i] -= gain * G[r, i] * force[r]


@numba.njit(cache=True)
def _hold(m, G, state, constants, energy, torque) -> None:
    spring, damper = np.zeros(6), np.zeros(6)
    for r in range(m):
        spring[r] = (2.0 * math.pi * BANDWIDTH) ** 2 * state[0, r]
        damper[r] = 4.0 * math.pi * BANDWIDTH * DAMPING_RATIO * state[1, r]
    solve(state[2:], spring, m)
    solve(state[2:], damper, m)
    share = _returned(spring, state[0], state[1], m, energy)
    scale = 1.0
    force = np.zeros(torque.size)
    for i in range(torque.size):
        for r in range(m):
            force[i] += G[r, i] * (share * spring[r] + damper[r])
        if abs(force[i]) > constants[2, i]:
            scale = min(scale, constants[2, i] / abs(force[i]))
    for i in range(torque.size):
        torque[i] -= scale * force[i]


@numba.njit(cache=True)
def _returned(spring, values, speed, m, energy) -> float:
    """Share of the spring's force, so that it never gives back more than was put into it."""
    power, stored = 0.0, 0.0
    for r in range(m):
        power += spring[r] * speed[r]
        stored += 0.5 * spring[r] * values[r]
    share = 1.0
    if power < 0.0:
        share = min(energy[0] / (-power * TICK), 1.0)
    energy[0] = min(max(energy[0] + share * power * TICK, 0.0), stored)
    return share
