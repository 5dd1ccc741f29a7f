"""The arm as the controller knows it: where its links are in a posture, and how near their hulls come to each other."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.pose import Pose, Vector

Array = NDArray[np.float64]

THIN = 1e-12
"""Square of a length below which a rod is a point [m²]."""


class Rod(NamedTuple):
    """A capsule that a part of the arm lies in."""

    link: int  # that it belongs to, from 0 base to flange; -1: the foot
    start: Vector  # of its axis, in the frame of the link's joint [m]
    end: Vector
    radius: float  # [m]


class ArmShape:
    """Joints, and the rods round them.

    Args:
        names: of the joints, base to flange.
        joints: pose of each joint's frame (z is its axis) in the one before, B for the first, at q = 0.
        flange: pose of F in the last joint's frame.
        rods: round the links.
        ranges: smallest and largest angle of each joint [rad].
        elbow: index of the joint whose origin is the elbow.
    """

    def __init__(
        self,
        names: tuple[str, ...],
        joints: Sequence[Pose],
        flange: Pose,
        *,
        rods: tuple[Rod, ...],
        ranges: tuple[tuple[float, float], ...],
        elbow: int,
    ) -> None:
        self.names, self.rods, self.elbow = names, rods, elbow
        self.ranges = np.array(ranges)
        self._p = np.array([pose.p for pose in (*joints, flange)])
        self._R = np.array([pose.R for pose in (*joints, flange)]).reshape(-1, 3, 3)

    def places(self, q: Array) -> tuple[Array, Array]:
        """Origins (m, n+1, 3) and orientations (m, n+1, 3, 3) in B of all joint frames and of F, in m postures q (m, n) [rad]."""
        count, n = q.shape
        origins, turns = np.empty((count, n + 1, 3)), np.empty((count, n + 1, 3, 3))
        p, R = np.zeros((count, 3)), np.broadcast_to(np.eye(3), (count, 3, 3))
        for k in range(n + 1):
            p = p + R @ self._p[k]
            R = R @ self._R[k]
            if k < n:
                R = R @ _about_z(q[:, k])
            origins[:, k], turns[:, k] = p, R
        return origins, turns

    def ends(self, rods: Sequence[Rod], origins: Array, turns: Array) -> tuple[Array, Array]:
        """Both ends (m, k, 3) in B of k rods, where the frames are as `places` says; the foot's frame is B."""
        index = [rod.link for rod in rods]
        p, R = origins[:, index], turns[:, index]  # of the foot they are overwritten
        foot = np.array(index) < 0
        p[:, foot], R[:, foot] = 0.0, np.eye(3)
        start, end = (p + (R @ np.array(points)[:, :, None])[..., 0] for points in zip(*[rod[1:3] for rod in rods], strict=True))
        return start, end


def _about_z(angle: Array) -> Array:
    """Turns about z (m, 3, 3)."""
    R = np.zeros((angle.size, 3, 3))
    R[:, 0, 0] = R[:, 1, 1] = np.cos(angle)
    R[:, 1, 0] = np.sin(angle)
    R[:, 0, 1] = -R[:, 1, 0]
    R[:, 2, 2] = 1.0
    return R


def apart(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Least distance between the lines from `a` to `b` and from `c` to `d`, all (..., 3) [m].

    Source: C. Ericson, Real-Time Collision Detection (2005), 5.1.9.
    """
    u, v, w = b - a, d - c, a - c
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    uw, vw = _dot(u, w), _dot(v, w)
    square = uu * vv - uv * uv
    s = np.where(square > THIN * uu * vv, np.clip((uv * vw - uw * vv) / np.where(square > 0.0, square, 1.0), 0.0, 1.0), 0.0)
    t = np.clip((uv * s + vw) / np.maximum(vv, THIN), 0.0, 1.0)
    s = np.clip((uv * t - uw) / np.maximum(uu, THIN), 0.0, 1.0)
    return np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)


def _dot(a: Array, b: Array) -> Array:
    return np.sum(a * b, axis=-1)
