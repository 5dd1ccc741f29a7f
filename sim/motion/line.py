"""A straight line of the tool centre point, and the joints' way along it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.frames import matrix_from_quaternion, quaternion_from_matrix
from sim.compiled.kernel import kernel
from sim.rigid_body.cholesky import factor, solve
from sim.rigid_body.dynamics import Dynamics
from sim.rigid_body.newton_euler import cross, turned

Array = NDArray[np.float64]

SINGULAR = 0.02  # smallest singular value of the tool's Jacobian that a line may pass: shoulder, elbow or wrist aligned
LINE_GAIN = 20.0  # pulls the line's reference back onto the line [1/s]


class FlangePlace(NamedTuple):
    """Where the arm is, in axes of B, n joints."""

    p: Array  # flange (3,) [m]
    R: Array  # and its orientation (3, 3)
    jacobian: Array  # of the flange (6, n), linear first


class Course(NamedTuple):
    """A straight line of the tool centre point, in axes of B."""

    tcp: Array  # tool centre point in F (3,) [m]
    start: Array  # (3,) [m]
    R_start: Array  # (3, 3)
    way: Array  # (3,) [m]
    turn: Array  # axis times angle, in T (3,) [rad]


class Line:
    """From where the tool centre point is at joint angles q, by `way` and turning by `turn`; both are zero at first.

    Joint speeds follow from resolved motion rates (qd = J^-1 (v + k e)) against the model's own kinematics.

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        q: joint angles at the begin (n,) [rad].
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, q: Array) -> None:
        self._dynamics, self._tcp = dynamics, tcp
        p, R, _ = dynamics.update(q)
        self.start, self.R = p + R @ tcp, R.copy()
        self.way, self.turn = np.zeros(3), np.zeros(3)  # in B [m]; axis times angle, in T [rad]

    def _jacobian(self, q: Array) -> tuple[Array, Array, Array]:
        """Tool centre point (3,), orientation (3, 3) and the Jacobian (6, n) of the tool centre point, in axes of B."""
        p, R, jacobian = self._dynamics.update(q)
        lever = R @ self._tcp
        at_tcp = jacobian.copy()
        (wx, wy, wz), (x, y, z) = jacobian[3:], lever.tolist()
        at_tcp[0] += wy * z - wz * y
        at_tcp[1] += wz * x - wx * z
        at_tcp[2] += wx * y - wy * x
        return p + lever, R, at_tcp

    def singular(self, q: Array) -> bool:
        """Whether the tool cannot go everywhere from q."""
        return bool(np.linalg.svd(self._jacobian(q)[2], compute_uv=False)[-1] < SINGULAR)

    def pose(self, q: Array) -> tuple[Array, Array]:
        """Tool centre point (3,) and orientation of the flange (3, 3) at q, in B."""
        p, R, _ = self._dynamics.places(q)
        return p + R @ self._tcp, R.copy()

    def twist(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """Speed of the tool centre point (3,) and about it (3,) at q, in B [m/s, rad/s]."""
        twist = self._jacobian(q)[2] @ qd
        return twist[:3], twist[3:]

    def speeds(self, q: Array, v: Array, w: Array) -> Array:
        """Joint speeds (n,) at q for a speed of the tool centre point (3,) and about it (3,), in B; the line is no matter."""
        place = self._dynamics.update(q)
        p, R, _ = place
        course = (self._tcp, p + R @ self._tcp, R.copy(), v, R.T @ w)  # a copy has the layout that the kernel is compiled for
        return np.asarray(_solve(place, course, 0.0, 1.0), dtype=np.float64)

    def torque(self, q: Array, force: Array) -> Array:
        """Of the joints (n,) at q for a force on the outside at the tool centre point (3,) in B [N]."""
        return self._jacobian(q)[2][:3].T @ force

    def solve(self, q: Array, s: float, rate: float) -> Array:
        """Joint speeds (n,) at q, for the share `s` of the line and its rate [1/s]."""
        course = (self._tcp, self.start, self.R, self.way, self.turn)
        return np.asarray(_solve(self._dynamics.update(q), course, s, rate), dtype=np.float64)


def rotation_vector(R: Array) -> Array:
    """Axis times angle (3,) [rad] of a rotation matrix."""
    w, *v = quaternion_from_matrix(R).tolist()
    size = math.sqrt(sum(x**2 for x in v))
    return np.array(v) * (2.0 * math.atan2(size, w) / size if size > 1e-12 else 2.0)


def rotation_by(vector: Array) -> Array:
    """Rotation matrix (3, 3) of axis times angle (3,) [rad]."""
    angle = float(np.linalg.norm(vector))
    half = 0.5 * math.sin(0.5 * angle) / (0.5 * angle) if angle > 1e-12 else 0.5
    return matrix_from_quaternion((math.cos(0.5 * angle), *(half * vector)))


# Loops over scalars, and a solver of our own: the compiled products and solvers of numpy cost a fresh installation ten seconds.


@kernel
def _solve(place, course, s, rate):
    place = FlangePlace(*place)
    course = Course(*course)
    p, R, jacobian = place
    tcp, start, R_start, way, turn = course
    n = jacobian.shape[1]
    lever, going, left = turned(R, tcp), turned(R_start, turn), _turn_between(R, R_start, turn, s)
    twist = np.empty(6)
    for k in range(3):
        twist[k] = rate * way[k] + LINE_GAIN * (start[k] + s * way[k] - p[k] - lever[k])
        twist[3 + k] = rate * going[k] + LINE_GAIN * left[k]
    at_tcp = np.empty((6, n))
    for i in range(n):
        swing = cross(jacobian[3:, i], lever)
        for k in range(3):
            at_tcp[k, i] = jacobian[k, i] + swing[k]
            at_tcp[3 + k, i] = jacobian[3 + k, i]
    normal, speeds = np.empty((n, n)), np.empty(n)
    for i in range(n):
        speeds[i] = 0.0
        for r in range(6):
            speeds[i] += at_tcp[r, i] * twist[r]
        for j in range(i + 1):
            # Damping only bites near a singularity, where the plan has been refused already.
            normal[i, j] = 1e-8 if i == j else 0.0
            for r in range(6):
                normal[i, j] += at_tcp[r, i] * at_tcp[r, j]
    factor(normal, n)
    solve(normal, speeds, n)
    return speeds


@kernel
def _turn_between(R, R_start, turn, s):
    """Axis times angle (3,) [rad], in axes of B, of the rotation by less than half a turn from R to R_start·exp(s·turn)."""
    angle = math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2])
    x, y, z = turn[0], turn[1], turn[2]
    if angle > 1e-12:
        x, y, z = x / angle, y / angle, z / angle
    sine, versed = math.sin(s * angle), 1.0 - math.cos(s * angle)
    # Columns of the goal, by Rodrigues' formula.
    columns = (
        turned(R_start, (1.0 - versed * (y * y + z * z), versed * x * y + sine * z, versed * x * z - sine * y)),
        turned(R_start, (versed * x * y - sine * z, 1.0 - versed * (x * x + z * z), versed * y * z + sine * x)),
        turned(R_start, (versed * x * z + sine * y, versed * y * z - sine * x, 1.0 - versed * (x * x + y * y))),
    )
    error = np.empty((3, 3))  # goal R^T
    for i in range(3):
        for j in range(3):
            error[i, j] = columns[0][i] * R[j, 0] + columns[1][i] * R[j, 1] + columns[2][i] * R[j, 2]
    vx, vy, vz = 0.5 * (error[2, 1] - error[1, 2]), 0.5 * (error[0, 2] - error[2, 0]), 0.5 * (error[1, 0] - error[0, 1])
    size = math.sqrt(vx * vx + vy * vy + vz * vz)
    scale = math.atan2(size, 0.5 * (error[0, 0] + error[1, 1] + error[2, 2] - 1.0)) / size if size > 1e-12 else 1.0
    return scale * vx, scale * vy, scale * vz
