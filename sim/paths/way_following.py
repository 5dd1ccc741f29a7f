"""Following a way of the tool, compiled: joint angles with the tool at a place of it, and how they go on from there."""

import math

import numpy as np

from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record
from sim.paths.tool_kinematics import aligned, factored, inverted, look
from sim.rigid_body.cholesky import solve
from sim.rigid_body.newton_euler import cross, turned

NEWTON_STEPS = 12
"""Of the search for the joint angles of a pose, at most: from within a tick it needs one or two."""

CLOSE = 1e-7
"""A step of that search that is the last one: the error after it is about its square [rad]."""

LEAP = 0.1
"""By so much a joint goes at most from where the search begins to where it ends [rad]."""

MOST_LEAPS = 50
"""Of them, between two places."""

SPATIAL = 6
"""Degrees of freedom of a pose; an arm with more joints has some left."""

ASIDE = 1e-4
"""Of a piece's length: over which the change of its turning is measured."""


def piece_record() -> Record:
    """A piece of a way of the tool, in axes of B, by its length s [m]; its numbers are zero.

        p(s) = p + s u + cos(k s) out + sin(k s) aside        R(s) = R exp(c0 + c1 s + c2 s² + c3 s³)

    Lines have no k, circles no u; p is the tool centre point, R the orientation of the flange, c axis times angle in F.
    """
    return record(p=(3,), u=(3,), out=(3,), aside=(3,), k=(), R=(3, 3), c=(4, 3), length=(), turns_evenly="i8")


@kernel
def follow(models, place, before, found):
    """Joint angles with the tool at a place of a way, and how they go on along it; whether they are found.

    Args:
        models: the rigid model's record, and `tool_record`.
        place: the piece's record, and how far it is gone [m].
        before: how much further than at a place before [m], and joint angles, their first and second derivatives there.
        found: the angles and their derivatives along the way (3, n); filled.

    Returns:
        The last correction of the angles [rad], and whether the tool cannot go everywhere from there.
    """
    piece, s = place
    own, way = models[1][0], piece[0]
    step, q_before, rate_before, bend_before = before
    q, rate, bend = found[0], found[1], found[2]
    n = q.size
    farthest = 0.0
    for i in range(n):
        q[i] = q_before[i] + step * (rate_before[i] + 0.5 * step * bend_before[i])
        farthest = max(farthest, abs(step * rate_before[i]))
    if farthest > LEAP:
        # So far away only the places between lead to the same posture of the arm.
        leaps = int(min(farthest / LEAP, MOST_LEAPS)) + 1
        for i in range(n):
            q[i] = q_before[i]
        for k in range(1, leaps):
            _goal(own, way, s - step * (1.0 - k / leaps))
            _search(models, q, rate)
    _goal(own, way, s)
    off = _search(models, q, rate)
    # The place after a last correction as small as that has the same Jacobian.
    goal, twist = own.goal, own.twist
    for k in range(3):
        twist[k], twist[3 + k] = goal[2, k], goal[3, k]
    inverted(own, rate)
    _bias(own, rate, bend)
    return off * off if off <= CLOSE else off, aligned(own.jacobian)


@kernel
def _search(models, q, change):
    """Change q so that the tool is at the goal; returns the last correction [rad]."""
    own = models[1][0]
    off = math.inf
    for _ in range(NEWTON_STEPS):
        look(models, q)
        _miss(own)
        factored(own)
        inverted(own, change)
        off = 0.0
        for i in range(q.size):
            q[i] += change[i]
            off += abs(change[i])
        if not off > CLOSE:
            break
    return off


@kernel
def _bias(own, rate, bend) -> None:
    """Second derivative (n,) of the joint angles, which go by q' = J^T y with J J^T y = x'.

    J q'' = x'' - J' q' has its shortest solution, and with more than six joints what J does not see of J'^T y besides.
    """
    jacobian, origins, goal, twist = own.jacobian, own.origins, own.goal, own.twist
    p = own.p
    n = rate.size
    for k in range(3):
        twist[k], twist[3 + k] = goal[4, k], goal[5, k]
    w, v, last = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    tip, y, free = np.zeros(3), np.zeros(6), np.zeros(n)
    if n > SPATIAL:
        _shortest(own, rate, y)
    for i in range(n):
        for k in range(3):
            tip[k] += jacobian[k, i] * rate[i]
    for i in range(n):
        here = (origins[i, 0], origins[i, 1], origins[i, 2])
        swing = cross(w, (here[0] - last[0], here[1] - last[1], here[2] - last[2]))
        v = (v[0] + swing[0], v[1] + swing[1], v[2] + swing[2])
        z = (jacobian[3, i], jacobian[4, i], jacobian[5, i])
        turning = cross(w, z)
        first = cross(turning, (p[0] - here[0], p[1] - here[1], p[2] - here[2]))
        second = cross(z, (tip[0] - v[0], tip[1] - v[1], tip[2] - v[2]))
        for k in range(3):
            twist[k] -= rate[i] * (first[k] + second[k])
            twist[3 + k] -= rate[i] * turning[k]
            free[i] += y[k] * (first[k] + second[k]) + y[3 + k] * turning[k]
        w = (w[0] + z[0] * rate[i], w[1] + z[1] * rate[i], w[2] + z[2] * rate[i])
        last = here
    inverted(own, bend)
    if n > SPATIAL:
        add_unseen(own, free, bend)


@kernel
def _shortest(own, rate, y) -> None:
    """The y (6,) of which `rate` (n,) is J^T y."""
    jacobian = own.jacobian
    n = rate.size
    x = rate.copy()
    solve(own.normal, x, n)
    for r in range(SPATIAL):
        for i in range(n):
            y[r] += jacobian[r, i] * x[i]


@kernel
def add_unseen(own, free, change) -> None:
    """Add to `change` (n,) what of `free` (n,) moves no tool; J is that of the place found last."""
    jacobian, twist = own.jacobian, own.twist
    seen = np.empty(free.size)
    for r in range(SPATIAL):
        twist[r] = 0.0
        for i in range(free.size):
            twist[r] += jacobian[r, i] * free[i]
    inverted(own, seen)
    for i in range(free.size):
        change[i] += free[i] - seen[i]


@kernel
def _goal(own, way, s) -> None:
    """Place (its position, axis times angle of its turn in R), and first and second derivatives of both, in axes of B."""
    goal = own.goal
    c, d = math.cos(way.k * s), math.sin(way.k * s)
    for i in range(3):
        goal[0, i] = way.p[i] + s * way.u[i] + c * way.out[i] + d * way.aside[i]
        goal[1, i] = way.c[0, i] + s * (way.c[1, i] + s * (way.c[2, i] + s * way.c[3, i]))
        goal[2, i] = way.u[i] + way.k * (c * way.aside[i] - d * way.out[i])
        goal[4, i] = -way.k * way.k * (c * way.out[i] + d * way.aside[i])
    turning = (way.c[1, 0], way.c[1, 1], way.c[1, 2])
    change = (0.0, 0.0, 0.0)
    if way.turns_evenly == 0:
        h = ASIDE * way.length
        before, after = _body_rate(way, s - h), _body_rate(way, s + h)
        turning = _body_rate(way, s)
        change = ((after[0] - before[0]) / (2 * h), (after[1] - before[1]) / (2 * h), (after[2] - before[2]) / (2 * h))
    _turn(own, way, (goal[1, 0], goal[1, 1], goal[1, 2]))
    w, alpha = turned(own.R_goal, turning), turned(own.R_goal, change)
    for i in range(3):
        goal[3, i], goal[5, i] = w[i], alpha[i]


@kernel
def _body_rate(way, s):
    """Angular velocity in turned axes, by the right Jacobian of SO(3) [rad/m]."""
    x, y = np.empty(3), np.empty(3)
    for i in range(3):
        x[i] = way.c[0, i] + s * (way.c[1, i] + s * (way.c[2, i] + s * way.c[3, i]))
        y[i] = way.c[1, i] + s * (2.0 * way.c[2, i] + 3.0 * s * way.c[3, i])
    angle = math.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    first, second = 0.5, 1.0 / 6.0
    if angle > 1e-3:
        first, second = (1.0 - math.cos(angle)) / angle**2, (angle - math.sin(angle)) / angle**3
    once = cross(x, y)
    twice = cross(x, once)
    return (
        y[0] - first * once[0] + second * twice[0],
        y[1] - first * once[1] + second * twice[1],
        y[2] - first * once[2] + second * twice[2],
    )


@kernel
def _turn(own, way, turn) -> None:
    """The orientation R exp(turn) of the goal, by Rodrigues' formula, into `R_goal`."""
    R, goal = way.R, own.R_goal
    angle = math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2])
    x, y, z = turn
    if angle > 1e-12:
        x, y, z = x / angle, y / angle, z / angle
    sine, versed = math.sin(angle), 2.0 * math.sin(0.5 * angle) ** 2
    a = turned(R, (1.0 - versed * (y * y + z * z), versed * x * y + sine * z, versed * x * z - sine * y))
    b = turned(R, (versed * x * y - sine * z, 1.0 - versed * (x * x + z * z), versed * y * z + sine * x))
    c = turned(R, (versed * x * z + sine * y, versed * y * z - sine * x, 1.0 - versed * (x * x + y * y)))
    for i in range(3):
        goal[i, 0], goal[i, 1], goal[i, 2] = a[i], b[i], c[i]


@kernel
def _miss(own) -> None:
    """The twist that takes the tool to the goal: its way, and axis times angle, by less than half a turn, in axes of B."""
    goal, R, twist = own.goal, own.R, own.twist
    error = np.empty((3, 3))  # R_goal R^T
    for i in range(3):
        for j in range(3):
            error[i, j] = own.R_goal[i, 0] * R[j, 0] + own.R_goal[i, 1] * R[j, 1] + own.R_goal[i, 2] * R[j, 2]
    x, y, z = 0.5 * (error[2, 1] - error[1, 2]), 0.5 * (error[0, 2] - error[2, 0]), 0.5 * (error[1, 0] - error[0, 1])
    size = math.sqrt(x * x + y * y + z * z)
    scale = math.atan2(size, 0.5 * (error[0, 0] + error[1, 1] + error[2, 2] - 1.0)) / size if size > 1e-12 else 1.0
    turn = (scale * x, scale * y, scale * z)
    for k in range(3):
        twist[k], twist[3 + k] = goal[0, k] - own.p[k], turn[k]
