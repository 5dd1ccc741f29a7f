"""Vectors and poses as plain floats, for single points that are computed in every tick."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Wrench = tuple[float, ...]  # force and torque, six numbers [N, N·m]
Quaternion = tuple[float, float, float, float]  # wxyz
Rotation = tuple[float, float, float, float, float, float, float, float, float]  # a matrix, row by row

ORIGIN: Vector = (0.0, 0.0, 0.0)
UNTURNED: Rotation = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class Pose(NamedTuple):
    """Pose X_AB of a frame B in a frame A."""

    p: Vector = ORIGIN  # p_AB [m]
    R: Rotation = UNTURNED  # R_AB


HERE = Pose()
"""The pose of a frame in itself."""


def rotation(quaternion: Quaternion) -> Rotation:
    """The matrix of a quaternion wxyz of any length but 0."""
    w, x, y, z = quaternion
    scale = 2.0 / (w * w + x * x + y * y + z * z)
    xx, yy, zz = scale * x * x, scale * y * y, scale * z * z
    xy, xz, yz = scale * x * y, scale * x * z, scale * y * z
    wx, wy, wz = scale * w * x, scale * w * y, scale * w * z
    return (1.0 - yy - zz, xy - wz, xz + wy, xy + wz, 1.0 - xx - zz, yz - wx, xz - wy, yz + wx, 1.0 - xx - yy)


def from_rpy(roll: float, pitch: float, yaw: float) -> Rotation:
    """The matrix of a turn about the fixed axes x, y, z in this order [rad] (URDF convention)."""
    a, b = math.cos(roll), math.sin(roll)
    c, d = math.cos(pitch), math.sin(pitch)
    e, f = math.cos(yaw), math.sin(yaw)
    return e * c, e * d * b - f * a, e * d * a + f * b, f * c, f * d * b + e * a, f * d * a - e * b, -d, c * b, c * a


def quaternion(R: Rotation) -> Quaternion:
    """The quaternion wxyz of unit length of a rotation matrix, by its largest component, which is taken positive."""
    a, b, c, d, e, f, g, h, i = R
    squares = (1.0 + a + e + i, 1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i)  # four times the squares of w, x, y, z
    rows: tuple[Quaternion, ...] = (
        (squares[0], h - f, c - g, d - b),
        (h - f, squares[1], b + d, c + g),
        (c - g, b + d, squares[2], f + h),
        (d - b, c + g, f + h, squares[3]),
    )
    w, x, y, z = rows[squares.index(max(squares))]
    size = math.sqrt(w * w + x * x + y * y + z * z)
    return w / size, x / size, y / size, z / size


def flat(matrix: Array) -> Rotation:
    """A rotation matrix (3, 3), row by row."""
    a, b, c, d, e, f, g, h, i = matrix.ravel().tolist()
    return a, b, c, d, e, f, g, h, i


def dot(a: Vector, b: Vector) -> float:
    """The inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(v: Vector) -> float:
    """The length."""
    x, y, z = v
    return math.sqrt(x * x + y * y + z * z)


def turned(R: Rotation, v: Vector) -> Vector:
    """R_AB times a vector in B: the vector in A."""
    a, b, c, d, e, f, g, h, i = R
    x, y, z = v
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def turned_back(R: Rotation, v: Vector) -> Vector:
    """The transpose of R_AB times a vector in A: the vector in B."""
    a, b, c, d, e, f, g, h, i = R
    x, y, z = v
    return a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z


def product(A: Rotation, B: Rotation) -> Rotation:
    """R_AB R_BC: the rotation R_AC."""
    columns = (turned(A, (B[k], B[k + 3], B[k + 6])) for k in range(3))
    (a, d, g), (b, e, h), (c, f, i) = columns
    return a, b, c, d, e, f, g, h, i


def seen_from(frame: Pose, point: Vector) -> Vector:
    """Coordinates in B of a point that is given in A; `frame` is the pose X_AB."""
    x, y, z = point
    px, py, pz = frame.p
    return turned_back(frame.R, (x - px, y - py, z - pz))


def finite(pose: Pose) -> bool:
    """All twelve numbers are finite."""
    return math.isfinite(sum(pose.p) + sum(pose.R))
