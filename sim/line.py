"""A straight line of the tool centre point, and the joints' way along it."""

import math

import numpy as np
from numpy.typing import NDArray

from sim.dynamics import Dynamics
from sim.frames import matrix_from_quaternion, quaternion_from_matrix

Array = NDArray[np.float64]

SINGULAR = 0.02  # smallest singular value of the tool's Jacobian that a line may pass: shoulder, elbow or wrist aligned
LINE_GAIN = 20.0  # pulls the line's reference back onto the line [1/s]


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
        at_tcp[:3] += np.cross(jacobian[3:].T, lever).T
        return p + lever, R, at_tcp

    def singular(self, q: Array) -> bool:
        """Whether the tool cannot go everywhere from q."""
        return bool(np.linalg.svd(self._jacobian(q)[2], compute_uv=False)[-1] < SINGULAR)

    def torque(self, q: Array, force: Array) -> Array:
        """Of the joints (n,) at q for a force on the outside at the tool centre point (3,) in B [N]."""
        return self._jacobian(q)[2][:3].T @ force

    def solve(self, q: Array, s: float, rate: float) -> Array:
        """Joint speeds (n,) at q, for the share `s` of the line and its rate [1/s]."""
        point, R, jacobian = self._jacobian(q)
        twist = np.empty(6)
        twist[:3] = rate * self.way + LINE_GAIN * (self.start + s * self.way - point)
        error = rotation_vector(R.T @ self.R @ _rotation(s * self.turn))
        twist[3:] = self.R @ (rate * self.turn) + LINE_GAIN * (R @ error)
        # Damping only bites near a singularity, where the plan has been refused already.
        return np.asarray(np.linalg.solve(jacobian.T @ jacobian + 1e-8 * np.eye(q.size), jacobian.T @ twist), dtype=np.float64)


def rotation_vector(R: Array) -> Array:
    """Axis times angle (3,) [rad] of a rotation matrix."""
    w, *v = quaternion_from_matrix(R)
    size = math.sqrt(sum(float(x) ** 2 for x in v))
    return np.array(v) * (2.0 * math.atan2(size, w) / size if size > 1e-12 else 2.0)


def _rotation(vector: Array) -> Array:
    """Rotation matrix (3, 3) of axis times angle (3,) [rad]."""
    angle = float(np.linalg.norm(vector))
    half = 0.5 * angle
    return matrix_from_quaternion([math.cos(half), *(vector * (math.sin(half) / angle if angle > 1e-12 else 0.5))])
