"""One wall or area at work: its place, the part's distance to it, its resistance, and what follows (VW-1 to VW-10)."""

import math
from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

import msgspec

from pendant.limits.resistance import LimitGuard, closeness, resisting
from pendant.settings.schema import ticks
from pendant.tick.pose import HERE, ORIGIN, Pose, Vector, dot, finite, product, rotation, seen_from, turned
from pendant.walls.anchors import Anchor, Stay
from pendant.walls.definitions import AnyBorder, Measure, Policy, Wall
from pendant.walls.placed_shape import PlacedShape
from pendant.walls.settings import Reaction

WRONG_WAY = 0.005
"""A part that started outside has gone further out when it is so far beyond its place [m]."""

LET_GO = 0.5  # of the force that frees a caught part: with less, it is caught again


class Stage(IntEnum):
    """Which shape holds."""

    ACTIVATION = 0
    OPERATION = 1


class Consequence(IntEnum):
    """What a wall asks of the supervisor; the order is the severity."""

    NONE = 0
    HOLD = 1  # keep the posture; stay in FREE_DRIVE
    LEAVE = 2  # to the remembered mode
    STOP = 3  # to mode STOP
    REFUSE = 4  # do not enter (FD-10)


class WatchedPart(msgspec.Struct, frozen=True, gc=False):
    """A point of the arm in one tick."""

    p: Vector  # in B [m]
    v: Vector  # axes of B [m/s]


class Around(msgspec.Struct, frozen=True, gc=False):
    """What walls need to know of one tick. Everything in B."""

    parts: Mapping[str, WatchedPart]
    references: Mapping[str, Pose]  # X_BR of each reference
    user_force: Vector  # without the payload-like residual [N]
    payload_force: Vector  # of the payload-like residual [N]
    measures: Mapping[Measure, float]
    led: bool = False  # somebody pays for the arm's motion


class Reading(msgspec.Struct, frozen=True, gc=False):
    """One wall in one tick."""

    border: AnyBorder
    distance: float  # to the wall, negative inside, infinite when it cannot be told [m]
    outward: Vector  # direction towards the wall, or away from it outside, of length 1, axes of B; zeros when it cannot be told
    near: float  # 0 before the feedback band, 1 at the wall and beyond
    exceeded: bool
    consequence: Consequence
    force: Vector  # on the part, against motion outwards, axes of B [N]
    anchored: bool  # anew in this tick
    p: Vector = ORIGIN  # the part's place, where it is known [m]


class Place(NamedTuple):
    """Where a wall's shape lies, to draw it."""

    pose: Pose  # of the shape in B
    factor: float  # on the shape's lengths


class Barrier:
    """A wall or an area from its beginning, in one stage.

    Args:
        border: its settings.
        stage: which shape holds, and what follows when it is exceeded.
    """

    __slots__ = (
        "_anchor",
        "_anchors",
        "_base",
        "_before",
        "_border",
        "_caught",
        "_constant",
        "_guard",
        "_lies",
        "_offset",
        "_part",
        "_reference",
        "_shape",
        "_stage",
    )
    NOT_STATE = ("_shape",)  # it is made of the border alone

    def __init__(self, border: AnyBorder, stage: Stage) -> None:
        self._border = border
        self._stage = stage
        self._shape = PlacedShape(border)
        self._anchor: Anchor | None = None  # of a wall, from its first tick on
        self._guard: LimitGuard | None = None
        self._lies: tuple[Vector, float, Pose] | None = None  # anchor, factor, reference of the tick before
        self._before = 0.0  # distance in the tick before [m]
        self._part: Vector = ORIGIN  # place in the tick before, in B [m]
        self._caught = False
        self._reference: Pose | None = None  # the last one found finite
        self._anchors = False  # the anchor may move
        self._constant: tuple[int, int] | None = None  # safety and redefine period, unless they depend on something [ticks]
        if isinstance(border, Wall):
            self._base = border.activation_size if stage is Stage.ACTIVATION else border.operation_size
            self._offset: Vector = border.offset
            self._anchors = stage is Stage.OPERATION and border.policy is not Policy.FIXED
            safety = ticks(border.safety_period)
            if border.safety_dependence is None:
                self._constant = (safety, safety if border.redefine_period is None else ticks(border.redefine_period))
        else:
            self._base, self._offset = 1.0, ORIGIN

    def step(self, around: Around) -> Reading:
        """One tick. The first anchors a wall."""
        border = self._border
        part, reference = around.parts.get(border.part), around.references.get(border.reference)
        if part is None or reference is None:
            return self._lost()
        place, (vx, vy, vz) = part.p, part.v
        px, py, pz = place
        total = px + py + pz + vx + vy + vz
        if total - total != 0.0 or not (reference is self._reference or finite(reference)):
            return self._lost()
        self._reference = reference
        local = place if reference is HERE else seen_from(reference, place)
        factor = self._base if border.size is None else self._base * border.size.factor(around.measures)
        if self._anchor is not None:
            anchor = self._anchor.local
        elif isinstance(border, Wall):
            self._anchor = Anchor(border, local, ticks(border.averaging_period))
            anchor = self._anchor.local
        else:
            anchor = border.position
        distance, outward = self._shape.measure(local, anchor, factor, reference)
        guard = self._guard
        if guard is None:
            guard = self._guard = LimitGuard(distance)
            self._part, self._before = place, distance
        x, y, z = self._part
        moved = (px - x, py - y, pz - z)
        lay, lies, before = self._lies, (anchor, factor, reference), self._before
        self._lies, self._before, self._part = lies, distance, place
        exceeded = distance > 0.0
        near, force, consequence, anchored = 0.0, ORIGIN, _NONE, False
        if distance > -border.band or exceeded or guard.place > 0.0:
            nx, ny, nz = outward
            drift = 0.0
            if lay is not None and lies != lay:
                drift = distance - before - dot(outward, moved)
            near = closeness(distance, border.band)
            beyond = guard.step(distance, drift)
            if self._stage is _OPERATION:
                size = -self._resist(exceeded, beyond, near, vx * nx + vy * ny + vz * nz)
                force = (size * nx, size * ny, size * nz)
            if exceeded:
                consequence = self._consequence(beyond, dot(around.user_force, outward))
        self._caught = consequence is _HOLD
        if self._anchors:
            assert self._anchor is not None
            safety, redefine = self._constant or self._periods(around)
            user, payload = around.user_force, around.payload_force
            stay = Stay(local, outward, near > 0.0, exceeded, moved, user, payload, safety, redefine, around.led)
            anchored = self._anchor.step(stay)
        return Reading(border, distance, outward, near, exceeded, consequence, force, anchored, place)

    def place(self) -> Place | None:
        """Where the shape lies; None before the first tick."""
        if self._lies is None:
            return None
        (ax, ay, az), factor, reference = self._lies
        ox, oy, oz = self._offset
        return placed(self._border, (ax + factor * ox, ay + factor * oy, az + factor * oz), factor, reference)

    def _resist(self, exceeded: bool, beyond: float, near: float, speed: float) -> float:
        """Size of the resisting force [N]."""
        border, guard = self._border, self._guard
        assert guard is not None
        push = 0.0 if guard.started_outside else near * border.push  # who starts outside is not kicked (VW-10)
        if not exceeded:
            return min(push + resisting(near, speed, border.damping), border.force)
        return min(push + guard.resisting(beyond, speed, border.stiffness, border.damping), border.force)

    def _consequence(self, beyond: float, push: float) -> Consequence:
        """Of a part outside. `push`: the user's force outwards [N]."""
        assert self._guard is not None
        over = beyond > WRONG_WAY if self._guard.started_outside else True
        if self._stage is Stage.ACTIVATION:
            return Consequence.REFUSE if over else Consequence.NONE
        border = self._border
        if border.reaction is not Reaction.STAY:
            return _LEAVING[border.reaction] if over else Consequence.NONE
        # Caught until the user pushes it back; and again when the user lets go outside.
        if self._caught:
            held = push > -border.push_back
        else:
            held = over and push > -LET_GO * border.push_back
        return Consequence.HOLD if held else Consequence.NONE

    def _periods(self, around: Around) -> tuple[int, int]:
        """Safety and redefine period, where they depend on something [ticks]."""
        border = self._border
        assert isinstance(border, Wall)
        assert border.safety_dependence is not None
        safety = ticks(border.safety_period * border.safety_dependence.factor(around.measures))
        return safety, safety if border.redefine_period is None else ticks(border.redefine_period)

    def _lost(self) -> Reading:
        """The part or the reference is not known, or not finite: nothing can be told of the distance (FD-12)."""
        border = self._border
        if self._stage is Stage.ACTIVATION:
            consequence = Consequence.REFUSE
        else:
            consequence = _LEAVING[border.reaction]
        return Reading(border, math.inf, ORIGIN, 1.0, True, consequence, ORIGIN, False)


def placed(border: AnyBorder, centre: Vector, factor: float, reference: Pose) -> Place:
    """Where a border's shape lies when its centre is at `centre` of the reference [m]."""
    x, y, z = turned(reference.R, centre)
    px, py, pz = reference.p
    return Place(Pose((x + px, y + py, z + pz), product(reference.R, rotation(border.orientation))), factor)


_NONE, _HOLD, _OPERATION = Consequence.NONE, Consequence.HOLD, Stage.OPERATION  # looked up in every tick
_LEAVING = {Reaction.STAY: Consequence.LEAVE, Reaction.LEAVE: Consequence.LEAVE, Reaction.STOP: Consequence.STOP}
