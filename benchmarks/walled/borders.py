"""Areas of every shape, laid where a motion that was seen without them comes to a border, passes it, or begins beyond."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.walled.course import Track
from pendant.tick.pose import Pose, Rotation, Vector, rotation, seen_from, turned
from pendant.walls.definitions import Area, Dependence, Measure
from pendant.walls.shapes import AnyShape, Box, Cone, Cylinder, Ellipsoid, HalfSpace, Polyhedron, Pyramid, Sphere
from pendant.walls.workspace import Workspace, measures

Array = NDArray[np.float64]

PARTS = ("tcp", "elbow", "flange")
CLEAR = 0.05  # a motion that keeps so far off is not slowed [m]
NEAR = 0.15  # nor does it pass further off, where it is to be one that passes [m]
THROUGH = 0.02  # beyond the border, without it, of one that comes to it [m]
INSIDE = 0.03  # before it, at the begin [m]
DRAWS = 300
FEW = 40
"""Places of a motion that are looked at first."""


class Wanted(NamedTuple):
    """How a motion goes by a border, from its distances in all ticks [m]; negative inside."""

    fits: Callable[[Array], bool]
    gap: tuple[float, float]  # from the motion's place to the border, outwards, that the draw begins with [m]


def comes_back(d: Array) -> bool:
    """As long as it is outside it comes nearer, and inside it stays."""
    outside = np.maximum(d, 0.0)
    return bool((outside - np.minimum.accumulate(outside)).max() < 2e-4 and d.min() < d[0] - INSIDE)


WANTED: dict[str, Wanted] = {
    "comes to it": Wanted(lambda d: d[0] < -INSIDE and d.max() > THROUGH, (0.0, 0.0)),
    "passes it": Wanted(lambda d: -NEAR < d.max() < -CLEAR, (CLEAR, NEAR)),
    "passes near": Wanted(lambda d: d[0] < -INSIDE and -CLEAR < d.max() < 0.0, (0.0, CLEAR)),
    "begins beyond, comes back": Wanted(lambda d: d[0] > 0.01 and comes_back(d), (-0.05, -0.02)),
    "begins beyond, goes on": Wanted(lambda d: d[0] > 0.01 and d.max() > d[0] + THROUGH, (-0.05, -0.01)),
}


class Lay(NamedTuple):
    """What areas can be laid by."""

    rng: np.random.Generator
    frames: Mapping[str, Pose]  # that stand still in B
    track: Track  # without them


def lay(by: Lay, wanted: str) -> Area | None:
    """An area that the motion goes by as wanted; None where none is found."""
    fits, gap = WANTED[wanted]
    for _ in range(DRAWS):
        part = str(by.rng.choice(PARTS, p=(0.5, 0.35, 0.15)))
        moving = part == "elbow" and by.rng.random() < 0.4
        name = str(by.rng.choice(["tcp", "flange"])) if moving else str(by.rng.choice(list(by.frames)))
        area = _drawn(by, part, name, by.rng.uniform(*gap))
        few = by.track.points[:: max(len(by.track.points) // FEW, 1)]
        space = Workspace((area,), by.frames)
        if fits(np.array([space.distances(each)[0] for each in few])) and fits(by.track.distances(space)[:, 0]):
            return area
    return None


def _drawn(by: Lay, part: str, reference: str, gap: float) -> Area:
    """An area whose border is so far outwards of a place of the part on its way."""
    rng, points = by.rng, by.track.points
    at = points[int(rng.integers(len(points)))]
    frame = at.flange if reference == "flange" else at.tcp if reference == "tcp" else by.frames[reference]
    local = seen_from(frame, at.places[part])
    shape, keep_out = _shape(rng), bool(rng.random() < 0.5)
    size = _size(rng, by.track) if rng.random() < 0.2 else None
    factor = 1.0 if size is None else size.factor(measures(at.flange.p, at.gravity, at.load))
    w, x, y, z = (rng.normal(size=4)).tolist()
    length = float(np.linalg.norm((w, x, y, z)))
    quaternion = (w / length, x / length, y / length, z / length)
    R: Rotation = rotation(quaternion)
    place, outward = _on_surface(shape, rng)
    away = gap if not keep_out else -gap
    spot = turned(R, (place[0] * factor, place[1] * factor, place[2] * factor))
    lies = [p + away * n - s for p, n, s in zip(local, turned(R, outward), spot, strict=True)]
    given: dict[str, Any] = {"position": tuple(lies), "orientation": quaternion, "keep_out": keep_out}
    return Area(name=f"{part} and {reference}", part=part, reference=reference, shape=shape, size=size, **given)


def _on_surface(shape: AnyShape, rng: np.random.Generator) -> tuple[Vector, Vector]:
    """A point of a shape's surface, on a ray from its origin, and the direction outwards there."""
    field = shape.field()
    if isinstance(shape, HalfSpace):
        _, *n = field(0.0, 0.0, 0.0)
        return (0.0, 0.0, 0.0), (n[0], n[1], n[2])
    ray = rng.normal(size=3)
    ray /= np.linalg.norm(ray)
    low, high = 0.0, 5.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if field(*(middle * ray))[0] < 0.0 else (low, middle)
    x, y, z = (low * ray).tolist()
    _, a, b, c = field(x, y, z)
    return (x, y, z), (a, b, c)


def _shape(rng: np.random.Generator) -> AnyShape:
    """Any shape, from the size of a post to that of a room."""

    def length() -> float:
        return float(np.exp(rng.uniform(np.log(0.05), np.log(1.5))))

    kind = int(rng.integers(8))
    if kind == 0:
        return Sphere(radius=length())
    if kind == 1:
        return Ellipsoid(radii=(length(), length(), length()))
    if kind == 2:
        return Box(size=(length(), length(), length()))
    if kind == 3:
        return Cylinder(radius=length(), height=length())
    if kind == 4:
        return Cone(radius=length(), height=length())
    if kind == 5:
        return Pyramid(size=(length(), length()), height=length())
    if kind == 6:
        x, y, z = rng.normal(size=3).tolist()
        return HalfSpace(normal=(x, y, z))
    a, b, c = length(), length(), length()  # an octahedron
    corners = ((a, 0.0, 0.0), (-a, 0.0, 0.0), (0.0, b, 0.0), (0.0, -b, 0.0), (0.0, 0.0, c), (0.0, 0.0, -c))
    faces = ((0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5))
    return Polyhedron(vertices=corners, faces=faces)


def _size(rng: np.random.Generator, track: Track) -> Dependence:
    """A size that follows the flange's reach or height on this way (VW-8)."""
    measure = Measure.REACH if rng.random() < 0.5 else Measure.HEIGHT
    seen = [measures(each.flange.p, each.gravity, each.load)[measure] for each in track.points[::20]]
    low, high = min(seen) - 0.1, max(seen) + 0.1
    return Dependence(
        measure=measure, low=low, high=high, at_low=float(rng.uniform(0.7, 1.3)), at_high=float(rng.uniform(0.7, 1.3))
    )
