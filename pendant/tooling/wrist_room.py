"""Room for the wrist: whether a way leaves joint ranges, the arm, the plane of its base and the walls alone."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.equipment.tools import Tool
from pendant.tick.pose import Vector, seen_from
from pendant.tooling.arm_shape import ArmShape, Rod, apart
from pendant.tooling.settings import ToolUse
from pendant.walls.barrier import Place
from pendant.walls.definitions import AnyBorder, Area

Array = NDArray[np.float64]

WRIST = 3
"""Joints that turn the wrist: the last ones."""

CLEAR = 3
"""Links so far apart along the arm can meet; the makers shape nearer ones so that they cannot."""

TOOL = "what the tool holds"

ALIKE = 1e-6
"""Differences of distances below it are rounding [m or rad]."""


class Obstacle(NamedTuple):
    """What there is too little room to."""

    what: str
    gap: float  # least distance on the way [m or rad]


class WristRoom:
    """What the controller knows of the room round an arm whose wrist is about to turn.

    Nothing may come nearer than the clearance, or than it is where the wizard begins, or where a way begins, if that is nearer.

    Args:
        shape: of the arm.
        begin: posture in which the wizard begins (n,) [rad].
        tool: in use; a ball of `use.room` moves along from the flange to its centre point, for what it holds is not known.
        use: room and clearance.
        borders: walls and areas that hold, with where they lie.
    """

    __slots__ = ("_begin", "_borders", "_moving", "_pairs", "_rods", "_tcp", "_use", "shape")

    def __init__(
        self, shape: ArmShape, begin: Array, tool: Tool, use: ToolUse, *, borders: Sequence[tuple[AnyBorder, Place]] = ()
    ) -> None:
        self.shape, self._begin, self._use = shape, begin, use
        n = len(shape.names)
        self._tcp = np.array(tool.tcp)
        held = Rod(n, (0.0, 0.0, 0.0), tuple(tool.tcp), use.room)  # type: ignore[arg-type]  # in F
        self._rods = (*shape.rods, held)
        links = [min(rod.link, n - 1) for rod in self._rods]
        self._moving = [k for k, link in enumerate(links) if link >= n - WRIST]
        self._pairs = [(k, m) for k in self._moving for m, link in enumerate(links) if links[k] - link >= CLEAR]
        self._borders = [(border, place, border.shape.field()) for border, place in borders]

    def obstacle(self, way: Array) -> Obstacle | None:
        """What a way through postures (m, n) [rad] comes too near to, or None."""
        way = np.vstack([self._begin, way])
        origins, turns = self.shape.places(way)
        start, end = self.shape.ends(self._rods, origins, turns)
        low, high = self.shape.ranges.T
        gaps, names = [np.minimum(way - low, high - way)], [f"the end of the range of {name}" for name in self.shape.names]
        radii = np.array([rod.radius for rod in self._rods])
        if self._pairs:
            first, second = (list(side) for side in zip(*self._pairs, strict=True))
            gaps.append(apart(start[:, first], end[:, first], start[:, second], end[:, second]) - radii[first] - radii[second])
            names += [f"{self._name(a)} to {self._name(b)}" for a, b in self._pairs]
        moving = self._moving
        gaps.append(np.minimum(start[:, moving, 2], end[:, moving, 2]) - radii[moving])
        names += [f"{self._name(k)} to the plane of the base" for k in moving]
        points = self._points(origins, turns)
        for border, place, field in self._borders:
            sign = 1.0 if isinstance(border, Area) and border.keep_out else -1.0
            where = [seen_from(place.pose, _vector(p)) for p in points[border.part]]
            inside = [field(*(way / place.factor for way in p))[0] for p in where]
            gaps.append(sign * place.factor * np.array(inside)[:, None])
            names.append(f"{border.part} to the wall {border.name}")
        return self._worst(np.hstack(gaps), names)

    def _worst(self, gaps: Array, names: list[str]) -> Obstacle | None:
        """The narrowest of what is too narrow."""
        missing = np.minimum(self._use.clearance, gaps[:2].min(axis=0)) - gaps.min(axis=0)
        k = int(np.argmax(missing))
        return Obstacle(names[k], float(gaps[:, k].min())) if missing[k] > ALIKE else None

    def _name(self, k: int) -> str:
        link = self._rods[k].link
        if link == len(self.shape.names):
            return TOOL
        return "the foot" if link < 0 else self.shape.names[link]

    def _points(self, origins: Array, turns: Array) -> dict[str, Array]:
        """What a wall can watch, (m, 3) each [m]."""
        flange = origins[:, -1]
        return {"flange": flange, "tcp": flange + turns[:, -1] @ self._tcp, "elbow": origins[:, self.shape.elbow]}


def _vector(point: Array) -> Vector:
    x, y, z = point.tolist()
    return x, y, z
