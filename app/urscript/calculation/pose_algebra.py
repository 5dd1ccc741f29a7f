"""Poses as the language calculates with them: a position and a rotation vector. Plain numbers, since poses are small."""

import math

from app.urscript.machine.values import PoseValue
from sim.arm.frames import matrix_from_quaternion, rpy_from_matrix

Quaternion = tuple[float, float, float, float]
Point = tuple[float, float, float]


def quaternion(vector: tuple[float, ...]) -> Quaternion:
    """wxyz of a rotation vector [rad]."""
    x, y, z = vector
    angle = math.sqrt(x * x + y * y + z * z)
    if angle < 1e-12:
        return 1.0, 0.5 * x, 0.5 * y, 0.5 * z
    s = math.sin(0.5 * angle) / angle
    return math.cos(0.5 * angle), s * x, s * y, s * z


def rotation(q: Quaternion) -> Point:
    """The rotation vector of wxyz, no longer than half a turn [rad]."""
    w, x, y, z = q if q[0] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])
    size = math.sqrt(x * x + y * y + z * z)
    k = 2.0 * math.atan2(size, w) / size if size > 1e-12 else 2.0
    return k * x, k * y, k * z


def times(a: Quaternion, b: Quaternion) -> Quaternion:
    """First b, then a."""
    w, x, y, z = a
    t, u, v, s = b
    return (
        w * t - x * u - y * v - z * s,
        w * u + x * t + y * s - z * v,
        w * v - x * s + y * t + z * u,
        w * s + x * v - y * u + z * t,
    )


def turned_back(q: Quaternion) -> Quaternion:
    """The inverse."""
    return q[0], -q[1], -q[2], -q[3]


def turned(q: Quaternion, point: tuple[float, ...]) -> Point:
    """A point, turned."""
    _, x, y, z = times(times(q, (0.0, point[0], point[1], point[2])), turned_back(q))
    return x, y, z


def _made(position: Point, q: Quaternion) -> PoseValue:
    return PoseValue((*position, *rotation(q)))


def transformed(a: PoseValue, b: PoseValue) -> PoseValue:
    """First a, and from there b."""
    q = quaternion(a[3:])
    x, y, z = turned(q, b[:3])
    return _made((a[0] + x, a[1] + y, a[2] + z), times(q, quaternion(b[3:])))


def inverted(a: PoseValue) -> PoseValue:
    """The way back."""
    q = turned_back(quaternion(a[3:]))
    x, y, z = turned(q, a[:3])
    return _made((-x, -y, -z), q)


def added(a: PoseValue, b: PoseValue) -> PoseValue:
    """Sum of the positions, product of the rotations."""
    return _made((a[0] + b[0], a[1] + b[1], a[2] + b[2]), times(quaternion(a[3:]), quaternion(b[3:])))


def subtracted(to: PoseValue, of: PoseValue) -> PoseValue:
    """Difference of the positions, and the rotation from `of` to `to`."""
    q = times(quaternion(to[3:]), turned_back(quaternion(of[3:])))
    return _made((to[0] - of[0], to[1] - of[1], to[2] - of[2]), q)


def between(a: PoseValue, b: PoseValue, share: float) -> PoseValue:
    """On the straight line from a to b, turning about one axis."""
    q = quaternion(a[3:])
    x, y, z = rotation(times(turned_back(q), quaternion(b[3:])))
    turn = quaternion((share * x, share * y, share * z))
    px, py, pz = (u + share * (v - u) for u, v in zip(a[:3], b[:3], strict=True))
    return _made((px, py, pz), times(q, turn))


def distance(a: PoseValue, b: PoseValue) -> float:
    """Length of the way and of the turn together."""
    return math.hypot(math.dist(a[:3], b[:3]), math.hypot(*rotation(times(turned_back(quaternion(a[3:])), quaternion(b[3:])))))


def from_rpy(rpy: tuple[float, ...]) -> Point:
    """Rotation vector of roll, pitch, yaw about fixed x, y, z [rad]."""
    roll, pitch, yaw = rpy
    q = times(times(quaternion((0.0, 0.0, yaw)), quaternion((0.0, pitch, 0.0))), quaternion((roll, 0.0, 0.0)))
    return rotation(q)


def to_rpy(vector: tuple[float, ...]) -> Point:
    """Roll, pitch, yaw about fixed x, y, z of a rotation vector [rad]."""
    return rpy_from_matrix(matrix_from_quaternion(quaternion(vector)))
