"""An arm that hits something, or is pushed with more than a robot may bear, is stopped (RL-3)."""

from collections import deque
from math import hypot, inf

from pendant.events.event import Event, Kind, Values, posture_text
from pendant.safety.settings import CollisionSettings
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate

MORE = 20.0
"""Force beyond that of a contact which was there already that the arm may meet when it moves away [N]: turning at a place costs
it as much."""

MOST = 9999.0
"""That is told of a force, be it larger or no number [N]."""

HELD_BY = 0.2
"""Share of the setting for a moving arm from which a force tells what holds an arm that has left its path: 10 N as shipped, twice
what the flange sensor is good to."""

BEFORE = ticks(0.05)
"""Ticks in which the contact itself brakes the arm before its force tells: the speed at the contact is the largest in them."""


class Collisions:
    """Compares the forces on tool and links with what may be there.

    What touched the arm when it was stopped still touches it after the reset. A force that is there when the arm begins to hold
    or to move is allowed, with a little more; as it falls, so does what is allowed, down to the setting.

    Args:
        joints: their names, base to flange.
    """

    __slots__ = ("_allowed", "_joints", "_speeds")

    def __init__(self, joints: tuple[str, ...]) -> None:
        self._joints = joints
        self._allowed = [inf, inf]  # of tool and link [N]
        self._speeds: deque[tuple[float, float]] = deque(maxlen=BEFORE)  # of tool and elbow, the last ones [m/s]

    def rest(self) -> None:
        """Nothing holds or moves the arm by itself: it is free, or stopped."""
        self._allowed[:] = inf, inf
        self._speeds.clear()

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
        self._speeds.append((estimate.v_tcp, estimate.v_elbow))
        if not settings.on:
            return None
        least = settings.force if moves else settings.clamping
        for k, force in enumerate(_forces(estimate)):
            limit = self._allowed[k] = max(min(least, most[k]), min(self._allowed[k], force + MORE))
            if not force <= limit < inf:
                joint = self._joints[-1 if k == 0 else estimate.link_force.joint]
                return Event(Kind.COLLISION, estimate.tick, {"joint": joint, "limit": limit, **self._met(estimate, k, force)})
        return None

    def holding(self, estimate: Estimate, settings: CollisionSettings) -> Values:
        """What holds an arm that has left its path, as the values of its event; the part is "" where no force tells."""
        forces = _forces(estimate)
        k = 0 if forces[0] >= forces[1] else 1
        met = self._met(estimate, k, forces[k])
        return met if forces[k] >= HELD_BY * settings.force else {**met, "part": ""}

    def _met(self, estimate: Estimate, k: int, force: float) -> Values:
        """What the arm meets with its tool, 0, or a link, 1: `pendant.safety.rows.MET`."""
        part = "tool" if k == 0 else _part(estimate.link_force.parts, sensed=estimate.wrench_valid)
        tool, elbow = (max(each) for each in zip(*self._speeds, (estimate.v_tcp, estimate.v_elbow), strict=True))
        x, y, z = estimate.tcp.tolist()[:3]
        return {
            "part": part,
            "force": force if force < MOST else MOST,
            "speed": 1e3 * (elbow if part in OF_THE_ELBOW else tool),
            "x": x,
            "y": y,
            "z": z,
            "posture": posture_text(estimate.q.tolist()),
        }


def _part(odds: tuple[float, float, float], *, sensed: bool) -> str:
    """Name of the part that a link's force is on, or of the two that are the most probable where neither is sure."""
    if not any(odds):
        return "arm"
    likely = sorted(range(len(PARTS)), key=lambda k: -odds[k])
    told = sorted(likely[: 1 if odds[likely[0]] >= SURE else 2])
    return " or ".join("wrist or tool" if PARTS[k] == "wrist" and not sensed else PARTS[k] for k in told)


PARTS = "elbow", "forearm", "wrist"
"""Of the probabilities in `LinkForce.parts`."""
SURE = 0.9
"""Probability from which one part is told alone; below it the next one is told as well."""

OF_THE_ELBOW = ("elbow", "forearm", "elbow or forearm")
"""Parts whose speed is told as that of the elbow."""


def _forces(estimate: Estimate) -> tuple[float, float]:
    """On the tool and on a link [N]. Beyond the sensor's range the joints feel the rest of a force on the tool."""
    x, y, z = estimate.F_user[:3].tolist() if estimate.wrench_valid else (0.0, 0.0, 0.0)
    tool, on_link = hypot(x, y, z), estimate.link_force.force
    return (tool + on_link, 0.0) if estimate.clipped else (tool, on_link)
