"""Convex polyhedra as meshes (VW-1): many faces against few, and meshes that are no convex body."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from pendant.tick.pose import Vector
from pendant.walls.polyhedron import MANY, SKIN, _faces, _normal, polyhedron
from pendant.walls.shapes import Box
from tests.pendant.bodies import from_mesh, points

CORNERS = tuple((x, y, z) for z in (-0.1, 0.1) for y in (-0.1, 0.1) for x in (-0.1, 0.1))
SQUARES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
TETRAHEDRON = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SIDES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


@given(points)
def test_triangles_and_whole_faces_make_the_same_box(point: tuple[float, float, float]) -> None:
    expected = Box(size=(0.2, 0.2, 0.2)).field()(*point)
    assert polyhedron(CORNERS, SQUARES)(*point)[0] == pytest.approx(expected[0], abs=1e-12)
    triangles = from_mesh(trimesh.creation.box((0.2, 0.2, 0.2)))
    assert len(triangles.faces) == 12
    assert triangles.field()(*point)[0] == pytest.approx(expected[0], abs=1e-12)


@given(st.sampled_from([1, 2]), points)
@settings(max_examples=100, deadline=None)
def test_many_faces_agree_with_a_query_of_the_mesh(fineness: int, point: tuple[float, float, float]) -> None:
    mesh = trimesh.creation.icosphere(fineness, 0.3)
    assert len(mesh.faces) >= MANY
    inside = bool((np.einsum("ij,ij->i", mesh.face_normals, np.array(point) - mesh.triangles[:, 0]) <= 0.0).all())
    nearest, far, _ = trimesh.proximity.closest_point_naive(mesh, [point])
    distance, *gradient = from_mesh(mesh).field()(*point)
    assert distance == pytest.approx(-far[0] if inside else far[0], abs=1e-7)
    if far[0] > 1e-3 and not inside:
        assert gradient == pytest.approx(list((np.array(point) - nearest[0]) / far[0]), abs=1e-6)


@pytest.mark.parametrize("off", [1e-12, 1e-10, 9e-10])
def test_at_an_edge_and_a_corner_the_gradient_stays_a_direction(off: float) -> None:
    field = polyhedron(CORNERS, SQUARES)
    for point in ((0.1 + off, 0.1 + off, 0.0), (0.1 + off, 0.1 + off, 0.1 + off), (0.1 + off, 0.0, 0.0)):
        distance, *gradient = field(*point)
        assert 0.0 <= distance <= 2.0 * off
        assert math.hypot(*gradient) == pytest.approx(1.0, abs=1e-12)


def test_an_inside_point_of_many_faces_gets_the_normal_of_the_nearest() -> None:
    mesh = trimesh.creation.cylinder(0.1, 0.4, sections=40)
    assert from_mesh(mesh).field()(0.0, 0.0, 0.19) == pytest.approx((-0.01, 0.0, 0.0, 1.0), abs=1e-12)
    assert from_mesh(mesh).field()(0.0, 0.0, 0.25) == pytest.approx((0.05, 0.0, 0.0, 1.0), abs=1e-12)


def test_a_face_seen_from_beside_it_does_not_count() -> None:
    # Above the slope of a wedge and beyond its low edge: the slope's plane is nearer than anything of the wedge.
    wedge = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.1), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.1))
    faces = ((0, 3, 4, 1), (0, 1, 2), (3, 5, 4), (0, 2, 5, 3), (1, 4, 5, 2))
    assert polyhedron(wedge, faces)(2.0, 0.5, 0.0)[0] == pytest.approx(1.0)
    assert polyhedron(wedge, faces)(-1.0, 2.0, 0.05)[0] == pytest.approx(math.sqrt(2.0))


DENTED = (*CORNERS[:7], (0.02, 0.02, 0.02))

BAD = [
    (TETRAHEDRON, SIDES[:3], "faces[0]: no face on the other side of edge 2-1, allowed: a closed surface"),
    (TETRAHEDRON, (*SIDES, (0, 2, 1)), "faces[4]: the edge 0-2 runs as in faces[0], allowed: once"),
    (TETRAHEDRON, (*SIDES[:3], (1, 2, 4)), "faces[3]: 4 is no vertex, allowed: 0 to 3"),
    (TETRAHEDRON, (*SIDES[:3], (1, 2, -1)), "faces[3]: -1 is no vertex, allowed: 0 to 3"),
    (
        TETRAHEDRON,
        tuple(face[::-1] for face in SIDES),
        "faces[0]: a vertex lies 1e+03 mm in front of it, allowed: a convex body,",
    ),
    ((*TETRAHEDRON[:2], (2.0, 0.0, 0.0), TETRAHEDRON[3]), SIDES, "faces[0]: its corners lie on a line, allowed: a face with an"),
    ((*TETRAHEDRON[:3], TETRAHEDRON[0]), SIDES, "faces[1]: vertices 3 and 0 are the same point, allowed: an edge with a length"),
    (DENTED, SQUARES, "in front of it"),
    ((*CORNERS[:7], (0.09999, 0.09999, 0.09999)), SQUARES, "in front of it"),
    ((*CORNERS[:6], (-0.1, 0.1, 0.09), CORNERS[7]), SQUARES, "faces[1]: a corner lies 5 mm off its plane, allowed: a flat face"),
]


@pytest.mark.parametrize(("vertices", "faces", "message"), BAD)
def test_what_is_no_convex_body_is_refused(vertices: tuple, faces: tuple, message: str) -> None:
    with pytest.raises(ValueError, match="faces") as error:
        polyhedron(vertices, faces)
    assert message in str(error.value)


def test_a_vertex_a_hair_off_is_taken_for_convex() -> None:
    moved = tuple((x + 5e-8 * (k % 3), y, z) for k, (x, y, z) in enumerate(CORNERS))
    triangles = tuple(t for a, b, c, d in SQUARES for t in ((a, b, c), (a, c, d)))
    assert polyhedron(moved, triangles)(0.3, 0.0, 0.0)[0] == pytest.approx(0.2, abs=1e-6)


@pytest.mark.parametrize("size", [0.05, 1.0, 40.0])
@pytest.mark.parametrize(("off", "taken"), [(0.8e-6, True), (1.3e-6, False)])
def test_a_hair_is_a_millionth_of_the_body_wherever_it_lies(size: float, off: float, taken: bool) -> None:
    """One corner of a square of its top stands out: so far off the other three's plane, half of it before the mean plane."""
    corners = np.array(CORNERS) * 5.0 * size
    corners[7] += (0.0, 0.0, 2.0 * off * size)
    raised = tuple((x, y, z) for x, y, z in np.add(corners, (700.0, -300.0, 200.0)).tolist())
    if taken:
        polyhedron(raised, SQUARES)
    else:
        with pytest.raises(ValueError, match=r"in front of it|off its plane"):
            polyhedron(raised, SQUARES)


def warped(off: float) -> tuple[Vector, ...]:
    """A block of 2 m, as SQUARES: of its top's corners, two lie so far below the other two."""
    return tuple((10.0 * x, 10.0 * y, -1.0 if z < 0.0 else math.copysign(0.5 * off, x * y)) for x, y, z in CORNERS)


@pytest.mark.parametrize(("off", "taken"), [(2e-6, True), (2.001e-6, False)])
def test_exactly_a_millionth_is_a_hair(off: float, taken: bool) -> None:
    """Of 2 m: a vertex in front of a face, a corner off its plane."""
    wide = (TETRAHEDRON[0], (2.0, 0.0, 0.0), *TETRAHEDRON[2:], (0.25, 0.25, -off))
    for vertices, faces, words in ((wide, SIDES, "in front of it"), (warped(off), SQUARES, "off its plane")):
        if taken:
            polyhedron(vertices, faces)
        else:
            with pytest.raises(ValueError, match=words):
                polyhedron(vertices, faces)


@pytest.mark.parametrize(
    ("vertices", "faces", "words"),
    [
        ((*TETRAHEDRON[:3], (0.25, 0.25, -0.0994)), SIDES, r"^faces\[0\]: a vertex lies 99.4 mm in front of it,"),
        (warped(0.0994), SQUARES, r"^faces\[1\]: a corner lies 99.4 mm off its plane,"),
    ],
)
def test_how_far_off_a_vertex_is_is_said_in_millimetres(vertices: tuple, faces: tuple, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        polyhedron(vertices, faces)


@pytest.mark.parametrize("size", [1e-5, 1e4])
def test_a_face_has_an_area_by_its_own_size(size: float) -> None:
    """A fine mesh has small faces; a large one may have corners that lie on a line but for a hair."""
    small = tuple((size * x, size * y, size * z) for x, y, z in TETRAHEDRON)
    assert polyhedron(small, SIDES)(0.0, 0.0, -size)[0] == pytest.approx(size)
    line = (*small[:2], (2.0 * size, 5e-10 * size, 0.0), small[3])
    with pytest.raises(ValueError, match="its corners lie on a line"):
        polyhedron(line, SIDES)


def test_triangles_side_by_side_in_a_plane_are_one_face() -> None:
    """What a tick costs grows with the faces."""
    fine = from_mesh(trimesh.creation.box((0.2, 0.2, 0.2)).subdivide())
    assert len(fine.faces) == 48
    assert sorted(len(face.edges) for face in _faces(fine.vertices, fine.faces)) == [8] * 6


CUBE: tuple[Vector, ...] = tuple((x, y, z) for z in (-1.0, 0.0) for y in (-1.0, 0.0) for x in (-1.0, 0.0))
"""As SQUARES; three of its faces lie in the planes of the axes."""


@pytest.mark.parametrize(("off", "skin"), [(SKIN, True), (1.01 * SKIN, False)])
def test_up_to_its_skin_a_plane_tells_the_way_out_and_beyond_the_nearest_point(off: float, skin: bool) -> None:
    """Beside an edge: just one of the two planes, or half way between them."""
    distance, *gradient = polyhedron(CUBE, SQUARES)(off, off, -0.5)
    assert distance == pytest.approx(off if skin else math.sqrt(2.0) * off)
    assert sorted(gradient) == pytest.approx([0.0, 0.0, 1.0] if skin else [0.0, math.sqrt(0.5), math.sqrt(0.5)])


def prism(corners: int) -> tuple[tuple[Vector, ...], tuple[tuple[int, ...], ...]]:
    """Of a radius and a height of 1 m, its top at z = 0; with its top and bottom it has two faces more than corners."""
    angles = [2.0 * math.pi * k / corners for k in range(corners)]
    vertices = tuple((math.cos(a), math.sin(a), z) for z in (-1.0, 0.0) for a in angles)
    sides = tuple((k, (k + 1) % corners, corners + (k + 1) % corners, corners + k) for k in range(corners))
    return vertices, (tuple(range(corners))[::-1], tuple(range(corners, 2 * corners)), *sides)


@pytest.mark.parametrize(("off", "skin"), [(SKIN, True), (1.01 * SKIN, False)])
def test_a_skin_is_as_thick_with_many_faces(off: float, skin: bool) -> None:
    """Above the top by it, and beyond a corner by half of it."""
    distance, *gradient = polyhedron(*prism(MANY))(1.0 + 0.5 * off, 0.0, off)
    if skin:
        assert (distance, gradient) == (off, [0.0, 0.0, 1.0])
    else:
        assert distance == pytest.approx(off * math.sqrt(1.25), rel=1e-6)
        assert gradient == pytest.approx([math.sqrt(0.2), 0.0, math.sqrt(0.8)], abs=1e-6)


@pytest.mark.parametrize(("corners", "way"), [(MANY - 3, "by_loop"), (MANY - 2, "by_matrix")])
def test_many_faces_are_reckoned_at_once(corners: int, way: str) -> None:
    """It takes half the time; fewer are faster one by one."""
    vertices, faces = prism(corners)
    assert len(faces) == corners + 2
    field = polyhedron(vertices, faces)
    assert field.__name__ == way
    assert field(0.0, 0.0, 0.5) == pytest.approx((0.5, 0.0, 0.0, 1.0))
    assert field(0.0, 0.0, -0.1) == pytest.approx((-0.1, 0.0, 0.0, 1.0))


@pytest.mark.parametrize(("height", "taken"), [(1e-9, False), (1.001e-9, True)])
def test_exactly_a_billionth_of_a_long_face_is_no_area(height: float, taken: bool) -> None:
    """A side of 1 m; twice the area is as much in square metres."""
    flat = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, height, 0.0))
    if taken:
        assert _normal(flat, (0, 1, 2), 0) == (0.0, 0.0, 1.0)
    else:
        with pytest.raises(ValueError, match="its corners lie on a line"):
            _normal(flat, (0, 1, 2), 0)
