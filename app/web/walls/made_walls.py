"""Areas as they are made on the page: where a new one lies, its sizes, its words, and how it is moved."""

import math
from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from app.web.widgets import svg
from app.web.widgets.svg import Colour
from pendant.tick.pose import HERE, ORIGIN, Pose, Quaternion, Rotation, Vector, quaternion, rotation, turned
from pendant.walls.barrier import Place
from pendant.walls.definitions import AnyBorder, Area
from pendant.walls.settings import Reaction
from pendant.walls.shapes import AnyShape, Box, Cylinder, HalfSpace, Sphere
from sim.arm.frames import matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

Array = NDArray[np.float64]

AHEAD = 0.1
"""A new plane lies so far ahead of the tool, square to its axis; the tool's side of it is allowed [m]."""

SHAPES: dict[str, AnyShape] = {
    "Plane": HalfSpace(normal=(0.0, 0.0, 1.0)),
    "Sphere": Sphere(radius=0.2),
    "Box": Box(size=(0.4, 0.4, 0.4)),
    "Cylinder": Cylinder(radius=0.2, height=0.4),
}
"""What can be made, as it is at first: an arm can be guided for 100 or 200 mm until it is stopped."""

SIDES = {"Stay inside": False, "Keep out": True}
FIXED = {"Base": "base", "Tool": "tcp", "Flange": "flange"}
"""What a wall can be fixed to, beside the objects of the world."""

REACTIONS = {"End free-drive": Reaction.LEAVE, "Stop there": Reaction.STAY, "Protective stop": Reaction.STOP}
PARTS = {"Tool": "tcp", "Flange": "flange", "Elbow": "elbow"}

SIZES: dict[type[AnyShape], tuple[str, ...]] = {
    Sphere: ("Radius",),
    Box: ("Along x", "Along y", "Along z"),
    Cylinder: ("Radius", "Height"),
}
"""What the sizes of a shape are called; another shape keeps the one that it has."""

SHORTEST, LONGEST = 1.0, 10_000.0
"""Of a size [mm]."""

FARTHEST = 10_000.0
"""Of a coordinate, either way [mm]."""


def made(shape: str, taken: frozenset[str], tcp: Pose) -> Area:
    """A new area that the tool centre point stays in.

    Args:
        shape: of `SHAPES`.
        taken: names that others have.
        tcp: pose of the tool centre point in B.
    """
    number = 1
    while (name := f"{shape.lower()} {number}") in taken:
        number += 1
    return at_tool(Area(name=name, part="tcp", shape=SHAPES[shape]), None, tcp)


def at_tool(area: Area, place: Place | None, tcp: Pose) -> Area:
    """The area, brought to the tool: a plane ahead of it and square to its axis, another shape round it as it is turned.

    Args:
        area: as it is.
        place: where it lies; None: nowhere yet, its reference is B.
        tcp: pose of the tool centre point in B.
    """
    if not isinstance(area.shape, HalfSpace):
        turn = area.orientation if place is None else quaternion(place.pose.R)
        return moved(area, place, tcp.p, turn)
    x, y, z = tcp.p
    ax, ay, az = turned(tcp.R, (0.0, 0.0, AHEAD))
    return moved(area, place, (x + ax, y + ay, z + az), quaternion(tcp.R))


def moved(area: Area, place: Place | None, p: Vector, turn: Quaternion) -> Area:
    """The area with its shape at another pose in B; its reference stays where it is.

    Args:
        area: as it is.
        place: where its shape lies now; None: its reference is B.
        p: origin of the shape in B [m].
        turn: its orientation in B, wxyz of any length but 0.
    """
    size = math.hypot(*turn)
    w, x, y, z = (value / size for value in turn)
    limit = FARTHEST / 1000.0
    px, py, pz = (min(max(value, -limit), limit) for value in p)
    if place is None or area.reference == "base":
        return replace(area, position=(px, py, pz), orientation=(w, x, y, z))
    # X_BR of the reference, from where the shape was: X_BS = X_BR X_RS.
    R_BR = _matrix(place.pose.R) @ _matrix(rotation(area.orientation)).T
    p_BR = np.array(place.pose.p) - R_BR @ np.array(area.position)
    local = R_BR.T @ (np.array((px, py, pz)) - p_BR)
    a, b, c, d, e, f, g, h, i = (R_BR.T @ _matrix(rotation((w, x, y, z)))).ravel().tolist()
    lx, ly, lz = np.clip(local, -limit, limit).tolist()
    return replace(area, position=(lx, ly, lz), orientation=quaternion((a, b, c, d, e, f, g, h, i)))


def fixed(area: Area, place: Place | None, to: str, frame: Pose) -> Area:
    """The area, where it lies now, fixed to something else, with which it moves from now on.

    Args:
        area: as it is.
        place: where its shape lies now; None: its reference is B.
        to: name of the reference.
        frame: X_BR of that reference.
    """
    p, R = (area.position, _matrix(rotation(area.orientation))) if place is None else (place.pose.p, _matrix(place.pose.R))
    R_BR = _matrix(frame.R)
    x, y, z = (R_BR.T @ (np.array(p) - np.array(frame.p))).tolist()
    a, b, c, d, e, f, g, h, i = (R_BR.T @ R).ravel().tolist()
    return replace(area, reference=to, position=(x, y, z), orientation=quaternion((a, b, c, d, e, f, g, h, i)))


def frame_of(reference: str, snapshot: Snapshot, objects: Sequence[str]) -> Pose:
    """X_BR of what a wall can be fixed to, now: base, flange, tool, or one of the `objects`, in the scenario's order."""
    if reference == "tcp":
        return tool_now(snapshot)
    if reference == "base":
        return HERE
    seen = snapshot.estimate
    if reference == "flange":
        return tool_pose(seen.p_BF, seen.R_BF, ORIGIN, np.eye(3))
    base, there = snapshot.truth_links[0], snapshot.truth_objects[objects.index(reference)]
    R_WB = matrix_from_quaternion(base[3:])
    p, R = R_WB.T @ (there[:3] - base[:3]), R_WB.T @ matrix_from_quaternion(there[3:])
    return tool_pose(p, R, ORIGIN, np.eye(3))


def sizes(shape: AnyShape) -> tuple[float, ...]:
    """The sizes of a shape [mm], in the order of `SIZES`; none of one that keeps its own."""
    match shape:
        case Sphere(radius=radius):
            return (1000.0 * radius,)
        case Box(size=(x, y, z)):
            return 1000.0 * x, 1000.0 * y, 1000.0 * z
        case Cylinder(radius=radius, height=height):
            return 1000.0 * radius, 1000.0 * height
        case _:
            return ()


def sized(shape: AnyShape, values: tuple[float, ...]) -> AnyShape:
    """The shape with other sizes [mm], as many as it has."""
    lengths = tuple(round(value / 1000.0, 6) for value in values)
    if isinstance(shape, Sphere):
        return Sphere(radius=lengths[0])
    if isinstance(shape, Cylinder):
        return Cylinder(radius=lengths[0], height=lengths[1])
    return Box(size=cast("tuple[float, float, float]", lengths)) if isinstance(shape, Box) else shape


def tool_pose(p_BF: Array, R_BF: Array, tcp: Vector, R_FT: Array) -> Pose:
    """Pose of the tool centre point in B, of a flange and a tool."""
    R = R_BF @ R_FT
    x, y, z = (p_BF + R_BF @ np.array(tcp)).tolist()
    a, b, c, d, e, f, g, h, i = R.ravel().tolist()
    return Pose((x, y, z), (a, b, c, d, e, f, g, h, i))


def tool_now(snapshot: Snapshot) -> Pose:
    """Of the tool centre point, in B, as the controller knows it."""
    seen = snapshot.estimate
    x, y, z = snapshot.p_FT.tolist()
    return tool_pose(seen.p_BF, seen.R_BF, (x, y, z), snapshot.R_FT)


def inwards(area: Area) -> Vector:
    """From the plane of a half-space to its allowed side, in the shape's axes, of length 1."""
    assert isinstance(area.shape, HalfSpace)
    size = math.hypot(*area.shape.normal)
    sign = 1.0 if area.keep_out else -1.0
    x, y, z = area.shape.normal
    return sign * x / size, sign * y / size, sign * z / size


def about(border: AnyBorder) -> str:
    """What is to be seen of a border in a list."""
    if not border.on:
        return "off"
    side = word(SIDES, border.keep_out).lower() if isinstance(border, Area) else "round it"
    moves = "" if border.reference == "base" else f", with {word(FIXED, border.reference).lower()}"
    return f"{word(PARTS, border.part)}: {side}{moves}"


def listed(borders: Sequence[AnyBorder], on: bool) -> str:
    """All borders in a list, none of which holds while walls are not `on` at all."""
    if not borders:
        text = "A wall holds the arm while a hand guides it, and stops programs and jogging at its border."
        return svg.note("No wall yet", text, Colour.GREY)
    told = "" if on else svg.note("All walls are off", "Settings, Virtual walls and areas, switches them on.", Colour.AMBER)
    return told + svg.facts([(border.name, about(border) if on else "off") for border in borders])


def word(words: Mapping[str, object], value: object) -> str:
    """The word of a value."""
    return next((name for name, each in words.items() if each == value), str(value))


def _matrix(R: Rotation) -> Array:
    return np.array(R).reshape(3, 3)
