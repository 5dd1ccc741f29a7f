"""Hypotheses of a hand: one that goes on, and one that changed (FD-19).

The ticks ahead of a change are explained by a hand that goes on, for each hypothesis alike; that it goes on to the end is one
more hypothesis.
"""

import math

import numpy as np

from pendant.sensor.hand_model import LARGEST, RISE, RISES, TREMOR
from sim.compiled.kernel import kernel
from sim.flange.wrench_hypotheses import BEFORE, LATE, LN_OFTEN, LN_RARE, jump, lever_of, noise
from sim.flange.wrench_steps import both

LN_RISES = math.log(len(RISES))


@kernel
def ahead(own, x, before, steep):
    """Log likelihood of a tick's wrench (6,) for a hand that goes on, by the mean before it (6,) and the square of its rise (2,).

    It stays, goes on rising, or changes by a touch, each with what comes late and without; and rarely it does anything.
    """
    total = -np.inf
    for way in range(7):
        likelihood, determinant = -LN_OFTEN if way < 6 else -LN_RARE, 1.0
        for axis in range(2):
            lever = lever_of(axis)
            V = noise(own, own.whole, axis, LATE if way % 2 else 0.0) * (1.0 + 1.0 / BEFORE)
            if way >= 2:
                V += 9.0 * steep[axis]
            if way >= 4:
                V += (TREMOR * lever) ** 2
            if way == 6:
                V = (0.5 * LARGEST * lever) ** 2
            square = 0.0
            for k in range(3 * axis, 3 * axis + 3):
                square += (x[k] - before[k]) ** 2
            likelihood -= 0.5 * square / V
            determinant *= V
        total = both(total, likelihood - 1.5 * np.log(determinant))
    return total


@kernel
def hand(own, seen, change, late):
    """Log likelihoods of a hand whose force rises, J + r (i + 1/2) from the wrench before, and of one that stays as it was."""
    length, before, steep = change
    count = float(length)
    once = 0.5 * count * (count + 2.0)  # the sum of i + 1/2
    square = count * (count + 1.0) * (2.0 * count + 1.0) / 6.0 + 0.5 * count * (count + 1.0) + 0.25 * count
    rising = np.zeros(len(RISES))
    of_rising = np.ones(len(RISES))  # determinants
    c, determinant = np.empty(len(RISES)), np.empty(len(RISES))  # of an axis
    steady, of_steady = 0.0, 1.0
    for axis in range(2):
        R, lever = noise(own, own.whole, axis, late), lever_of(axis)
        sudden = jump(own, steep, axis)
        a, b = count / R + 1.0 / sudden, once / R
        of_steady *= a * sudden
        for which in range(len(RISES)):
            V = (RISES[which] * 0.5 * LARGEST / RISE * lever) ** 2
            c[which] = square / R + 1.0 / V
            determinant[which] = a * c[which] - b * b
            of_rising[which] *= determinant[which] * sudden * V
        for k in range(3 * axis, 3 * axis + 3):
            first = seen.x[k] - count * before[k]
            later = seen.later[k] - 0.5 * before[k] * count * (count - 1.0)
            whole = seen.xx[k] - 2.0 * before[k] * seen.x[k] + count * before[k] ** 2
            g, h = first / R, ((count + 0.5) * first - later) / R
            steady -= 0.5 * (whole / R - g * g / a)
            for which in range(len(RISES)):
                explained = (c[which] * g * g - 2.0 * b * g * h + a * h * h) / determinant[which]
                rising[which] -= 0.5 * (whole / R - explained)
    by_noise = count * own.spread[0 if late == 0.0 else 1]
    rises = -np.inf
    for which in range(len(RISES)):
        rises = both(rises, rising[which] - 1.5 * (by_noise + np.log(of_rising[which])) - LN_RISES)
    return rises, steady - 1.5 * (by_noise + np.log(of_steady))
