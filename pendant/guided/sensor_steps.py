"""Steps of the flange sensor, which are no hand's (FD-19).

A sensor that steps does so in no time, where a hand needs 10 ms or more; and the joints do not feel it. They feel the opposite
first: the help that the step calls for pushes them from within.
"""

import math

from pendant.guided.user_force import UserForce
from pendant.limits.parameters import beyond_gravity
from pendant.tick.estimate import Estimate
from pendant.tick.pose import ORIGIN, Vector, dot, norm

QUIET = 2.5
"""Before a step nobody is felt: a hand that lets go is none [N]."""

JUMP = 3.5
"""Smallest step [N] of a tick or two: the sensor's noise and a hand's first touch look like smaller ones."""

STRAY, NOISE, NOISE_OF_LOAD = 0.3, 0.9, 0.25
"""Share of it by which the mean of two ticks may stray until it is judged, what noise adds [N], and what that of the acceleration
adds for each kilogram of the load [m/s²]: a knock is over by then."""

LEAST = 3.3
"""Smallest mean of a step [N]: what is less was noise on top of a hand's first touch."""

MOVED = 0.03
"""A joint that is faster is moved by somebody [rad/s]."""

LEAST_MOVED = 10.0
"""Then a step is at least so large [N]: a hand that guides an arm shoves by up to 9 N at once, from hardly any force."""

SHAKEN = 1.5
"""What is felt by the accelerometer as well, in the step's first ticks, is a hand's or a knock [m/s²]."""

SOON = 3
"""Ticks of a step in which a hand's shakes the flange; later the help does that a step of the sensor calls for."""

LATER = 6
"""Ticks for which a step lasts, and for which the joints are asked what they feel of it."""

EARLIER = 0.2
"""Weight of a tick in what the joints felt before: their noise in one alone is as large as a fifth of a small step."""

ANSWER = 0.3
"""Share of a step from which on it is a hand's, for the joints feel it; of a sensor's only the help for it, the other way."""


class Steps:
    """Looks for steps of the sensor that the joints do not feel."""

    __slots__ = ("_age", "_before", "_felt", "_last", "_least", "_older", "_oldest", "_step", "_sum", "_zero")

    def __init__(self) -> None:
        self._last: Vector | None = None  # the force that is felt, one, two and three ticks before
        self._older: Vector | None = None
        self._oldest: Vector | None = None
        self._age = 0  # ticks since a step, 0: none
        self._least = LEAST
        self._zero: Vector = ORIGIN  # before it
        self._step: Vector = ORIGIN
        self._sum: Vector = ORIGIN  # of what was felt since, without what was felt before
        self._before: Vector | None = None  # what the joints feel without one [N]
        self._felt: Vector = ORIGIN  # sum of what they felt since, beyond that

    def step(self, estimate: Estimate, hand: UserForce) -> Vector | None:
        """One tick, `hand` after its step. A step that is the sensor's, axes of B [N], or None."""
        change = hand.change
        oldest, older, last = self._oldest, self._older, self._last
        self._oldest, self._older, self._last = older, last, change
        x, y, z = estimate.F_joints.tolist()
        bx, by, bz = self._before or (x, y, z)
        x, y, z = x - bx, y - by, z - bz
        if self._age:
            assert last is not None
            return self._judge(estimate, last, change, (x, y, z))
        self._before = (bx + EARLIER * x, by + EARLIER * y, bz + EARLIER * z)
        if older is None:
            return None
        zero = older if oldest is None else _mean(oldest, older)
        x, y, z = _less(change, zero)
        if x * x + y * y + z * z >= JUMP * JUMP and dot(zero, zero) <= QUIET * QUIET and hand.stands_out((x, y, z)):
            self._age = 1
            self._zero = zero
            self._least = LEAST_MOVED if any(abs(speed) > MOVED for speed in estimate.qd.tolist()) else LEAST
        return None

    def _judge(self, estimate: Estimate, last: Vector, change: Vector, felt: Vector) -> Vector | None:
        """A tick after a step: `last` and now its `change`; the joints feel so much more than before [N]."""
        self._age += 1
        if self._age <= SOON and not (estimate.acceleration_valid and beyond_gravity(estimate) <= SHAKEN):
            self._age = 0
            return None
        if self._age == 2:  # the sensor's mean over the tick in which it happened may have held a part of it
            self._step = self._sum = _less(change, self._zero)
            self._felt = felt
            return None
        self._sum, self._felt = _more(self._sum, _less(change, self._zero)), _more(self._felt, felt)
        off = _less(_less(_mean(last, change), self._zero), self._step)
        size = dot(self._step, self._step)
        if norm(off) > STRAY * math.sqrt(size) + NOISE + NOISE_OF_LOAD * estimate.load_mass:
            self._age = 0
            return None
        if self._age <= LATER:
            return None
        self._age = 0
        x, y, z = self._sum  # of ticks 2 to LATER + 1 of its age
        mean = (x / LATER, y / LATER, z / LATER)
        if dot(self._felt, self._step) >= ANSWER * LATER * size or norm(mean) < self._least:
            return None
        self._last = self._older = self._oldest = None
        return mean


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _mean(a: Vector, b: Vector) -> Vector:
    return 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])


def _more(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]
