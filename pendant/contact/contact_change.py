"""What a contact detector reports: a change in contact, as a value (CD-13, CD-14, CD-16)."""

import math
from enum import StrEnum
from typing import NamedTuple

from pendant.events.event import Event, Kind, posture_text
from pendant.tick.pose import Rotation, Vector


class Change(StrEnum):
    """Kinds of change in contact (CD-13)."""

    GAINED = "gained"  # the external force was small and is large
    LOST = "lost"  # it was large and is small
    RESISTANCE = "resistance"  # large before and after: a snap-fit, another surface friction
    CLAMPING = "clamping"  # it has grown while the acceleration has died out


class ArmPose(NamedTuple):
    """Where the arm was in one tick."""

    q: tuple[float, ...]  # (n,) output angles [rad]
    p_BT: Vector  # tool centre point [m]
    R_BF: Rotation  # orientation of the flange


class Contact(NamedTuple):
    """One change in contact. Vectors are in B, with the sign of what the arm does to the object."""

    tick: int  # of the decision
    change: Change
    rule: str  # the rule that saw it
    part: str  # the contact part: "tool", a link
    source: str  # of force and acceleration (CD-2)
    force: Vector  # change of the contact force when the rule saw it [N]
    acceleration: Vector  # change of the part's acceleration when the rule saw it [m/s²]
    ratio: float  # of these two: minus the mass of what the contact brakes; free motion has no contact force, and 0 [kg]
    steps: int  # ticks from the first suspicious sample to the decision (CD-14)
    pose: ArmPose  # at the first suspicious sample


TOLD = {
    Change.GAINED: Kind.CONTACT_GAINED,
    Change.LOST: Kind.CONTACT_LOST,
    Change.RESISTANCE: Kind.CONTACT_RESISTANCE,
    Change.CLAMPING: Kind.CONTACT_CLAMPING,
}


def told(contact: Contact, tick: int, action: str, speed: float) -> Event:
    """The event of a contact, with the `action` that a program takes, and the tool's `speed` at the decision [m/s] (CD-16)."""
    (fx, fy, fz), (ax, ay, az), (x, y, z) = contact.force, contact.acceleration, contact.pose.p_BT
    return Event(
        TOLD[contact.change],
        tick,
        {
            "part": contact.part,
            "source": contact.source,
            "rule": contact.rule,
            "force": math.hypot(fx, fy, fz),
            "fx": fx,
            "fy": fy,
            "fz": fz,
            "acceleration": math.hypot(ax, ay, az),
            "ax": ax,
            "ay": ay,
            "az": az,
            "ratio": contact.ratio,
            "steps": contact.steps,
            "speed": 1e3 * speed,
            "x": x,
            "y": y,
            "z": z,
            "posture": posture_text(contact.pose.q),
            "action": action,
        },
    )
