"""The workspace: the areas that bind every motion which the arm makes by itself, a program's, a script's, a jogged one (VW-9).

A hand is resisted, and its free-drive has consequences; a motion that the arm makes by itself is braked before the border. What
is told of a border here follows from joint angles alone: the areas lie in frames that stand still in B, or move with the arm.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

from pendant.tick.estimate import GRAVITY
from pendant.tick.pose import HERE, Pose, Vector, seen_from
from pendant.walls.definitions import Area, Measure
from pendant.walls.placed_shape import PlacedShape

TOLERANCE = 0.001
"""So far beyond a border, or beyond where it began outside, a motion may lead [m]: a posture that was taught at a border, where
a hand was stopped, can be gone to, and a way along a border stays one."""

SIDEWAYS = 0.0002
"""A motion whose rest is not known may come so much further out than where it began [m]: along a border it bends so much on the
way on which it would stop."""


class ArmPoints(NamedTuple):
    """Where the arm is in a posture, as walls see it. Everything in B."""

    flange: Pose
    tcp: Pose
    elbow: Vector  # [m]
    gravity: Vector  # [m/s²]
    load: float  # configured: payload and tool [kg]

    @property
    def places(self) -> dict[str, Vector]:
        """The parts that a wall can watch, by name [m]."""
        return {"flange": self.flange.p, "tcp": self.tcp.p, "elbow": self.elbow}


class Nearby(NamedTuple):
    """A part and the border of an area."""

    border: Area
    distance: float  # to the border, negative where the part may be [m]
    outward: Vector  # the direction that leads out, of length 1, axes of B
    p: Vector  # of the part, in B [m]


class Workspace:
    """Areas that hold together.

    Args:
        areas: they lie in these frames, or move with flange or tcp.
        frames: poses X_BR of the frames that stand still in B.
    """

    def __init__(self, areas: tuple[Area, ...], frames: Mapping[str, Pose]) -> None:
        self.areas = areas
        self._frames = frames
        self._shapes = tuple([PlacedShape(area) for area in areas])
        self._measured = any(area.size is not None for area in areas)

    def distances(self, points: ArmPoints) -> list[float]:
        """Of each area's part to its border [m], negative where the part may be; in the order of `areas`."""
        places, measures = points.places, self._measures(points)
        return [self._near(k, points, places, measures)[0] for k in range(len(self.areas))]

    def nearby(self, k: int, points: ArmPoints) -> Nearby:
        """Area `k` and its part."""
        places = points.places
        distance, outward = self._near(k, points, places, self._measures(points))
        return Nearby(self.areas[k], distance, outward, places[self.areas[k].part])

    def _measures(self, points: ArmPoints) -> Mapping[Measure, float]:
        return measures(points.flange.p, points.gravity, points.load) if self._measured else {}

    def _near(
        self, k: int, points: ArmPoints, places: Mapping[str, Vector], known: Mapping[Measure, float]
    ) -> tuple[float, Vector]:
        area = self.areas[k]
        place, name = places[area.part], area.reference
        reference = points.flange if name == "flange" else points.tcp if name == "tcp" else self._frames[name]
        local = place if reference is HERE else seen_from(reference, place)
        factor = 1.0 if area.size is None else area.size.factor(known)
        return self._shapes[k].measure(local, area.position, factor, reference)


class OutwardLimits:
    """How far out each part may be: to the border, or where it begins outside, not further than there (VW-10).

    A part that is outside may come back and may not go out again: its outermost place goes with it.

    Attributes:
        place: the outermost place of each part, as its distance to the border [m], 0 or more.
        bound: of a motion whose rest is not known, likewise [m].
    """

    def __init__(self, count: int) -> None:
        self.place = [math.inf] * count
        self.bound = [math.inf] * count

    def begin(self, distances: list[float]) -> None:
        """A motion begins there."""
        for k, distance in enumerate(distances):
            # Beyond it somebody else has brought the part, which is no reason to hold it there.
            moved = distance > self.place[k] + TOLERANCE
            self.place[k] = distance if moved else min(self.place[k], max(distance, 0.0))
            self.bound[k] = min(max(self.place[k], distance) + SIDEWAYS, self.place[k] + TOLERANCE)

    def step(self, distances: list[float]) -> None:
        """The motion has come there."""
        for k, distance in enumerate(distances):
            inner = max(distance, 0.0)
            if inner < self.place[k]:
                self.place[k] = inner
                self.bound[k] = min(self.bound[k], inner + TOLERANCE)

    def beyond(self, distances: list[float]) -> int | None:
        """Which part has left what it may, the one that is furthest out; None: none has."""
        out = [distance - place - TOLERANCE for distance, place in zip(distances, self.place, strict=True)]
        furthest = max(range(len(out)), key=out.__getitem__)
        return furthest if not out[furthest] <= 0.0 else None

    def copy(self) -> "OutwardLimits":
        """The same, for a look ahead."""
        twin = OutwardLimits(0)
        twin.place, twin.bound = self.place[:], self.bound[:]
        return twin


def measures(flange: Vector, gravity: Vector, load: float) -> dict[Measure, float]:
    """What sizes depend on; a measure that is not in it gives the smallest size.

    Args:
        flange: its place in B [m].
        gravity: in B [m/s²].
        load: configured [kg].
    """
    x, y, z = flange
    gx, gy, gz = gravity
    return {
        Measure.REACH: math.sqrt(x * x + y * y + z * z),
        Measure.HEIGHT: -(x * gx + y * gy + z * gz) / GRAVITY,
        Measure.PAYLOAD: load,
    }


def told(near: Nearby) -> str:
    """Why a motion ends there, in words: which part, which area, and the way back."""
    out = f"{1000.0 * near.distance:.0f} mm beyond" if near.distance > 2.0 * TOLERANCE else "at the border of"
    return f"{near.border.part} {out} {near.border.name}; back is {way(near.outward)} of the base"


def way(outward: Vector) -> str:
    """The way back in, along axes of B: those that it leads along by more than 24° from square, of three at least one."""
    return "".join([_word(-share, axis) for share, axis in zip(outward, "xyz", strict=True)]).strip()


def _word(share: float, axis: str) -> str:
    """An axis of B with its sign, if the way leads along it."""
    return f" {'+' if share > 0.0 else '-'}{axis}" if abs(share) >= 0.4 else ""
