"""A payload that drops in the moment in which a hand lets go that pulled against gravity (FD-19).

The hand's force may have been as large as what the payload weighed. Then no force comes or goes with the drop, and the arm would
rise as if it were still guided. But what the sensor misses turns within two ticks into just what the payload needs, in size and
direction, and stays so while the arm moves. A hand that changes as fast does not stop there; one that does is slower.
"""

from pendant.tick.estimate import GRAVITY
from pendant.tick.pose import ORIGIN, Vector, dot, norm

LEAST = 4.0
"""Smallest force that is taken for a payload's weight [N]."""

NEAR = 0.8
"""As much may be left of what is missing, in any tick [N]: the sensor's noise, and the arm that swings."""

EXACT = 0.4  # and so much in the mean [N]

APART = 1.25
"""So far off it was two ticks before [N]."""

LASTS = 10
"""Ticks for which it must stay."""


class HiddenDrop:
    """Compares what is missing with what the payload needs.

    Attributes:
        held: configured payload without the tool [kg].
        ticks: for which both have been the same, after they were not; 0: not so.
    """

    __slots__ = ("_sum", "held", "ticks")

    def __init__(self, held: float) -> None:
        self.held = held
        self._sum: Vector = ORIGIN
        self.ticks = 0

    def forget(self) -> None:
        """The sensor is out."""
        self.ticks, self._sum = 0, ORIGIN

    def step(self, missing: Vector, before: Vector, needs: Vector, mass: float) -> bool:
        """One tick. True in that in which the payload is known to be gone.

        Args:
            missing: what the sensor misses of the load (3,), axes of F [N].
            before: the same of two ticks ago.
            needs: what the load needs in its motion (3,), axes of F [N].
            mass: of the load, the tool with it [kg].
        """
        if self.held * GRAVITY < LEAST:
            return False
        part = self.held / mass
        x, y, z = off = _beyond(missing, needs, part)
        if dot(off, off) > NEAR * NEAR:
            self.ticks = 0
            return False
        if self.ticks == 0:
            then = _beyond(before, needs, part)
            if dot(then, then) < APART * APART:
                return False
            self._sum = ORIGIN
        sx, sy, sz = self._sum
        self._sum = (sx + x, sy + y, sz + z)
        self.ticks += 1
        return self.ticks > LASTS and norm(self._sum) <= EXACT * self.ticks


def _beyond(force: Vector, needs: Vector, part: float) -> Vector:
    """What a force is beyond a `part` of what the load `needs`."""
    return force[0] - part * needs[0], force[1] - part * needs[1], force[2] - part * needs[2]
