"""An arm that does not follow its reference is stopped: something holds it, or its model is wrong (RL-1)."""

from math import degrees

from pendant.events.event import Event, Kind
from pendant.safety.settings import FollowingSettings
from pendant.tick.estimate import Estimate


def left_path(estimate: Estimate, settings: FollowingSettings, joints: tuple[str, ...]) -> Event | None:
    """The event of an arm that is too far from its reference, None where it follows. What is not a number is too far.

    Args:
        estimate: of this tick.
        settings: the limits.
        joints: their names.
    """
    error = estimate.following
    if not settings.on or (error.share <= settings.joint and error.tool <= settings.tool):
        return None
    limit = degrees(settings.joint * error.limit)
    values = {"joint": joints[error.joint], "value": degrees(error.angle), "limit": limit}
    return Event(Kind.PATH_LEFT, estimate.tick, {**values, "distance": 1e3 * error.tool})
