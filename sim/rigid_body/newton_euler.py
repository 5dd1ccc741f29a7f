"""What every tick needs of the controller's rigid model, in one compiled pass over the joints of Pinocchio's model."""

import numba
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Columns of the constants: a joint's placement in the joint before it, then its link in its own frame.
P_AT, R_AT, MASS, COM, INERTIA, WIDTH = 0, 3, 12, 13, 16, 25


class NewtonEuler:
    """Recursive Newton-Euler inverse dynamics of a motion, with pose, Jacobian and velocity of the flange.

    A chain of n hinges about z, in axes of B. Pinocchio holds the numbers and says the same within rounding, in four calls
    that take about three times as long.

    Source: Luh, Walker, Paul, On-line computational scheme for mechanical manipulators (1980).

    Attributes (valid until the next `run`):
        torque: (n,) [N·m], without rotors, friction and external forces.
        p, R: flange position (3,) [m] and orientation (3, 3) in B.
        jacobian: (6, n), linear first, axes of B, at the flange origin.
        v_F: flange velocity (6,), linear [m/s], then angular [rad/s].
        origins: of the joints (n, 3) in B [m].
        energy: kinetic, of the links (1,) [J].
        tcp, elbow: position [m], then velocity [m/s] of the tool centre point and of the elbow (6,) each.

    Args:
        model: Pinocchio's; `set_load` reads its inertias again.
        flange: pose of F in the last joint's frame.
        elbow: index of the joint whose origin is the elbow.
    """

    def __init__(self, model: pin.Model, flange: pin.SE3, elbow: int) -> None:
        n = model.nv
        self._model = model
        self._constants = np.zeros((n + 1, WIDTH))
        placements = [model.jointPlacements[i + 1] for i in range(n)] + [flange]
        for row, placement in zip(self._constants, placements, strict=True):
            row[P_AT:R_AT] = placement.translation
            row[R_AT:MASS] = placement.rotation.ravel()
        self._gravity = np.array(model.gravity.linear)
        self._elbow_at = elbow
        self.torque = np.zeros(n)
        self.p, self.R, self.v_F = np.zeros(3), np.eye(3), np.zeros(6)
        self.jacobian = np.zeros((6, n))
        self.origins = np.zeros((n, 3))
        self.energy = np.zeros(1)
        self.tcp, self.elbow = np.zeros((2, 6))

    def set_load(self) -> None:
        """Take the inertias that Pinocchio's model has now."""
        for i in range(self._model.nv):
            body, row = self._model.inertias[i + 1], self._constants[i]
            row[MASS] = body.mass
            row[COM:INERTIA] = body.lever
            row[INERTIA:] = body.inertia.ravel()

    def run(self, q: Array, motion: Array, tcp: Array) -> tuple[float, float]:
        """Fill the attributes; returns the speeds of the tool centre point and of the elbow [m/s].

        Args:
            q: joint angles (n,) [rad].
            motion: (3, n), of which rows 1 and 2 count: speed [rad/s] and acceleration [rad/s²].
            tcp: tool centre point in F (3,) [m].
        """
        outcome = (self.torque, self.p, self.R, self.jacobian, self.v_F, self.origins, self.tcp, self.elbow, self.energy)
        return _run(q, motion, self._constants, self._gravity, self._elbow_at, tcp, *outcome)


@numba.njit(cache=True)
def cross(a, b):
    """Cross product of two triples or vectors, as a triple."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@numba.njit(cache=True)
def turned(R, a):
    """R a."""
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )


@numba.njit(cache=True)
def turned_back(R, a):
    """R^T a."""
    return (
        R[0, 0] * a[0] + R[1, 0] * a[1] + R[2, 0] * a[2],
        R[0, 1] * a[0] + R[1, 1] * a[1] + R[2, 1] * a[2],
        R[0, 2] * a[0] + R[1, 2] * a[1] + R[2, 2] * a[2],
    )


@numba.njit(cache=True)
def _norm(a):
    return np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@numba.njit(cache=True)
def _place(row, behind_p, behind_R, p, R) -> None:
    """Pose (p, R) of the frame that `row` places in the frame (behind_p, behind_R)."""
    for k in range(3):
        p[k] = behind_p[k]
        for m in range(3):
            p[k] += behind_R[k, m] * row[P_AT + m]
            R[k, m] = behind_R[k, 0] * row[R_AT + m] + behind_R[k, 1] * row[R_AT + 3 + m] + behind_R[k, 2] * row[R_AT + 6 + m]


@numba.njit(cache=True)
def _run(q, motion, constants, gravity, elbow, tcp, torque, p_F, R_F, jacobian, v_F, origins, tip, bend, energy):
    n = q.size
    p, R = np.zeros((n + 1, 3)), np.empty((n + 1, 3, 3))
    behind_p, behind_R = np.zeros(3), np.eye(3)
    for i in range(n):
        _place(constants[i], behind_p, behind_R, p[i], R[i])
        c, s = np.cos(q[i]), np.sin(q[i])
        for k in range(3):
            x, y = R[i, k, 0], R[i, k, 1]
            R[i, k, 0], R[i, k, 1] = c * x + s * y, c * y - s * x
        behind_p, behind_R = p[i], R[i]
    _place(constants[n], behind_p, behind_R, p_F, R_F)
    p[n] = p_F
    for i in range(n):
        origins[i] = p[i]
        z = (R[i, 0, 2], R[i, 1, 2], R[i, 2, 2])
        arm = (p_F[0] - p[i, 0], p_F[1] - p[i, 1], p_F[2] - p[i, 2])
        linear = cross(z, arm)
        for k in range(3):
            jacobian[k, i], jacobian[3 + k, i] = linear[k], z[k]
    v_elbow = _inverse(p, R, motion, constants, gravity, elbow, torque, bend, energy)
    for k in range(6):
        v_F[k] = 0.0
        for i in range(n):
            v_F[k] += jacobian[k, i] * motion[1, i]
    offset = turned(R_F, tcp)
    swing = cross((v_F[3], v_F[4], v_F[5]), offset)
    for k in range(3):
        tip[k], tip[3 + k] = p_F[k] + offset[k], v_F[k] + swing[k]
    return _norm((v_F[0] + swing[0], v_F[1] + swing[1], v_F[2] + swing[2])), v_elbow


@numba.njit(cache=True)
def _inverse(p, R, motion, constants, gravity, elbow, torque, bend, energy):
    """Torques (n,) of a motion, its kinetic energy (1,), the speed of the elbow, and where the elbow is and how it moves (6,).

    The base accelerates upwards: that is gravity.
    """
    n = torque.size
    force, moment = np.empty((n, 3)), np.empty((n, 3))
    w, alpha, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    a = (-gravity[0], -gravity[1], -gravity[2])
    last = (0.0, 0.0, 0.0)
    v_elbow = 0.0
    energy[0] = 0.0
    for i in range(n):
        here, qd, qdd = (p[i, 0], p[i, 1], p[i, 2]), motion[1, i], motion[2, i]
        step = (here[0] - last[0], here[1] - last[1], here[2] - last[2])
        tangential, whirl = cross(alpha, step), cross(w, step)
        v = (v[0] + whirl[0], v[1] + whirl[1], v[2] + whirl[2])
        normal = cross(w, whirl)
        a = (a[0] + tangential[0] + normal[0], a[1] + tangential[1] + normal[1], a[2] + tangential[2] + normal[2])
        if i == elbow:
            v_elbow = _norm(v)
            for k in range(3):
                bend[k], bend[3 + k] = here[k], v[k]
        spin = (R[i, 0, 2] * qd, R[i, 1, 2] * qd, R[i, 2, 2] * qd)
        turn = cross(w, spin)
        alpha = (
            alpha[0] + R[i, 0, 2] * qdd + turn[0],
            alpha[1] + R[i, 1, 2] * qdd + turn[1],
            alpha[2] + R[i, 2, 2] * qdd + turn[2],
        )
        w = (w[0] + spin[0], w[1] + spin[1], w[2] + spin[2])
        last = here

        row = constants[i]
        com = turned(R[i], (row[COM], row[COM + 1], row[COM + 2]))
        tangential, normal = cross(alpha, com), cross(w, cross(w, com))
        inertia = row[INERTIA:WIDTH].reshape(3, 3)
        rate, local = turned_back(R[i], alpha), turned_back(R[i], w)
        spun = turned(inertia, local)
        whirl = cross(local, spun)
        going = cross(w, com)
        energy[0] += 0.5 * (spun[0] * local[0] + spun[1] * local[1] + spun[2] * local[2])
        energy[0] += 0.5 * row[MASS] * _norm((v[0] + going[0], v[1] + going[1], v[2] + going[2])) ** 2
        change = turned(inertia, rate)
        moment_com = turned(R[i], (change[0] + whirl[0], change[1] + whirl[1], change[2] + whirl[2]))
        for k in range(3):
            force[i, k] = row[MASS] * (a[k] + tangential[k] + normal[k])
            moment[i, k] = moment_com[k]
        lever = cross(com, (force[i, 0], force[i, 1], force[i, 2]))
        for k in range(3):
            moment[i, k] += lever[k]
    f, m = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)  # what passes on at the joint after this
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            ahead = (p[i + 1, 0] - p[i, 0], p[i + 1, 1] - p[i, 1], p[i + 1, 2] - p[i, 2])
            lever = cross(ahead, f)
            m = (m[0] + lever[0], m[1] + lever[1], m[2] + lever[2])
        f = (f[0] + force[i, 0], f[1] + force[i, 1], f[2] + force[i, 2])
        m = (m[0] + moment[i, 0], m[1] + moment[i, 1], m[2] + moment[i, 2])
        torque[i] = m[0] * R[i, 0, 2] + m[1] * R[i, 1, 2] + m[2] * R[i, 2, 2]
    return v_elbow
