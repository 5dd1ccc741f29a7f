"""Shapes for tests, with surfaces worked out here, apart from pendant's distance functions."""

import functools
import itertools
import math

import numpy as np
import trimesh
from hypothesis import strategies as st

from pendant.walls.shapes import AnyShape, Box, Cone, Cylinder, Ellipsoid, HalfSpace, Polyhedron, Pyramid, Sphere

lengths = st.floats(0.02, 0.6)
coordinates = st.one_of(st.just(0.0), st.floats(-1.0, 1.0), st.floats(-0.1, 0.1))
points = st.tuples(coordinates, coordinates, coordinates)


@functools.cache
def hull(seed: int, count: int) -> Polyhedron:
    """Convex hull of points drawn on a stretched sphere: every triple with all other points on one side is a face."""
    rng = np.random.default_rng(seed)
    cloud = rng.normal(size=(count, 3))
    cloud *= rng.uniform(0.05, 0.4, 3) / np.linalg.norm(cloud, axis=1, keepdims=True)
    cloud += rng.uniform(-0.1, 0.1, 3)
    triples = np.array(list(itertools.combinations(range(count), 3)))
    a, b, c = cloud[triples[:, 0]], cloud[triples[:, 1]], cloud[triples[:, 2]]
    normals = np.cross(b - a, c - a)
    heights = normals @ cloud.T - np.einsum("ij,ij->i", normals, a)[:, None]
    np.put_along_axis(heights, triples, 0.0, axis=1)
    before, behind = (heights <= 0.0).all(axis=1), (heights >= 0.0).all(axis=1)
    faces = [*triples[before].tolist(), *triples[behind][:, ::-1].tolist()]
    return Polyhedron(vertices=tuple(map(tuple, cloud.tolist())), faces=tuple(map(tuple, faces)))


def from_mesh(mesh: trimesh.Trimesh) -> Polyhedron:
    vertices = tuple((float(x), float(y), float(z)) for x, y, z in mesh.vertices)
    return Polyhedron(vertices=vertices, faces=tuple(tuple(int(k) for k in face) for face in mesh.faces))


hulls = st.builds(hull, st.integers(0, 50), st.sampled_from([4, 8, 14, 40]))
flat_shapes = st.one_of(
    st.builds(Box, size=st.tuples(lengths, lengths, lengths)),
    st.builds(Pyramid, size=st.tuples(lengths, lengths), height=lengths),
    hulls,
)
round_shapes = st.one_of(
    st.builds(Sphere, radius=lengths),
    st.builds(Ellipsoid, radii=st.tuples(lengths, lengths, lengths)),
    st.builds(Ellipsoid, radii=st.tuples(lengths, st.just(0.1), st.just(0.1))),
    st.builds(Cylinder, radius=lengths, height=lengths),
    st.builds(Cone, radius=lengths, height=lengths),
)
half_spaces = st.builds(
    HalfSpace, normal=st.tuples(*[st.floats(-3.0, 3.0)] * 3).filter(lambda n: math.hypot(*n) > 0.1), distance=st.floats(-0.5, 0.5)
)
shapes = st.one_of(flat_shapes, round_shapes, half_spaces)


def flat_mesh(shape: AnyShape) -> trimesh.Trimesh:
    """The exact mesh of a shape with flat faces."""
    if isinstance(shape, Box):
        return trimesh.creation.box(shape.size)
    if isinstance(shape, Pyramid):
        (a, b), c = shape.size, shape.height
        corners = [
            (-a / 2, -b / 2, -c / 2),
            (a / 2, -b / 2, -c / 2),
            (a / 2, b / 2, -c / 2),
            (-a / 2, b / 2, -c / 2),
            (0, 0, c / 2),
        ]
        return trimesh.Trimesh(corners, [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], process=False)
    assert isinstance(shape, Polyhedron)
    triangles = [(f[0], f[k], f[k + 1]) for f in shape.faces for k in range(1, len(f) - 1)]
    return trimesh.Trimesh(shape.vertices, triangles, process=False)


def surface(shape: AnyShape, point: tuple[float, float, float], count: int) -> tuple[np.ndarray, float]:
    """Points of a round shape's surface, about `count` squared of them, and the largest gap from any surface point to one.

    A cylinder and a cone are cut in the half-plane through the point, where their nearest points lie.
    """
    if isinstance(shape, (Sphere, Ellipsoid)):
        radii = np.array(shape.radii if isinstance(shape, Ellipsoid) else (shape.radius,) * 3)
        u, v = np.meshgrid(np.linspace(0.0, np.pi, count), np.linspace(-np.pi, np.pi, 2 * count))
        ball = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1).reshape(-1, 3)
        return ball * radii, float(radii.max()) * np.pi / count
    assert isinstance(shape, (Cylinder, Cone))
    r, h = shape.radius, 0.5 * shape.height
    corners = [(0.0, -h), (r, -h), (r, h), (0.0, h)] if isinstance(shape, Cylinder) else [(0.0, -h), (r, -h), (0.0, h)]
    line, gap = [], 0.0
    for (r0, z0), (r1, z1) in itertools.pairwise(corners):
        t = np.linspace(0.0, 1.0, count * count // 2)[:, None]
        line.append(np.array([r0, z0]) * (1 - t) + np.array([r1, z1]) * t)
        gap = max(gap, math.dist((r0, z0), (r1, z1)) / (len(t) - 1))
    profile = np.concatenate(line)
    angle = math.atan2(point[1], point[0])
    return np.stack([profile[:, 0] * np.cos(angle), profile[:, 0] * np.sin(angle), profile[:, 1]], axis=-1), gap


def contains(shape: AnyShape, point: tuple[float, float, float]) -> bool:
    """From the shape's definition."""
    x, y, z = point
    if isinstance(shape, Sphere):
        return math.hypot(x, y, z) <= shape.radius
    if isinstance(shape, Ellipsoid):
        a, b, c = shape.radii
        return math.hypot(x / a, y / b, z / c) <= 1.0
    if isinstance(shape, Cylinder):
        return math.hypot(x, y) <= shape.radius and abs(z) <= shape.height / 2
    assert isinstance(shape, Cone)
    return abs(z) <= shape.height / 2 and math.hypot(x, y) <= shape.radius * (0.5 - z / shape.height)
