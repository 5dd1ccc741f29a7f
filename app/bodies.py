"""Whether the bodies of a scenario can exist: what the types of loads and world objects cannot say."""

import numpy as np

from app.checked import BadInput
from sim.scenario import AnyObject, Load


def check_load(load: Load, where: str, field: str) -> None:
    """Refuse a load whose inertia no rigid body has.

    Raises:
        BadInput: not six numbers, or principal moments that are not positive or of which one exceeds the sum of the others.
    """
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
