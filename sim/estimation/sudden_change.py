"""Whether a change came at once, as when a payload falls, or as a hand makes it (FD-19).

A payload that falls is gone within a tick. A hand takes 10 ms and more to push as hard, pushes
harder than that, or changes its push all the time. The last `SEEN` ticks of a value are compared
with these courses; the size and the level of each course are free:

- at once: a step, through the same filters as the value;
- a hand that comes or goes: a ramp of `RISES` ticks, through the same filters;
- a hand that is there: a polynomial of the degree `DEGREE`;
- nothing: a constant.

Let S be the sum of the squared differences between a course and the values, with white noise of
unknown size. The likelihood of the course is proportional to S^(-SEEN / 2). Each free number of a
course costs log(SEEN) / 2.

Source: generalised likelihood ratio of linear models of unknown variance; Schwarz, Estimating the Dimension of a Model, Annals of
Statistics 6(2), 1978.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from pendant.sensor.hand_model import DEGREE, RISE
from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record
from sim.estimation.momentum_observer import follow
from sim.flange.wrench_hypotheses import LONGEST

Array = NDArray[np.float64]

MEAN = LONGEST // 2
"""The mean is over so many ticks; for the other half of `LONGEST` it must look like a fall."""

SEEN = 2 * LONGEST + MEAN
"""Window [ticks]: the time for which a fall is checked, the mean, and the same time before it."""

RISES = (2 * RISE, 4 * RISE, 8 * RISE)
"""Times in which a hand comes or goes [ticks], each twice the one before. The shortest possible
time is left out, because it looks like a step."""

FREE = 0.5 * math.log(SEEN)
"""Cost of a free number [nats]."""

TINY = float(np.finfo(np.float64).tiny)


class Came(NamedTuple):
    """How a value came to be what it is."""

    by_hand: float  # log of the odds of a hand's course against a step [nats]
    at_all: float  # the same of a step against a constant
    size: float  # of the step that fits best
    level: float  # after that step


def courses() -> Record:
    """Courses of a value after the momentum observer's two filters, and the value, still zero.

    Each course is a row with mean 0 and norm 1; the rows of the polynomial are orthogonal.
    """
    steps, ramps, smooth = _rows()
    made = record(
        steps=steps.shape,
        level=(len(steps),),  # mean of a step of 1
        length=(len(steps),),  # norm of that step, without its mean
        ramps=ramps.shape,
        smooth=smooth.shape,
        latest=(SEEN,),  # a ring
        newest="i8",  # place in it
        value=(SEEN,),  # in the order of time, without its mean
    )
    own = made[0]
    own["level"], own["length"] = steps.mean(axis=1), np.linalg.norm(_flat(steps), axis=1)
    own["steps"], own["ramps"], own["smooth"] = _unit(steps), _unit(ramps), smooth
    return made


@cache
def _rows() -> tuple[Array, Array, Array]:
    """Steps and ramps from 0 to 1, each beginning in another tick, and the polynomial.

    They are computed once, because they are the same for all arms. A ramp is the mean of the steps
    in its ticks.
    """
    before = SEEN + int(max(RISES))
    first, second, answer = np.zeros(1), np.zeros(1), np.zeros(2 * before)
    for tick in range(before, len(answer)):
        follow(first, second, 1.0, 0)
        answer[tick] = second[0]
    step = sliding_window_view(answer, SEEN)[before::-1]  # in tick 0 of the window, in tick 1, ...
    earlier = sliding_window_view(answer, SEEN)[before:]  # in tick 0, a tick before the window, ...
    ramps = [
        np.concatenate([earlier[rise:0:-1], step])[begin : begin + rise].mean(axis=0)
        for rise in map(int, RISES)
        for begin in range(rise + SEEN - 1)
    ]
    powers = np.vander(np.linspace(-1.0, 1.0, SEEN), DEGREE + 1, increasing=True)
    return step[: SEEN - 1], np.array(ramps), np.linalg.qr(powers)[0].T[1:]


def _flat(rows: Array) -> Array:
    return rows - rows.mean(axis=1, keepdims=True)


def _unit(rows: Array) -> Array:
    return _flat(rows) / np.linalg.norm(_flat(rows), axis=1, keepdims=True)


@kernel
def forget(known) -> None:
    """The value was 0 until now."""
    known[0].latest[:] = 0.0


@kernel
def add(known, value) -> None:
    """One tick."""
    own = known[0]
    own.newest = (own.newest + 1) % SEEN
    own.latest[own.newest] = value


@kernel
def came(known) -> tuple[float, float, float, float]:
    """How the value came to be what it is, as `Came`."""
    own, value = known[0], known[0].value
    mean = own.latest.mean()
    for k in range(SEEN):
        value[k] = own.latest[(own.newest + 1 + k) % SEEN] - mean
    whole, smooth = _dot(value, value), 0.0
    for k in range(DEGREE):
        smooth += _dot(own.smooth[k], value) ** 2
    step, ramp = _best(own.steps, value), _best(own.ramps, value)
    along = _dot(own.steps[step], value)
    left, by_ramp = whole - along**2, whole - _dot(own.ramps[ramp], value) ** 2
    by_hand = max(_odds(by_ramp, left), _odds(whole - smooth, left) - (DEGREE - 1) * FREE)
    size = along / own.length[step]
    return by_hand, _odds(left, whole) - FREE, size, mean + size * (1.0 - own.level[step])


@kernel
def _dot(a, b) -> float:
    total = 0.0
    for k in range(SEEN):
        total += a[k] * b[k]
    return total


@kernel
def _best(rows, value) -> int:
    """The row that fits the value best."""
    most, which = 0.0, 0
    for i in range(rows.shape[0]):
        square = _dot(rows[i], value) ** 2
        if square > most:
            most, which = square, i
    return which


@kernel
def _odds(left, against) -> float:
    """Log of the odds of a course with the sum of squares `left` against one with `against` [nats]."""
    return 0.5 * SEEN * math.log(max(against, TINY) / max(left, TINY))
