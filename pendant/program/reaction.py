"""Moves that end at a contact, and what the arm does then (CD-15)."""

import math
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pendant.contact.contact_change import ArmPose, Change, Contact
from pendant.settings.bounds import Coordinate
from pendant.tick.pose import UNTURNED, Rotation, Vector, product, quaternion

REACTION_SPEED = 0.05  # of straight reactions, slow enough to end where they should [m/s]


class Until(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A move goes on until a contact changes; then the arm stops at once, and may do one thing more."""

    change: Literal["any", "gained", "lost", "resistance", "clamping"] = "any"
    part: str | None = None  # of the contact; None: any
    within: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.0  # way of the tool in which the arm stops; 0: at once [m]
    time: Annotated[float, Meta(ge=0.0, le=5.0)] = 0.0  # in which the arm stops; 0: at once [s]
    then: Literal["stop", "contact_pose", "retract", "reverse", "turn", "position"] = "stop"
    position: tuple[Coordinate, Coordinate, Coordinate] | None = None  # `position`: p_BT, straight there [m]
    distance: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.05  # `retract`: from the contact pose, back where it came from [m]
    angle: Annotated[float, Meta(ge=-math.pi, le=math.pi)] = 0.5  # `turn`: about the tool's z axis [rad]

    def __post_init__(self) -> None:
        if (self.then == "position") != (self.position is not None):
            raise ValueError("position: it goes with `then: position`, and only with that")
        if self.within > 0.0 and self.time > 0.0:
            raise ValueError("within, time: one of them says how the arm stops")

    def deceleration(self, speed: float) -> float:
        """Of the tool at its hardest, for a stop from this speed [m/s]; infinite for one at once [m/s²].

        A stop's speed falls as half a cosine: it takes twice the time of its way at full speed, and brakes by pi/2 of the mean.
        """
        time = 2.0 * self.within / speed if self.within > 0.0 and speed > 0.0 else self.time
        return 0.5 * math.pi * speed / time if time > 0.0 else math.inf

    def meets(self, contact: Contact) -> bool:
        """Whether `contact` is what the move waits for."""
        wanted = self.change == "any" or contact.change == self.change or (self.change, contact.change) == GENTLE
        return wanted and self.part in (None, contact.part)


GENTLE = ("gained", Change.CLAMPING)
"""Who waits for a contact to be gained takes one that came so gently that it is called clamping."""


class Goal(msgspec.Struct, frozen=True):
    """Where a reaction goes: joint angles, or a straight line to a pose."""

    q: tuple[float, ...] = ()  # [rad]
    position: Vector | None = None  # p_BT [m]
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


def goal(until: Until, contact: Contact, *, begun: ArmPose, now: ArmPose, R_FT: Rotation = UNTURNED) -> Goal | None:
    """Where the arm goes after it has come to rest; None for nowhere.

    Args:
        until: what was asked for.
        contact: what happened.
        begun: where the move began.
        now: where the arm stands.
        R_FT: orientation of the tool centre point in the flange.
    """
    there = contact.pose
    if until.then == "contact_pose":
        return Goal(q=there.q)
    if until.then == "reverse":
        return Goal(q=begun.q)
    if until.then == "position":
        return Goal(position=until.position, quaternion=quaternion(product(now.R_BF, R_FT)))
    if until.then == "turn":
        c, s = math.cos(until.angle), math.sin(until.angle)
        R = product(product(now.R_BF, R_FT), (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))
        return Goal(position=now.p_BT, quaternion=quaternion(R))
    if until.then == "retract":
        (x, y, z), (u, v, w) = there.p_BT, begun.p_BT
        length = math.dist(there.p_BT, begun.p_BT)
        share = until.distance / length if length > 0.0 else 0.0
        position = (x + share * (u - x), y + share * (v - y), z + share * (w - z))
        return Goal(position=position, quaternion=quaternion(product(there.R_BF, R_FT)))
    return None
