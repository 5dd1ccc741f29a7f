"""Hypotheses of what changed the wrench at the flange, and how likely each makes what followed (FD-19).

The flange sensor measures what the flange exerts on its load. What the configured load needs beyond that is, in axes of B,

    x = w_needed - w_sensor - bias = h + share p,

with a hand's wrench h, the wrench p that the payload alone needs in the motion that is felt behind the sensor (by accelerometer
and gyro), and the share of the payload that is gone. A change takes a tick at most; x0 is the mean of the `BEFORE` ticks ahead of
it, i the age of a tick after it:

    nobody          x(i) = c + e,                    a hand that was there let go
    steady          x(i) = x0 + J + e,               a hand's force stays, within what it may change by in a tick
    rising          x(i) = x0 + J + r (i + 1/2) + e, a force that rises as a hand's does: not at once, fast or slowly
    anything        x(i) = e',                       e' as large as a hand's force: what none of the others explains
    payload lost    x(i) = x0 + s p(i) + c + e,      what touches the arm stays; s is 1 within what is known of the payload
    lost and freed  x(i) = s p(i) + c + e,           and a hand lets go in the same moment
    more payload    x(i) = x0 + s p(i) + c + e,      s is negative: as much may have come again; rare at once
    carried         as any of these three,           but it is a hand that takes the weight on: not at once, and p may not swing
    sensor stepped  x(i) = x0 + d + e,               d as large as a hand's force; nothing moves the flange in the first two ticks
    knock           x(i) = x0 + d + e,               the same, but a force: it moves the flange; rare

A hand's are in `sim.flange.wrench_hand`, the last two in `sim.flange.wrench_steps`.

Each is linear in what is not known of it (J, r, s, an offset c), which has a Gaussian prior. So its likelihood is a closed form.
With noise of variance R in L ticks, a basis a(i), a prior (m, V), and sums over the ticks S of (x - a m)² / R, A of a a' / R and
g of a (x - a m) / R, it is

    log p = -(S - g' (V^-1 + A)^-1 g) / 2 - log det(1 + V A) / 2 - L log R / 2.

A hypothesis with more freedom pays for it by its determinant (Bayes factors: Kass and Raftery, J. Am. Stat. Assoc. 90, 773,
1995).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.sensor.hand_model import GRIP_LEVER, LARGEST, TOUCH, TREMOR
from pendant.sensor.sensor_errors import CENTRE
from pendant.tick.estimate import GRAVITY
from sim.compiled.kernel import kernel

Array = NDArray[np.float64]

BEFORE = 4
"""Ticks of which the mean is the wrench before a change."""

LONGEST = 10
"""Ticks since the change that are looked at, at most: 20 ms, in which a dropped payload has to be known (bench `drop`)."""

SURE = 1.0 / 2.576
"""Standard deviation of the payload's mass [kg]: the activation sequence refuses 99 of 100 payloads that are wrong by 1 kg."""

CENTRE_AXIS = CENTRE / math.sqrt(3.0)
"""Standard deviation of the payload's centre in each direction [m]."""

LATE = math.sqrt(0.5)
"""Share of an angular acceleration at the bandwidth of its filter that is missed."""

RARE = 1.0 / TOUCH
"""Share of the ticks in which a hand does what none of its hypotheses says, or changes at once: once in a touch."""

LN_OFTEN, LN_RARE = -math.log((1.0 - RARE) / 6.0), -math.log(RARE)

STRAY = 11.34
"""Square of three Gaussian numbers that 99 of 100 are below (chi-square): what is less in a rise is noise."""

SHORTEST = 2
"""Ticks since a change that are needed; as long nothing moves the flange in a step of the sensor. Then the help does that it
calls for (sim/control/)."""

LOST, FREED, MORE = range(3)  # what became of the payload

_, _, LINE = range(0, 9, 3)  # behind forces and torques is the force along the line from the flange to the payload's centre


class Seen(NamedTuple):
    """What followed a change, summed over its ticks, an axis each: of x, of the payload's p, and of their products."""

    x: Array  # (6,)
    xx: Array
    later: Array  # of x times its age
    p: Array
    pp: Array
    px: Array
    swing: Array  # of what p, and its force along the `LINE`, changes by from a tick to the next, squared (7,)
    newest: Array  # they in the newest tick
    oldest: Array  # and in the first


@kernel
def lever_of(axis):
    """What makes a hand's torques of its forces: 1 for a force itself (axis 0)."""
    return 1.0 if axis == 0 else GRIP_LEVER


@kernel
def noise(own, load, axis, late):
    """Variance of x in a tick, beside a `load`: of sensor, accelerometer and gyro, and the share of a turn that comes `late`."""
    turns = own.turning**2 + (late * own.fastest) ** 2
    return own.noise[axis] ** 2 + (own.shaking * load[axis]) ** 2 + turns * load[axis + 1] ** 2


@kernel
def spread(own, late):
    """Log of the variances of a force and of a torque in a tick."""
    return np.log(noise(own, own.whole, 0, late) * noise(own, own.whole, 1, late))


@kernel
def jump(own, steep, axis):
    """Variance of what a hand's wrench may change by within a tick, beyond its rise before."""
    return (TREMOR * lever_of(axis)) ** 2 + 9.0 * steep[axis] + noise(own, own.whole, axis, LATE) / BEFORE


@kernel
def least(length):
    """What noise leaves of the square of six numbers in so many ticks, where their means are fitted; better is no evidence."""
    return 6.0 * (length - 1.0)


@kernel
def nobody(own, seen, length, late):
    """Log likelihood of an arm that nobody touches."""
    likelihood, determinant = 0.0, 1.0
    for axis in range(2):
        R, offset = noise(own, own.whole, axis, late), (own.offset * lever_of(axis)) ** 2
        determinant *= 1.0 + length * offset / R
        for k in range(3 * axis, 3 * axis + 3):
            likelihood -= 0.5 * (seen.xx[k] - offset / (R + length * offset) * seen.x[k] ** 2) / R
    return likelihood - 1.5 * (length * own.spread[0 if late == 0.0 else 1] + np.log(determinant))


@kernel
def anything(seen, length):
    """Log likelihood of what none of the others explains: whatever a hand's wrench can be, in each tick by itself."""
    likelihood = 0.0
    for axis in range(2):
        V = (0.5 * LARGEST * lever_of(axis)) ** 2
        likelihood -= 1.5 * length * np.log(V)
        for k in range(3 * axis, 3 * axis + 3):
            likelihood -= 0.5 * seen.xx[k] / V
    return likelihood


@kernel
def payload(own, seen, change, kind):
    """Log likelihood of a payload that changed; how much less likely a hand is that comes to carry as much; the share gone.

    Args:
        own, seen: of `sim.flange.external_wrench`.
        change: its ticks; the wrench before (6,), and the square of its rise (2,).
        kind: `LOST`, `FREED` or `MORE`.
    """
    length, before, steep = change
    weight = own.mass * GRAVITY
    mean, variance = (-0.5, 0.25) if kind == MORE else (1.0, (SURE / own.mass) ** 2)
    xx, px, pp, determinant = 0.0, 0.0, 0.0, 1.0
    for axis in range(2):
        # What the accelerometer adds to x and to p cancels where the payload is gone, with a hand as well. So a payload has to
        # fit within the noise of what is left at the flange, and that this noise is small says nothing. One that stays swings on.
        loaded = noise(own, own.whole, axis, LATE if kind == MORE else 0.0)
        R, lever = loaded if kind == MORE else noise(own, own.rest, axis, 0.0), lever_of(axis)
        offset = (own.gain * weight * lever) ** 2
        if axis == 1:
            offset += (CENTRE_AXIS * weight) ** 2
        if kind == FREED:
            offset += (own.offset * lever) ** 2
        else:
            offset += 4.0 * steep[axis] + noise(own, own.whole, axis, LATE) / BEFORE
        determinant *= 1.0 + length * offset / R
        known = offset / (R * (R + length * offset))
        for k in range(3 * axis, 3 * axis + 3):
            start = 0.0 if kind == FREED else before[k]
            x = seen.x[k] - length * start
            xx += (seen.xx[k] - 2.0 * start * seen.x[k] + length * start * start) / R - known * x * x
            px += (seen.px[k] - start * seen.p[k]) / R - known * x * seen.p[k]
            pp += seen.pp[k] / R - known * seen.p[k] ** 2
    off = px - mean * pp
    step = off / (1.0 / variance + pp)
    square, share = max(xx - 2.0 * mean * px + mean * mean * pp - off * step, least(length)), mean + step
    by_noise = length * own.spread[1 if kind == MORE else 0]
    likelihood = -0.5 * (square + np.log((1.0 + variance * pp) * determinant**3) + 3.0 * by_noise)
    return likelihood, carried(own, seen, change, (kind, share)), share


@kernel
def carried(own, seen, change, gone):
    """How much less likely a hand is that comes to carry a share of the payload, in nats.

    Its wrench has to get there within a tick, and to follow the payload's from then on. It does so at any even rate, within
    what a hand is off it. A swing that is no swing, of the accelerometer's noise or of a turn that comes late, it need not
    follow. Along the line from the flange to the payload's centre no turn makes a force, so there swings are what they are.
    """
    length, before, steep = change
    kind, share = gone
    unlikely = 0.0
    for axis in range(2):
        sudden, off = jump(own, steep, axis), (TREMOR * lever_of(axis)) ** 2
        swings = 0.0
        for k in range(3 * axis, 3 * axis + 3):
            way = share * seen.p[k] / length - (before[k] if kind == FREED else 0.0)
            unlikely += way * way / sudden
            swings += uneven(seen, k, length)
        line = uneven(seen, LINE, length) if axis == 0 else 0.0
        for swing, late in ((swings - line, LATE), (line, 0.0)):
            unlikely += share * share * swing / (2.0 * (off + noise(own, own.whole, axis, late)))
    return 0.5 * unlikely


@kernel
def uneven(seen, k, length):
    """Square of what a component of p changes by from tick to tick, beyond an even rate."""
    return seen.swing[k] - (seen.newest[k] - seen.oldest[k]) ** 2 / (length - 1.0)
