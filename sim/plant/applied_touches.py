"""What hands do to the true arm in a tick: wrenches and virtual springs at points of its parts, as MuJoCo takes them."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.compiled.kernel import kernel
from sim.plant.touch import ZERO, Pull, Touch, Triple

Array = NDArray[np.float64]

STIFFNESS = 800.0  # of a virtual hand [N/m]
DAMPING = 40.0
"""Of a virtual hand, at most [N·s/m]. On a part so light that this would turn its speed round within a tick, it is what takes the
speed away in one: a hand drives nothing that it damps."""

RESPONSE = 0.03
"""Time constant with which a virtual hand goes to where it is wanted [s]. A page tells it 20 times a second; without that each
time would be a step of force, which no arm of flesh can do and a falling payload does."""

WEIGHED = 10
"""Ticks between two looks at how light a part is where it is held, which changes with the posture only."""

_FOLLOWS = 1.0 - math.exp(-TICK / RESPONSE)


class Pulling(NamedTuple):
    """How a virtual hand holds in a tick."""

    point: Triple  # of the body [m]
    goes: Triple  # where it had come to a tick ago, in W [m]
    target: Triple  # where it is wanted, in W [m]
    cap: float  # largest force [N]
    damping: float  # [N·s/m]


class Bodies(NamedTuple):
    """Arrays of MuJoCo's, a body a row."""

    xpos: Array
    xmat: Array
    centres: Array  # of mass
    motion: Array  # angular, then linear, at the centre of mass of its tree
    trees: Array  # these centres
    applied: Array  # wrenches


class Hands:
    """Applies touches to the bodies of a model.

    Attributes:
        touched: what acted in the last tick: part, point in W [m], force [N] and torque [N·m] in W.

    Args:
        model, data: MuJoCo's.
        parts: number of the body that each part is.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, parts: Mapping[str, int]) -> None:
        self._parts, self._mujoco = parts, (model, data)
        self._jacobian, self._freed = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        self._roots: list[int] = model.body_rootid.tolist()
        self._bodies = (data.xpos, data.xmat, data.xipos, data.cvel, data.subtree_com, data.xfrc_applied)
        self._applied = data.xfrc_applied
        self._pushed: set[int] = set()
        # By part and point: where a hand had come to, its damping, ticks since the part was weighed.
        self._holds: dict[tuple[str, Triple], tuple[Triple, float, int]] = {}
        self.touched: tuple[tuple[str, Triple, Triple, Triple], ...] = ()

    def apply(self, touches: Sequence[Touch]) -> None:
        """Put the wrenches of a tick into `xfrc_applied`.

        Raises:
            KeyError: a touch names a part that does not exist.
        """
        bodies, pushed = self._bodies, self._pushed
        if pushed:
            for body in pushed:
                self._applied[body] = 0.0
            pushed.clear()
        before, self._holds = self._holds, {}
        if not touches:
            self.touched = ()
            return
        seen = []
        for touch in touches:
            body = self._parts[touch.part]
            if isinstance(touch, Pull):
                place = touch.part, touch.point
                at = _floats(touch.point)
                goes, damping, weighed = before.get(place) or (_at(bodies, body, at), 0.0, WEIGHED)
                if weighed == WEIGHED:
                    damping, weighed = self._damping(at, body), 0
                held = at, goes, _floats(touch.target), float(touch.cap), damping
                point, force, goes = _pull(bodies, self._roots[body], body, held)
                self._holds[place] = goes, damping, weighed + 1
                torque = ZERO
            else:
                force, torque = _floats(touch.force), _floats(touch.torque)
                point = _push(bodies, body, _floats(touch.point), (*force, *torque))
            pushed.add(body)
            seen.append((touch.part, point, force, torque))
        self.touched = tuple(seen)

    def _damping(self, point: Triple, body: int) -> float:
        """Of a hand that pulls at this point of the body [N·s/m]."""
        place = np.array(_at(self._bodies, body, point))
        mujoco.mj_jac(*self._mujoco, self._jacobian, None, place, body)
        mujoco.mj_solveM(*self._mujoco, self._freed, self._jacobian)
        return _stable(self._jacobian, self._freed)

    def velocity(self, body: int, point: Array) -> Array:
        """True linear velocity (3,) in W of a point (3,) in W of a body [m/s]."""
        return np.array(_velocity(self._bodies, self._roots[body], body, _floats(point)))


def _floats(three: Sequence[float] | Array) -> Triple:
    x, y, z = three
    return float(x), float(y), float(z)


# Numba: arrays are written in place.


@kernel
def _velocity(bodies, root, body, point):
    """MuJoCo keeps a body's motion as angular and linear velocity at the centre of mass of its tree."""
    bodies = Bodies(*bodies)
    wx, wy, wz, vx, vy, vz = bodies.motion[body]
    c = bodies.trees[root]
    x, y, z = point[0] - c[0], point[1] - c[1], point[2] - c[2]
    return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x


@kernel
def _at(bodies, body, point):
    """Where a point (3,) of a body is."""
    bodies = Bodies(*bodies)
    p, R = bodies.xpos[body], bodies.xmat[body]
    x, y, z = point
    return (
        p[0] + R[0] * x + R[1] * y + R[2] * z,
        p[1] + R[3] * x + R[4] * y + R[5] * z,
        p[2] + R[6] * x + R[7] * y + R[8] * z,
    )


@kernel
def _push(bodies, body, point, wrench):
    """Add a wrench (6,) at a point (3,) of a body; returns the point in W."""
    bodies = Bodies(*bodies)
    c, w = bodies.centres[body], bodies.applied[body]
    px, py, pz = _at(bodies, body, point)
    fx, fy, fz, tx, ty, tz = wrench
    x, y, z = px - c[0], py - c[1], pz - c[2]
    w[0] += fx
    w[1] += fy
    w[2] += fz
    w[3] += tx + y * fz - z * fy
    w[4] += ty + z * fx - x * fz
    w[5] += tz + x * fy - y * fx
    return px, py, pz


@kernel
def _stable(jacobian, freed):
    """Largest damping that turns no speed round in a tick, `DAMPING` at most.

    Of a point with the jacobian J (3, nv), a force f changes the velocity by J M^-1 J' f dt in a tick; `freed` is J M^-1. No
    direction is lighter than the largest sum of a row.
    """
    lightest = 0.0
    for i in range(3):
        row = 0.0
        for j in range(3):
            part = 0.0
            for k in range(jacobian.shape[1]):
                part += jacobian[i, k] * freed[j, k]
            row += abs(part)
        lightest = max(lightest, row)
    return min(DAMPING, 1.0 / (TICK * lightest)) if lightest > 0.0 else DAMPING


@kernel
def _pull(bodies, root, body, held):
    """Spring and damper of a virtual hand; the cap holds the whole force, so a far cursor pulls no harder.

    Returns the point that it holds, its force, and where it has come to.
    """
    bodies, held = Bodies(*bodies), Pulling(*held)
    x, y, z = held.goes
    a, b, c = held.target
    x, y, z = x + _FOLLOWS * (a - x), y + _FOLLOWS * (b - y), z + _FOLLOWS * (c - z)
    point = _push(bodies, body, held.point, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    vx, vy, vz = _velocity(bodies, root, body, point)
    fx = STIFFNESS * (x - point[0]) - held.damping * vx
    fy = STIFFNESS * (y - point[1]) - held.damping * vy
    fz = STIFFNESS * (z - point[2]) - held.damping * vz
    size = np.sqrt(fx * fx + fy * fy + fz * fz)
    share = held.cap / size if size > held.cap else 1.0
    fx, fy, fz = fx * share, fy * share, fz * share
    _push(bodies, body, held.point, (fx, fy, fz, 0.0, 0.0, 0.0))
    return point, (fx, fy, fz), (x, y, z)
