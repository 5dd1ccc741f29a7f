"""Signed distance of a convex polyhedron given as a mesh (VW-1).

Inside a convex polyhedron the nearest surface point lies on the face whose plane is nearest, so the distance is the largest of
the planes' signed distances. Outside it is the distance to the nearest face among those that see the point.
"""

import math
from typing import NamedTuple

import numpy as np

from pendant.tick.pose import Vector, dot
from pendant.walls.solids import Field, Signed

TOLERANCE = 1e-6  # of the mesh's extent: a vertex this far beyond a face's plane is still taken for convex
FLAT = 1e-9  # faces whose normals differ by less, side by side, are one face
SKIN = 1e-9  # [m] nearer than this from outside, the nearest plane gives the gradient: a difference of points would be noise
MANY = 24  # faces; from here on one matrix product is faster than a loop

Faces = tuple[tuple[int, ...], ...]


class Edge(NamedTuple):
    """An edge of a face, seen from that face."""

    start: Vector
    along: Vector  # of length 1
    length: float
    outward: Vector  # of length 1, in the face's plane, away from the face


class Face(NamedTuple):
    """A flat face: points p of its plane have normal · p = offset."""

    normal: Vector  # of length 1, away from the body
    offset: float
    edges: tuple[Edge, ...]


def polyhedron(vertices: tuple[Vector, ...], faces: Faces) -> Field:
    """A convex polyhedron; as all fields in pendant.walls.solids.

    Args:
        vertices: corners [m].
        faces: the corners of each face as indices, counterclockwise seen from outside, three or more.

    Raises:
        ValueError: the faces do not enclose a convex body.
    """
    flat = _faces(vertices, faces)
    planes = [(*face.normal, face.offset) for face in flat]
    matrix = np.array([(*face.normal, -face.offset) for face in flat])

    def by_loop(x: float, y: float, z: float) -> Signed:
        best, nearest = -math.inf, planes[0]
        for plane in planes:
            nx, ny, nz, offset = plane
            value = nx * x + ny * y + nz * z - offset
            if value > best:
                best, nearest = value, plane
        if best <= SKIN:
            return best, nearest[0], nearest[1], nearest[2]
        return _outside(flat, (x, y, z))

    def by_matrix(x: float, y: float, z: float) -> Signed:
        values = matrix @ (x, y, z, 1.0)
        first = int(values.argmax())
        best = float(values[first])
        if best <= SKIN:
            return (best, *flat[first].normal)
        return _outside([flat[index] for index in np.flatnonzero(values > 0.0)], (x, y, z))

    return by_loop if len(flat) < MANY else by_matrix


def pyramid(size: tuple[float, float], height: float) -> Field:
    """A pyramid: its base, size[0] along x and size[1] along y, at z = -height / 2, its tip at z = height / 2."""
    a, b, c = 0.5 * size[0], 0.5 * size[1], 0.5 * height
    corners = ((-a, -b, -c), (a, -b, -c), (a, b, -c), (-a, b, -c), (0.0, 0.0, c))
    return polyhedron(corners, ((3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)))


def _outside(faces: list[Face], point: Vector) -> Signed:
    """Distance from outside: the nearest point of all faces that see the point."""
    x, y, z = point
    least, best = math.inf, (0.0, 0.0, 0.0, 0.0)
    for normal, offset, edges in faces:
        height = dot(normal, point) - offset
        if height <= 0.0 or height >= least:
            continue
        over = True
        for (sx, sy, sz), (ax, ay, az), length, outward in edges:
            rx, ry, rz = x - sx, y - sy, z - sz
            if outward[0] * rx + outward[1] * ry + outward[2] * rz <= 0.0:
                continue
            over = False
            t = min(max(ax * rx + ay * ry + az * rz, 0.0), length)
            rx, ry, rz = rx - t * ax, ry - t * ay, rz - t * az
            far = math.sqrt(rx * rx + ry * ry + rz * rz)
            if far < least:
                least, best = far, (far, rx / far, ry / far, rz / far)
        if over:
            least, best = height, (height, *normal)
    return best


def _faces(vertices: tuple[Vector, ...], faces: Faces) -> list[Face]:
    """The faces, flat neighbours joined. Raises ValueError unless they enclose a convex body."""
    normals = [_normal(vertices, face, number) for number, face in enumerate(faces)]
    owner = _owners(faces)
    points = np.array(vertices)
    allowed = TOLERANCE * float(np.ptp(points, axis=0).max())
    for number, (normal, face) in enumerate(zip(normals, faces, strict=True)):
        heights = (points - points[face[0]]) @ normal
        if (beyond := float(heights.max())) > allowed:
            raise ValueError(
                f"faces[{number}]: a vertex lies {1e3 * beyond:.3g} mm in front of it, "
                "allowed: a convex body, each face counterclockwise seen from outside"
            )
        if (beyond := float(-heights[list(face)].min())) > allowed:
            raise ValueError(f"faces[{number}]: a corner lies {1e3 * beyond:.3g} mm off its plane, allowed: a flat face")
    group = list(range(len(faces)))
    for (start, end), number in owner.items():
        other = owner[end, start]
        if math.dist(normals[number], normals[other]) < FLAT:
            old, new = group[other], group[number]
            group = [new if entry == old else entry for entry in group]
    return [_joined(vertices, normals[root], group=group, root=root, owner=owner) for root in sorted(set(group))]


def _joined(
    vertices: tuple[Vector, ...],
    normal: Vector,
    *,
    group: list[int],
    root: int,
    owner: dict[tuple[int, int], int],
) -> Face:
    """The face made of all whose entry in `group` is `root`: its edges are those not shared within, by the `owner` of each."""
    edges: list[Edge] = []
    corners: set[int] = set()
    for (start, end), number in owner.items():
        if group[number] == root:
            corners.add(start)
            if group[owner[end, start]] != root:
                edges.append(_edge(vertices[start], vertices[end], normal))
    return Face(normal, max(dot(normal, vertices[corner]) for corner in corners), tuple(edges))


def _edge(start: Vector, end: Vector, normal: Vector) -> Edge:
    length = math.dist(start, end)
    ax, ay, az = ((end[k] - start[k]) / length for k in range(3))
    nx, ny, nz = normal
    return Edge(start, (ax, ay, az), length, (ay * nz - az * ny, az * nx - ax * nz, ax * ny - ay * nx))


def _owners(faces: Faces) -> dict[tuple[int, int], int]:
    """The face of each directed edge; in a closed surface each edge runs once in each direction."""
    owner: dict[tuple[int, int], int] = {}
    for number, face in enumerate(faces):
        for start, end in zip(face, face[1:] + face[:1], strict=True):
            if (start, end) in owner:
                raise ValueError(f"faces[{number}]: the edge {start}-{end} runs as in faces[{owner[start, end]}], allowed: once")
            owner[start, end] = number
    for (start, end), number in owner.items():
        if (end, start) not in owner:
            raise ValueError(f"faces[{number}]: no face on the other side of edge {start}-{end}, allowed: a closed surface")
    return owner


def _normal(vertices: tuple[Vector, ...], face: tuple[int, ...], number: int) -> Vector:
    """Unit normal of a face by Newell's method, for which its corners may be any number."""
    for index in face:
        if not 0 <= index < len(vertices):
            raise ValueError(f"faces[{number}]: {index} is no vertex, allowed: 0 to {len(vertices) - 1}")
    nx = ny = nz = extent = 0.0
    for start, end in zip(face, face[1:] + face[:1], strict=True):
        (ax, ay, az), (bx, by, bz) = vertices[start], vertices[end]
        side = math.dist((ax, ay, az), (bx, by, bz))
        if side == 0.0:
            raise ValueError(f"faces[{number}]: vertices {start} and {end} are the same point, allowed: an edge with a length")
        extent = max(extent, side)
        nx += (ay - by) * (az + bz)
        ny += (az - bz) * (ax + bx)
        nz += (ax - bx) * (ay + by)
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if length <= 1e-9 * extent * extent:
        raise ValueError(f"faces[{number}]: its corners lie on a line, allowed: a face with an area")
    return nx / length, ny / length, nz / length
