"""Torque feedback controller: correction of the transmission-torque error (AF-5)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK

Array = NDArray[np.float64]

SUPPORT = 0.6
"""Share of a load that the desired torque does not know and that the motor takes over at once. It stiffens the hold by
1 / (1 - SUPPORT); more than that and the motor-side mode of a light arm loses its damping."""

BANDWIDTH = 90.0  # [Hz]


class TorqueFeedback:
    """Filtered error of the transmission torque of n joints, times `SUPPORT`."""

    def __init__(self, n: int) -> None:
        self._rate = 1.0 - math.exp(-2.0 * math.pi * BANDWIDTH * TICK)
        self._error = np.zeros(n)

    def start(self, measured: Array, desired: Array) -> None:
        """Begin with this error as if it had always been there."""
        np.subtract(measured, desired, out=self._error)

    def add(self, measured: Array, desired: Array, torque: Array) -> None:
        """Add the correction for measured against desired transmission torque (n,) to `torque` (n,) [N·m]."""
        _support(measured, desired, self._rate, self._error, torque)


@numba.njit(cache=True)
def _support(measured, desired, rate, error, torque) -> None:
    for i in range(torque.size):
        error[i] += rate * (measured[i] - desired[i] - error[i])
        torque[i] += SUPPORT * error[i]
