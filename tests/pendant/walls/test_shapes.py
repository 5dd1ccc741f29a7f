"""Signed distance and gradient of every shape (VW-1): against meshes, sampled surfaces, finite differences and known points."""

import math

import msgspec
import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pendant.walls.shapes import AnyShape, Box, Cone, Cylinder, Ellipsoid, HalfSpace, Polyhedron, Pyramid, Shape, Sphere
from tests.pendant import bodies
from tests.pendant.bodies import contains, flat_mesh, flat_shapes, half_spaces, points, round_shapes, shapes, surface

Point = tuple[float, float, float]


@given(flat_shapes, points)
@settings(max_examples=250, deadline=None)
def test_flat_shapes_agree_with_a_query_of_their_mesh(shape: AnyShape, point: Point) -> None:
    mesh = flat_mesh(shape)
    nearest, far, _ = trimesh.proximity.closest_point_naive(mesh, [point])
    inside = bool((np.einsum("ij,ij->i", mesh.face_normals, np.array(point) - mesh.triangles[:, 0]) <= 0.0).all())
    distance, *gradient = shape.field()(*point)
    assert distance == pytest.approx(-far[0] if inside else far[0], abs=1e-7)
    if far[0] > 1e-3 and not inside:
        # inside, several faces can be equally near
        assert gradient == pytest.approx(list((np.array(point) - nearest[0]) / far[0]), abs=1e-6)


@given(round_shapes, points)
@settings(max_examples=300, deadline=None)
def test_round_shapes_agree_with_their_sampled_surface(shape: AnyShape, point: Point) -> None:
    samples, gap = surface(shape, point, 160)
    far = float(np.linalg.norm(samples - point, axis=1).min())
    distance, *_ = shape.field()(*point)
    # a sample lies within the gap of the nearest point, along the surface: off by its square where it is smooth
    assert far - gap - 1e-9 <= abs(distance) <= far + 1e-9
    if abs(distance) > 1e-9:
        assert (distance < 0.0) == contains(shape, point)


@given(half_spaces, points)
def test_a_half_space_by_its_definition(shape: HalfSpace, point: Point) -> None:
    normal = np.array(shape.normal) / np.linalg.norm(shape.normal)
    distance, *gradient = shape.field()(*point)
    assert distance == pytest.approx(float(normal @ point) - shape.distance, abs=1e-12)
    assert gradient == pytest.approx(list(normal), abs=1e-12)


@given(shapes, points)
@settings(max_examples=300, deadline=None)
def test_the_gradient_has_length_1_everywhere_and_leads_to_the_surface(shape: AnyShape, point: Point) -> None:
    field = shape.field()
    distance, *gradient = field(*point)
    assert math.hypot(*gradient) == pytest.approx(1.0, abs=1e-9)
    foot = np.array(point) - distance * np.array(gradient)
    assert field(*foot.tolist())[0] == pytest.approx(0.0, abs=1e-7)


@given(shapes, points)
@settings(max_examples=300, deadline=None)
def test_the_gradient_agrees_with_finite_differences(shape: AnyShape, point: Point) -> None:
    field, step = shape.field(), 1e-6
    _, *gradient = field(*point)
    around = [[field(*(np.array(point) + s * step * e).tolist()) for s in (-1.0, 1.0)] for e in np.eye(3)]
    bend = max(math.dist(side[1:], gradient) for pair in around for side in pair)
    assume(bend < 1e-4)  # not across an edge or a ridge, where there is no one slope
    slopes = [(after[0] - before[0]) / (2.0 * step) for before, after in around]
    assert slopes == pytest.approx(gradient, abs=1e-6 + 0.5 * bend)


@given(shapes, points, points)
@settings(max_examples=300, deadline=None)
def test_the_distance_changes_no_faster_than_the_point_moves(shape: AnyShape, a: Point, b: Point) -> None:
    field = shape.field()
    assert abs(field(*a)[0] - field(*b)[0]) <= math.dist(a, b) + 1e-9


TIP = 1.0 / math.sqrt(1.25)  # of a cone of radius 0.1 and height 0.2

KNOWN: list[tuple[Shape, Point, tuple[float, float, float, float]]] = [
    (Sphere(radius=0.2), (0.0, 0.0, 0.0), (-0.2, 0.0, 0.0, 1.0)),
    (Sphere(radius=0.2), (0.0, -0.3, 0.0), (0.1, 0.0, -1.0, 0.0)),
    (Sphere(radius=0.2), (0.2, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)),
    (Box(size=(0.2, 0.4, 0.6)), (0.0, 0.0, 0.0), (-0.1, 1.0, 0.0, 0.0)),
    (Box(size=(0.2, 0.4, 0.6)), (0.0, -0.15, 0.0), (-0.05, 0.0, -1.0, 0.0)),
    (Box(size=(0.2, 0.4, 0.6)), (0.0, 0.0, -0.29), (-0.01, 0.0, 0.0, -1.0)),
    (Box(size=(0.2, 0.2, 0.2)), (0.13, 0.14, 0.0), (0.05, 0.6, 0.8, 0.0)),
    (Box(size=(0.2, 0.2, 0.2)), (-0.13, 0.0, -0.14), (0.05, -0.6, 0.0, -0.8)),
    (Cylinder(radius=0.1, height=0.4), (0.0, 0.0, 0.0), (-0.1, 1.0, 0.0, 0.0)),
    (Cylinder(radius=0.1, height=0.1), (0.0, 0.0, -0.01), (-0.04, 0.0, 0.0, -1.0)),
    (Cylinder(radius=0.1, height=0.4), (0.0, 0.3, 0.0), (0.2, 0.0, 1.0, 0.0)),
    (Cylinder(radius=0.1, height=0.4), (0.0, 0.0, 0.25), (0.05, 0.0, 0.0, 1.0)),
    (Cylinder(radius=0.1, height=0.4), (0.0, -0.14, -0.23), (0.05, 0.0, -0.8, -0.6)),
    (Cone(radius=0.1, height=0.2), (0.0, 0.0, 0.15), (0.05, 0.0, 0.0, 1.0)),
    (Cone(radius=0.1, height=0.2), (0.0, 0.05, -0.13), (0.03, 0.0, 0.0, -1.0)),
    (Cone(radius=0.1, height=0.2), (0.14, 0.0, -0.13), (0.05, 0.8, 0.0, -0.6)),
    (Cone(radius=0.1, height=0.2), (0.0, 0.0, -0.09), (-0.01, 0.0, 0.0, -1.0)),
    (Cone(radius=0.1, height=0.2), (0.0, 0.0, 0.0), (-0.05 * TIP, TIP, 0.0, TIP / 2)),
    (Cone(radius=0.1, height=0.2), (0.0, 0.15, 0.05), (0.125 * TIP, 0.0, TIP, TIP / 2)),
    (Ellipsoid(radii=(0.1, 0.2, 0.3)), (0.0, 0.0, 0.0), (-0.1, 1.0, 0.0, 0.0)),
    (Ellipsoid(radii=(0.1, 0.2, 0.3)), (0.0, 0.0, 0.4), (0.1, 0.0, 0.0, 1.0)),
    (Ellipsoid(radii=(0.1, 0.2, 0.3)), (-0.05, 0.0, 0.0), (-0.05, -1.0, 0.0, 0.0)),
    (Ellipsoid(radii=(0.3, 0.1, 0.3)), (0.0, -0.15, 0.0), (0.05, 0.0, -1.0, 0.0)),
    (Ellipsoid(radii=(0.2, 0.2, 0.2)), (0.0, 0.0, 0.0), (-0.2, 3**-0.5, 3**-0.5, 3**-0.5)),
    (Pyramid(size=(0.2, 0.2), height=0.2), (0.0, 0.0, 0.15), (0.05, 0.0, 0.0, 1.0)),
    (Pyramid(size=(0.2, 0.4), height=0.2), (0.0, 0.0, -0.13), (0.03, 0.0, 0.0, -1.0)),
    (Pyramid(size=(0.2, 0.4), height=0.2), (0.0, 0.0, -0.09), (-0.01, 0.0, 0.0, -1.0)),
    (Pyramid(size=(0.2, 0.4), height=0.2), (0.13, 0.0, -0.14), (0.05, 0.6, 0.0, -0.8)),
    (HalfSpace(normal=(0.0, 0.0, -2.0), distance=0.05), (3.0, 1.0, -0.07), (0.02, 0.0, 0.0, -1.0)),
]


@pytest.mark.parametrize(("shape", "point", "expected"), KNOWN)
def test_known_points(shape: Shape, point: Point, expected: tuple[float, ...]) -> None:
    assert shape.field()(*point) == pytest.approx(expected, abs=1e-11)


def test_the_nearest_point_of_an_ellipsoid_from_its_focal_ellipse() -> None:
    # On the long axis, inside the centre of curvature, the nearest points are off the axis: (a² x / (a² - b²), ...)
    a, b, x = 0.3, 0.1, 0.1
    foot = a * a * x / (a * a - b * b)
    side = b * math.sqrt(1.0 - (foot / a) ** 2)
    assert Ellipsoid(radii=(a, b, 0.2)).field()(x, 0.0, 0.0)[0] == pytest.approx(-math.hypot(foot - x, side), abs=1e-12)
    # and just beyond it the end of the axis
    assert Ellipsoid(radii=(a, b, 0.2)).field()(0.27, 0.0, 0.0)[0] == pytest.approx(-0.03, abs=1e-12)


lengths = st.floats(0.02, 0.6)


@given(st.tuples(lengths, lengths, lengths), st.tuples(*[st.floats(0.001, 0.8)] * 3))
@settings(max_examples=200, deadline=None)
def test_an_ellipsoid_agrees_with_bisection(radii: Point, point: Point) -> None:
    a, y = np.array(radii), np.array(point)
    low, high = -(a.min() ** 2), float(np.linalg.norm(a * y))
    for _ in range(200):
        t = 0.5 * (low + high)
        low, high = (t, high) if np.sum((a * y / (t + a * a)) ** 2) > 1.0 else (low, t)
    foot = a * a * y / (high + a * a)
    normal = foot / (a * a)
    normal /= np.linalg.norm(normal)
    distance, *gradient = Ellipsoid(radii=radii).field()(*point)
    assert distance == pytest.approx(float(normal @ (y - foot)), abs=1e-9)
    assert gradient == pytest.approx(list(normal), abs=1e-8)


@pytest.mark.parametrize("edge", [(a * a - b * b) / a for a, b in ((0.3, 0.1), (0.3, 0.29), (10.0, 0.001))])
def test_an_ellipsoid_at_the_end_of_its_focal_line_where_roots_are_hardest_to_find(edge: float) -> None:
    field = Ellipsoid(radii=(0.3, 0.1, 0.1)).field()
    for off in (0.0, 1e-300, 1e-15, 1e-9, 1e-4):
        for x in (edge * (1 - 1e-15), edge, edge * (1 + 1e-15)):
            distance, *gradient = field(x, off, 0.0)
            foot = np.array([x, off, 0.0]) - distance * np.array(gradient)
            assert np.linalg.norm(foot / (0.3, 0.1, 0.1)) == pytest.approx(1.0, abs=1e-6)


SHAPES: list[Shape] = [
    Sphere(radius=0.1),
    Ellipsoid(radii=(0.1, 0.2, 0.3)),
    Box(size=(0.1, 0.2, 0.3)),
    Cylinder(radius=0.1, height=0.2),
    Cone(radius=0.1, height=0.2),
    Pyramid(size=(0.1, 0.2), height=0.3),
    HalfSpace(normal=(0.0, 1.0, 0.0), distance=0.1),
    bodies.hull(3, 8),
]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_in_a_file_comes_back_equal(shape: Shape) -> None:
    assert msgspec.json.decode(msgspec.json.encode(shape), type=AnyShape) == shape


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"kind": "sphere", "radius": 0.0}, "Expected `float` >= 0.001 - at `$.radius`"),
        ({"kind": "sphere", "radius": 11}, "Expected `float` <= 10.0 - at `$.radius`"),
        ({"kind": "sphere", "radius": math.nan}, "Expected `float` >= 0.001 - at `$.radius`"),
        ({"kind": "box", "size": [0.1, math.nan, 0.1]}, "Expected `float` >= 0.001 - at `$.size[1]`"),
        ({"kind": "half_space", "normal": [0, 0, 0]}, "normal: its length is 0, allowed: a direction"),
        ({"kind": "half_space", "normal": [0, 9e-7, 0]}, "normal: its length is 9e-07, allowed: a direction"),
        ({"kind": "half_space", "normal": [math.inf, 0, 0]}, "normal: its length is inf, allowed: a direction"),
        ({"kind": "half_space", "normal": [0, math.nan, 0]}, "normal: its length is nan, allowed: a direction"),
        ({"kind": "box", "size": [0.1, 0.1]}, "Expected `array` of length 3, got 2 - at `$.size`"),
        ({"kind": "box", "size": [0.1, 0.1, 0.1], "colour": 1}, "Object contains unknown field `colour`"),
        ({"kind": "blob"}, "Invalid value 'blob' - at `$.kind`"),
    ],
)
def test_a_bad_shape_is_refused_by_name(data: dict[str, object], message: str) -> None:
    with pytest.raises(msgspec.ValidationError) as error:
        msgspec.convert(data, type=AnyShape)
    assert message in str(error.value)


def test_the_length_of_a_normal_does_not_matter() -> None:
    for length in (1e-6, 2.0, 1e6):
        field = HalfSpace(normal=(0.0, length, 0.0), distance=-0.05).field()
        assert field(3.0, -0.07, 1.0) == pytest.approx((-0.02, 0.0, 1.0, 0.0))


def test_the_base_is_no_shape() -> None:
    with pytest.raises(NotImplementedError):
        Shape()


@given(st.sampled_from(SHAPES), st.tuples(*[st.sampled_from([0.0, -0.0, 0.05, -0.05, 0.1, 0.15, 1e-12, 1e-300, 9.0])] * 3))
@settings(max_examples=250, deadline=None)
def test_a_mirrored_point_or_one_at_an_edge_gives_finite_values(shape: Shape, point: Point) -> None:
    assert all(map(math.isfinite, shape.field()(*point)))


def test_a_polyhedron_is_a_shape() -> None:
    assert isinstance(bodies.hull(0, 6), Polyhedron)
