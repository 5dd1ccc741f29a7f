"""Signed distance of an ellipsoid (VW-1).

The nearest surface point of y has a normal along y_i / (x + a_i² - a_min²), where x > 0 solves
    sum (a_i y_i / (x + a_i² - a_min²))² = 1.
(D. Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid.) The inverse root of that sum is concave and
increasing in x (the secular equation of Moré and Sorensen), so Newton's method from below reaches the root in a few steps, never
beyond it, without a bracket. Measured along the unit normal n, the distance is n·y minus the ellipsoid's support
sqrt(sum a_i² n_i²), the largest such value of all n: a small error of n makes no error of first order.
"""

import math

from pendant.tick.pose import Vector
from pendant.walls.solids import Field, Signed

ON_PLANE = 1e-12  # of the shortest half-axis: a point this near to a plane of symmetry counts as this far from it
CLOSE = 1e-9  # relative: the last step of the root finding, whose error is about its square


def ellipsoid(radii: Vector) -> Field:
    """An ellipsoid with half-axes `radii` along the axes, centred on the origin; as all fields in pendant.walls.solids."""
    a, b, c = radii
    least = min(radii)
    aa, bb, cc = a * a, b * b, c * c
    ra, rb, rc = aa - least * least, bb - least * least, cc - least * least
    floor = ON_PLANE * least

    def field(px: float, py: float, pz: float) -> Signed:
        u, v, w = max(abs(px), floor), max(abs(py), floor), max(abs(pz), floor)
        au, bv, cw = a * u, b * v, c * w
        x = max(au - ra, bv - rb, cw - rc)  # one term is 1 there: at or below the root
        step = x
        while step > CLOSE * x:
            da, db, dc = x + ra, x + rb, x + rc
            ta, tb, tc = au / da, bv / db, cw / dc
            ta, tb, tc = ta * ta, tb * tb, tc * tc
            total = ta + tb + tc
            step = total * (math.sqrt(total) - 1.0) / (ta / da + tb / db + tc / dc)
            x += step
        nx, ny, nz = u / (x + ra), v / (x + rb), w / (x + rc)
        length = math.sqrt(nx * nx + ny * ny + nz * nz)
        nx, ny, nz = nx / length, ny / length, nz / length
        reach = math.sqrt(aa * nx * nx + bb * ny * ny + cc * nz * nz)
        distance = nx * abs(px) + ny * abs(py) + nz * abs(pz) - reach
        return distance, math.copysign(nx, px), math.copysign(ny, py), math.copysign(nz, pz)

    return field
