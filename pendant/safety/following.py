"""An arm that does not follow its reference is stopped: something holds it, or its model is wrong (RL-1)."""

from collections.abc import Callable
from math import degrees

from pendant.events.event import Event, Kind, Values
from pendant.safety.settings import FollowingSettings
from pendant.tick.estimate import Estimate


def left_path(
    estimate: Estimate, settings: FollowingSettings, joints: tuple[str, ...], held: Callable[[], Values]
) -> Event | None:
    """The event of an arm that is too far from its reference, None where it follows. What is not a number is too far.

    Args:
        estimate: of this tick.
        settings: the limits.
        joints: their names.
        held: tells what holds the arm, as `pendant.safety.rows.MET`; asked when it has left its path.
    """
    error = estimate.following
    if not settings.on or (error.share <= settings.joint and error.tool <= settings.tool):
        return None
    limit = degrees(settings.joint * error.limit)
    values: Values = {"joint": joints[error.joint], "value": degrees(error.angle), "limit": limit, "distance": 1e3 * error.tool}
    return Event(Kind.PATH_LEFT, estimate.tick, {**values, **held()})
