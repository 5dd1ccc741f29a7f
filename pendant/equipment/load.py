"""A rigid load on the flange: what it is made of, and whether there can be such a body."""

import math
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
from msgspec import Meta

from pendant.settings.bounds import FARTHEST, THINNEST, WIDEST, Angle, Coordinate, Mass, Moment

Vector = Annotated[list[Coordinate], Meta(min_length=3, max_length=3)]  # [m]
Angles = Annotated[list[Angle], Meta(min_length=3, max_length=3)]  # [rad]
Moments = Annotated[list[Moment], Meta(min_length=6, max_length=6)]  # ixx iyy izz ixy ixz iyz [kg·m²]


class Load(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A rigid load on the tool-side face of the flange. Without an inertia it counts as a sphere of 1 000 kg/m³."""

    mass: Mass  # [kg]
    com: Vector = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.05])  # centre of mass in F [m]
    inertia: Moments | None = None  # about the centre: ixx iyy izz ixy ixz iyz, axes of F [kg·m²]


NOTHING = Load(mass=0.0, com=[0.0, 0.0, 0.0])
"""No load."""


class Problem(NamedTuple):
    """What is wrong with a load or a tool."""

    field: str
    value: object
    allowed: str


def problem(load: Load, most: float) -> Problem | None:
    """Why there can be no such load on an arm, or None.

    Args:
        load: to look at.
        most: the heaviest that is allowed [kg].
    """
    if not 0.0 <= load.mass <= most:
        return Problem("mass", load.mass, f"0 .. {most:g} kg")
    return misplaced(load.com, "com") or strange(load.inertia, load.mass)


def misplaced(point: list[float], field: str) -> Problem | None:
    """Why `point` in F cannot be that of a load or a tool, or None."""
    for axis, way in enumerate(point):
        if not abs(way) <= FARTHEST:  # NaN is not either
            return Problem(f"{field}[{axis}]", way, f"-{FARTHEST:g} .. {FARTHEST:g} m")
    return None


def strange(inertia: list[float] | None, mass: float) -> Problem | None:
    """Why no rigid body of this mass [kg] that a flange could carry has this inertia [kg·m²], or None.

    Its principal moments obey the triangle inequality, and no radius of gyration is beyond what a body has.
    """
    if inertia is None:
        return None
    if len(inertia) != 6 or not math.isfinite(sum(inertia)):
        return Problem("inertia", inertia, "six numbers: ixx iyy izz ixy ixz iyz")
    xx, yy, zz, xy, xz, yz = inertia
    low, middle, high = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not (low > 0 and high <= low + middle):
        return Problem("inertia", inertia, "principal moments above 0, each at most the sum of the others")
    least, most = mass * THINNEST**2, mass * WIDEST**2
    if not (least <= low and high <= most):
        return Problem("inertia", inertia, f"principal moments from {least:.3g} to {most:.3g} kg·m² for {mass:g} kg")
    return None
