"""The rule that knew a lost payload before the observer did: the force that the sensor misses is a share of what the load needs.

It is kept as what the observer is measured against (bench `observer`). It looks at the force alone.
"""

import math

from pendant.guided.user_force import UserForce
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.pose import ORIGIN, Vector, Wrench, dot, flat, norm, turned_back

STEP = 2
"""A payload comes or goes within so many ticks."""

CERTAIN = 4
"""Ticks for which the step must last, before it is called one: no vibration does; the additional torque goes at once."""

LASTS = 10
"""And for so many, where less than half of the load is missing: then a residual that swings with the arm is as large."""

NOTHING_FOLLOWS = (0, math.inf, -math.inf, math.inf, 0.0)
"""Ticks, least and most share, least and most of the square of what the load needs."""

STAYS = 0.6  # of the step is what the new level must be, and the reverse: a hand that lets go ends at none
RISES = 1.35  # of the level after the step is the most that may follow: a hand's force still rises
ACROSS = 0.35  # of a step may be across it: the share that is not explained
SLACK = 2.0  # [N] for the sensor's noise
LOST_AT_MOST = 1.15  # of the configured load

FOLLOWS = 8
"""Ticks for which what is missing must follow the load's own inertia, where a hand that lets go at once hides the step."""

SWINGS = 1.4  # from the least to the most that the load needs meanwhile
SAME = 0.1  # of the share is as far as it may stray meanwhile
CALM = 0.3
"""Share by which the square of what the load needs may be off its weight's: beyond, the arm swings, and residuals with it."""

SWUNG = 10  # calm ticks that a swinging one undoes: the step of a payload itself swings for two

MUCH = 0.5  # of the load is missing at least, where the arm swings

OLD = 50  # ticks after which such a run starts again: slow changes are hands

LEAST = 4.0
"""Smallest force that is taken for a payload's weight [N]."""

NEAR = 0.8
"""As much may be left of what is missing, in any tick [N]: the sensor's noise, and the arm that swings."""

EXACT = 0.4  # and so much in the mean [N]

APART = 1.25
"""So far off it was two ticks before [N]."""

REMAINS = 10
"""Ticks for which it must stay."""


class PayloadInHand:
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
        return self.ticks > REMAINS and norm(self._sum) <= EXACT * self.ticks


class ForceShare:
    """Watches one free-drive."""

    def __init__(self, held: float) -> None:
        """`held` is the configured payload without the tool [kg]."""
        self._missed: list[Vector] = [ORIGIN] * STEP  # force that the sensor misses, in the last ticks, axes of F [N]
        self._calm = 0  # rises with every tick in which the arm does not swing
        self._level = 0.0  # of the share after a step
        self._stepped = 0  # ticks since a step, 0: none
        self._followed = NOTHING_FOLLOWS
        self._hidden = PayloadInHand(held)
        self.suspect = False

    def step(self, estimate: Estimate, hand: UserForce, baseline: Wrench, least: float = LEAST) -> bool:
        """One tick, `hand` after its own; the sensor's `baseline`, axes of F. Whether a payload has come or gone."""
        mass = estimate.load_mass
        weight = mass * GRAVITY
        if weight < LEAST:
            return False
        fx, fy, fz, _, _, _ = estimate.F_user.tolist()
        rx, ry, rz = turned_back(flat(estimate.R_BF), (fx, fy, fz))
        wx, wy, wz, _, _, _ = estimate.w_sensor.tolist()
        nx, ny, nz = rx + wx, ry + wy, rz + wz  # what the configured load needs in this motion
        ox, oy, oz, _, _, _ = baseline
        mx, my, mz = rx - ox, ry - oy, rz - oz  # what is missing of it
        square = nx * nx + ny * ny + nz * nz
        share = (mx * nx + my * ny + mz * nz) / max(square, 1e-9)
        missed = self._missed
        bx, by, bz = missed.pop(0)
        missed.append((mx, my, mz))
        calm = self._calm >= SWUNG
        swings = abs(square - weight * weight) > CALM * weight * weight
        self._calm = max(self._calm - SWUNG, 0) if swings else min(self._calm + 1, 3 * SWUNG)
        across = norm((mx - share * nx, my - share * ny, mz - share * nz))
        if not self._stepped:
            # Of the force alone: a hand's, which stays, becomes another share of what a swinging load needs.
            jump = share - (bx * nx + by * ny + bz * nz) / max(square, 1e-9)
            began = abs(share) * weight >= least and share * jump > 0.0 and abs(jump) >= STAYS * abs(share)
            began = began and abs(share) >= STAYS * abs(jump) and (calm or abs(share) >= MUCH)
            began = began and hand.stands_out((mx - bx, my - by, mz - bz))
            self._stepped = int(began and self._like(share, across, square))
        elif self._stepped == 1:  # the sensor's mean over the tick in which it happened may have held a part of it
            self._level = share
            self._stepped = 2 if self._like(share, across, square) and abs(share) * weight >= least else 0
        elif self._like(share, across, square) and STAYS <= share / self._level <= RISES:
            self._stepped += 1
        else:
            self._stepped = 0
        hidden = self._hidden.step((mx, my, mz), (bx, by, bz), (nx, ny, nz), mass)
        self.suspect = self._stepped > 0 or self._hidden.ticks > 0
        if hidden:
            return True
        certain = CERTAIN if abs(self._level) >= MUCH else LASTS
        return self._stepped > certain or self._follows(share, across, square, weight)

    def _follows(self, share: float, across: float, square: float, weight: float) -> bool:
        """What is missing swings with what the load needs in the arm's own motion, as no hand's force does."""
        if abs(share) < MUCH or abs(share) * weight < LEAST or not self._like(share, across, square):
            self._followed = NOTHING_FOLLOWS
            return False
        count, low, high, least, most = self._followed
        low, high = min(low, share), max(high, share)
        if high - low > SAME * abs(share) or count == OLD:
            count, low, high, least, most = 0, share, share, square, square
        count, least, most = count + 1, min(least, square), max(most, square)
        self._followed = (count, low, high, least, most)
        return count >= FOLLOWS and most >= SWINGS * SWINGS * least

    @staticmethod
    def _like(share: float, across: float, square: float) -> bool:
        """What is missing is a share of the load."""
        return abs(share) <= LOST_AT_MOST and across <= ACROSS * abs(share) * math.sqrt(square) + SLACK


def _beyond(force: Vector, needs: Vector, part: float) -> Vector:
    """What a force is beyond a `part` of what the load `needs`."""
    return force[0] - part * needs[0], force[1] - part * needs[1], force[2] - part * needs[2]
