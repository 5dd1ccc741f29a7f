"""The flange sensor's zero in free-drive: what it drifts and steps by is no hand's, and must not drive the arm (FD-19).

A sensor that drifts changes more slowly than a hand that wants something; while nobody moves the arm, so much of every change is
taken off. A hand that begins to push cannot be told from it before the arm moves; then what was taken off lately is given back,
for push after push it would add up to an offset that drives the arm when it is let go. A sensor that steps is not used any more
(`pendant.sensor_steps`).
"""

import math
from collections import deque

from pendant.estimate import Estimate
from pendant.events import Event, Kind
from pendant.hand import Hand
from pendant.modes import TICK
from pendant.parameters import ZEROS
from pendant.pose import Vector, Wrench, flat, norm, turned
from pendant.sensor_steps import MOVED, Steps
from pendant.watch import WINDOW, WrenchMean, in_flange

SLOW = 3.0
"""So fast may a force drift [N/s]."""

SLOW_TURN = 0.6
"""And a torque [N·m/s]."""

NOISY, NOISY_TURN = 0.5, 0.1
"""What of a change was too fast waits for the next windows up to so much [N, N·m], for it may be noise; more is a hand's."""

FAR, FAR_TURN = 4.0, 1.0
"""A sensor that has drifted so far [N, N·m] is not used any more: it is not so good as it should be, or a hand presses slowly on
an arm that does not move, and would seem to push the other way when it lets go."""

BEGINS = 5
"""Windows of the mean for which a hand may push before the arm is seen to move: 0.5 s."""


class Drift:
    """What the sensor has drifted by while nobody moved the arm, in steps of the mean's window.

    Attributes:
        lately: what was taken off in the last windows, axes of F [N, N·m].
    """

    __slots__ = ("_count", "_followed", "lately")

    def __init__(self) -> None:
        self._count = 0
        self._followed: Wrench | None = None
        self.lately: deque[Wrench] = deque(maxlen=BEGINS)

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._count, self._followed, tuple(self.lately))

    def restart(self) -> None:
        """The arm may be moved, or the sensor is not used."""
        self._count, self._followed = 0, None

    def give_back(self) -> list[Wrench]:
        """What was taken off lately was a hand's, axes of F [N, N·m]."""
        lately = list(self.lately)
        self.lately.clear()
        return lately

    def keep(self, gone: Wrench) -> None:
        """So much was taken off, axes of F [N, N·m]."""
        self.lately.append(gone)

    def due(self) -> bool:
        """One tick; whether a mean is wanted in it."""
        self._count = self._count % WINDOW + 1
        return self._count == 1

    def step(self, mean: Wrench) -> Wrench | None:
        """The mean of the last window, axes of B [N, N·m]: what is to be taken off; None for the first one."""
        if self._followed is None:
            self._followed = mean
            return None
        change = [now - then for now, then in zip(mean, self._followed, strict=True)]
        time = WINDOW * TICK
        gone = (*_within(change[:3], SLOW * time), *_within(change[3:], SLOW_TURN * time))
        rest = [whole - part for whole, part in zip(change, gone, strict=True)]
        later = (*_within(rest[:3], NOISY), *_within(rest[3:], NOISY_TURN))
        self._followed = tuple([now - part for now, part in zip(mean, later, strict=True)])
        return gone


def _within(change: list[float], most: float) -> Vector:
    """A change of three numbers, at most so large."""
    x, y, z = change
    share = most / max(math.sqrt(x * x + y * y + z * z), most)
    return share * x, share * y, share * z


class Zero:
    """What of F_user is nobody's: from the activation sequence on, or from entry, to leaving.

    Attributes:
        used: the flange sensor is; it was valid in every tick since.
        baseline: F_user in the beginning, and what the sensor drifted by, axes of F [N, N·m]; zeros without the sensor.
        drifted: what the sensor drifted by since, axes of F [N, N·m].
    """

    __slots__ = ("_drift", "_steps", "baseline", "drifted", "used")

    def __init__(self) -> None:
        self.used = False
        self.baseline: Wrench = ZEROS
        self.drifted: Wrench = ZEROS
        self._drift, self._steps = Drift(), Steps()

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self.used, self.baseline, self.drifted, self._drift.memory, self._steps.memory)

    def begin(self, estimate: Estimate, wrench_ok: bool, mean: WrenchMean) -> None:
        """The sequence or free-drive begins; `mean` of F_user is what was felt before."""
        self.used, self.baseline, self.drifted = wrench_ok, in_flange(estimate, mean.mean()), ZEROS
        self._drift, self._steps = Drift(), Steps()

    def leave(self) -> None:
        """The sensor is not used any more."""
        self.used, self.baseline, self.drifted = False, ZEROS, ZEROS

    def felt(self, estimate: Estimate) -> Wrench | None:
        """F_user without what the sensor drifted by, axes of B [N, N·m]; None where the sensor is not used."""
        if not self.used:
            return None
        wrench = tuple(estimate.F_user.tolist())
        if self.drifted is ZEROS:
            return wrench
        x, y, z, a, b, c = self.drifted
        R_BF = flat(estimate.R_BF)
        drifted = (*turned(R_BF, (x, y, z)), *turned(R_BF, (a, b, c)))
        return tuple([value - part for value, part in zip(wrench, drifted, strict=True)])

    def step(self, estimate: Estimate, hand: Hand, mean: WrenchMean, waits: bool) -> Event | None:
        """One tick of free-drive with a valid sensor: what it drifts by is taken off.

        One that steps, or has drifted far, is not used any more; that is returned.

        Args:
            estimate: of this tick.
            hand: after its step.
            mean: of F_user.
            waits: nobody is known to move the arm.
        """
        stepped = self._steps.step(estimate, hand.change)
        if stepped is not None:
            self.leave()
            return Event(Kind.SENSOR_STEPPED, estimate.tick, {"force": norm(stepped)})
        if not waits:
            self._drift.restart()
            # A sensor that has drifted far seems to be a hand as well, but moves nothing.
            if self._drift.lately and any(abs(speed) > MOVED for speed in estimate.qd.tolist()):
                for taken in self._drift.give_back():
                    self._take_off(tuple([-value for value in taken]), hand)
        elif self._drift.due():
            gone = self._drift.step(mean.mean())
            if gone is not None:
                gone = in_flange(estimate, gone)
                self._drift.keep(gone)
                self._take_off(gone, hand)
                x, y, z, a, b, c = self.drifted
                far, turn = norm((x, y, z)), norm((a, b, c))
                if far >= FAR or turn >= FAR_TURN:
                    self.leave()
                    return Event(Kind.SENSOR_DRIFTED, estimate.tick, {"force": far, "torque": turn})
        return None

    def _take_off(self, gone: Wrench, hand: Hand) -> None:
        """So much, axes of F [N, N·m], is an offset of the sensor."""
        hand.shift((gone[0], gone[1], gone[2]))
        self.drifted = tuple([a + b for a, b in zip(self.drifted, gone, strict=True)])
        self.baseline = tuple([a + b for a, b in zip(self.baseline, gone, strict=True)])
