"""Kinematics of the tool centre point, compiled: pose, Jacobian, and joint speeds for a twist."""

import math

import numpy as np

from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record
from sim.rigid_body.cholesky import factor, solve
from sim.rigid_body.newton_euler import cross, place, turned

SINGULAR = 0.02
"""Smallest singular value of the tool's Jacobian (m and rad alike) that a way may pass: shoulder, elbow or wrist aligned."""

DAMPING = 1e-8
"""Of the inverse of the Jacobian. It bites near a singularity alone, where a plan has been refused already."""


def tool_record(n: int) -> Record:
    """Scratch of n joints: tool centre point in F, its pose in B and Jacobian, and what is solved with it."""
    return record(
        tcp=(3,), p=(3,), R=(3, 3), jacobian=(6, n), origins=(n, 3), normal=(n, n), twist=(6,), R_goal=(3, 3), goal=(6, 3)
    )


# Loops over scalars, and a solver of our own: the compiled products and solvers of numpy cost a fresh installation ten seconds.


@kernel
def look(models, q) -> None:
    """Pose and Jacobian of the tool centre point at q, in axes of B. `models`: the rigid model's record, and `tool_record`."""
    chain, own = models[0][0], models[1][0]
    n = q.size
    p, R, jacobian, origins = own.p, own.R, own.jacobian, own.origins
    here, behind, R_here, R_behind = np.empty(3), np.zeros(3), np.empty((3, 3)), np.eye(3)
    for i in range(n):
        place(chain, i, (behind, R_behind), (here, R_here))
        c, s = math.cos(q[i]), math.sin(q[i])
        for k in range(3):
            x, y = R_here[k, 0], R_here[k, 1]
            R_behind[k, 0], R_behind[k, 1], R_behind[k, 2] = c * x + s * y, c * y - s * x, R_here[k, 2]
            origins[i, k] = behind[k] = here[k]
            jacobian[3 + k, i] = R_here[k, 2]
    place(chain, n, (behind, R_behind), (p, R))
    lever = turned(R, own.tcp)
    for k in range(3):
        p[k] += lever[k]
    for i in range(n):
        arm = (p[0] - origins[i, 0], p[1] - origins[i, 1], p[2] - origins[i, 2])
        linear = cross((jacobian[3, i], jacobian[4, i], jacobian[5, i]), arm)
        for k in range(3):
            jacobian[k, i] = linear[k]


@kernel
def factored(own) -> None:
    """Factor the damped J^T J."""
    jacobian, normal = own.jacobian, own.normal
    n = jacobian.shape[1]
    for i in range(n):
        for j in range(i + 1):
            normal[i, j] = DAMPING if i == j else 0.0
            for r in range(6):
                normal[i, j] += jacobian[r, i] * jacobian[r, j]
    factor(normal, n)


@kernel
def inverted(own, qd) -> None:
    """Joint speeds of the twist, after `factored`."""
    jacobian, twist = own.jacobian, own.twist
    n = jacobian.shape[1]
    for i in range(n):
        qd[i] = 0.0
        for r in range(6):
            qd[i] += jacobian[r, i] * twist[r]
    solve(own.normal, qd, n)


@kernel
def aligned(jacobian):
    """Whether J J^T less the square of `SINGULAR` has a pivot that is not positive."""
    n = jacobian.shape[1]
    a = np.empty((6, 6))
    for i in range(6):
        for j in range(i + 1):
            rest = -SINGULAR * SINGULAR if i == j else 0.0
            for k in range(n):
                rest += jacobian[i, k] * jacobian[j, k]
            for k in range(j):
                rest -= a[i, k] * a[j, k]
            if i == j:
                if not rest > 0.0:
                    return True
                a[i, i] = math.sqrt(rest)
            else:
                a[i, j] = rest / a[j, j]
    return False
