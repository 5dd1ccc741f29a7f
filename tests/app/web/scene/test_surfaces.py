"""What is drawn of a wall lies on the wall: every corner and every line has the distance 0."""

import numpy as np
import pytest
import trimesh

from app.web.scene.surfaces import plane, surface
from pendant.walls.shapes import AnyShape, Box, Cone, Cylinder, Ellipsoid, HalfSpace, Polyhedron, Pyramid, Sphere

WEDGE = Polyhedron(
    vertices=((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1)),
    faces=((3, 2, 1, 0), (0, 1, 4), (2, 3, 5), (0, 4, 5, 3), (1, 2, 5, 4)),
)
SHAPES: list[tuple[AnyShape, float]] = [
    (Sphere(radius=0.3), 4 / 3 * np.pi * 0.3**3),
    (Ellipsoid(radii=(0.3, 0.2, 0.1)), 4 / 3 * np.pi * 0.3 * 0.2 * 0.1),
    (Box(size=(0.3, 0.2, 0.1)), 0.006),
    (Cylinder(radius=0.2, height=0.5), np.pi * 0.2**2 * 0.5),
    (Cone(radius=0.2, height=0.5), np.pi * 0.2**2 * 0.5 / 3),
    (Pyramid(size=(0.3, 0.2), height=0.6), 0.012),
    (WEDGE, 0.5),
]


@pytest.mark.parametrize(("shape", "volume"), SHAPES, ids=lambda value: type(value).__name__)
def test_the_surface_of_a_body_lies_on_it_and_encloses_it(shape: AnyShape, volume: float) -> None:
    drawn = surface(shape, 1.0)
    field = shape.field()
    for x, y, z in drawn.vertices:
        assert field(x, y, z)[0] == pytest.approx(0.0, abs=1e-6)
    for x, y, z in drawn.outline.reshape(-1, 3):
        assert field(x, y, z)[0] == pytest.approx(0.0, abs=1e-6)
    assert trimesh.Trimesh(drawn.vertices, drawn.faces).volume == pytest.approx(volume, rel=0.02)


@pytest.mark.parametrize(("shape", "lines"), [(Box(size=(1, 1, 1)), 12), (Pyramid(size=(1, 1), height=1), 8), (WEDGE, 9)])
def test_the_outline_of_a_body_is_its_edges_and_no_diagonals(shape: AnyShape, lines: int) -> None:
    assert len(surface(shape, 1.0).outline) == lines


def test_a_plane_is_a_square_turned_to_its_normal() -> None:
    shape = HalfSpace(normal=(1.0, -2.0, 2.0), distance=0.3)
    drawn = surface(shape, 0.8)
    turn, normal = plane(shape.normal), np.array([1.0, -2.0, 2.0]) / 3.0
    assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    for corner in np.concatenate([drawn.vertices, drawn.outline.reshape(-1, 3)]):
        x, y, z = turn @ corner + 0.3 * normal
        assert shape.field()(x, y, z)[0] == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(drawn.vertices, axis=0) == pytest.approx((0.8, 0.8, 0.0))
