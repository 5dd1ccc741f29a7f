"""What a model leaves of measured torques, by joint: root mean squares over a log of any length, added up second by second."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.real_logs.log_controller import Estimates
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.estimation.adaptive_friction import GATE, AdaptiveFriction, rub

Array = NDArray[np.float64]

LEARNED = 30.0
"""Motion after which the friction is to be learned [s]."""
TERMS = 4
"""Of the fit that is the yardstick: sign of the speed, speed, torque of the rigid model with the rotor, offset."""
LEFT = ("measured", "without friction", "fixed", "learned")
"""What the squares are of: the measured torque; what rigid model and rotor leave of it; the same less the friction of the arm's
file; the same less the friction as learned so far."""


def own_terms(speed: Array, rigid: Array) -> Array:
    """Terms (k, TERMS) of a fit of a joint to one log: sign, speed, rigid torque, offset; of speed and rigid torque (k,)."""
    return np.column_stack([np.sign(speed), speed, rigid, np.ones_like(speed)])


class Second(NamedTuple):
    """Sums over a second of a log."""

    t: float  # at which it begins [s]
    moved: float  # time in which some joint moves [s]
    ticks: Array  # (n,) in which the joint moves
    squares: Array  # (len(LEFT), n) over them [N²·m²]


class Residuals:
    """Sums of squares of n joints, second by second, over the ticks in which a joint moves.

    Args:
        arm: the arm's numbers; the friction of its file is the fixed one.
    """

    def __init__(self, arm: Arm) -> None:
        self._fixed = AdaptiveFriction(arm)
        self.seconds: list[Second] = []
        self._normal = np.zeros((arm.n, TERMS + 1, TERMS + 1))  # of the fit: terms, then the measured torque

    def add(self, t: Array, temperature: Array, out: Estimates) -> Array:
        """Take in a block of k ticks at times `t` (k,) with temperatures (k, n); returns the fixed friction there (k, n)."""
        fixed = np.empty_like(out.friction)
        slide_along(self._fixed.record, (out.speed, out.tau_J, temperature), fixed)
        driven = out.driven
        moves = np.abs(out.speed) > GATE
        squares = np.stack([out.tau_m, driven, driven - fixed, out.left]) ** 2 * moves
        step = round(1.0 / TICK)
        for begin in range(0, len(t), step):
            part = slice(begin, begin + step)
            some = float(moves[part].any(axis=1).sum()) * TICK
            self.seconds.append(Second(float(t[begin]), some, moves[part].sum(axis=0), squares[:, part].sum(axis=1)))
        for i in range(moves.shape[1]):
            on = moves[:, i]
            v, drive = out.speed[on, i], (out.rotor + out.rigid)[on, i]
            rows = np.column_stack([own_terms(v, drive), out.tau_m[on, i]])
            self._normal[i] += rows.T @ rows
        return fixed

    @property
    def moved(self) -> float:
        """Time in which some joint moved [s]."""
        return sum(second.moved for second in self.seconds)

    def rms(self, begin: float = 0.0, end: float = np.inf) -> Array:
        """Root mean squares (len(LEFT), n) [N·m] between two amounts of motion [s]; NaN for a joint that did not move there."""
        gone, count, squares = 0.0, np.zeros(self._normal.shape[0]), np.zeros((len(LEFT), self._normal.shape[0]))
        for second in self.seconds:
            if begin <= gone < end:
                count, squares = count + second.ticks, squares + second.squares
            gone += second.moved
        return np.sqrt(squares / np.where(count > 0, count, np.nan))

    def fitted(self) -> Array:
        """What a fit to this same log leaves (n,) [N·m], by least squares of `TERMS`; NaN for a joint that did not move."""
        left = np.full(self._normal.shape[0], np.nan)
        for i, normal in enumerate(self._normal):
            count = normal[3, 3]
            if count > TERMS:
                best = np.linalg.lstsq(normal[:TERMS, :TERMS], normal[:TERMS, TERMS], rcond=None)[0]
                left[i] = np.sqrt(max(normal[TERMS, TERMS] - best @ normal[:TERMS, TERMS], 0.0) / count)
        return left


@kernel
def slide_along(friction, motion, total) -> None:
    """Friction that nobody learns, tick after tick.

    Args:
        friction: `AdaptiveFriction.record`.
        motion: speeds (k, n) [rad/s], transmission torques (k, n) [N·m] and temperatures (k, n) [°C].
        total: takes the friction of both sides (k, n) [N·m].
    """
    speed, tau_J, temperature = motion
    nothing = np.full(speed.shape[1], np.nan)
    for j in range(speed.shape[0]):
        rub(friction, (speed[j], nothing, nothing, tau_J[j]), temperature[j], False)
        total[j] = friction[0].total
