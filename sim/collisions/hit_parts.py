"""Which part of the arm a contact meets, by the torques of all joints: a probability for each part (RL-3).

A contact with a link presses on one of its shapes, a capsule about a segment: its force f goes through a point p of the segment
and stands across it, but for friction. Before it is felt, f has no other direction of its own: f ~ N(0, C) with

    C = F² (I - (1 - mu²) a a^T)        a: direction of the segment, F: usual size of the force, mu: friction

It makes the torques J^T f, J the Jacobian of p, with none beyond the link. What is felt beside them is the error of each torque,
of variance D. So the torques r have for this p the density N(r; 0, D + J^T C J), of which

    ln N = const + b^T A^-1 b / 2 - ln det A / 2        A = C^-1 + J D^-1 J^T,  b = J D^-1 r

The probability of a part is the sum of this over points of all its shapes, each as likely as its length is. A part that explains
the torques by few of the forces that it could meet counts for less: what would be a coincidence is not taken for the cause.

Source: Bayes' rule for hypotheses that are linear in unknowns with a normal distribution: Rasmussen, Williams, Gaussian Processes
for Machine Learning, 2006, equations 2.43, A.9 and A.10. The forces: as in `sim.collisions.link_force`.
"""

import math

import numpy as np

from sim.arm.arm_file import Arm
from sim.arm.frames import hulls
from sim.collisions.link_force import since_rest
from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record
from sim.estimation.torque_errors import CAUSES, left_over, noise, variance

PARTS = 3
"""Elbow with the upper arm, forearm, wrist."""

POINTS = 8  # of each shape
USUAL = 2.0
"""Times the least force that explains what is felt: a force is seldom across the longest lever, as the least one is."""
FRICTION = 0.4  # of what the arm meets, and of where the ends of shapes are round
SHARE = 0.05
"""Of a torque that it may be wrong by beside its error at rest: gears and motor constants as far as they are known."""
ON_AXIS = 1e-3  # so near a shape lies to a joint's axis that is its housing [m]


def hit_shapes(arm: Arm) -> Record:
    """The shapes that a contact with a link may press on, for `hit_parts`. The elbow's housing is the elbow on either side."""
    elbow = arm.chain.elbow
    shapes = [shape for shape in hulls(arm) if shape.link > 0]
    count = max(len(shapes), 1)
    made = record(link=f"{count}i8", part=f"{count}i8", start=(count, 3), way=(count, 3), length=(count,), count="i8")
    own = made[0]
    own["count"] = len(shapes)
    for k, shape in enumerate(shapes):
        start, end = np.array(shape.start), np.array(shape.end)
        housing = math.hypot(*start[:2]) < ON_AXIS and math.hypot(*end[:2]) < ON_AXIS
        own["link"][k], own["start"][k], own["way"][k] = shape.link, start, end - start
        own["part"][k] = 0 if shape.link < elbow or (shape.link == elbow and housing) else 1 if shape.link == elbow else 2
        own["length"][k] = np.linalg.norm(end - start) + shape.radius
    return made


@kernel
def hit_parts(models, shapes, force):
    """Probability of each of the `PARTS`; of none where the arm has no shapes.

    Args:
        models: records of the rigid model's recursion, of the momentum observer and of its errors.
        shapes: `hit_shapes`.
        force: least force that explains what is felt [N].
    """
    rigid, momentum, errors = models[0][0], models[1][0], models[2][0]
    own, n = shapes[0], momentum.residual.size
    if own.count == 0:
        return 0.0, 0.0, 0.0
    felt, certainty = np.empty(n), np.empty(n)
    change = np.empty(CAUSES)
    for i in range(n):
        residual, causes = momentum.residual[i], errors.causes[i]
        unexplained = noise(errors, momentum.doubt[i], causes[0])
        felt[i] = since_rest(errors, i, residual, change)
        unsure = momentum.held[i] ** 2 / 3.0  # of a uniform error; a change has two of them
        whole, error = variance(errors, i, causes) + unsure, variance(errors, i, change) + 2.0 * unsure
        if whole < error:
            felt[i], error = left_over(errors.shares[i], residual, causes), whole
        certainty[i] = 1.0 / (error + unexplained + (SHARE * felt[i]) ** 2)
    size, odds = USUAL * force, np.full(PARTS, -math.inf)
    for k in range(own.count):
        for point in range(POINTS):
            evidence = _evidence(rigid, (own.link[k], own.start[k], own.way[k], (point + 0.5) / POINTS), size, (felt, certainty))
            odds[own.part[k]] = _either(odds[own.part[k]], evidence + math.log(own.length[k]))
    most, total = max(odds[0], odds[1], odds[2]), 0.0
    for k in range(PARTS):
        odds[k] = math.exp(odds[k] - most)
        total += odds[k]
    return odds[0] / total, odds[1] / total, odds[2] / total


@kernel
def _either(a, b):
    """ln(e^a + e^b)."""
    high, low = max(a, b), min(a, b)
    return high + math.log1p(math.exp(low - high))


@kernel
def _evidence(rigid, place, force, torques):
    """b^T A^-1 b / 2 - ln det A / 2 of a point of a shape."""
    link, start, way, share = place
    felt, certainty = torques
    R, origin = rigid.turns[link], rigid.origins[link]
    p, a = np.empty(3), np.empty(3)
    size = math.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2])
    for k in range(3):
        p[k], a[k] = origin[k], 0.0
        for m in range(3):
            p[k] += R[k, m] * (start[m] + share * way[m])
            a[k] += R[k, m] * way[m] / size if size > 0.0 else 0.0  # a ball has no axis: it is pressed on from anywhere
    A, b, column = np.zeros((3, 3)), np.zeros(3), np.empty(3)
    for k in range(3):
        A[k, k] = 1.0 / (force * force)
        for m in range(3):
            A[k, m] += (1.0 / (FRICTION * FRICTION) - 1.0) * a[k] * a[m] / (force * force)
    for i in range(link + 1):
        x, y, z = p[0] - rigid.origins[i, 0], p[1] - rigid.origins[i, 1], p[2] - rigid.origins[i, 2]
        u, v, w = rigid.jacobian[3, i], rigid.jacobian[4, i], rigid.jacobian[5, i]
        column[0], column[1], column[2] = v * z - w * y, w * x - u * z, u * y - v * x
        for k in range(3):
            b[k] += column[k] * certainty[i] * felt[i]
            for m in range(3):
                A[k, m] += column[k] * certainty[i] * column[m]
    # Cholesky's factors L of A: b^T A^-1 b = |L^-1 b|², and ln det A = 2 ln of the product of their diagonal.
    l00 = math.sqrt(A[0, 0])
    l10, l20 = A[1, 0] / l00, A[2, 0] / l00
    l11 = math.sqrt(A[1, 1] - l10 * l10)
    l21 = (A[2, 1] - l20 * l10) / l11
    l22 = math.sqrt(A[2, 2] - l20 * l20 - l21 * l21)
    x = b[0] / l00
    y = (b[1] - l10 * x) / l11
    z = (b[2] - l20 * x - l21 * y) / l22
    return 0.5 * (x * x + y * y + z * z) - math.log(l00 * l11 * l22)
