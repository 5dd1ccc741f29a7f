"""Where fingers or a vacuum cup meet a part: a line through a box or a cylinder (GR-1)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.scenario import AnyPart, FreeBox

Array = NDArray[np.float64]

SQUEEZE = 0.005
"""How far a vacuum cup is pressed together at most [m]."""

GAP = 0.002
"""From how far a vacuum cup draws a face to itself [m]."""

RIM = 8
"""Points of a cup's rim that must lie on the part."""

ALONG = 1e-9  # a line is parallel to a face where it comes nearer by less than this in a metre


class Chord(NamedTuple):
    """The stretch of a line that lies in a part, from a point of the line on [m], and how its ends meet the surface."""

    begin: float
    end: float
    begin_cosine: float  # of the angle between the line and the surface's normal
    end_cosine: float


def chord(part: AnyPart, point: Array, along: Array) -> Chord | None:
    """Where a line passes through a part.

    Args:
        part: a box or a cylinder; its frame is in its centre.
        point: of the line (3,), in the part's frame [m].
        along: the line's direction (3,), of length 1, in the part's frame.

    Returns:
        None where it passes by.
    """
    half = [length / 2.0 for length in part.size]
    x, u = point.tolist(), along.tolist()
    begin, end, low, high = -math.inf, math.inf, 0.0, 0.0
    for axis in range(3) if isinstance(part, FreeBox) else (2,):
        if abs(u[axis]) < ALONG:
            if abs(x[axis]) > half[axis]:
                return None
            continue
        one, other = (-half[axis] - x[axis]) / u[axis], (half[axis] - x[axis]) / u[axis]
        if min(one, other) > begin:
            begin, low = min(one, other), abs(u[axis])
        if max(one, other) < end:
            end, high = max(one, other), abs(u[axis])
    if not isinstance(part, FreeBox):
        a = u[0] ** 2 + u[1] ** 2
        b = x[0] * u[0] + x[1] * u[1]
        c = x[0] ** 2 + x[1] ** 2 - part.radius**2
        if a < ALONG**2:
            if c > 0.0:
                return None
        else:
            root = b * b - a * c
            if root <= 0.0:
                return None
            one, other = (-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a
            cosine = math.sqrt(root) / part.radius  # of both ends: the line's way to the middle of its chord
            if one > begin:
                begin, low = one, cosine
            if other < end:
                end, high = other, cosine
    return Chord(begin, end, low, high) if begin < end else None


def firm(found: Chord, friction: float) -> bool:
    """Whether two fingers on the ends of a chord hold: it lies in both friction cones.

    An antipodal grasp (V.-D. Nguyen, Constructing force-closure grasps, 1988): cos(angle) >= 1 / sqrt(1 + mu²).
    """
    return min(found.begin_cosine, found.end_cosine) >= 1.0 / math.sqrt(1.0 + friction * friction)


def seals(part: AnyPart, point: Array, axes: Array, radius: float) -> bool:
    """Whether a cup closes on a part: its middle and its rim all reach the surface.

    Args:
        part: a box or a cylinder.
        point: middle of the uncompressed cup's rim (3,), in the part's frame [m].
        axes: of the cup, as columns (3, 3), in the part's frame; it looks along the last.
        radius: of the rim [m].
    """
    angles = [2.0 * math.pi * k / RIM for k in range(RIM)]
    rim = [point + radius * (math.cos(angle) * axes[:, 0] + math.sin(angle) * axes[:, 1]) for angle in angles]
    for place in (point, *rim):
        found = chord(part, place, axes[:, 2])
        if found is None or not -SQUEEZE <= found.begin <= GAP:
            return False
    return True
