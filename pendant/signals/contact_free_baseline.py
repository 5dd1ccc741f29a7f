"""The untouched state of the held arm: what sensors feel while nobody touches it, so that a push is a change from it (FD-5)."""

import math
from collections.abc import Sequence

from pendant.limits.validity import WINDOW
from pendant.sensor.hand_model import KEEPS, STEADY, TREMOR
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK

FOLLOW = TICK / KEEPS
"""It follows small changes, as a sensor drifts, by this share a tick."""

STILL = ticks(STEADY)
"""Ticks after which a change that stays within a hand's tremor is none of a hand's."""

CREEP = TREMOR / STILL
"""It follows large ones by so much: less than a hand would notice [N or N·m a tick]."""


class Untouched:
    """Smooths measured values and gives their change from the untouched state."""

    __slots__ = ("_base", "_count", "_held", "_near", "_rate", "_smooth", "_steady", "_weights", "_zeros", "change", "noise")

    def __init__(self, weights: Sequence[float], near: float, smoothing: float) -> None:
        """
        Args:
            weights: of each value in the size of a change, which is the largest weighted value.
            near: changes of a smaller size are followed.
            smoothing: time constant [s].
        """
        self._weights = tuple(weights)
        self._zeros = [0.0] * len(self._weights)
        self._near = near
        self._rate = 1.0 - math.exp(-TICK / smoothing)
        self.noise = 0.0  # root of the mean square of the largest small change, as weighted
        self.restart()

    def restart(self) -> None:
        """Learn it afresh: the posture is another, or the sensor was away. Until then nothing is felt."""
        self._base = list(self._zeros)
        self._smooth = list(self._zeros)
        self._count = 0
        self._held = 0.0
        self._steady = 0
        self.change = self._zeros

    def step(self, values: Sequence[float]) -> list[float]:
        """One tick of finite values. Returns their change, zeros while it is being learned."""
        base = self._base
        if self._count < WINDOW:
            self._count += 1
            for k, value in enumerate(values):
                base[k] += (value - base[k]) / self._count
            self._smooth = list(base)
            return self.change
        smooth, rate, size = self._smooth, self._rate, 0.0
        change: list[float] = []
        for k, value in enumerate(values):
            smooth[k] += rate * (value - smooth[k])
            part = smooth[k] - base[k]
            change.append(part)
            weighted = abs(part) * self._weights[k]
            if weighted > size:
                size = weighted
        self.change = change
        if abs(size - self._held) > TREMOR:
            self._held, self._steady = size, 0
        elif self._steady < STILL:
            self._steady += 1
        if size < self._near:
            self.noise = math.sqrt(self.noise * self.noise + FOLLOW * (size * size - self.noise * self.noise))
            share = FOLLOW
        elif self._steady == STILL:
            share = 1.0
        else:
            share = CREEP / size
        for k, part in enumerate(change):
            base[k] += share * part
        return change
