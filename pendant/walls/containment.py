"""Walls and areas in the running robot: what they know of a tick, what they say and do in it (VW-6, VW-9)."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import msgspec
from msgspec.structs import replace

from pendant.events.event import Event, Kind, Values
from pendant.tick.estimate import Estimate
from pendant.tick.pose import HERE, ORIGIN, UNTURNED, Pose, Vector, flat, product
from pendant.tick.words import difference
from pendant.walls.barrier import Around, Consequence, Place, Reading, WatchedPart, placed
from pendant.walls.definitions import AnyBorder, Area, Measure, Policy, Start, Wall, problem
from pendant.walls.enclosure import Enclosure, worst
from pendant.walls.settings import WallSettings
from pendant.walls.shapes import Sphere
from pendant.walls.workspace import ArmPoints, Nearby, Workspace, measures, way

PARTS = ("flange", "tcp", "elbow")
"""The points of the arm that a wall can watch."""

TETHER = "tether"
"""Name of the wall that is always there: a sphere round the flange that follows the user, and nobody else (VW-4)."""

BACK = 0.01
"""A part is back from beyond an area that triggers REDUCED when it is so far inside [m]: at the border it switches once."""

NOBODY = (ORIGIN, ORIGIN, False)
"""The user's and the payload-like force where nothing is known of them, and nobody is known to lead the arm."""


def tether(walls: WallSettings) -> Wall:
    """The sphere round the flange, in the sizes of the settings."""
    return Wall(
        name=TETHER,
        shape=Sphere(radius=walls.operation_radius),
        policy=Policy.AVERAGE,
        averaging_period=walls.averaging,
        safety_period=walls.safety_period,
        band=min(walls.band, 0.8 * walls.operation_radius),
        activation_size=max(walls.activation_radius / walls.operation_radius, 0.05),
        push=walls.push,
        push_back=walls.push_back,
        reaction=walls.tether_reaction,
    )


class WallState(msgspec.Struct, frozen=True, gc=False):
    """A wall or an area in one tick, everything in B; the law pushes the part with its force, pictures draw it (VW-7)."""

    name: str
    part: str  # "flange", "tcp", "elbow"
    p: Vector  # of the part [m]
    distance: float  # to the wall, negative inside [m]
    outward: Vector  # direction towards the wall, of length 1
    near: float  # 0 before the feedback band, 1 at the wall and beyond
    exceeded: bool
    force: Vector  # on the part [N]


class Areas(NamedTuple):
    """The workspace of some areas, and what it was made of."""

    borders: tuple[AnyBorder, ...]
    walls: WallSettings
    space: Workspace | None  # None: there are none


class Containment:
    """All walls of one robot, from the activation period to leaving. It does nothing while they are switched off."""

    __slots__ = (
        "R_FT",
        "_beyond",
        "_enclosure",
        "_frames",
        "_measured",
        "_parts",
        "_points",
        "_reading",
        "_triggers",
        "_turned",
        "_workspace",
        "borders",
    )
    NOT_STATE = ("_triggers", "_workspace")  # they are made of the borders and the settings alone

    def __init__(self, borders: tuple[AnyBorder, ...], frames: Mapping[str, Pose]) -> None:
        """
        Args:
            borders: walls and areas beside the tether; `pendant.walls.definitions.problem` has found nothing.
            frames: poses X_BR of the frames and objects that they can lie in and that do not move in B.
        """
        self.R_FT = UNTURNED  # orientation of the tool centre point in the flange
        self.borders = borders
        self._frames = {"base": HERE, **frames}
        self._enclosure: Enclosure | None = None  # walls hold, or will
        self._reading: tuple[Reading, ...] = ()
        self._parts: tuple[str, ...] = ()
        self._points: dict[str, WatchedPart] = {}  # where they were in the last step
        self._turned: tuple[str, ...] = ()  # parts that are references
        self._measured = False
        self._beyond = ""  # name of the area that triggers REDUCED
        self._workspace: Areas | None = None
        self._triggers: Areas | None = None

    def workspace(self, walls: WallSettings) -> Workspace | None:
        """The areas that bind the arm's own motions, the same object until they change; None where there are none.

        A wall round a part is no part of it: free-drive anchors it, and a hand takes it along.
        """
        made = self._workspace = self._areas(self._workspace, walls, triggers=False)
        return made.space

    def beyond(self, estimate: Estimate, walls: WallSettings) -> str:
        """Name of the area that triggers REDUCED because its part is beyond it, or cannot be placed; "" where none is (RL-7)."""
        made = self._triggers = self._areas(self._triggers, walls, triggers=True)
        before, self._beyond = self._beyond, ""
        if made.space is not None:
            for area, distance in zip(made.space.areas, made.space.distances(self._seen(estimate)), strict=True):
                if not distance <= (-BACK if area.name == before else 0.0):
                    self._beyond = area.name
                    break
        return self._beyond

    def _areas(self, made: "Areas | None", walls: WallSettings, *, triggers: bool) -> "Areas":
        """The areas that trigger REDUCED, or those that keep their part; what was `made` before, while it holds."""
        if made is not None and made.borders is self.borders and made.walls is walls:
            return made
        switched = [_switched(border, walls) for border in self.borders if border.on and walls.on]
        held = tuple([area for area in switched if isinstance(area, Area) and area.triggers_reduced is triggers])
        return Areas(self.borders, walls, Workspace(held, self._frames) if held else None)

    def reached(self, estimate: Estimate, wall: str, walls: WallSettings) -> list[Event]:
        """The event of a motion that was stopped at the border of the area `wall`."""
        space = self.workspace(walls)
        names = [] if space is None else [area.name for area in space.areas]
        if space is None or wall not in names:
            return []  # it was deleted in this moment
        near = space.nearby(names.index(wall), self._seen(estimate))
        return [Event(Kind.MOTION_AT_WALL, estimate.tick, facts(near))]

    def change(self, borders: tuple[AnyBorder, ...], where: str, tick: int) -> list[Event]:
        """Take another list of borders, whole or not at all; what was holds on where it is refused.

        Args:
            borders: the list from now on.
            where: in which state no list is taken, if in this one; else "".
            tick: for the event.
        """
        if borders == self.borders:
            return []
        why_not = f"no change of a wall in {where}" if where else ""
        if not why_not and any(border.name == TETHER for border in borders):
            why_not = f"name: {TETHER!r} is the name of the wall that the settings make, allowed: another"
        why_not = why_not or problem(borders, frozenset(PARTS), frozenset({*self._frames, "flange", "tcp"})) or ""
        if why_not:
            return [Event(Kind.WALLS_REFUSED, tick, {"reason": why_not})]
        done, self.borders = difference(self.borders, borders), borders
        return [Event(Kind.WALLS_CHANGED, tick, {"change": done, "count": len(borders)})]

    def begin(self, start: Start, walls: WallSettings) -> None:
        """The activation period or the sequence begins."""
        if start is Start.ACTIVATION or self._enclosure is None:
            self._enclosure = self._build(walls)
        if self._enclosure is not None:
            self._enclosure.begin(start)

    def enter(self, walls: WallSettings) -> None:
        """FREE_DRIVE begins."""
        self._enclosure = self._build(walls)
        if self._enclosure is not None:
            self._enclosure.enter()

    def leave(self) -> None:
        """Nothing holds any more."""
        self._enclosure = None
        self._reading = ()

    def step(self, estimate: Estimate, user: Vector, payload: Vector, led: bool) -> Reading | None:
        """One tick; its joint values are finite. Returns what has the gravest consequence, if anything has one.

        Args:
            estimate: of this tick.
            user: the user's force, axes of B [N].
            payload: force of the payload-like residual, axes of B [N].
            led: somebody pays for the arm's motion (`pendant.guided.unintended_motion`).
        """
        if self._enclosure is None:
            return None
        parts = self._points
        for name in self._parts:
            parts[name] = _point(name, estimate)
        references = self._frames
        if self._turned:
            R_BF = flat(estimate.R_BF)
            turns = {"flange": R_BF, "tcp": product(R_BF, self.R_FT)}
            references = {**references, **{name: Pose(_point(name, estimate).p, turns[name]) for name in self._turned}}
        measures = _measures(estimate) if self._measured else {}
        self._reading = self._enclosure.step(Around(parts, references, user, payload, measures, led))
        return worst(self._reading)

    def states(self) -> tuple[WallState, ...]:
        """What the last step found, for the law and for pictures; without a wall that could not be told."""
        states = [
            WallState(r.border.name, r.border.part, r.p, r.distance, r.outward, r.near, r.exceeded, r.force)
            for r in self._reading
            if r.distance < math.inf
        ]
        return tuple(states)

    def places(self) -> tuple[tuple[AnyBorder, Place], ...]:
        """Every border that holds, with where its shape lies."""
        if self._enclosure is None:
            return ()
        pairs = zip([reading.border for reading in self._reading], self._enclosure.places(), strict=False)
        return tuple([(border, place) for border, place in pairs if place is not None])

    def every_place(self, walls: WallSettings) -> tuple[tuple[AnyBorder, Place], ...]:
        """What holds, and all other areas of the list, each with where its shape lies.

        Areas that do not hold yet and lie in a part of the arm are left out; one whose size follows the posture has its smallest.
        """
        hold = self.places()
        if not walls.on:
            return hold
        names = {border.name for border, _ in hold}
        areas = [border for border in self.borders if isinstance(border, Area) and border.reference in self._frames]
        rest = [area for area in areas if area.name not in names]
        return hold + tuple([(area, placed(area, area.position, area.least, self._frames[area.reference])) for area in rest])

    def _seen(self, estimate: Estimate) -> ArmPoints:
        R_BF, places = flat(estimate.R_BF), {name: _point(name, estimate).p for name in PARTS}
        gx, gy, gz = estimate.g_B.tolist()
        flange, tcp = Pose(places["flange"], R_BF), Pose(places["tcp"], product(R_BF, self.R_FT))
        return ArmPoints(flange, tcp, places["elbow"], (gx, gy, gz), estimate.load_mass)

    def _build(self, walls: WallSettings) -> Enclosure | None:
        borders = self.borders if not walls.tether else (tether(walls), *self.borders)
        borders = tuple([_switched(border, walls) for border in borders if border.keeps])
        if not walls.on or not borders:
            return None
        self._parts = tuple(sorted({border.part for border in borders}))
        self._turned = tuple({border.reference for border in borders} & {"flange", "tcp"})
        self._measured = any(
            border.size is not None or (isinstance(border, Wall) and border.safety_dependence is not None) for border in borders
        )
        return Enclosure(borders)


def _switched(border: AnyBorder, walls: WallSettings) -> AnyBorder:
    """The border without what is switched off."""
    if not walls.resistance:
        border = replace(border, band=0.0)
    if not walls.sizes and border.size is not None:
        border = replace(border, size=replace(border.size, at_low=border.least, at_high=border.least))
    if not walls.new_anchors and isinstance(border, Wall):
        border = replace(border, policy=Policy.FIXED)
    return border


def facts(reading: Reading | Nearby) -> Values:
    """What an event says of a wall: which, which part, where, how far out [mm], and the way back in."""
    x, y, z = reading.outward
    known = reading.distance < math.inf
    back = way(reading.outward) if known else "unknown"
    out = 1000.0 * reading.distance if known else 0.0
    px, py, pz = reading.p
    vectors = {"x": -x, "y": -y, "z": -z, "px": px, "py": py, "pz": pz}
    return {"wall": reading.border.name, "part": reading.border.part, "distance": out, "way": back} | vectors


def caught(reading: Reading | None) -> bool:
    """The arm is to keep its posture at the wall."""
    return reading is not None and reading.consequence is Consequence.HOLD


def _point(name: str, estimate: Estimate) -> WatchedPart:
    if name == "flange":
        x, y, z = estimate.p_BF.tolist()
        vx, vy, vz = estimate.v_F.tolist()[:3]
    else:
        x, y, z, vx, vy, vz = (estimate.tcp if name == "tcp" else estimate.elbow).tolist()
    return WatchedPart((x, y, z), (vx, vy, vz))


def _measures(estimate: Estimate) -> dict[Measure, float]:
    """What sizes depend on; a measure that is not in it gives the smallest size."""
    x, y, z = estimate.p_BF.tolist()
    gx, gy, gz = estimate.g_B.tolist()
    return measures((x, y, z), (gx, gy, gz), estimate.load_mass)
