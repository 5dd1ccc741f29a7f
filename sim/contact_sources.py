"""Force and acceleration for the contact detectors: from the sensors at the flange, and from the joints (CD-2)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.estimate import Estimate
from pendant.modes import TICK
from pendant.settings import ContactUse
from pendant.signal import Signal
from sim.chain import Body
from sim.dynamics import Dynamics
from sim.sensors import Sample

Array = NDArray[np.float64]

TURN_BANDWIDTH = 60.0
"""Of the angular acceleration that moves a measured acceleration to the load's centre [Hz]: its delay is half a tick more than
the force's, its noise that of the accelerometer."""
MASS_TICKS = 50
"""Ticks between two looks at the effective mass, which changes with the posture only."""
LEAST_MASS = 0.3  # of the arm behind the sensor [kg]
SINGULAR = 0.2
"""Damping of the least-squares force on a link [m]: levers shorter than this say little about a force."""


class ContactSources:
    """Makes the signals of every contact part that is watched: tool, then elbow and forearm.

    Args:
        dynamics: the controller's model, already updated to this tick's posture when `read` is called.
        tcp: tool centre point in F (3,) [m].
        elbow: index of the joint that the elbow is.
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, elbow: int) -> None:
        self._dynamics, self._tcp = dynamics, tcp
        self._smoothing = 1.0 - math.exp(-2.0 * math.pi * TURN_BANDWIDTH * TICK)
        self._turns = np.zeros((2, 2, 3))  # tool side, arm side: last gyro value, smoothed angular acceleration
        self._out = np.zeros((3, 3))
        self._point = np.zeros(3)
        self._links = (elbow, elbow + 1)  # joints whose origins are elbow and end of the forearm
        n = dynamics.recursion.origins.shape[0]
        self._before, self._started = np.zeros((2, 3, n)), False  # Jacobians of the two points, a tick ago
        self._effective = 1.4
        self.set_load(dynamics.load)

    def set_load(self, load: Body) -> None:
        """Take `load` (in F) as everything beyond the flange."""
        self._mass, self._com, self._inertia = load.mass, np.array(load.com), load.inertia

    def read(self, sample: Sample, estimate: Estimate, jacobian: Array, use: ContactUse) -> None:
        """Put this tick's signals and the tool centre point into `estimate`.

        Args:
            sample: this tick's measurements.
            estimate: this tick's estimate.
            jacobian: of the flange (6, n), axes of B.
            use: which sources are on; the others give None.
        """
        if estimate.tick % MASS_TICKS == 1:
            self._weigh(estimate, jacobian)
        pair = sample.wrench_valid and sample.acceleration_valid
        tool = self._pair(sample.wrench, sample.acceleration_tool, sample.gyro_tool, 0, estimate) if pair else None
        flange = None
        if pair and use.flange:
            flange = self._pair(sample.wrench, sample.acceleration_flange, sample.gyro_flange, 1, estimate)
        elbow = forearm = None
        if use.links and sample.joints_valid:
            elbow, forearm = self._link(0, estimate), self._link(1, estimate)
        self._started = elbow is not None
        estimate.signals = (tool, flange, elbow, forearm)
        _place(estimate.p_BF, estimate.R_BF, self._tcp, self._point)
        x, y, z = self._point.tolist()
        estimate.p_BT = (x, y, z)

    def _pair(self, wrench: Array, acceleration: Array, gyro: Array, side: int, estimate: Estimate) -> Signal:
        """Force at the flange and specific force at the load's centre, in F."""
        out = self._out
        _transfer(wrench, acceleration, gyro, self._turns[side], self._smoothing, self._com, estimate.R_BF, estimate.g_B, out)
        (fx, fy, fz), (ax, ay, az), (gx, gy, gz) = out.tolist()
        return Signal(fx, fy, fz, ax, ay, az, gx, gy, gz, self._mass, self._effective)

    def _link(self, which: int, estimate: Estimate) -> Signal:
        """Force at a link's point from the external torques, and its acceleration from the model, in B."""
        rigid = self._dynamics.recursion
        geometry = (rigid.origins, rigid.jacobian, self._links[which], self._before[which], self._started)
        _derive(geometry, estimate.tau_ext, estimate.qd, estimate.qdd, estimate.g_B, self._out)
        (fx, fy, fz), (ax, ay, az), (gx, gy, gz) = self._out.tolist()
        return Signal(fx, fy, fz, ax, ay, az, gx, gy, gz, 0.0, self._effective)

    def _weigh(self, estimate: Estimate, jacobian: Array) -> None:
        """Smallest effective mass of the arm at the flange, its rotors decoupled, without what it carries."""
        R, linear, angular = estimate.R_BF, jacobian[:3], jacobian[3:]
        at_load = linear + np.cross(angular.T, R @ self._com).T
        load = self._mass * at_load.T @ at_load + angular.T @ R @ self._inertia @ R.T @ angular
        mobility = linear @ np.linalg.solve(self._dynamics.mass(estimate.q) - load, linear.T)
        self._effective = max(LEAST_MASS, 1.0 / float(np.linalg.eigvalsh(mobility)[-1]))


@numba.njit(cache=True)
def _transfer(wrench, acceleration, gyro, turns, smoothing, com, R, gravity, out) -> None:
    """Force, specific force at the load's centre, and gravity, each (3,) in F, into `out` (3, 3)."""
    for k in range(3):
        turns[1, k] += smoothing * ((gyro[k] - turns[0, k]) / TICK - turns[1, k])
        turns[0, k] = gyro[k]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        tangential = turns[1, i] * com[j] - turns[1, j] * com[i]
        # w x (w x c) = w (w·c) - c w²
        along = gyro[0] * com[0] + gyro[1] * com[1] + gyro[2] * com[2]
        square = gyro[0] * gyro[0] + gyro[1] * gyro[1] + gyro[2] * gyro[2]
        out[0, k] = wrench[k]
        out[1, k] = acceleration[k] + tangential + gyro[k] * along - com[k] * square
        out[2, k] = R[0, k] * gravity[0] + R[1, k] * gravity[1] + R[2, k] * gravity[2]


@numba.njit(cache=True)
def _derive(geometry, tau_ext, qd, qdd, gravity, out) -> None:
    """Force of the arm on the outside, specific force at the point, and gravity, each (3,) in B, into `out` (3, 3).

    The force is the smallest one that explains the external torques of the joints that can move the point: with
    J^T F = tau, F = (J J^T + d²)^-1 J tau.
    """
    origins, flange, joint, before, started = geometry
    n = qd.size
    jacobian = np.zeros((3, n))
    for i in range(joint):
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            jacobian[k, i] = flange[3 + a, i] * (origins[joint, b] - origins[i, b])
            jacobian[k, i] -= flange[3 + b, i] * (origins[joint, a] - origins[i, a])
    if not started:
        before[:] = jacobian
    square = np.empty((3, 3))
    right = np.empty(3)
    for r in range(3):
        acceleration, push = 0.0, 0.0
        for i in range(n):
            acceleration += jacobian[r, i] * qdd[i] + (jacobian[r, i] - before[r, i]) / TICK * qd[i]
            push += jacobian[r, i] * tau_ext[i]
        for c in range(3):
            total = SINGULAR * SINGULAR if r == c else 0.0
            for i in range(n):
                total += jacobian[r, i] * jacobian[c, i]
            square[r, c] = total
        out[1, r] = acceleration - gravity[r]
        out[2, r] = gravity[r]
        right[r] = -push
    before[:] = jacobian
    force = np.linalg.solve(square, right)
    for r in range(3):
        out[0, r] = force[r]


@numba.njit(cache=True)
def _place(p, R, tcp, out) -> None:
    for k in range(3):
        out[k] = p[k] + R[k, 0] * tcp[0] + R[k, 1] * tcp[1] + R[k, 2] * tcp[2]
