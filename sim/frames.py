"""Rotations, poses and inertia tensors as plain numpy. Quaternions are wxyz; matrices turn coordinates of the child into the parent."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rotation_x(angle: float) -> Array:
    """Rotation about x by `angle` [rad], (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rotation_z(angle: float) -> Array:
    """Rotation about z by `angle` [rad], (3, 3)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_rpy(rpy: Sequence[float]) -> Array:
    """Rotation of roll, pitch, yaw [rad] (about fixed x, then y, then z), (3, 3)."""
    c, s = math.cos(rpy[1]), math.sin(rpy[1])
    pitch = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return rotation_z(rpy[2]) @ pitch @ rotation_x(rpy[0])


def quaternion(R: Array) -> Array:
    """Unit quaternion wxyz, w >= 0, of the rotation matrix `R`, (4,)."""
    # Shepperd's method: the largest of the four squared components is found first, so no small number divides.
    squares = np.array([np.trace(R), R[0, 0], R[1, 1], R[2, 2]])
    k = int(np.argmax(squares))
    if k == 0:
        q = np.array([1.0 + squares[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    else:
        i, j, m = (k - 1), k % 3, (k + 1) % 3
        q = np.empty(4)
        q[0] = R[m, j] - R[j, m]
        q[1 + i] = 1.0 + R[i, i] - R[j, j] - R[m, m]
        q[1 + j] = R[j, i] + R[i, j]
        q[1 + m] = R[m, i] + R[i, m]
    q /= math.sqrt(float(q @ q))
    return -q if q[0] < 0 else q


def matrix(q: Sequence[float] | Array) -> Array:
    """Rotation matrix of the unit quaternion `q` wxyz, (3, 3)."""
    w, x, y, z = (float(v) for v in q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def skew(v: Sequence[float] | Array) -> Array:
    """Matrix S with S @ u = v x u, (3, 3)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def tensor(six: Sequence[float] | Array) -> Array:
    """Inertia tensor (3, 3) from ixx iyy izz ixy ixz iyz."""
    xx, yy, zz, xy, xz, yz = (float(v) for v in six)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def dh_step(a: float, d: float, alpha: float) -> tuple[Array, Array]:
    """What standard Denavit-Hartenberg puts behind a joint: Tz(d) Tx(a) Rx(alpha). Returns position (3,) and rotation (3, 3)."""
    return np.array([a, 0.0, d]), rotation_x(alpha)
