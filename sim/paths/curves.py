"""Ways of the tool centre point: lines, a circle through three points, and lines that circles join."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.frames import cross, rotation_vector
from sim.compiled.record import Record
from sim.paths.timing_law import MoveRefused
from sim.paths.way_following import piece_record

Array = NDArray[np.float64]

NEAREST = 1e-4
"""Two of the three points are one, or all are on a line, within this [m]."""

LEVER = 0.3
"""A pure turn counts as an arc of this radius [m]."""

SHARPEST = math.radians(170.0)
"""A corner that turns by more is a way back, which no circle joins [rad]."""

STRAIGHT = 1e-4
"""A corner that turns by less goes straight on [rad]."""

NO_WAY = 1e-6
"""A way that is no way [m]."""


class Straight:
    """A line from a place, whose orientation turns evenly.

    Args:
        p: tool centre point (3,) in B [m].
        R: orientation of the flange (3, 3).
        way: of the tool centre point (3,) [m].
        turn: axis times angle, in axes of the flange (3,) [rad].

    Attributes:
        length: of the way, or of a turn with hardly any [m].
        record: as of `sim.paths.way_following.piece_record`.
    """

    def __init__(self, p: Array, R: Array, way: Array, turn: Array) -> None:
        self.p, self.R, self.way, self.turn = p, R, way, turn
        size, turning = float(np.linalg.norm(way)), LEVER * float(np.linalg.norm(turn))
        self.goes = size > NO_WAY and size >= turning  # its length is the tool's way
        self.length = max(size, turning)
        share = 1.0 / self.length if self.length > 0.0 else 0.0
        self.record = _record(self.length, p=p, u=share * way, R=R, c=(np.zeros(3), share * turn))


class Circle:
    """An arc through three points.

    Args:
        p: tool centre point at its begin (3,) in B [m].
        via: a point on it (3,) [m].
        end: of it (3,) [m].

    Attributes:
        angle: of the arc [rad].
        axis: that it goes round, right-handed (3,).
        radius: [m].

    Raises:
        MoveRefused: there is no circle through the three.
    """

    def __init__(self, p: Array, *, via: Array, end: Array) -> None:
        a, b = via - p, end - p
        normal = np.cross(a, b)
        size = float(np.linalg.norm(normal))
        if min(float(np.linalg.norm(a)), float(np.linalg.norm(b)), float(np.linalg.norm(b - a))) < NEAREST:
            raise MoveRefused("circular move: two of its three points are the same")
        if size < NEAREST * max(float(np.linalg.norm(a)), float(np.linalg.norm(b))):
            raise MoveRefused("circular move: its three points are on a line; use a linear move")
        # Centre of the circle through the origin, a and b, from the origin.
        across = (np.dot(a, a) * np.cross(b, normal) + np.dot(b, b) * np.cross(normal, a)) / (2.0 * size * size)
        self._centre, self.axis = p + across, normal / size
        self.radius = float(np.linalg.norm(across))
        self._out = -across  # from the centre to the begin
        self._aside = cross(self.axis, self._out)
        x, y = float(np.dot(end - self._centre, self._out)), float(np.dot(end - self._centre, self._aside))
        self.angle = math.atan2(y, x) % (2.0 * math.pi)

    def turning(self, R: Array, turn: Array, length: float) -> "Arc":
        """The arc from orientation R (3, 3) of the flange, which turns by `turn` (3,) in axes of the flange [rad].

        `length` [m]: what counts as the arc's, which its speed is the speed of.
        """
        record = _record(
            length,
            p=self._centre,
            out=self._out,
            aside=self._aside,
            k=self.angle / length,
            R=R,
            c=(np.zeros(3), turn / length),
        )
        return Arc(record, length)


class Arc(NamedTuple):
    """A circle's arc, whose orientation turns evenly."""

    record: Record
    length: float  # [m]


class Corner:
    """A circle from `radius` before the end of one line to `radius` after the begin of the next.

    The tool's speed keeps its size and the orientation has no step in its speed: it goes as a cubic curve from what the first
    line has to what the second has. Where the second goes straight on, so does the corner.

    Args:
        first: ends where `second` begins.
        second: goes on.
        radius: of the blend [m].
    """

    def __init__(self, first: Straight, second: Straight, radius: float) -> None:
        u, v = first.way / first.length, second.way / second.length
        angle = between(first, second)
        begin = first.p + first.way - radius * u
        leaving, entering = first.turn / first.length, second.turn / second.length  # for a metre
        if angle < STRAIGHT:
            self.length = 2.0 * radius
            # Both directions are one within STRAIGHT; it ends where the second goes on.
            place = {"p": begin, "u": (second.p + radius * v - begin) / self.length}
        else:
            bend = radius / math.tan(0.5 * angle)  # radius of the circle
            self.length = bend * angle
            aside = (v - math.cos(angle) * u) / math.sin(angle)
            place = {"p": begin + bend * aside, "out": -bend * aside, "aside": bend * u, "k": 1.0 / bend}
        ends = (-radius * leaving, self.length * leaving, radius * entering, self.length * entering)
        # Hermite's cubic curve, from two ends and the slopes there, in powers of the share.
        cubic = ((1, 0, 0, 0), (0, 1, 0, 0), (-3, -2, 3, -1), (2, 1, -2, 1))
        c = [sum((w * e for w, e in zip(row, ends, strict=True)), np.zeros(3)) / self.length**k for k, row in enumerate(cubic)]
        self.record = _record(self.length, **place, R=second.R, c=c)


Piece = Straight | Arc | Corner


def _record(length: float, *, c: "list[Array] | tuple[Array, ...]", **numbers: "Array | float") -> Record:
    made = piece_record()
    own = made[0]
    own["length"] = length
    for name, value in numbers.items():
        own[name] = value
    for k, row in enumerate(c):
        own["c"][k] = row
    own["turns_evenly"] = len(c) == 2
    return made


def between(first: Straight, second: Straight) -> float:
    """The angle by which the way turns from one line to the next [rad]."""
    u, v = first.way / first.length, second.way / second.length
    return math.atan2(float(np.linalg.norm(np.cross(u, v))), float(u @ v))


class Part(NamedTuple):
    """Of a path: a piece from one of its places to another [m]."""

    piece: Piece
    first: float
    last: float
    begin: float  # of the part, on the path

    @property
    def end(self) -> float:
        """Of the part, on the path."""
        return self.begin + self.last - self.first


class Path:
    """Pieces one after the other, by the way along them [m].

    Args:
        parts: of the path.
        p: tool centre point at its end (3,) in B [m].
        R: orientation of the flange there (3, 3).
    """

    def __init__(self, parts: tuple[Part, ...], p: Array, R: Array) -> None:
        self.parts, self._p, self._R = parts, p, R
        self.length = parts[-1].end

    @classmethod
    def of(cls, piece: Piece, p: Array, R: Array) -> "Path":
        """A path of a single piece, to a place and an orientation."""
        return cls((Part(piece, 0.0, piece.length, 0.0),), p, R)

    def part(self, s: float) -> Part:
        """The part that a place of the path is on."""
        for part in self.parts:
            if s <= part.end:
                return part
        return self.parts[-1]

    def goes_on(self, p: Array, R: Array, *, radius: float, s: float) -> "Path | None":
        """The path with one more line, for a tool that is at `s`; None where no circle leads over to it.

        Args:
            p: end of the line (3,) in B [m].
            R: orientation of the flange there (3, 3).
            radius: of the blend at its begin, at most [m].
            s: where the tool is [m].
        """
        line, last = straight_to(self._p, self._R, p, R), self.parts[-1]
        first = last.piece
        if not isinstance(first, Straight) or not (first.goes and line.goes):
            return None
        radius = min(radius, line.length, last.last - last.first, self.length - s)
        if radius <= NO_WAY or between(first, line) > SHARPEST:
            return None
        corner = Corner(first, line, radius)
        begin = self.length - radius
        parts = (
            *(part for part in self.parts[:-1] if part.end >= s),
            last._replace(last=last.last - radius),
            Part(corner, 0.0, corner.length, begin),
            Part(line, radius, line.length, begin + corner.length),
        )
        return Path(parts, p, R)


def straight_to(p: Array, R: Array, end: Array, R_end: Array) -> Straight:
    """The line from tool centre point p (3,) [m] and orientation R (3, 3) of the flange to those at its end."""
    return Straight(p, R, end - p, rotation_vector(R.T @ R_end))
