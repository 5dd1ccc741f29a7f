"""Hypotheses beside a hand's and a payload's: steps, of the sensor or of a force (FD-19).

A step is the sensor's if nothing moves the flange in its first ticks, or else a knock's.
"""

import math
import sys

import numpy as np

from pendant.sensor.hand_model import LARGEST
from sim.compiled.kernel import kernel
from sim.flange.wrench_hypotheses import BEFORE, LATE, LN_RARE, LONGEST, SHORTEST, STRAY, jump, least, lever_of, noise

NOTHING = -math.log(sys.float_info.epsilon)
"""Of two logs of likelihoods that are so far apart the smaller one adds nothing [nats]."""


@kernel
def recent(values, place, variance, mean):
    """The square of the rise, a tick, of three numbers in the `BEFORE` ticks ahead of one; and their `mean`.

    Args:
        values: a ring (ticks, numbers).
        place: of the tick, and of the first number.
        variance: of each in a tick, by noise.
        mean: of each number, written.
    """
    (here, axis), kept, square = place, values.shape[0], 0.0
    for k in range(axis, axis + 3):
        a = values[(here - 1) % kept, k] + values[(here - 2) % kept, k]
        b = values[(here - 3) % kept, k] + values[(here - 4) % kept, k]
        mean[k] = (a + b) / BEFORE
        square += ((a - b) / BEFORE) ** 2
    return max(square - STRAY * variance / BEFORE, 0.0)


@kernel
def both(a, b):
    """Log of the sum of what these are the logs of."""
    most, less = max(a, b), min(a, b)
    return most + np.log1p(np.exp(less - most)) if less > most - NOTHING else most


@kernel
def quiet(own):
    """Log likelihood of a tick in which there is noise alone, in the mean."""
    return -3.0 - 1.5 * own.spread[0]


@kernel
def sudden(own, seen, change):
    """Log likelihood of any step that stays, up to a hand's wrench, and its size [N].

    What comes late of a turn counts always: where it is much, a swinging load looks like a step.
    """
    length, before = change
    square, size, determinant = 0.0, 0.0, 1.0
    for axis in range(2):
        R, V = noise(own, own.whole, axis, LATE), (0.5 * LARGEST * lever_of(axis)) ** 2
        determinant *= 1.0 + length * V / R
        for k in range(3 * axis, 3 * axis + 3):
            first = seen.x[k] - length * before[k]
            whole = seen.xx[k] - 2.0 * before[k] * seen.x[k] + length * before[k] ** 2
            square += (whole - V / (R + length * V) * first * first) / R
            if axis == 0:
                size += (first / length) ** 2
    determinants = 3.0 * (length * own.spread[1] + np.log(determinant))
    return -0.5 * (max(square, least(length)) + determinants), np.sqrt(size)


@kernel
def unanswered(own, first, size):
    """Log of how much likelier the flange's acceleration is in a step's first ticks if it is the sensor's, than if a force came.

    A force f moves the flange at once, by f / m or less. Without an accelerometer a step counts as a hand's.

    Args:
        own: of `sim.flange.external_wrench`.
        first: place of the first of these ticks.
        size: of the step [N].
    """
    before, square, noise_each = np.zeros(3), 0.0, own.shaking**2
    rise = recent(own.felt, (first, 0), noise_each, before)
    for k in range(3):
        mean = 0.0
        for n in range(SHORTEST):
            mean += own.felt[(first + n) % own.felt.shape[0], k] / SHORTEST
        square += (mean - before[k]) ** 2
    if np.isnan(square):
        return -LN_RARE
    still = noise_each * (1.0 / SHORTEST + 1.0 / BEFORE) + 9.0 * rise
    moved = still + (size / own.moves) ** 2
    return 0.5 * square * (1.0 / moved - 1.0 / still) + 1.5 * np.log(moved / still)


@kernel
def jumps(own, here) -> bool:
    """The wrench may have changed by more than a hand's does within a tick: else no odds are more than about even."""
    mean, kept = own.sums[0], own.x.shape[0]
    mean[:] = 0.0
    for length in range(1, LONGEST + 1):
        first = (here - length) % kept
        moved = 0.0
        for axis in range(2):
            square = 0.0
            for k in range(3 * axis, 3 * axis + 3):
                mean[k] += own.x[(first + 1) % kept, k]
                square += (mean[k] / length - own.before[first, k]) ** 2
            moved += 0.5 * square / jump(own, own.steep[first], axis)
        if length >= SHORTEST and moved >= 0.5:
            return True
    return False
