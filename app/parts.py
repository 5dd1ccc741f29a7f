"""Where a named part of the arm truly is, from a snapshot: for scoring, and for a hand that takes hold of it."""

from collections.abc import Sequence

import numpy as np

from sim.snapshot import Snapshot
from sim.touch import Triple


def point_of(snapshot: Snapshot, joints: list[str], part: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> Triple:
    """A point of a part, in W [m].

    Args:
        snapshot: whose truth is read.
        joints: the arm's joint names, base to flange.
        part: "foot", a joint's link by its joint name, "flange" or "tool"; these two are the tool-side face of the flange sensor.
        point: in the part's frame [m].
    """
    row = -1 if part in ("flange", "tool") else 0 if part == "foot" else 1 + joints.index(part)
    x, y, z, w, i, j, k = snapshot.truth_links[row]
    axis = np.array([i, j, k])
    # Rotation by the unit quaternion (w, axis): p + 2 w (axis x p) + 2 axis x (axis x p).
    turn = np.cross(axis, point)
    moved = np.asarray(point) + 2.0 * (w * turn + np.cross(axis, turn))
    return (float(x + moved[0]), float(y + moved[1]), float(z + moved[2]))
