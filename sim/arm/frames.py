"""Frames and tensors of an arm's chain. Pure numpy; transforms are (4, 4), quaternions wxyz."""

import math

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.arm.arm_file import Arm, Capsule, LinkOrigin

Array = NDArray[np.float64]


def rotation(axis: int, angle: float) -> Array:
    """Rotation matrix (3, 3) about coordinate axis 0, 1 or 2 by `angle` [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[j, i], matrix[i, j] = s, -s
    return matrix


def rotation_from_rpy(rpy: ArrayLike) -> Array:
    """Rotation matrix (3, 3) of roll, pitch, yaw [rad] about the fixed axes x, y, z in this order (URDF convention)."""
    roll, pitch, yaw = np.asarray(rpy, dtype=float)
    return rotation(2, yaw) @ rotation(1, pitch) @ rotation(0, roll)


def rpy_from_matrix(matrix: ArrayLike) -> tuple[float, float, float]:
    """Roll, pitch, yaw [rad] of a rotation matrix (3, 3), as `rotation_from_rpy` takes them.

    The pitch is within a quarter turn. At its ends roll and yaw turn about the same axis, and all of that is the roll: yaw is 0.
    """
    r = np.asarray(matrix, dtype=float)
    level = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], level)
    if level < 1e-9:
        return math.atan2(-r[1, 2], r[1, 1]), pitch, 0.0
    return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])


def quaternion_from_matrix(matrix: ArrayLike) -> Array:
    """Unit quaternion wxyz (4,), w >= 0, of a rotation matrix (3, 3)."""
    # Numbers, not arrays: some controllers ask for several in every tick.
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = np.asarray(matrix, dtype=float).tolist()
    # Each row is the quaternion times four times one of its components; the row of the largest component is well conditioned.
    w, x, y, z = 1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz
    largest = max(w, x, y, z)
    if largest == w:
        row = (w, zy - yz, xz - zx, yx - xy)
    elif largest == x:
        row = (zy - yz, x, yx + xy, xz + zx)
    elif largest == y:
        row = (xz - zx, yx + xy, y, zy + yz)
    else:
        row = (yx - xy, xz + zx, zy + yz, z)
    quaternion = np.array(row)
    quaternion = quaternion / math.sqrt(quaternion.dot(quaternion))
    return -quaternion if quaternion[0] < 0 else quaternion


def cross(a: Array, b: Array) -> Array:
    """Cross product of two vectors (3,); `np.cross`, which takes any number of them, needs ten times as long."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def matrix_from_quaternion(quaternion: ArrayLike) -> Array:
    """Rotation matrix (3, 3) of a quaternion wxyz (4,) of any length but 0."""
    q = np.asarray(quaternion, dtype=float)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def transform(matrix: ArrayLike, position: ArrayLike) -> Array:
    """Transform (4, 4) of a rotation matrix (3, 3) and a position (3,) [m]."""
    pose = np.eye(4)
    pose[:3, :3] = matrix
    pose[:3, 3] = position
    return pose


def placements(arm: Arm) -> Array:
    """Where each joint frame sits in the one before, B for the first, and F in the last, at q = 0: (n + 1, 4, 4).

    The joint frame of link k has z along joint k's axis and turns with the link.
    """
    chain = arm.chain
    if not chain.origins:
        behind = [transform(rotation(0, alpha), [a, 0.0, d]) for a, d, alpha in zip(chain.a, chain.d, chain.alpha, strict=True)]
        return np.array([np.eye(4), *behind])
    assert chain.flange is not None  # sim.arm_problems sees to it
    found, before = [], np.eye(3)
    for k, origin in enumerate([*chain.origins, chain.flange]):
        own = file_axes(arm, k).T if k < arm.n else np.eye(3)
        found.append(transform(before.T @ _turn(origin) @ own, before.T @ origin.xyz))
        before = own
    return np.array(found)


def _turn(origin: LinkOrigin) -> Array:
    """Orientation of a frame in the one before it (3, 3)."""
    return rotation_from_rpy(origin.rpy or [0.0] * 3) if origin.quaternion is None else matrix_from_quaternion(origin.quaternion)


def link_transform(arm: Arm, k: int) -> Array:
    """What comes behind link k in its joint frame (4, 4): the joint frame of link k + 1 while q_{k+1} = 0; of the last link F."""
    return placements(arm)[k + 1]


def file_axes(arm: Arm, k: int) -> Array:
    """Orientation (3, 3) in link k's joint frame of the axes that the arm's file has for it: its tensor, its shapes.

    Theirs are the joint frame's own with Denavit-Hartenberg; a link of a chain of transforms may turn about any axis, which the
    shortest turn takes to z.
    """
    axis = arm.chain.origins[k].axis if arm.chain.origins else None
    return np.eye(3) if axis is None else z_turned_to(axis).T


def z_turned_to(direction: ArrayLike) -> Array:
    """The shortest turn (3, 3) that takes z to a direction (3,) of any length but 0."""
    way = np.asarray(direction, dtype=float)
    x, y, z = way / np.linalg.norm(way)
    return matrix_from_quaternion((1.0 + z, -y, x, 0.0) if z > -1.0 else (0.0, 1.0, 0.0, 0.0))


def link_frame(arm: Arm, k: int) -> Array:
    """Frame in which the arm's file gives link k's centre of mass, in its joint frame (4, 4)."""
    return transform(file_axes(arm, k), np.zeros(3)) if arm.chain.origins else link_transform(arm, k)


def joint_frames(arm: Arm, q: ArrayLike) -> Array:
    """Joint frames of all links and the flange in B at joint angles q (n,) [rad]: (n + 1, 4, 4)."""
    frames = placements(arm)
    pose = frames[0]
    for k, angle in enumerate(np.asarray(q, dtype=float)):
        frames[k] = pose @ transform(rotation(2, angle), np.zeros(3))
        pose = frames[k] @ frames[k + 1]
    frames[arm.n] = pose
    return frames


def com_in_joint_frame(arm: Arm, k: int) -> Array:
    """Centre of mass of link k in its joint frame (3,) [m]."""
    return (link_frame(arm, k) @ [*arm.masses.com[k], 1.0])[:3]


def tensor_in_joint_frame(arm: Arm, k: int) -> Array:
    """Inertia of link k about its centre of mass, axes of its joint frame (3, 3) [kg·m²]."""
    R = file_axes(arm, k)
    return R @ inertia_matrix(arm.inertias.tensor[k]) @ R.T


def hulls(arm: Arm) -> list[Capsule]:
    """The arm's collision shapes, in the joint frames of their links."""

    def turned(shape: Capsule) -> Capsule:
        R = file_axes(arm, shape.link)
        start, end = (R @ point for point in (shape.start, shape.end))
        return msgspec.structs.replace(shape, start=start.tolist(), end=end.tolist())

    return [turned(shape) if shape.link >= 0 else shape for shape in arm.shapes]


def inertia_matrix(tensor: ArrayLike) -> Array:
    """Symmetric matrix (3, 3) of ixx iyy izz ixy ixz iyz."""
    xx, yy, zz, xy, xz, yz = np.asarray(tensor, dtype=float)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def inertia_numbers(matrix: Array) -> list[float]:
    """ixx iyy izz ixy ixz iyz of a symmetric matrix (3, 3), as `inertia_matrix` takes them."""
    return matrix[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)].tolist()


def skew(vector: ArrayLike) -> Array:
    """Matrix (3, 3) S with S @ u = vector x u."""
    x, y, z = np.asarray(vector, dtype=float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation_vector(R: Array) -> Array:
    """Axis times angle (3,) [rad] of a rotation matrix (3, 3), by half a turn at most."""
    w, *v = quaternion_from_matrix(R).tolist()
    size = math.sqrt(sum(x**2 for x in v))
    return np.array(v) * (2.0 * math.atan2(size, w) / size if size > 1e-12 else 2.0)


def rotation_by(vector: Array) -> Array:
    """Rotation matrix (3, 3) of axis times angle (3,) [rad]."""
    angle = float(np.linalg.norm(vector))
    half = 0.5 * math.sin(0.5 * angle) / (0.5 * angle) if angle > 1e-12 else 0.5
    return matrix_from_quaternion((math.cos(0.5 * angle), *(half * vector)))
