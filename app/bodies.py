"""Whether the bodies of a scenario can exist: what the types of loads and world objects cannot say."""

import numpy as np

from app.checked import BadInput
from sim.arm import Arm
from sim.scenario import AnyObject, Load

OVERLOAD = 10.0
"""Heaviest load, as a multiple of the arm's rated payload: enough to try any mistake, and within what the physics can bear."""

FARTHEST = 1.0
"""Largest distance of a load's centre from the flange along each axis [m]."""


def check_load(load: Load, arm: Arm, where: str, field: str) -> None:
    """Refuse a load that no arm could carry, or whose inertia no rigid body has.

    Raises:
        BadInput: mass or centre out of range; or the inertia is not six numbers, or has principal moments that are not
            positive or of which one exceeds the sum of the others.
    """
    if load.mass > OVERLOAD * arm.payload:
        raise BadInput(where, f"{field}.mass", load.mass, f"0 .. {OVERLOAD * arm.payload:g} kg for the {arm.name}")
    for i, way in enumerate(load.com):
        if abs(way) > FARTHEST:
            raise BadInput(where, f"{field}.com[{i}]", way, f"-{FARTHEST:g} .. {FARTHEST:g} m")
    if load.inertia is None:
        return
    if len(load.inertia) != 6:
        raise BadInput(where, f"{field}.inertia", load.inertia, "six numbers: ixx iyy izz ixy ixz iyz")
    xx, yy, zz, xy, xz, yz = load.inertia
    low, middle, high = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if low <= 0 or high > low + middle:
        raise BadInput(where, f"{field}.inertia", load.inertia, "principal moments above 0, each at most the sum of the others")


def check_world(world: list[AnyObject], where: str) -> None:
    """Refuse objects of the same name, and sizes that are not positive.

    Raises:
        BadInput: as said.
    """
    names = [thing.name for thing in world]
    for i, thing in enumerate(world):
        if thing.name in names[:i]:
            raise BadInput(where, f"world[{i}].name", thing.name, "each object needs a name of its own")
        for size in getattr(thing, "size", ()):  # a plane has none
            if size <= 0:
                raise BadInput(where, f"world[{i}].size", size, "lengths above 0 m")
