"""Capsules round what a link is made of: its collision shapes."""

import itertools

import numpy as np
import trimesh
from numpy.typing import NDArray

Array = NDArray[np.float64]

SAMPLES = 3000
"""Points of a link's surface."""

PARTS = 4
"""Capsules of a link, at most."""

WORTH = 0.75
"""A capsule is cut in two where both together have at most this share of its volume."""

THINNEST = 0.002
"""Radius of a capsule, at least [m]."""

Rod = tuple[Array, Array, float]
"""Start (3,), end (3,) and radius [m]."""


def surface_points(meshes: list[trimesh.Trimesh]) -> Array:
    """Points on the surfaces of meshes (m, 3), the same ones each time."""
    areas = np.array([mesh.area for mesh in meshes])
    shares = areas / areas.sum() if areas.sum() > 0.0 else np.full(len(meshes), 1.0 / len(meshes))
    found: list[Array] = []
    for mesh, share in zip(meshes, shares, strict=True):
        count = max(200, round(share * SAMPLES))
        if mesh.area > 0.0:
            found.append(np.asarray(trimesh.sample.sample_surface(mesh, count, seed=0)[0]))
        corners = np.asarray(mesh.vertices)
        found.append(corners[:: max(1, len(corners) // count)])
        # The outermost points along 26 ways, so that no capsule is smaller than what it is round.
        ways = np.array([way for way in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(way)])
        found.append(corners[np.argmax(corners @ ways.T, axis=0)])
    return np.vstack(found)


def capsules_round(points: Array) -> list[Rod]:
    """Capsules that hold all points (m, 3): one, or several where those are much smaller."""
    rods = [(points, capsule_round(points))]
    while len(rods) < PARTS:
        best: tuple[float, int, list[tuple[Array, Rod]]] | None = None
        for k, (inside, rod) in enumerate(rods):
            halves = _halves(inside)
            if halves is None:
                continue
            saved = volume(rod) - sum(volume(half) for _, half in halves)
            small = volume(rod) - saved <= WORTH * volume(rod)
            if small and (best is None or saved > best[0]):
                best = saved, k, halves
        if best is None:
            break
        rods[best[1] : best[1] + 1] = best[2]
    return [rod for _, rod in rods]


def _halves(points: Array) -> list[tuple[Array, Rod]] | None:
    """The better cut of points in two, across one of their own three axes."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    found = None
    for axis in axes:
        along = centred @ axis
        for share in (0.35, 0.5, 0.65):
            cut = along.min() + share * np.ptp(along)
            sides = [points[along <= cut], points[along > cut]]
            if min(len(side) for side in sides) < 20:
                continue
            halves = [(side, capsule_round(side)) for side in sides]
            if found is None or sum(volume(half) for _, half in halves) < sum(volume(half) for _, half in found):
                found = halves
    return found


def capsule_round(points: Array) -> Rod:
    """The smallest of the capsules along the points' own three axes, and one more across, that holds them all."""
    centre = points.mean(axis=0)
    axes = np.linalg.svd(points - centre, full_matrices=False)[2]
    return min((_along(points, axes, k) for k in range(3)), key=volume)


def _along(points: Array, axes: Array, k: int) -> Rod:
    """The capsule along axis k: about the middle of what lies across, just long enough for every point to be inside."""
    own = points @ axes.T
    middle = (own.min(axis=0) + own.max(axis=0)) / 2.0
    across = [i for i in range(3) if i != k]
    off = np.linalg.norm(own[:, across] - middle[across], axis=1)
    radius = max(float(off.max()), THINNEST)
    reach = np.sqrt(np.maximum(radius**2 - off**2, 0.0))
    low, high = float((own[:, k] + reach).min()), float((own[:, k] - reach).max())
    if low > high:
        low = high = (low + high) / 2.0
        radius = max(radius, float(np.sqrt(off**2 + (own[:, k] - low) ** 2).max()))
    ends = []
    for place in (low, high):
        point = middle.copy()
        point[k] = place
        ends.append(point @ axes)
    return ends[0], ends[1], radius


def volume(rod: Rod) -> float:
    """Of a capsule [m³]."""
    start, end, radius = rod
    return float(np.pi * radius**2 * (np.linalg.norm(end - start) + 4.0 / 3.0 * radius))
