"""Jogging: a motion of one joint, of the tool along or about one axis, or to a posture, for as long as a button is held."""

import math
from typing import Annotated, Literal, NamedTuple, Self

from msgspec import Meta

from pendant.program.steps import JointMove, LinearMove, Move
from pendant.tick.estimate import Estimate

LONGEST = 1.0
"""Of a single step [m or rad]."""

NAMES = ("x", "y", "z", "rx", "ry", "rz")
"""Along x, y, z, and about them."""

TURNS = 3
"""Axes from here on are turned about."""


class JogMove(Move, tag="jog", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One joint, or the tool centre point along (0, 1, 2) or about (3, 4, 5) an axis of the base or of the tool."""

    frame: Literal["joint", "base", "tool"]
    axis: int  # from 0: of the joint, or of x, y, z along, then x, y, z about
    sign: Literal[-1, 1]
    length: float = 0.0  # after which it ends by itself [m or rad]; 0: it goes on while the button is held

    @property
    def what(self) -> str:
        """The motion in words."""
        sign = "+" if self.sign > 0 else "-"
        if self.frame == "joint":
            return f"joint {self.axis + 1} {sign}"
        axis = NAMES[self.axis] if 0 <= self.axis < len(NAMES) else f"axis {self.axis}"
        return f"{self.frame} {axis} {sign}"

    def moved(self, start: "JogPlace", now: "JogPlace") -> str:
        """How far it has gone from `start` to `now`, and of how much, in words: of the joint, or of the tool centre point."""
        if self.frame == "joint":
            gone = abs(now.q[self.axis] - start.q[self.axis])
        elif self.axis < TURNS:
            return _of(1000.0 * math.dist(now.p, start.p), 1000.0 * self.length, " mm")
        else:
            gone = start.turn_to(now)
        return _of(math.degrees(gone), math.degrees(self.length), "°")


class MoveThere(JointMove, tag="there", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """To joint angles while a button is held, all joints arriving together, at manual speed at most."""

    name: Annotated[str, Meta(min_length=1, max_length=40)] = "the posture"  # where that is, in words

    @property
    def what(self) -> str:
        """The motion in words."""
        return f"to {self.name}"

    def moved(self, start: "JogPlace", now: "JogPlace") -> str:
        """How far it has gone from `start` to `now`, and of how much, in words: the joint with the longest way."""
        ways = [abs(goal - began) for goal, began in zip(self.q, start.q, strict=True)]
        joint = ways.index(max(ways))
        return _of(math.degrees(abs(now.q[joint] - start.q[joint])), math.degrees(ways[joint]), "°")


class MoveStraight(LinearMove, tag="straight", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point straight to a pose while a button is held, at manual speed at most."""

    @property
    def what(self) -> str:
        """The motion in words."""
        return "straight to the pose"

    def moved(self, start: "JogPlace", now: "JogPlace") -> str:
        """How far it has gone from `start` to `now`, and of how much, in words: its way, or its turn on the spot."""
        whole = 1000.0 * math.dist(self.position, start.p)
        if whole < 1.0:
            return _of(math.degrees(start.turn_to(now)), 0.0, "°")
        return _of(1000.0 * math.dist(now.p, start.p), whole, " mm")


Jogged = JogMove | MoveThere | MoveStraight
"""What a held button moves."""


class JogPlace(NamedTuple):
    """Where the arm is, for how far it is jogged."""

    q: tuple[float, ...]  # output angles [rad]
    p: tuple[float, ...]  # tool centre point in B [m]
    R: tuple[float, ...]  # R_BF, row by row

    @classmethod
    def of(cls, seen: Estimate) -> Self:
        """That of an estimate."""
        return cls(tuple(seen.q.tolist()), tuple(seen.tcp[:3].tolist()), tuple(seen.R_BF.ravel().tolist()))

    def turn_to(self, other: "JogPlace") -> float:
        """Angle between two orientations [rad]: the trace of the matrix of a turn by an angle is 1 + 2 cos(angle)."""
        trace = sum(a * b for a, b in zip(self.R, other.R, strict=True))
        return math.acos(max(-1.0, min(1.0, (trace - 1.0) / 2.0)))


def _of(gone: float, whole: float, unit: str) -> str:
    return f"{gone:.0f} of {whole:.0f}{unit}" if whole else f"{gone:.0f}{unit}"


def unfit(move: Jogged, n_joints: int) -> str | None:
    """Why an arm of `n_joints` cannot be jogged like that, or None."""
    if isinstance(move, MoveStraight):
        return None
    if isinstance(move, MoveThere):
        return None if len(move.q) == n_joints else f"{len(move.q)} joint angles, allowed: {n_joints}"
    count = n_joints if move.frame == "joint" else 2 * TURNS
    if not 0 <= move.axis < count:
        return f"axis {move.axis}, allowed: 0 .. {count - 1}"
    if not (math.isfinite(move.length) and 0.0 <= move.length <= LONGEST):
        return f"length {move.length:g}, allowed: 0 .. {LONGEST:g}"
    return None
