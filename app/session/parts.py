"""Where a named part of the arm truly is, in a tick: for scoring, and for a hand that takes hold of it."""

from collections.abc import Sequence

from sim.exchange.scoring import Scored
from sim.plant.touch import Triple


def point_of(seen: Scored, joints: list[str], part: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> Triple:
    """A point of a part, in W [m].

    Args:
        seen: whose truth is read.
        joints: the arm's joint names, base to flange.
        part: "foot", a joint's link by its joint name, "flange" or "tool"; these two are the tool-side face of the flange sensor.
        point: in the part's frame [m].
    """
    row = -1 if part in ("flange", "tool") else 0 if part == "foot" else 1 + joints.index(part)
    x, y, z, w, i, j, k = seen.truth_links[row].tolist()
    a, b, c = point
    # Rotation by the unit quaternion (w, v): p + 2 w t + 2 v x t with t = v x p; by hand, since it runs every tick.
    tx, ty, tz = j * c - k * b, k * a - i * c, i * b - j * a
    return (
        x + a + 2.0 * (w * tx + j * tz - k * ty),
        y + b + 2.0 * (w * ty + k * tx - i * tz),
        z + c + 2.0 * (w * tz + i * ty - j * tx),
    )
