"""A straight line of the tool centre point, and the joints' way along it."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from sim.dynamics import Dynamics
from sim.frames import quaternion_from_matrix
from sim.newton_euler import cross

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
        return np.asarray(
            _solve(*self._dynamics.update(q), self._tcp, self.start, self.R, self.way, self.turn, s, rate), dtype=np.float64
        )


def rotation_vector(R: Array) -> Array:
    """Axis times angle (3,) [rad] of a rotation matrix."""
    w, *v = quaternion_from_matrix(R)
    size = math.sqrt(sum(float(x) ** 2 for x in v))
    return np.array(v) * (2.0 * math.atan2(size, w) / size if size > 1e-12 else 2.0)


@numba.njit(cache=True)
def _solve(p, R, jacobian, tcp, start, R_start, way, turn, s, rate):
    lever = R @ tcp
    at_tcp = np.ascontiguousarray(jacobian).copy()
    for i in range(jacobian.shape[1]):
        dx, dy, dz = cross(jacobian[3:, i], lever)
        at_tcp[0, i] += dx
        at_tcp[1, i] += dy
        at_tcp[2, i] += dz
    twist = np.empty(6)
    twist[:3] = rate * way + LINE_GAIN * (start + s * way - p - lever)
    left = R.T @ R_start @ _rotation(s * turn)
    twist[3:] = R_start @ (rate * turn) + LINE_GAIN * (R @ _turn_of(left))
    # Damping only bites near a singularity, where the plan has been refused already.
    return np.linalg.solve(at_tcp.T @ at_tcp + 1e-8 * np.eye(at_tcp.shape[1]), at_tcp.T @ twist)


@numba.njit(cache=True)
def _rotation(vector):
    """Rotation matrix (3, 3) of axis times angle (3,) [rad], by Rodrigues' formula."""
    angle = np.sqrt(vector @ vector)
    axis = vector / angle if angle > 1e-12 else vector
    x, y, z = axis
    K = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    if angle <= 1e-12:
        return np.eye(3) + K
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


@numba.njit(cache=True)
def _turn_of(R):
    """Axis times angle (3,) [rad] of a rotation by less than half a turn."""
    v = 0.5 * np.array((R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]))
    sine = np.sqrt(v @ v)
    cosine = 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0)
    return v * (np.arctan2(sine, cosine) / sine if sine > 1e-12 else 1.0)
