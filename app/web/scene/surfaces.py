"""The surfaces of virtual walls as meshes with an outline, in the shape's own frame and size (VW-1)."""

import math
from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray

from pendant.walls.shapes import AnyShape, Box, Cone, Cylinder, Ellipsoid, HalfSpace, Polyhedron, Pyramid, Sphere

Array = NDArray[np.float64]

ROUND = 48
"""Corners of a circle."""

SHARP = math.radians(20.0)
"""Edges between faces that are turned by more belong to the outline."""

CELLS = 8
"""A plane's outline has so many cells along each side."""


class Surface(NamedTuple):
    """What is drawn of a shape."""

    vertices: Array  # (v, 3) [m]
    faces: NDArray[np.int64]  # (f, 3)
    outline: Array  # (s, 2, 3) ends of its lines [m]


def surface(shape: AnyShape, side: float) -> Surface:
    """The surface of a shape.

    Args:
        shape: of a wall or an area.
        side: of the square that stands for a plane [m]; it lies in z = 0 around the origin (see `plane`).
    """
    match shape:
        case Sphere(radius=radius):
            return _ball((radius, radius, radius))
        case Ellipsoid(radii=radii):
            return _ball(radii)
        case Box(size=size):
            return _edged(trimesh.creation.box(size))
        case Cylinder(radius=radius, height=height):
            return _edged(trimesh.creation.cylinder(radius, height, sections=ROUND))
        case Cone(radius=radius, height=height):
            cone = trimesh.creation.cone(radius, height, sections=ROUND)
            cone.apply_translation((0.0, 0.0, -height / 2))
            return _edged(cone)
        case Pyramid(size=(x, y), height=height):
            base = [(sx * x / 2, sy * y / 2, -height / 2) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
            return _edged(_solid([*base, (0.0, 0.0, height / 2)], [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]))
        case Polyhedron(vertices=vertices, faces=faces):
            return _edged(_solid(vertices, faces))
        case HalfSpace():
            return _plane(side)


def plane(normal: tuple[float, float, float]) -> Array:
    """A rotation (3, 3) that turns z to a direction of any length."""
    z = np.array(normal) / math.hypot(*normal)
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _ball(radii: tuple[float, float, float]) -> Surface:
    ball = trimesh.creation.icosphere(subdivisions=3)
    turns = np.linspace(0.0, 2.0 * math.pi, ROUND + 1)
    lines: list[Array] = []
    for axis in range(3):
        circle = np.zeros((ROUND + 1, 3))
        circle[:, (axis + 1) % 3], circle[:, (axis + 2) % 3] = np.cos(turns), np.sin(turns)
        lines.append(np.stack([circle[:-1], circle[1:]], axis=1))
    return Surface(np.asarray(ball.vertices) * radii, np.asarray(ball.faces), np.concatenate(lines) * radii)


def _edged(body: trimesh.Trimesh) -> Surface:
    edges = body.face_adjacency_edges[body.face_adjacency_angles > SHARP]
    vertices = np.asarray(body.vertices)
    return Surface(vertices, np.asarray(body.faces), vertices[edges])


def _solid(vertices: object, faces: object) -> trimesh.Trimesh:
    """A mesh of convex faces with any number of corners."""
    corners = [tuple(face) for face in faces]  # type: ignore[attr-defined]
    fans = [(face[0], face[i], face[i + 1]) for face in corners for i in range(1, len(face) - 1)]
    return trimesh.Trimesh(np.array(vertices, dtype=float), np.array(fans), process=False)


def _plane(side: float) -> Surface:
    half, at = side / 2, np.linspace(-side / 2, side / 2, CELLS + 1)
    corners = np.array([(-half, -half, 0.0), (half, -half, 0.0), (half, half, 0.0), (-half, half, 0.0)])
    lines = [[(value, -half, 0.0), (value, half, 0.0)] for value in at]
    lines += [[(-half, value, 0.0), (half, value, 0.0)] for value in at]
    return Surface(corners, np.array([(0, 1, 2), (0, 2, 3)]), np.array(lines))
