"""Virtual walls as settings (VW-1 to VW-10): a list of these stands in a session file."""

import math
from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated

import msgspec
from msgspec import Meta

from pendant.settings.bounds import MOST_WALLS
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Quaternion, Vector, rotation, turned_back
from pendant.tick.words import Word
from pendant.walls.settings import Reaction
from pendant.walls.shapes import AnyShape, Coordinate

Period = Annotated[float, Meta(ge=0.1, le=10.0)]  # [s]
Factor = Annotated[float, Meta(ge=0.05, le=10.0)]
Name = Annotated[str, Meta(min_length=1, max_length=60)]

SAMPLED = 2.0 * TICK
"""A spring sampled every tick gives back energy unless its damper is at least half of stiffness times tick; four times that is
asked for here, since the force acts a tick late as well (Colgate and Schenkel, Passivity of a class of sampled-data systems)."""


class Policy(StrEnum):
    """When a wall round a part is anchored again (VW-3 to VW-5)."""

    FIXED = "fixed"
    STEPWISE = "stepwise"
    AVERAGE = "average"
    USER = "user"


class Start(StrEnum):
    """When the activation shape is anchored (VW-6)."""

    SEQUENCE = "sequence"  # with the activation sequence
    ACTIVATION = "activation"  # with the activation period


class Measure(Word):
    """What a size or a period can depend on (VW-3, VW-8)."""

    REACH = "reach"  # distance of the flange from the base's origin [m]
    HEIGHT = "height"  # of the flange above the base's origin, in W [m]
    MANIPULABILITY = "manipulability"  # sqrt(det(J J^T))
    PAYLOAD = "payload"  # configured mass [kg]


class Dependence(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A factor that runs straight from one value to another as a measure does, and stays where the measure is beyond (VW-8)."""

    measure: Measure
    low: float
    high: float
    at_low: Factor = 1.0
    at_high: Factor = 1.0

    def __post_init__(self) -> None:
        if not self.low < self.high or not math.isfinite(self.high - self.low):  # NaN is less than nothing
            raise ValueError(f"low: {self.low:g} is not allowed; allowed: less than high, {self.high:g}, both finite")

    @property
    def least(self) -> float:
        """The smallest factor."""
        return min(self.at_low, self.at_high)

    def factor(self, measures: Mapping[Measure, float]) -> float:
        """The factor now; the smallest when the measure is missing or not a number."""
        value = measures.get(self.measure, math.nan)
        if value != value:
            return self.least
        share = min(max((value - self.low) / (self.high - self.low), 0.0), 1.0)
        return self.at_low + share * (self.at_high - self.at_low)


class Border(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """What walls and areas have in common. Lengths of the shape and of where it lies on it grow with the size factor."""

    name: Name
    part: Name = "flange"  # the named point that is watched
    shape: AnyShape
    reference: Name = "base"  # the frame that the shape moves with: world, base, a part, an object (VW-2)
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)  # of the shape in the reference, wxyz
    size: Dependence | None = None  # VW-8
    band: Annotated[float, Meta(ge=0.0, le=0.5)] = 0.02  # width of the feedback band before the border [m]
    stiffness: Annotated[float, Meta(ge=0.0, le=20000.0)] = 4000.0  # beyond the border, against motion further out [N/m]
    damping: Annotated[float, Meta(ge=0.0, le=1000.0)] = 200.0  # at the border, against motion outwards [N·s/m]
    force: Annotated[float, Meta(ge=1.0, le=500.0)] = 150.0  # most that it resists with [N]
    push: Annotated[float, Meta(ge=0.0, le=100.0)] = 0.0  # back inwards at the border, at rest too; it grows through the band [N]
    push_back: Annotated[float, Meta(ge=1.0, le=50.0)] = 8.0  # smallest force that counts as the user's [N]
    reaction: Reaction = Reaction.LEAVE  # free-drive is kept only while the part is inside (P 84)
    on: bool = True  # it holds in free-drive; one that is off is only remembered

    def __post_init__(self) -> None:
        if not 0.999 < math.hypot(*self.orientation) < 1.001:
            raise ValueError(f"orientation: its length is {math.hypot(*self.orientation):.4g}, allowed: 1 (wxyz)")
        if self.reference == self.part:
            raise ValueError(f"reference: {self.reference!r} is the part itself, allowed: another frame")
        if self.damping < SAMPLED * self.stiffness:
            raise ValueError(f"damping: {self.damping:g} is too little, allowed: {SAMPLED:g} s of the stiffness or more")

    @property
    def least(self) -> float:
        """Smallest factor of the size."""
        return 1.0 if self.size is None else self.size.least

    @property
    def keeps(self) -> bool:
        """It keeps its part where it may be."""
        return self.on


class Wall(Border, tag="wall", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A shape round a part: the part stays inside. It is anchored where the part was, and anew as its policy says."""

    offset: tuple[Coordinate, Coordinate, Coordinate] = ORIGIN  # of the shape's centre from the part, in the reference's axes [m]
    policy: Policy = Policy.STEPWISE
    literal: bool = False  # stepwise and average: anchor also a part that nobody moved, as P 87 and P 88 say
    safety_period: Period = 1.0  # stepwise: anchored again only when not exceeded for so long (VW-3)
    safety_dependence: Dependence | None = None  # a factor on the safety period
    redefine_period: Period | None = None  # stepwise: how often; None: as the safety period
    averaging_period: Annotated[float, Meta(ge=0.02, le=10.0)] = 2.0  # average (VW-4) [s]
    step: Annotated[float, Meta(ge=0.002, le=0.5)] = (
        0.02  # user: how far away from the wall the user must move the part [m] (VW-5)
    )
    activation_size: Factor = 0.3  # factor on the shape in the activation sequence (VW-6)
    operation_size: Factor = 1.0  # factor on the shape in FREE_DRIVE
    anchored_at: Start = Start.SEQUENCE

    def __post_init__(self) -> None:
        super().__post_init__()
        depth = -self.shape.field()(*in_shape(self.orientation, self.offset))[0]
        if depth <= 0.0:
            raise ValueError(f"offset: the part would start {-1e3 * depth:.4g} mm outside the shape, allowed: inside")
        depth *= self.operation_size * self.least
        if self.band >= depth:
            raise ValueError(f"band: {self.band:g} m reaches to the part itself, allowed: less than {depth:.4g} m")


class Area(Border, tag="area", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """An allowed area (VW-9): a shape at a place of the reference that the part stays inside, or outside."""

    position: tuple[Coordinate, Coordinate, Coordinate] = ORIGIN  # of the shape's centre in the reference [m]
    keep_out: bool = False  # the shape's inside is forbidden instead of its outside
    triggers_reduced: bool = False  # beyond it the safety mode is REDUCED, and nothing keeps the part inside (RL-7)

    @property
    def keeps(self) -> bool:
        """It keeps its part where it may be."""
        return self.on and not self.triggers_reduced


AnyBorder = Wall | Area


def in_shape(orientation: Quaternion, offset: Vector) -> Vector:
    """Where a part lies in the shape round it, of size 1, when it is anchored."""
    x, y, z = turned_back(rotation(orientation), offset)
    return -x, -y, -z


def problem(borders: tuple[AnyBorder, ...], parts: frozenset[str], references: frozenset[str]) -> str | None:
    """Why a list of borders does not fit an arm and its world, or None.

    Args:
        borders: all of them.
        parts: names of the parts that can be watched.
        references: names of the frames and objects that they can lie in.
    """
    if len(borders) > MOST_WALLS:
        return f"walls: {len(borders)} are too many, allowed: {MOST_WALLS}"
    seen: set[str] = set()
    for border in borders:
        if border.name in seen:
            return f"name: {border.name!r} is given twice, allowed: a name of its own for each wall"
        seen.add(border.name)
        if border.part not in parts:
            return f"{border.name}.part: {border.part!r} is unknown, allowed: {', '.join(sorted(parts))}"
        if border.reference not in references:
            return f"{border.name}.reference: {border.reference!r} is unknown, allowed: {', '.join(sorted(references))}"
    return None
