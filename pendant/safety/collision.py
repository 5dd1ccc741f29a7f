"""An arm that hits something, or is pushed with more than a robot may bear, is stopped (RL-3)."""

from math import hypot, inf

from pendant.events.event import Event, Kind, Values
from pendant.safety.settings import CollisionSettings
from pendant.tick.estimate import Estimate

MORE = 20.0
"""Force beyond that of a contact which was there already that the arm may meet when it moves away [N]: turning at a place costs
it as much."""

MOST = 9999.0
"""That is told of a force, be it larger or no number [N]."""


class Collisions:
    """Compares the forces on tool and links with what may be there.

    What touched the arm when it was stopped still touches it after the reset. A force that is there when the arm begins to hold
    or to move is allowed, with a little more; as it falls, so does what is allowed, down to the setting.

    Args:
        elbow: index of the joint whose origin is the elbow.
    """

    __slots__ = ("_allowed", "_elbow")

    def __init__(self, elbow: int) -> None:
        self._elbow = elbow
        self._allowed = [inf, inf]  # of tool and link [N]

    def rest(self) -> None:
        """Nothing holds or moves the arm by itself: it is free, or stopped."""
        self._allowed[:] = inf, inf

    def step(
        self, estimate: Estimate, settings: CollisionSettings, *, moves: bool, most: tuple[float, float] = (inf, inf)
    ) -> Event | None:
        """The event of an arm that meets more than it may, None where it does not. What is not a number is more.

        Args:
            estimate: of this tick.
            settings: the limits.
            moves: the arm follows a motion, and nobody asked for a contact.
            most: the robot's limits of the forces of tool and link [N].
        """
        if not settings.on:
            return None
        link = estimate.link_force
        x, y, z = estimate.F_user[:3].tolist() if estimate.wrench_valid else (0.0, 0.0, 0.0)
        # Beyond the sensor's range the joints feel the rest of a force on the tool.
        tool, on_link = hypot(x, y, z), link.force
        if estimate.clipped:
            tool, on_link = tool + on_link, 0.0
        least = settings.force if moves else settings.clamping
        for k, force in enumerate((tool, on_link)):
            limit = self._allowed[k] = max(min(least, most[k]), min(self._allowed[k], force + MORE))
            if not force <= limit < inf:
                part = "tool" if k == 0 else self._part(link.joint, sensed=estimate.wrench_valid)
                told = force if force < MOST else MOST
                values: Values = {"part": part, "force": told, "limit": limit, "speed": 1e3 * estimate.v_tcp}
                return Event(Kind.COLLISION, estimate.tick, values)
        return None

    def _part(self, joint: int, *, sensed: bool) -> str:
        """Name of the link that this joint, the last that feels the force, moves."""
        if joint < self._elbow:
            return "elbow"
        if joint == self._elbow:
            return "forearm"
        return "wrist" if sensed else "wrist or tool"
