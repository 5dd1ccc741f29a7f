"""What locked axes ask of the tool's pose: functions that are to stay 0, and how the joints change them (FD-4).

A locked way is the way along its axis. Of three locked turns each is twice the vector part of the turn's quaternion; of two, the
tilt of the free axis; one alone is the twist about its axis. So a free turn may be large, and every row is an exact derivative.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.control.singularity import LENGTH

Array = NDArray[np.float64]


class ToolPose(NamedTuple):
    """Where the tool is, in axes of B."""

    p_BF: Array  # flange (3,) [m]
    R: Array  # and its orientation (3, 3)
    tcp: Array  # tool centre point in F (3,) [m]
    jacobian: Array  # of the flange (6, n), linear first


@kernel
def _quaternion(R):
    """(w, x, y, z) of a rotation matrix, w not negative."""
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    if trace > 0.0:
        s = 2.0 * math.sqrt(1.0 + trace)
        return 0.25 * s, (R[2, 1] - R[1, 2]) / s, (R[0, 2] - R[2, 0]) / s, (R[1, 0] - R[0, 1]) / s
    i = 0
    for k in range(1, 3):
        if R[k, k] > R[i, i]:
            i = k
    j, k = (i + 1) % 3, (i + 2) % 3
    s = 2.0 * math.sqrt(max(1.0 + R[i, i] - R[j, j] - R[k, k], 1e-12))
    v = np.empty(3)
    v[i], v[j], v[k] = 0.25 * s, (R[j, i] + R[i, j]) / s, (R[k, i] + R[i, k]) / s
    w = (R[k, j] - R[j, k]) / s
    if w < 0.0:
        return -w, -v[0], -v[1], -v[2]
    return w, v[0], v[1], v[2]


@kernel
def _tilts(own, turned, rows, m) -> int:
    """The rows of two locked turns: the free axis must not tilt."""
    locked, frame, values = own.locked, own.frame, own.values
    f = 0
    for k in range(3):
        if not locked[3 + k]:
            f = k
    ax, ay, az = frame[0, f], frame[1, f], frame[2, f]
    now = np.empty(3)
    for k in range(3):
        now[k] = turned[k, 0] * ax + turned[k, 1] * ay + turned[k, 2] * az
    upright = ax * now[0] + ay * now[1] + az * now[2]
    tx, ty, tz = ay * now[2] - az * now[1], az * now[0] - ax * now[2], ax * now[1] - ay * now[0]
    for k in range(3):
        if locked[3 + k]:
            bx, by, bz = frame[0, k], frame[1, k], frame[2, k]
            along = bx * now[0] + by * now[1] + bz * now[2]
            values[m] = bx * tx + by * ty + bz * tz
            rows[m, 3] = upright * bx - along * ax
            rows[m, 4] = upright * by - along * ay
            rows[m, 5] = upright * bz - along * az
            m += 1
    return m


@kernel
def _turns(own, R, rows, m) -> int:
    """Add the rows of the locked turns, by the angular velocity in B, and their values [rad]; the number of all rows."""
    locked, frame, turn, values = own.locked, own.frame, own.turn, own.values
    count = 0
    for k in range(3):
        count += locked[3 + k]
    if count == 0:
        return m
    turned = np.empty((3, 3))  # since the beginning, in B
    for j in range(3):
        for k in range(3):
            turned[j, k] = R[j, 0] * turn[k, 0] + R[j, 1] * turn[k, 1] + R[j, 2] * turn[k, 2]
    if count == 2:
        return _tilts(own, turned, rows, m)
    w, x, y, z = _quaternion(turned)
    for k in range(3):
        if not locked[3 + k]:
            continue
        bx, by, bz = frame[0, k], frame[1, k], frame[2, k]
        along = x * bx + y * by + z * bz
        cx, cy, cz = y * bz - z * by, z * bx - x * bz, x * by - y * bx
        if count == 3:  # no turn at all
            values[m] = 2.0 * along
            rows[m, 3], rows[m, 4], rows[m, 5] = w * bx + cx, w * by + cy, w * bz + cz
        else:  # no twist about the one axis
            size = max(w * w + along * along, 0.01)
            values[m] = 2.0 * math.atan2(along, w)
            rows[m, 3] = (w * w * bx + w * cx + along * x) / size
            rows[m, 4] = (w * w * by + w * cy + along * y) / size
            rows[m, 5] = (w * w * bz + w * cz + along * z) / size
        m += 1
    return m


@kernel
def constraint(own, pose) -> int:
    """Fill the constraint's `rows` (m, n) and its `values` (m,) [m], turns as ways; m is the number of locked axes.

    `own` says what is locked, and frame, orientation and place of the tool when it was (sim.control.axis_constraint).
    """
    pose = ToolPose(*pose)
    p_BF, R, tcp, jacobian = pose
    locked, frame, place, G, values = own.locked, own.frame, own.place, own.rows, own.values
    rows = np.zeros((6, 6))
    offset = np.empty(3)
    for k in range(3):
        offset[k] = R[k, 0] * tcp[0] + R[k, 1] * tcp[1] + R[k, 2] * tcp[2]
    m = 0
    for k in range(3):
        if locked[k]:
            values[m] = 0.0
            for j in range(3):
                rows[m, j] = frame[j, k]
                values[m] += frame[j, k] * (p_BF[j] + offset[j] - place[j])
            m += 1
    ways = m
    m = _turns(own, R, rows, m)
    for r in range(ways, m):
        values[r] *= LENGTH
        for k in range(3, 6):
            rows[r, k] *= LENGTH
    for i in range(jacobian.shape[1]):
        wx, wy, wz = jacobian[3, i], jacobian[4, i], jacobian[5, i]
        vx = jacobian[0, i] + wy * offset[2] - wz * offset[1]
        vy = jacobian[1, i] + wz * offset[0] - wx * offset[2]
        vz = jacobian[2, i] + wx * offset[1] - wy * offset[0]
        for r in range(m):
            G[r, i] = rows[r, 0] * vx + rows[r, 1] * vy + rows[r, 2] * vz
            G[r, i] += rows[r, 3] * wx + rows[r, 4] * wy + rows[r, 5] * wz
    return m
