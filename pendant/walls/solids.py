"""Signed distance of sphere, box, cylinder, cone and half-space, each centred on the origin, its axis along z (VW-1).

A field takes a point [m] and returns the signed distance to the surface [m], negative inside, and its gradient, of length 1
everywhere. Where several surface points are equally near, as at the centre of a sphere, the gradient is that of one of them.
"""

import math
from collections.abc import Callable

from pendant.tick.pose import Vector

Signed = tuple[float, float, float, float]  # distance, then gradient
Field = Callable[[float, float, float], Signed]


def sphere(radius: float) -> Field:
    """A sphere."""

    def field(x: float, y: float, z: float) -> Signed:
        far = math.sqrt(x * x + y * y + z * z)
        if far == 0.0:
            return -radius, 0.0, 0.0, 1.0
        return far - radius, x / far, y / far, z / far

    return field


def half_space(normal: Vector, distance: float) -> Field:
    """The side of a plane that its normal, of any length but 0, points away from; `distance` is the plane's from the origin."""
    length = math.hypot(*normal)
    nx, ny, nz = normal[0] / length, normal[1] / length, normal[2] / length

    def field(x: float, y: float, z: float) -> Signed:
        return nx * x + ny * y + nz * z - distance, nx, ny, nz

    return field


def box(size: Vector) -> Field:
    """A box with edges of the lengths `size` along the axes."""
    a, b, c = 0.5 * size[0], 0.5 * size[1], 0.5 * size[2]

    def field(x: float, y: float, z: float) -> Signed:
        dx, dy, dz = abs(x) - a, abs(y) - b, abs(z) - c
        if dx <= 0.0 and dy <= 0.0 and dz <= 0.0:
            if dx >= dy and dx >= dz:
                return dx, math.copysign(1.0, x), 0.0, 0.0
            if dy >= dz:
                return dy, 0.0, math.copysign(1.0, y), 0.0
            return dz, 0.0, 0.0, math.copysign(1.0, z)
        dx, dy, dz = max(dx, 0.0), max(dy, 0.0), max(dz, 0.0)
        far = math.hypot(dx, dy, dz)
        return far, math.copysign(dx / far, x), math.copysign(dy / far, y), math.copysign(dz / far, z)

    return field


def cylinder(radius: float, height: float) -> Field:
    """A cylinder."""
    half = 0.5 * height

    def field(x: float, y: float, z: float) -> Signed:
        rho = math.sqrt(x * x + y * y)
        out, up = rho - radius, abs(z) - half
        if out <= 0.0 or up <= 0.0:
            distance, along, across = (up, 1.0, 0.0) if up >= out else (out, 0.0, 1.0)
        else:
            distance = math.hypot(out, up)
            along, across = up / distance, out / distance
        return _round(x, y, rho, distance=distance, across=across, along=math.copysign(along, z))

    return field


def cone(radius: float, height: float) -> Field:
    """A cone: its base at z = -height / 2, its tip at z = height / 2."""
    half, slant = 0.5 * height, math.hypot(radius, height)
    nr, nz = height / slant, radius / slant  # normal of the side in the half-plane (rho, z); (nz, -nr) runs from tip to rim

    def field(x: float, y: float, z: float) -> Signed:
        rho = math.sqrt(x * x + y * y)
        side, base = nr * rho + nz * (z - half), -half - z
        along = nz * rho - nr * (z - half)
        if side <= 0.0 and base <= 0.0:
            if base >= side:
                return base, 0.0, 0.0, -1.0
            return _round(x, y, rho, distance=side, across=nr, along=nz)
        if along < 0.0:
            dr, dz = rho, z - half  # from the tip
        elif along <= slant and side > 0.0:
            return _round(x, y, rho, distance=side, across=nr, along=nz)
        elif rho <= radius:
            return base, 0.0, 0.0, -1.0
        else:
            dr, dz = rho - radius, z + half  # from the rim
        distance = math.hypot(dr, dz)
        return _round(x, y, rho, distance=distance, across=dr / distance, along=dz / distance)

    return field


def _round(x: float, y: float, rho: float, *, distance: float, across: float, along: float) -> Signed:
    """The half-plane's gradient (across, along) turned about z to the point."""
    if rho == 0.0:
        return distance, across, 0.0, along
    return distance, across * x / rho, across * y / rho, along
