"""A planned motion that leads out of the workspace is seen ahead of the arm, and stopped on its way at the border (VW-9).

The look goes ahead tick by tick, as far as a stop needs. Where it meets no border, the motion is as it was planned. Where it
does, the motion's own time slows down as half a cosine and stands when the part is there:

    rate(t) = rate_0 (1 + cos(pi t / T)) / 2        t_border - t_0 = rate_0 T / 2

so that the tool stays on its path. T is the time that the joints need to brake from the fastest that was seen so far.
"""

import copy
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from pendant.walls.workspace import OutwardLimits
from sim.braking.stopping_distance import StoppingDistance

Array = NDArray[np.float64]

AHEAD = 4
"""Ticks that are looked at beyond the way of a stop."""

AT_BORDER = 25
"""As many where a part is just beyond a border, which it may be by a hair: whether it goes further, or comes back."""

GLANCE = 5
"""Ticks between the places whose braking time is looked at: joints gain 6 % of their speed in that time at most."""


HARDEST = 2.0 / math.pi
"""Of the time in which the joints can brake as half a cosine: in so much an even deceleration needs the same torque."""


class AlongPlan(Protocol):
    """A motion whose rest is known."""

    done: bool

    def step(self, rate: float = 1.0) -> Sequence[Array]:
        """The reference of the next tick, whose first two are angles and speeds (n,); `rate`: how fast its own time passes."""
        ...


class Brake(NamedTuple):
    """A motion's own time that comes to a stand."""

    time: float  # since it began [s]
    length: float  # that it takes [s]
    rate: float  # at its begin
    own: float  # motion's own time then [s]
    area: int  # at whose border it stands in the end


class LookAhead:
    """One motion from where it is now.

    Args:
        motion: which it looks at a copy of.
        limits: how far out each part may be.
        distances: of the parts to the borders, by angles (n,).
        stopping: what it takes to come to rest.

    Attributes:
        stopped: it stands at a border; the area's number, None for none.
    """

    def __init__(
        self, motion: AlongPlan, limits: OutwardLimits, distances: Callable[[Array], list[float]], stopping: StoppingDistance
    ) -> None:
        self._probe, self._limits = copy.copy(motion), limits.copy()
        self._distances, self._stopping = distances, stopping
        self._own = self._seen = 0.0  # the motion's own time, of the arm and of the look [s]
        self._looks = 0
        self._first = self._longest = 0.0  # braking time from full rate, at the begin and of all that was seen [s]
        self._border: float | None = None  # own time at which a part comes to the border that it then goes beyond [s]
        self._beyond: tuple[float, int] | None = None  # own time, and which area
        self._brake: Brake | None = None
        self.stopped: int | None = None

    def rate(self, rate: float) -> float:
        """The rate of the next tick, at most `rate`."""
        if self._brake is None:
            self._look(rate)
            if self._beyond is not None:
                self._begin(rate, *self._beyond)
        if self._brake is not None:
            braked = self._braked()
            if braked > rate:  # something else slows the motion down more: it brakes from there
                self._brake = None
            rate = min(rate, braked)
        self._own += rate * TICK
        return rate

    def _look(self, rate: float) -> None:
        """Go ahead as far as a stop from this rate needs."""
        probe = self._probe
        while self._beyond is None and not probe.done:
            more = AHEAD if self._border is None else AT_BORDER
            if self._seen - self._own >= self._stop(rate) + more * rate * TICK:
                return
            q, qd = probe.step(rate)[:2]
            self._seen += rate * TICK
            if self._looks % GLANCE == 0:
                seconds = self._stopping.seconds(q, qd) / rate
                self._first = seconds if self._looks == 0 else self._first
                self._longest = max(self._longest, seconds)
            self._looks += 1
            distances = self._distances(q)
            self._limits.step(distances)
            beyond = self._limits.beyond(distances)
            if beyond is not None:
                self._beyond = self._seen, beyond
            elif any(not d <= place for d, place in zip(distances, self._limits.place, strict=True)):
                self._border = self._seen if self._border is None else self._border
            else:
                self._border = None

    def _stop(self, rate: float) -> float:
        """Own time in which the motion comes to rest from a rate [s]."""
        return rate * self._stopping.way(rate * self._longest, 0.0)

    def _begin(self, rate: float, beyond: float, area: int) -> None:
        """Begin to brake where it is time to: to stand at the border, or where that is too near, before what is beyond it."""
        stop = self._stop(rate)
        border = self._border
        end = beyond if border is None or border - self._own < stop else border
        left = end - rate * TICK - self._own
        if rate > 0.0 and left <= stop + rate * TICK:
            # An arm that moved as the motion began may be so near that it can only brake as hard as it can.
            length = max(2.0 * left / rate, HARDEST * rate * self._first)
            self._brake = Brake(0.0, length, rate, self._own, area)

    def _braked(self) -> float:
        """The rate of the next tick of a motion that brakes."""
        assert self._brake is not None
        time, length, begin, own, area = self._brake
        time += TICK
        self._brake = self._brake._replace(time=time)
        if time >= length:
            self.stopped = area
            return 0.0
        phase = math.pi / length
        return max(own + 0.5 * begin * (time + math.sin(phase * time) / phase) - self._own, 0.0) / TICK
