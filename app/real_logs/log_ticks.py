"""A log as the ticks of the controller: what it would have measured in each, and the motion without the noise of it."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from app.real_logs.joint_log import JointLog
from pendant.tick.modes import TICK, TICK_RATE
from sim.arm.arm_file import Arm
from sim.estimation.joint_tracking import TORQUE_BANDWIDTH

Array = NDArray[np.float64]

BLOCK = 10_000
"""Ticks that are made at once: 20 s, 10 MB of an arm of six joints."""
MARGIN = 1_000
"""Ticks on both sides of a block that its filters need: they have forgotten how they began after a tenth of it."""
SHORT = 100
"""Ticks of a stretch of which nothing is told: the slowest filter has forgotten after half of it that it began at rest."""
SLOW = 0.5
"""Below this the angles tell where a joint is, above it the sum of its speeds [Hz]: an angle that is rounded to 1e-4 rad would
be noise of 1 rad/s² in an acceleration, a speed rounded to 1e-4 rad/s is 0.01 rad/s²."""
PLANNED = 6.0
"""Up to which a motion is taken for planned, so that the filters follow it without lag, as they do behind a plan [Hz]: a planned
acceleration rises within 0.1 s; what is faster is the arm's swing on its gears (10 to 25 Hz), noise, and what touches it."""
OF_RATE = 0.2
"""Of the rows a second, up to which frequencies are in a log: half of what the sampling theorem allows, less its filter."""
SAME_RATE = 0.01
"""So much may the rate differ from that of the ticks, for the rows to be the ticks."""


class Ticks(NamedTuple):
    """k ticks of n joints."""

    t: Array  # (k,) [s]
    theta: Array  # (k, n) motor angle [rad]
    q: Array  # (k, n) output angle [rad]
    tau_m: Array  # (k, n) motor torque referred to the output [N·m]
    wrench: Array | None  # (k, 6) [N, N·m]; NaN where it is not known
    temperature: Array  # (k, n) [°C]
    planned: tuple[Array, Array, Array]  # angle, speed, acceleration (k, n) of the motion, smooth and without lag
    learns: NDArray[np.bool_]  # (k,) no hand leads the arm, as far as is known
    run_in: int  # so many at the beginning of a stretch tell nothing yet: filters begin


def rows_are_ticks(log: JointLog) -> bool:
    """The log has a row for each tick, so that nothing is made up between two rows."""
    return abs(log.rate / TICK_RATE - 1.0) < SAME_RATE


def bandwidth(log: JointLog) -> float:
    """Up to which the motion is told [Hz]."""
    return min(TORQUE_BANDWIDTH, OF_RATE * log.rate)


def in_ticks(log: JointLog, arm: Arm) -> Iterator[Ticks]:
    """The log in blocks of ticks, in order."""
    for part in log.stretches:
        t = log.t[part]
        count = int((t[-1] - t[0]) / TICK + 1e-6) + 1
        if count <= SHORT:
            continue
        for begin in range(0, count, BLOCK):
            low, high = max(0, begin - MARGIN), min(count, begin + BLOCK + MARGIN)
            keep = slice(begin - low, min(begin + BLOCK, count) - low)
            yield _block(log, arm, t[0] + TICK * np.arange(low, high), (part, keep, 0 if begin else SHORT))


def _block(log: JointLog, arm: Arm, t: Array, place: tuple[slice, slice, int]) -> Ticks:
    part, keep, run_in = place
    rows = slice(
        part.start + max(0, int(np.searchsorted(log.t[part], t[0], side="right")) - 2),
        part.start + min(part.stop - part.start, int(np.searchsorted(log.t[part], t[-1], side="left")) + 2),
    )
    between = _Between(log.t[rows], t)
    smooth, slow, plan = (_low_pass(hertz) for hertz in (bandwidth(log), SLOW, PLANNED))
    measured = between.curve(log.q[rows], log.qd[rows])
    speed = between.line(log.qd[rows])
    q = measured if rows_are_ticks(log) else _joined(measured, sosfiltfilt(smooth, speed, axis=0), slow)
    planned = sosfiltfilt(plan, speed, axis=0)
    theta = q if log.theta is None else between.line(log.theta[rows])
    warmth = log.temperature
    celsius = np.full_like(q, arm.frictions.temperature) if warmth is None else between.before(warmth[rows])
    return Ticks(
        t[keep],
        theta[keep],
        q[keep],
        between.line(log.motor_torque(arm, rows))[keep],
        None if log.wrench is None else between.line(log.wrench[rows])[keep],
        np.where(np.isfinite(celsius), celsius, arm.frictions.temperature)[keep],
        (_joined(measured, planned, slow)[keep], planned[keep], np.gradient(planned, TICK, axis=0)[keep]),
        np.ones(len(t), dtype=bool)[keep] if log.guided is None else ~between.before(log.guided[rows])[keep],
        run_in,
    )


def _low_pass(hertz: float) -> Array:
    """Sections of a Butterworth filter of second order."""
    return np.asarray(butter(2, hertz, fs=TICK_RATE, output="sos"))


def _joined(angle: Array, speed: Array, slow: Array) -> Array:
    """What is slow of the angles (k, n), and what is fast of the speeds' sum."""
    gone = np.zeros_like(speed)
    np.cumsum(0.5 * TICK * (speed[1:] + speed[:-1]), axis=0, out=gone[1:])
    return gone + sosfiltfilt(slow, angle - gone, axis=0)


class _Between:
    """Times `t` (k,) among those of rows (m,)."""

    def __init__(self, rows: Array, t: Array) -> None:
        self._row = np.clip(np.searchsorted(rows, t + 1e-9, side="right") - 1, 0, len(rows) - 2)
        self._step = (rows[self._row + 1] - rows[self._row])[:, None]
        self._share = ((t - rows[self._row])[:, None] / self._step).clip(0.0, 1.0)

    def line(self, values: Array) -> Array:
        """On the straight line between two rows."""
        return values[self._row] + self._share * (values[self._row + 1] - values[self._row])

    def before(self, values: NDArray[Any]) -> NDArray[Any]:
        """Of the last row."""
        return values[np.where(self._share[:, 0] < 1.0, self._row, self._row + 1)]

    def curve(self, values: Array, slopes: Array) -> Array:
        """On the cubic that has both values and both slopes (Hermite)."""
        s, h = self._share, self._step
        a, b, u, v = values[self._row], values[self._row + 1], slopes[self._row], slopes[self._row + 1]
        return a + s * s * (3.0 - 2.0 * s) * (b - a) + h * s * (1.0 - s) * ((1.0 - s) * u - s * v)
