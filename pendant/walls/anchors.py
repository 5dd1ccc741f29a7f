"""Where a wall round a part is anchored, and when anew: fixed, stepwise, average, user (VW-3 to VW-5).

A fallen or too heavy payload must not take its wall along. So a part counts as moved by somebody only when a user force acts
on it, when somebody pays for its motion (`unintended_motion`), or when it moved against the force of the payload-like residual,
which no payload does by itself.
"""

import math
from collections.abc import Callable

import msgspec

from pendant.tick.pose import Vector, dot
from pendant.walls.definitions import Policy, Wall

MOVED = 0.005
"""So far against the payload-like residual within a period counts as moved by somebody [m]."""

RESIDUAL = 2.0
"""A payload-like residual below this has no direction to speak of [N]."""


class Stay(msgspec.Struct, frozen=True, gc=False):
    """A part at its wall in one tick."""

    local: Vector  # the part in the wall's reference [m]
    outward: Vector  # direction towards the wall, of length 1, axes of B
    in_band: bool
    exceeded: bool
    moved: Vector  # since the tick before, axes of B [m]
    user_force: Vector  # without the payload-like residual, axes of B [N]
    payload_force: Vector  # of the payload-like residual, axes of B [N]
    safety_ticks: int  # safety period
    redefine_ticks: int  # redefine period
    led: bool = False  # somebody pays for the arm's motion


class Anchor:
    """The anchor of one wall.

    Args:
        wall: its settings.
        local: the part in the wall's reference now [m].
        averaging_ticks: averaging period.
    """

    __slots__ = (
        "_away",
        "_clear",
        "_decide",
        "_least",
        "_left",
        "_length",
        "_next",
        "_sums",
        "_touched",
        "_track",
        "_wall",
        "local",
    )
    NOT_STATE = ("_decide",)  # it is the method of the wall's policy

    def __init__(self, wall: Wall, local: Vector, averaging_ticks: int) -> None:
        self.local = local  # the anchor in the wall's reference [m]
        self._wall = wall
        self._least = wall.push_back * wall.push_back  # square of the force that counts as a push [N²]
        self._clear = 0  # ticks in a row in which the wall was not exceeded
        self._left = 0  # stepwise: ticks to the end of the redefine period, 0 before the first; average: for which a hand counts
        self._touched = False  # stepwise: a user force acted in this redefine period
        self._away = 0.0  # stepwise: way against the residual in it; user: way away from the wall [m]
        self._track: list[tuple[float, float, float, float]] = []  # average: place, way against the residual
        self._next = 0
        self._length = averaging_ticks
        self._sums = (0.0, 0.0, 0.0, 0.0)
        decide: dict[Policy, Callable[[Stay, bool], bool]] = {
            Policy.STEPWISE: self._stepwise,
            Policy.AVERAGE: self._average,
            Policy.USER: self._user,
        }
        self._decide = decide.get(wall.policy)  # none: fixed

    def step(self, stay: Stay) -> bool:
        """One tick. Returns whether the anchor has moved."""
        if self._decide is None:
            return False
        self._clear = 0 if stay.exceeded else self._clear + 1
        x, y, z = stay.user_force
        mx, my, mz = stay.moved
        # A hand drives a part or holds it; the inertia of a wrong payload that gathers speed looks like a force against it.
        driving = x * mx + y * my + z * mz >= 0.0
        return self._decide(stay, stay.led or (driving and x * x + y * y + z * z >= self._least))

    def _stepwise(self, stay: Stay, pushed: bool) -> bool:
        """VW-3: at the end of each redefine period, unless exceeded within the safety period before."""
        if self._left == 0:
            self._left = stay.redefine_ticks
        self._left -= 1
        self._touched = self._touched or pushed
        self._away += _against(stay)
        if self._left > 0:
            return False
        somebody = (self._touched or self._away >= MOVED) and not stay.in_band
        self._touched, self._away = False, 0.0
        if self._clear >= stay.safety_ticks and (somebody or self._wall.literal):
            self.local = stay.local
            return True
        return False

    def _average(self, stay: Stay, pushed: bool) -> bool:
        """VW-4: the mean of the part's places in the averaging period, while somebody moves it.

        A hand that guides in steady motion needs hardly any force: it counts for the safety period after it was last felt.
        """
        self._left = stay.safety_ticks if pushed else max(self._left - 1, 0)
        x, y, z = stay.local
        against = _against(stay)
        track = self._track
        sx, sy, sz, sum_against = self._sums
        if len(track) < self._length:
            track.append((x, y, z, against))
        else:
            at = self._next
            ox, oy, oz, before = track[at]
            track[at] = (x, y, z, against)
            self._next = (at + 1) % self._length
            sx, sy, sz, sum_against = sx - ox, sy - oy, sz - oz, sum_against - before
        sx, sy, sz, sum_against = self._sums = (sx + x, sy + y, sz + z, sum_against + against)
        somebody = (self._left > 0 or sum_against >= MOVED) and not stay.in_band
        count = len(track)
        if self._clear >= count and (somebody or self._wall.literal):
            self.local = (sx / count, sy / count, sz / count)
            return True
        return False

    def _user(self, stay: Stay, pushed: bool) -> bool:
        """VW-5: once a user has moved the part a set distance away from the wall."""
        away = -dot(stay.moved, stay.outward)
        if stay.exceeded:
            self._away = 0.0
        elif away < 0.0:
            self._away = max(self._away + away, 0.0)
        elif pushed and (stay.led or dot(stay.user_force, stay.outward) < 0.0):
            self._away += away
        if self._away >= self._wall.step:
            self.local, self._away = stay.local, 0.0
            return True
        return False


def _against(stay: Stay) -> float:
    """How far the part moved against the payload-like residual in this tick [m]."""
    fx, fy, fz = stay.payload_force
    size = math.hypot(fx, fy, fz)
    if size < RESIDUAL:
        return 0.0
    x, y, z = stay.moved
    return -(x * fx + y * fy + z * fz) / size
