"""What every tick needs of the controller's rigid model, in one compiled pass over the joints of Pinocchio's model."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.compiled.record import record

Array = NDArray[np.float64]


class NewtonEuler:
    """Recursive Newton-Euler inverse dynamics of a motion, with pose, Jacobian and velocity of the flange.

    A chain of n hinges about z, in axes of B. Pinocchio holds the numbers and says the same within rounding, in four calls
    that take about three times as long.

    Source: Luh, Walker, Paul, On-line computational scheme for mechanical manipulators (1980).

    Attributes (valid until the next `run`):
        torque: (n,) [N·m], without rotors, friction and external forces.
        at_rest: (n,) what of it holds the arm up in the same posture, at rest [N·m].
        p, R: flange position (3,) [m] and orientation (3, 3) in B.
        jacobian: (6, n), linear first, axes of B, at the flange origin.
        v_F: flange velocity (6,), linear [m/s], then angular [rad/s].
        origins: of the joints (n, 3) in B [m].
        turns: their orientations (n, 3, 3) in B.
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
        self.record = record(
            # Of a joint, and of the flange: its placement in the joint before it, then its link in its own frame.
            p_at=(n + 1, 3),
            R_at=(n + 1, 9),
            mass=(n,),
            com=(n, 3),
            inertia=(n, 3, 3),
            gravity=(3,),
            elbow_joint="i8",
            torque=(n,),
            at_rest=(n,),
            p=(3,),
            R=(3, 3),
            jacobian=(6, n),
            v_F=(6,),
            origins=(n, 3),
            turns=(n, 3, 3),
            energy=(1,),
            tcp=(6,),
            elbow=(6,),
        )
        own = self.record[0]
        for i, placement in enumerate([*(model.jointPlacements[i + 1] for i in range(n)), flange]):
            own["p_at"][i] = placement.translation
            own["R_at"][i] = placement.rotation.ravel()
        own["gravity"] = model.gravity.linear
        own["elbow_joint"] = elbow
        own["R"] = np.eye(3)
        self.torque, self.p, self.R, self.v_F = own["torque"], own["p"], own["R"], own["v_F"]
        self.at_rest = own["at_rest"]
        self.jacobian, self.origins, self.energy = own["jacobian"], own["origins"], own["energy"]
        self.turns = own["turns"]
        self.tcp, self.elbow = own["tcp"], own["elbow"]

    def set_load(self) -> None:
        """Take the inertias that Pinocchio's model has now."""
        own = self.record[0]
        for i in range(self._model.nv):
            body = self._model.inertias[i + 1]
            own["mass"][i], own["com"][i], own["inertia"][i] = body.mass, body.lever, body.inertia

    def run(self, q: Array, motion: Array, tcp: Array) -> tuple[float, float]:
        """Fill the attributes; returns the speeds of the tool centre point and of the elbow [m/s].

        Args:
            q: joint angles (n,) [rad].
            motion: (3, n), of which rows 1 and 2 count: speed [rad/s] and acceleration [rad/s²].
            tcp: tool centre point in F (3,) [m].
        """
        return _run(self.record, q, motion, tcp)


@kernel
def cross(a, b):
    """Cross product of two triples or vectors, as a triple."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def turned(R, a):
    """R a."""
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )


@kernel
def turned_back(R, a):
    """R^T a."""
    return (
        R[0, 0] * a[0] + R[1, 0] * a[1] + R[2, 0] * a[2],
        R[0, 1] * a[0] + R[1, 1] * a[1] + R[2, 1] * a[2],
        R[0, 2] * a[0] + R[1, 2] * a[1] + R[2, 2] * a[2],
    )


@kernel
def _norm(a):
    return np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def about(ahead, acting, heavy):
    """What all links beyond have about the next joint, about this one, which lies `ahead` (3,) before it.

    Args:
        ahead: from this joint to the next one [m].
        acting: a force or momentum (3,), and its moment (3,) about the next joint.
        heavy: mass times centre (3,) from there [kg·m], and mass [kg].

    Returns:
        The moment (3,), and mass times centre (3,).
    """
    f, m = acting
    S, mass = heavy
    lever = cross(ahead, f)
    return (
        (m[0] + lever[0], m[1] + lever[1], m[2] + lever[2]),
        (S[0] + mass * ahead[0], S[1] + mass * ahead[1], S[2] + mass * ahead[2]),
    )


@kernel
def place(model, i, behind, pose) -> None:
    """Pose (p, R) of joint i, of the flange after the last, placed in the pose `behind` of the joint before it."""
    p_at, R_at = model.p_at[i], model.R_at[i]
    behind_p, behind_R = behind
    p, R = pose
    for k in range(3):
        p[k] = behind_p[k]
        for m in range(3):
            p[k] += behind_R[k, m] * p_at[m]
            R[k, m] = behind_R[k, 0] * R_at[m] + behind_R[k, 1] * R_at[3 + m] + behind_R[k, 2] * R_at[6 + m]


@kernel
def _run(rigid, q, motion, tcp):
    own = rigid[0]
    p_F, R_F, v_F, jacobian, tip = own.p, own.R, own.v_F, own.jacobian, own.tcp
    n = q.size
    p, R = np.zeros((n + 1, 3)), own.turns
    behind_p, behind_R = np.zeros(3), np.eye(3)
    for i in range(n):
        place(own, i, (behind_p, behind_R), (p[i], R[i]))
        c, s = np.cos(q[i]), np.sin(q[i])
        for k in range(3):
            x, y = R[i, k, 0], R[i, k, 1]
            R[i, k, 0], R[i, k, 1] = c * x + s * y, c * y - s * x
        behind_p, behind_R = p[i], R[i]
    place(own, n, (behind_p, behind_R), (p_F, R_F))
    p[n] = p_F
    origins = own.origins
    for i in range(n):
        origins[i] = p[i]
        z = (R[i, 0, 2], R[i, 1, 2], R[i, 2, 2])
        arm = (p_F[0] - p[i, 0], p_F[1] - p[i, 1], p_F[2] - p[i, 2])
        linear = cross(z, arm)
        for k in range(3):
            jacobian[k, i], jacobian[3 + k, i] = linear[k], z[k]
    v_elbow = _inverse(own, p, R, motion)
    for k in range(6):
        v_F[k] = 0.0
        for i in range(n):
            v_F[k] += jacobian[k, i] * motion[1, i]
    offset = turned(R_F, tcp)
    swing = cross((v_F[3], v_F[4], v_F[5]), offset)
    for k in range(3):
        tip[k], tip[3 + k] = p_F[k] + offset[k], v_F[k] + swing[k]
    return _norm((v_F[0] + swing[0], v_F[1] + swing[1], v_F[2] + swing[2])), v_elbow


@kernel
def _inverse(own, p, R, motion):
    """Torques of a motion, its kinetic energy, where the elbow is and how it moves; returns the elbow's speed.

    The base accelerates upwards: that is gravity.
    """
    torque, bend, energy, gravity, elbow = own.torque, own.elbow, own.energy, own.gravity, own.elbow_joint
    n = torque.size
    force, moment, heavy = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
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

        at = own.com[i]
        com = turned(R[i], (at[0], at[1], at[2]))
        tangential, normal = cross(alpha, com), cross(w, cross(w, com))
        inertia, mass = own.inertia[i], own.mass[i]
        rate, local = turned_back(R[i], alpha), turned_back(R[i], w)
        spun = turned(inertia, local)
        whirl = cross(local, spun)
        going = cross(w, com)
        energy[0] += 0.5 * (spun[0] * local[0] + spun[1] * local[1] + spun[2] * local[2])
        energy[0] += 0.5 * mass * _norm((v[0] + going[0], v[1] + going[1], v[2] + going[2])) ** 2
        change = turned(inertia, rate)
        moment_com = turned(R[i], (change[0] + whirl[0], change[1] + whirl[1], change[2] + whirl[2]))
        for k in range(3):
            force[i, k] = mass * (a[k] + tangential[k] + normal[k])
            moment[i, k] = moment_com[k]
            heavy[i, k] = mass * com[k]
        lever = cross(com, (force[i, 0], force[i, 1], force[i, 2]))
        for k in range(3):
            moment[i, k] += lever[k]
    f, m = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)  # what passes on at the joint after this
    S, mass = (0.0, 0.0, 0.0), 0.0  # mass times centre, and mass, of all beyond
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            ahead = (p[i + 1, 0] - p[i, 0], p[i + 1, 1] - p[i, 1], p[i + 1, 2] - p[i, 2])
            m, S = about(ahead, (f, m), (S, mass))
        f = (f[0] + force[i, 0], f[1] + force[i, 1], f[2] + force[i, 2])
        m = (m[0] + moment[i, 0], m[1] + moment[i, 1], m[2] + moment[i, 2])
        S = (S[0] + heavy[i, 0], S[1] + heavy[i, 1], S[2] + heavy[i, 2])
        mass += own.mass[i]
        weight = cross(gravity, S)  # its moment, turned round
        torque[i] = m[0] * R[i, 0, 2] + m[1] * R[i, 1, 2] + m[2] * R[i, 2, 2]
        own.at_rest[i] = weight[0] * R[i, 0, 2] + weight[1] * R[i, 1, 2] + weight[2] * R[i, 2, 2]
    return v_elbow
