"""What hands do to the true arm in a tick: wrenches and virtual springs at points of its parts, as MuJoCo takes them."""

import math
from collections.abc import Mapping, Sequence

import mujoco
import numba
import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.plant.touch import ZERO, Pull, Touch, Triple

Array = NDArray[np.float64]

STIFFNESS = 800.0  # of a virtual hand [N/m]
DAMPING = 40.0  # of a virtual hand [N·s/m]
RESPONSE = 0.03
"""Time constant with which a virtual hand goes to where it is wanted [s]. A page tells it 20 times a second; without that each
time would be a step of force, which no arm of flesh can do and a falling payload does."""

_FOLLOWS = 1.0 - math.exp(-TICK / RESPONSE)


class Hands:
    """Applies touches to the bodies of a model.

    Attributes:
        touched: what acted in the last tick: part, point in W [m], force [N] and torque [N·m] in W.

    Args:
        model, data: MuJoCo's.
        parts: number of the body that each part is.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, parts: Mapping[str, int]) -> None:
        self._parts = parts
        self._roots: list[int] = model.body_rootid.tolist()
        self._motion = (data.cvel, data.subtree_com)
        self._poses = (data.xpos, data.xmat, data.xipos)
        self._applied = data.xfrc_applied
        self._pushed: set[int] = set()
        self._goes: dict[tuple[str, Triple], Triple] = {}  # where each pull has come to by now, in W [m]
        self.touched: tuple[tuple[str, Triple, Triple, Triple], ...] = ()

    def apply(self, touches: Sequence[Touch]) -> None:
        """Put the wrenches of a tick into `xfrc_applied`.

        Raises:
            KeyError: a touch names a part that does not exist.
        """
        applied, pushed = self._applied, self._pushed
        if pushed:
            for body in pushed:
                applied[body] = 0.0
            pushed.clear()
        went, self._goes = self._goes, {}
        if not touches:
            self.touched = ()
            return
        seen = []
        for touch in touches:
            body = self._parts[touch.part]
            if isinstance(touch, Pull):
                spring = map(float, (*touch.point, *self._reach(touch, body, went), touch.cap))
                point, force = _pull(*self._poses, *self._motion, self._roots[body], body, applied, *spring)
                torque = ZERO
            else:
                force, torque = _floats(touch.force), _floats(touch.torque)
                point = _push(*self._poses, body, applied, *map(float, (*touch.point, *force, *torque)))
            pushed.add(body)
            seen.append((touch.part, point, force, torque))
        self.touched = tuple(seen)

    def _reach(self, pull: Pull, body: int, went: Mapping[tuple[str, Triple], Triple]) -> Triple:
        """Where a pull has come to in this tick, in W [m]; it begins where it takes hold."""
        hold = pull.part, pull.point
        x, y, z = went.get(hold) or _at(self._poses[0], self._poses[1], body, *_floats(pull.point))
        a, b, c = pull.target
        self._goes[hold] = goes = (x + _FOLLOWS * (a - x), y + _FOLLOWS * (b - y), z + _FOLLOWS * (c - z))
        return goes

    def velocity(self, body: int, point: Array) -> Array:
        """True linear velocity (3,) in W of a point (3,) in W of a body [m/s]."""
        return np.array(_velocity(*self._motion, self._roots[body], body, _floats(point)))


def _floats(three: Sequence[float] | Array) -> Triple:
    x, y, z = three
    return float(x), float(y), float(z)


# Numba: arrays are written in place.


@numba.njit(cache=True)
def _velocity(cvel, tree_com, root, body, point):
    """MuJoCo keeps a body's motion as angular and linear velocity at the centre of mass of its tree."""
    wx, wy, wz, vx, vy, vz = cvel[body]
    x, y, z = point[0] - tree_com[root, 0], point[1] - tree_com[root, 1], point[2] - tree_com[root, 2]
    return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x


@numba.njit(cache=True)
def _at(positions, orientations, body, x, y, z):
    """Where a point (x, y, z) of a body is."""
    p, R = positions[body], orientations[body]
    return (
        p[0] + R[0] * x + R[1] * y + R[2] * z,
        p[1] + R[3] * x + R[4] * y + R[5] * z,
        p[2] + R[6] * x + R[7] * y + R[8] * z,
    )


@numba.njit(cache=True)
def _push(positions, orientations, centres, body, applied, x, y, z, fx, fy, fz, tx, ty, tz):
    """Add a wrench at a point (x, y, z) of a body; returns the point in W."""
    c, w = centres[body], applied[body]
    px, py, pz = _at(positions, orientations, body, x, y, z)
    x, y, z = px - c[0], py - c[1], pz - c[2]
    w[0] += fx
    w[1] += fy
    w[2] += fz
    w[3] += tx + y * fz - z * fy
    w[4] += ty + z * fx - x * fz
    w[5] += tz + x * fy - y * fx
    return px, py, pz


@numba.njit(cache=True)
def _pull(positions, orientations, centres, cvel, tree_com, root, body, applied, x, y, z, to_x, to_y, to_z, cap):
    """Spring and damper of a virtual hand; the cap holds the whole force, so a far cursor pulls no harder."""
    point = _push(positions, orientations, centres, body, applied, x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    vx, vy, vz = _velocity(cvel, tree_com, root, body, point)
    fx = STIFFNESS * (to_x - point[0]) - DAMPING * vx
    fy = STIFFNESS * (to_y - point[1]) - DAMPING * vy
    fz = STIFFNESS * (to_z - point[2]) - DAMPING * vz
    size = np.sqrt(fx * fx + fy * fy + fz * fz)
    share = cap / size if size > cap else 1.0
    fx, fy, fz = fx * share, fy * share, fz * share
    _push(positions, orientations, centres, body, applied, x, y, z, fx, fy, fz, 0.0, 0.0, 0.0)
    return point, (fx, fy, fz)
