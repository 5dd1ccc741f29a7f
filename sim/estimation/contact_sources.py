"""Force and acceleration for the contact detectors: from the sensors at the flange, and from the joints (CD-2)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.contact.settings import ContactUse
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.source_signal import ContactSignals, Signal
from sim.arm.chain import Body
from sim.arm.frames import skew
from sim.rigid_body.cholesky import factor, solve
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.sensors import Sample

Array = NDArray[np.float64]

TURN_BANDWIDTH = 150.0
"""Of the angular acceleration that moves a measured acceleration to the load's centre [Hz]: it is there a tick after the
force at the most, its noise at a load's usual distance within that of the accelerometer."""
MASS_TICKS = 50
"""Ticks between two looks at the effective mass, which changes with the posture only."""
LEAST_MASS = 0.3  # of the arm behind the sensor [kg]
SINGULAR = 0.2
"""Damping of the least-squares force on a link [m]: levers shorter than this say little about a force."""


class ContactSources:
    """Makes the signals of every contact part that is watched: tool, then elbow and forearm.

    Args:
        dynamics: the controller's model, already updated to this tick's posture when `read` is called.
        elbow: index of the joint that the elbow is.
        reach: force at which the flange sensor saturates [N].
    """

    def __init__(self, dynamics: Dynamics, elbow: int, reach: float) -> None:
        self._dynamics, self._range, self._reach = dynamics, reach, reach
        self._smoothing = 1.0 - math.exp(-2.0 * math.pi * TURN_BANDWIDTH * TICK)
        self._turns = np.zeros((3, 3))  # a tick ago: angular speed; its change; what the turning added to the acceleration
        self._turns[0] = np.nan  # not known yet
        self._out = np.zeros((4, len(Signal._fields)))  # a signal a row
        self._links = np.array([elbow, elbow + 1])  # joints whose origins are elbow and end of the forearm
        n = dynamics.recursion.origins.shape[0]
        self._before, self._started = np.zeros((2, 3, n)), False  # Jacobians of the two points, a tick ago
        self._out[:, 10] = 1.4  # until the arm has been weighed
        self.set_load(dynamics.load)

    def set_load(self, load: Body) -> None:
        """Take `load` (in F) as everything beyond the flange."""
        self._load, self._com = load, np.array(load.com)
        self._out[:2, 9], self._out[:2, 12] = load.mass, np.linalg.norm(load.com)

    def set_zero(self, zero: Array) -> None:
        """So much (6,) is subtracted from the sensor's values, in F [N, N·m]: it may saturate at a force that seems less."""
        self._reach = self._range - float(np.abs(zero[:3]).max())

    def read(self, sample: Sample, estimate: Estimate, jacobian: Array, use: ContactUse) -> None:
        """Put this tick's signals into `estimate`.

        Args:
            sample: this tick's measurements.
            estimate: this tick's estimate.
            jacobian: of the flange (6, n), axes of B.
            use: which sources are on; the others give None.
        """
        if estimate.tick % MASS_TICKS == 1:
            lightest = _effective_mass(self._dynamics.mass(estimate.q), estimate.R_BF, jacobian, self._load)
            self._out[:, 10] = max(LEAST_MASS, lightest)
        pair = sample.wrench_valid and sample.acceleration_valid
        links = use.links and sample.joints_valid
        rigid, out = self._dynamics.recursion, self._out
        flange = pair and use.flange
        _read(
            pair, flange, links, sample.values, self._smoothing, self._com, estimate.R_BF, estimate.g_B, self._reach, self._turns,
            rigid.origins, rigid.jacobian, self._links, self._before, self._started, estimate.tau_ext, estimate.qd, estimate.qdd,
            out,
        )  # fmt: skip
        self._started = links
        estimate.signals = ContactSignals(out.copy(), (pair, flange, links, links))


def _effective_mass(mass: Array, R: Array, jacobian: Array, load: Body) -> float:
    """Smallest effective mass of the arm at the flange, its rotors decoupled, without what it carries [kg].

    Not compiled: it is asked for rarely, and a compiled solver of systems costs a fresh installation half a minute.
    """
    linear, angular = jacobian[:3], jacobian[3:]
    at_load = linear - skew(R @ load.com) @ angular
    carried = load.mass * (at_load.T @ at_load) + angular.T @ (R @ load.inertia @ R.T) @ angular
    mobility = linear @ np.linalg.solve(mass - carried, linear.T)
    return 1.0 / float(np.linalg.eigvalsh(mobility)[-1])


@numba.njit(cache=True)
def _read(tool, arm_side, links, values, smoothing, com, R, gravity, reach, turns, origins, flange, points, before, started,
          tau_ext, qd, qdd, out) -> None:  # fmt: skip
    """All sources that are on, into the rows of `out`. One kernel: each array that is handed over costs as much as its work."""
    rest = values[3 * qd.size :]
    wrench = rest[:6]
    if tool:
        moved = _to_load(rest[9:12], rest[15:18], turns[0], turns[1], smoothing, com)
        _transfer(wrench, rest[12:15], moved, turns[2], R, gravity, reach, out[0])
        if arm_side:
            _transfer(wrench, rest[6:9], moved, turns[2], R, gravity, reach, out[1])
        turns[2] = moved
    else:
        turns[0] = np.nan
    if links:
        _derive(origins, flange, points, before, started, tau_ext, qd, qdd, gravity, out[2:])


@numba.njit(cache=True)
def _to_load(arm_side, tool_side, before, change, smoothing, com):
    """Acceleration (3,) of the load's centre against the flange [m/s²]; `before` and `change` are kept from tick to tick.

    Both gyros feel the same turning, for the flange sensor gives way along its axes and does not turn: their mean has so little
    noise that its difference needs little smoothing. With more, the load's turning came so much later than its force that an
    arm which vibrates at 60 Hz laid the two against each other like a contact.
    """
    turn, moved = np.empty(3), np.empty(3)
    for k in range(3):
        turn[k] = 0.5 * (arm_side[k] + tool_side[k])
        if np.isnan(before[k]):
            change[k] = 0.0
        else:
            change[k] += smoothing * ((turn[k] - before[k]) / TICK - change[k])
        before[k] = turn[k]
    # w x (w x c) = w (w·c) - c w²
    along = turn[0] * com[0] + turn[1] * com[1] + turn[2] * com[2]
    square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        moved[k] = change[i] * com[j] - change[j] * com[i] + turn[k] * along - com[k] * square
    return moved


@numba.njit(cache=True)
def _transfer(wrench, acceleration, moved, before, R, gravity, reach, out) -> None:
    """Force, specific force at the load's centre, gravity, and the change since `before` of what is `moved`, each (3,) in F."""
    for k in range(3):
        out[k] = wrench[k]
        out[3 + k] = acceleration[k] + moved[k]
        out[6 + k] = R[0, k] * gravity[0] + R[1, k] * gravity[1] + R[2, k] * gravity[2]
        out[13 + k] = moved[k] - before[k]
    out[11] = 1.0 if max(abs(wrench[0]), abs(wrench[1]), abs(wrench[2])) >= reach else 0.0


@numba.njit(cache=True)
def _derive(origins, flange, links, all_before, started, tau_ext, qd, qdd, gravity, all_out) -> None:
    """Force of each link on the outside, specific force at its point, and gravity, each (3,) in B, into the rows of `all_out`.

    The force is the smallest one that explains the external torques of the joints that can move the point: with
    J^T F = tau, F = (J J^T + d²)^-1 J tau.
    """
    n = qd.size
    jacobian = np.empty((3, n))
    square = np.empty((3, 3))
    right = np.empty(3)
    for which in range(links.size):
        joint, before, out = links[which], all_before[which], all_out[which]
        for i in range(n):
            for k in range(3):
                a, b = (k + 1) % 3, (k + 2) % 3
                jacobian[k, i] = 0.0
                if i < joint:
                    jacobian[k, i] = flange[3 + a, i] * (origins[joint, b] - origins[i, b])
                    jacobian[k, i] -= flange[3 + b, i] * (origins[joint, a] - origins[i, a])
                if not started:
                    before[k, i] = jacobian[k, i]
        for r in range(3):
            acceleration, push = 0.0, 0.0
            for i in range(n):
                acceleration += jacobian[r, i] * qdd[i] + (jacobian[r, i] - before[r, i]) / TICK * qd[i]
                push += jacobian[r, i] * tau_ext[i]
                before[r, i] = jacobian[r, i]
            for c in range(3):
                total = SINGULAR * SINGULAR if r == c else 0.0
                for i in range(n):
                    total += jacobian[r, i] * jacobian[c, i]
                square[r, c] = total
            out[3 + r] = acceleration - gravity[r]
            out[6 + r] = gravity[r]
            right[r] = -push
        factor(square, 3)
        solve(square, right, 3)
        for k in range(3):
            out[k] = right[k]
