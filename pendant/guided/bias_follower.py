"""What the flange sensor drifts by in free-drive: followed while nobody moves the arm, in steps of the mean's window (FD-19)."""

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from pendant.limits.parameters import ZEROS
from pendant.limits.validity import WINDOW
from pendant.sensor.hand_model import SLOWEST, TOUCH, TREMOR
from pendant.sensor.odds import HALF
from pendant.sensor.sensor_errors import LEVER, load_weight, window_error
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, Wrench, dot, norm

BEGINS = TOUCH // WINDOW
"""Windows of the mean for which a hand may push before the arm is seen to move: as long as a touch."""


class Slack(NamedTuple):
    """What the sensor may have drifted by itself since that was last followed: an uncertainty of what it tells."""

    force: float  # [N]
    torque: float  # [N·m]


SURE = Slack(0.0, 0.0)


def drift(sensor: SensorSpec, ticks: int) -> Slack:
    """Of a good sensor in so many ticks at most, each axis."""
    seconds = TICK * ticks
    return Slack(sensor.drift_force * seconds, sensor.drift_torque * seconds)


class BiasFollower:
    """What the sensor has drifted by while nobody moved the arm, in steps of the mean's window.

    Attributes:
        lately: what was subtracted in the last windows, axes of F [N, N·m].
    """

    __slots__ = ("_began", "_count", "_felt", "_followed", "_quiet", "_sensor", "_taken", "_weight", "lately")

    def __init__(self, sensor: SensorSpec, tick: int = 0, weight: Vector = ORIGIN) -> None:
        """
        Args:
            sensor: what is known of it.
            tick: of now.
            weight: of the load, axes of F [N].
        """
        self._sensor = sensor
        self._quiet, self._weight = tick, weight  # when it was last followed
        self._count = 0
        self._followed: Wrench | None = None
        self._taken: Wrench = ZEROS  # what was subtracted since the arm last came to rest, axes of F [N, N·m]
        self._began: Vector = ORIGIN  # the force of the first window, axes of B [N]
        self._felt: Vector = ORIGIN  # by the joints in it [N]
        self.lately: deque[Wrench] = deque(maxlen=BEGINS)

    @property
    def begun(self) -> bool:
        """It follows an arm at rest."""
        return self._followed is not None

    def restart(self) -> None:
        """The arm may be moved, held by a hand, or the sensor is not used."""
        self._followed = None

    def pause(self) -> None:
        """The same, and the next window begins with the next tick in which nobody moves the arm."""
        self._count = 0
        self.restart()

    def drifted(self, tick: int) -> Slack:
        """By so much it may have drifted since the arm came to rest."""
        return drift(self._sensor, tick - self._quiet)

    def slack(self, tick: int) -> Slack:
        """At this tick: it may have drifted since the arm came to rest, or what was subtracted then was a hand's."""
        (force, torque), (x, y, z, a, b, c) = self.drifted(tick), self._taken
        return Slack(max(force, norm((x, y, z))), max(torque, norm((a, b, c))))

    def begin(self, apart: Wrench, estimate: Estimate) -> Wrench | None:
        """The arm has come to rest in the tick of the estimate, and feels so much beyond the baseline, axes of F [N, N·m].

        What was subtracted at the last rest may have been a hand's: it may come back, but nothing beside it. Else a hand that
        is taken for drift would make it likelier that it is at the next rest.

        Returns:
            What of it the sensor drifted by while the arm was moved; None while a hand holds the arm, for it is more than this,
            drift, noise and gain explain.
        """
        slack, back = self.drifted(estimate.tick), self._back(apart)
        x, y, z, a, b, c = added(apart, back, -1.0)
        if norm((x, y, z)) > slack.force + window_error(self._sensor, estimate, self._weight):
            return None
        self._quiet, self._weight = estimate.tick, load_weight(estimate)
        self._taken = taken = added(back, (*within((x, y, z), slack.force), *within((a, b, c), slack.torque)))
        return taken

    def _back(self, apart: Wrench) -> Wrench:
        """What of what was subtracted at the last rest was a hand's, as far as that explains what is felt now."""
        x, y, z = self._taken[:3]
        size = x * x + y * y + z * z
        share = min(max(-dot((x, y, z), (apart[0], apart[1], apart[2])) / size, 0.0), 1.0) if size > 0.0 else 0.0
        return added(ZEROS, self._taken, -share)

    def give_back(self) -> list[Wrench]:
        """What was subtracted lately was a hand's force, axes of F [N, N·m]."""
        lately = list(self.lately)
        self.lately.clear()
        for gone in lately:
            self._taken = added(self._taken, gone, -1.0)
        return lately

    def keep(self, gone: Wrench) -> None:
        """So much was subtracted, axes of F [N, N·m]."""
        self.lately.append(gone)
        self._taken = added(self._taken, gone)

    def due(self) -> bool:
        """One tick; whether a mean is wanted in it."""
        self._count = self._count % WINDOW + 1
        return self._count == 1

    def step(self, mean: Wrench, felt: Vector, least: float) -> Wrench | None:
        """One window. Returns what is to be subtracted; None for the first one, and for what the joints feel as well.

        Args:
            mean: of it, axes of B [N, N·m].
            felt: mean of the force that the joints felt in it, axes of B [N].
            least: a hand's force is at least so large [N]: of less the joints cannot tell.
        """
        force: Vector = (mean[0], mean[1], mean[2])
        if self._followed is None:
            self._followed, self._began, self._felt = mean, force, felt
            return None
        since, answer = _less(force, self._began), _less(felt, self._felt)
        size = dot(since, since)
        # Of what a sensor alone feels the joints feel the help for it, the other way.
        if size >= least * least and dot(since, answer) >= HALF * size:
            return None
        change = [now - then for now, then in zip(mean, self._followed, strict=True)]
        time = WINDOW * TICK
        gone = (*within(change[:3], SLOWEST * time), *within(change[3:], LEVER * SLOWEST * time))
        # What was too fast may be noise, up to a hand's tremor, and waits for the next windows; more is a hand's.
        rest = [whole - part for whole, part in zip(change, gone, strict=True)]
        later = (*within(rest[:3], TREMOR), *within(rest[3:], LEVER * TREMOR))
        self._followed = tuple([now - part for now, part in zip(mean, later, strict=True)])
        return gone


def within(change: Sequence[float], most: float) -> Vector:
    """A change of three numbers, at most so large."""
    x, y, z = change
    share = most / max(math.sqrt(x * x + y * y + z * z), most, 1e-12)
    return share * x, share * y, share * z


def added(one: Wrench, other: Wrench, factor: float = 1.0) -> Wrench:
    """The sum of a wrench and another times a factor."""
    return tuple([a + factor * b for a, b in zip(one, other, strict=True)])


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
