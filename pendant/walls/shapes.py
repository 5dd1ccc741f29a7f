"""Shapes of virtual walls (VW-1) as values: what a file says of them. All are centred on their origin, axes along z."""

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from pendant.tick.pose import Vector
from pendant.walls import solids
from pendant.walls.ellipsoid import ellipsoid
from pendant.walls.polyhedron import polyhedron, pyramid
from pendant.walls.solids import Field

Length = Annotated[float, Meta(ge=0.001, le=10.0)]  # [m]
Coordinate = Annotated[float, Meta(ge=-10.0, le=10.0)]  # [m]


class Shape(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """Base of all shapes."""

    def __post_init__(self) -> None:
        self.field()  # which refuses what is no body

    def field(self) -> Field:
        """Signed distance and gradient, in the shape's frame."""
        raise NotImplementedError


class Sphere(Shape, tag="sphere", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A sphere."""

    radius: Length  # [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        return solids.sphere(self.radius)


class Ellipsoid(Shape, tag="ellipsoid", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """An ellipsoid."""

    radii: tuple[Length, Length, Length]  # half-axes along x, y, z [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        return ellipsoid(self.radii)


class Box(Shape, tag="box", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A box."""

    size: tuple[Length, Length, Length]  # whole edges along x, y, z [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        return solids.box(self.size)


class Cylinder(Shape, tag="cylinder", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A cylinder."""

    radius: Length  # [m]
    height: Length  # [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        return solids.cylinder(self.radius, self.height)


class Cone(Shape, tag="cone", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A cone: its base at z = -height / 2, its tip at z = height / 2."""

    radius: Length  # of the base [m]
    height: Length  # [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        return solids.cone(self.radius, self.height)


class Pyramid(Shape, tag="pyramid", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A pyramid: its base at z = -height / 2, its tip at z = height / 2."""

    size: tuple[Length, Length]  # edges of the base along x, y [m]
    height: Length  # [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        return pyramid(self.size, self.height)


class HalfSpace(Shape, tag="half_space", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All that lies behind a plane."""

    normal: Vector  # away from the half-space; its length does not matter
    distance: Coordinate = 0.0  # of the plane from the origin, along the normal [m]

    def field(self) -> Field:
        """As `Shape.field`."""
        if not 1e-6 <= math.hypot(*self.normal) < math.inf:  # NaN is in no range
            raise ValueError(f"normal: its length is {math.hypot(*self.normal):g}, allowed: a direction")
        return solids.half_space(self.normal, self.distance)


class Polyhedron(Shape, tag="polyhedron", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A convex polyhedron as a mesh."""

    vertices: Annotated[tuple[tuple[Coordinate, Coordinate, Coordinate], ...], Meta(min_length=4, max_length=2000)]  # [m]
    faces: Annotated[
        tuple[Annotated[tuple[int, ...], Meta(min_length=3, max_length=100)], ...], Meta(min_length=4, max_length=4000)
    ]  # indices of vertices, counterclockwise seen from outside

    def field(self) -> Field:
        """As `Shape.field`."""
        return polyhedron(self.vertices, self.faces)


AnyShape = Sphere | Ellipsoid | Box | Cylinder | Cone | Pyramid | HalfSpace | Polyhedron
