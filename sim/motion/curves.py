"""Ways of the tool centre point that bend: a circle through three points, and lines that circles join."""

import copy
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.frames import skew
from sim.motion.line import Line, rotation_by, rotation_vector
from sim.motion.moves import MoveRefused
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

NEAREST = 1e-4
"""Two of the three points are one, or all are on a line, within this [m]."""

LEVER = 0.3
"""A pure turn counts as an arc of this radius [m]."""

SPACING = 0.01
"""Between the places along a way that are looked at beforehand [m]."""

SHARPEST = math.radians(170.0)
"""A corner that turns by more is a way back, which no circle joins [rad]."""

STRAIGHT = 1e-4
"""One that turns by less is none [rad]."""

FEWEST = 4
"""Places of a piece that are looked at beforehand, at least."""

CLOSE = 1e-6
"""A way that is no way [m]."""


class Arc(Line):
    """From where the tool centre point is at joint angles q through `via` to `end`; its share `s` goes from 0 to 1.

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        q: joint angles at the begin (n,) [rad].
        via: on the way (3,) in B [m].
        end: of it (3,) [m].

    Attributes:
        angle: of the arc [rad].
        axis: that it goes round, right-handed (3,).
        radius: of the circle [m].

    Raises:
        MoveRefused: there is no circle through the three.
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, q: Array, *, via: Array, end: Array) -> None:
        super().__init__(dynamics, tcp, q)
        a, b = via - self.start, end - self.start
        normal = np.cross(a, b)
        size = float(np.linalg.norm(normal))
        if min(float(np.linalg.norm(a)), float(np.linalg.norm(b)), float(np.linalg.norm(b - a))) < NEAREST:
            raise MoveRefused("circular move: two of its three points are the same")
        if size < NEAREST * max(float(np.linalg.norm(a)), float(np.linalg.norm(b))):
            raise MoveRefused("circular move: its three points are on a line; use a linear move")
        self._origin = self.start
        # Centre of the circle through the origin, a and b, from the origin.
        across = (np.dot(a, a) * np.cross(b, normal) + np.dot(b, b) * np.cross(normal, a)) / (2.0 * size * size)
        self._centre, self.axis = self.start + across, normal / size
        self.radius = float(np.linalg.norm(across))
        self._out = -across  # from the centre to the begin
        self._aside = np.cross(self.axis, self._out)
        x, y = float(np.dot(end - self._centre, self._out)), float(np.dot(end - self._centre, self._aside))
        self.angle = math.atan2(y, x) % (2.0 * math.pi)

    def solve(self, q: Array, s: float, rate: float) -> Array:
        """Joint speeds (n,) at q, for the share `s` of the arc and its rate [1/s]."""
        c, d = math.cos(s * self.angle), math.sin(s * self.angle)
        self.way = self.angle * (c * self._aside - d * self._out)  # the tangent, which the line has at this share
        self.start = self._centre + c * self._out + d * self._aside - s * self.way
        return super().solve(q, s, rate)


class PathPlace(NamedTuple):
    """Of a path, and how it goes on there for each metre of it."""

    p: Array  # tool centre point (3,) in B [m]
    R: Array  # orientation of the flange (3, 3)
    way: Array  # (3,) in B
    turn: Array  # (3,) in axes of the flange [rad/m]


class Straight:
    """A line from a place, whose orientation turns evenly.

    Args:
        p: tool centre point (3,) in B [m].
        R: orientation of the flange (3, 3).
        way: of the tool centre point (3,) [m].
        turn: axis times angle, in axes of the flange (3,) [rad].

    Attributes:
        length: of the way, or of a turn with hardly any [m].
    """

    def __init__(self, p: Array, R: Array, way: Array, turn: Array) -> None:
        self.p, self.R, self.way, self.turn = p, R, way, turn
        size, turning = float(np.linalg.norm(way)), LEVER * float(np.linalg.norm(turn))
        self.goes = size > CLOSE and size >= turning  # its length is the tool's way
        self.length = max(size, turning)

    def at(self, s: float) -> PathPlace:
        """The place `s` metres from its begin."""
        share = s / self.length
        R = self.R @ rotation_by(share * self.turn)
        return PathPlace(self.p + share * self.way, R, self.way / self.length, self.turn / self.length)


class Corner:
    """A circle from `radius` before the end of one line to `radius` after the begin of the next.

    The tool's speed keeps its size and the orientation has no step in its speed: it goes as a cubic curve from what the first
    line has to what the second has.

    Args:
        first: ends where `second` begins.
        second: goes on in another direction.
        radius: of the blend [m].
    """

    def __init__(self, first: Straight, second: Straight, radius: float) -> None:
        u, v = first.way / first.length, second.way / second.length
        angle = between(first, second)
        self._u, self._n = u, (v - math.cos(angle) * u) / math.sin(angle)
        self._radius = radius / math.tan(0.5 * angle)
        self.length = self._radius * angle
        self._begin = first.p + first.way - radius * u
        self._R = second.R
        leaving, entering = first.turn / first.length, second.turn / second.length  # for a metre
        self._curve = (-radius * leaving, self.length * leaving, radius * entering, self.length * entering)

    def at(self, s: float) -> PathPlace:
        """The place `s` metres from its begin."""
        angle, x = s / self._radius, s / self.length
        across = self._radius * (math.sin(angle) * self._u + (1.0 - math.cos(angle)) * self._n)
        way = math.cos(angle) * self._u + math.sin(angle) * self._n
        hermite = (2 * x**3 - 3 * x**2 + 1, x**3 - 2 * x**2 + x, 3 * x**2 - 2 * x**3, x**3 - x**2)
        change = (6 * x**2 - 6 * x, 3 * x**2 - 4 * x + 1, 6 * x - 6 * x**2, 3 * x**2 - 2 * x)
        turned = sum((a * b for a, b in zip(hermite, self._curve, strict=True)), np.zeros(3))
        rate = sum((a * b for a, b in zip(change, self._curve, strict=True)), np.zeros(3)) / self.length
        return PathPlace(self._begin + across, self._R @ rotation_by(turned), way, _body_rate(turned, rate))


def between(first: Straight, second: Straight) -> float:
    """The angle by which the way turns from one line to the next [rad]."""
    u, v = first.way / first.length, second.way / second.length
    return math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v))


def _body_rate(vector: Array, rate: Array) -> Array:
    """Angular velocity in turned axes (3,), where a rotation's vector changes at a rate (right Jacobian of SO(3))."""
    angle, cross = float(np.linalg.norm(vector)), skew(vector)
    if angle < 1e-6:
        return rate - 0.5 * (cross @ rate)
    first, second = (1.0 - math.cos(angle)) / angle**2, (angle - math.sin(angle)) / angle**3
    return rate - first * (cross @ rate) + second * (cross @ cross @ rate)


class Part(NamedTuple):
    """Of a path: a piece from one of its places to another [m]."""

    piece: Straight | Corner
    first: float
    last: float
    begin: float  # of the part, on the path


class Lines(Line):
    """Lines and corners one after the other; `s` is the way along them [m].

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        q: joint angles at the begin (n,) [rad].
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, q: Array) -> None:
        super().__init__(dynamics, tcp, q)
        self._parts: tuple[Part, ...] = ()
        self._end = (self.start, self.R)

    @property
    def length(self) -> float:
        """Of all of it [m]."""
        return 0.0 if not self._parts else self._parts[-1].begin + self._parts[-1].last - self._parts[-1].first

    def begin(self, p: Array, R: Array) -> None:
        """The first line, to a place of the tool centre point with an orientation of the flange."""
        line = self._line_to(p, R)
        self._parts, self._end = (Part(line, 0.0, line.length, 0.0),), (p, R)

    def goes_on(self, p: Array, R: Array, *, radius: float, s: float) -> "Lines | None":
        """The path with one more line, for a tool that is at `s`; None where no circle leads over to it.

        Args:
            p: end of the line (3,) in B [m].
            R: orientation of the flange there (3, 3).
            radius: of the blend at its begin, at most [m].
            s: where the tool is [m].
        """
        line, last = self._line_to(p, R), self._parts[-1]
        first = last.piece
        if not isinstance(first, Straight) or not (first.goes and line.goes):
            return None
        radius = min(radius, line.length, last.last - last.first, self.length - s)
        angle = between(first, line)
        if radius <= CLOSE or angle > SHARPEST:
            return None
        path = copy.copy(self)
        path._end = (p, R)
        before = tuple(part for part in self._parts[:-1] if part.begin + part.last - part.first >= s)
        if angle < STRAIGHT:
            path._parts = (*before, last, Part(line, 0.0, line.length, self.length))
            return path
        corner = Corner(first, line, radius)
        begin = self.length - radius
        path._parts = (
            *before,
            last._replace(last=last.last - radius),
            Part(corner, 0.0, corner.length, begin),
            Part(line, radius, line.length, begin + corner.length),
        )
        return path

    def samples(self, s: float) -> list[float]:
        """Places from `s` to the end that are to be looked at."""
        places: list[float] = []
        for part in self._parts:
            end = part.begin + part.last - part.first
            begin = max(part.begin, s)
            if end - begin > CLOSE:
                count = max(FEWEST, math.ceil((end - begin) / SPACING))
                places += [begin + k / count * (end - begin) for k in range(count)]
        return [*places, self.length]

    def solve(self, q: Array, s: float, rate: float) -> Array:
        """Joint speeds (n,) at q, for a place of the path [m] and the speed along it [m/s]."""
        part = next((part for part in self._parts if s <= part.begin + part.last - part.first), self._parts[-1])
        spot = part.piece.at(part.first + min(max(s - part.begin, 0.0), part.last - part.first))
        self.start, self.R, self.way, self.turn = spot
        return super().solve(q, 0.0, rate)

    def _line_to(self, p: Array, R: Array) -> Straight:
        start, R_start = self._end
        return Straight(start, R_start, p - start, rotation_vector(R_start.T @ R))
