"""What the flange sensor drifts by in free-drive (FD-19).

While nobody moves the arm, what changes is followed in steps of the mean's window. But a hand may hold the arm at rest, so what
the sensor has drifted by while the arm was moved is known only where it rests for so long, and feels the same, that no hand is
there. Until then all that may have come since the bias was last known is an uncertainty of what it tells: its `Slack`.
"""

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from pendant.limits.parameters import ZEROS
from pendant.limits.validity import WINDOW
from pendant.sensor.hand_model import HALF, SLOWEST, STEADY, TOUCH, TREMOR
from pendant.sensor.sensor_errors import CENTRE, LEVER, load_weight, window_error
from pendant.sensor.sensor_spec import SensorSpec
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, Wrench, dot, norm

BEGINS = TOUCH // WINDOW
"""Windows of the mean for which a hand may push before the arm is seen to move: as long as a touch."""


OFTEN = WINDOW // 5
"""Ticks from one look at what changes slowly to the next one."""


STILL = ticks(STEADY) // WINDOW
"""Windows in which a hand that holds the arm would be known by its tremor."""


class Slack(NamedTuple):
    """What the sensor may tell without a hand, since that was last followed: an uncertainty of what it tells."""

    force: float  # [N]
    torque: float  # [N·m]

    @property
    def axis(self) -> float:
        """Standard deviation of an axis of the force [N]: three alike make it at most, and each may be anything up to that."""
        return self.force / 3.0


SURE = Slack(0.0, 0.0)

UNUSED = Slack(math.inf, math.inf)
"""The sensor is not used: all of what it tells may be wrong."""


def drift(sensor: SensorSpec, time: int) -> Slack:
    """Of a good sensor in so many ticks at most, all three axes together: each goes from nothing to its largest bias.

    It does so as fast as the quickest of such sensors warms up. Of 1,000 that were switched on just before, 3 to 10 have gone
    further at any one time within nine minutes.
    """
    force, torque, gone = sensor.offset_force, sensor.offset_torque, -math.expm1(-TICK * time / sensor.quickest)
    return Slack(gone * norm((force, force, force)), gone * norm((torque, torque, torque)))


class BiasFollower:
    """What the sensor has drifted by while nobody moved the arm, in steps of the mean's window.

    Attributes:
        lately: what was subtracted in the last windows, axes of F [N, N·m].
    """

    __slots__ = (
        "_began",
        "_count",
        "_felt",
        "_first",
        "_followed",
        "_known_at",
        "_rested",
        "_sensor",
        "_slack",
        "_slack_at",
        "_taken",
        "_weight",
        "lately",
    )

    def __init__(self, sensor: SensorSpec, tick: int = 0, weight: Vector = ORIGIN) -> None:
        """
        Args:
            sensor: what is known of it.
            tick: of now.
            weight: of the load, axes of F [N].
        """
        self._sensor = sensor
        self._known_at, self._weight = tick, weight  # when it was last known
        self._count = 0
        self._followed: Wrench | None = None
        self._taken: Wrench = ZEROS  # what was subtracted since then, axes of F [N, N·m]
        self._rested, self._first = 0, ORIGIN  # windows at rest that felt the same, and the force of the first, axes of F [N]
        self._slack, self._slack_at = SURE, tick  # as told last, and when
        self._began: Vector = ORIGIN  # the force of the first window, axes of B [N]
        self._felt: Vector = ORIGIN  # by the joints in it [N]
        self.lately: deque[Wrench] = deque(maxlen=BEGINS)

    @property
    def begun(self) -> bool:
        """It follows an arm at rest."""
        return self._followed is not None

    def restart(self) -> None:
        """The arm may be moved, held by a hand, or the sensor is not used."""
        self._followed, self._rested = None, 0

    def pause(self) -> None:
        """The same, and the next window begins with the next tick in which nobody moves the arm."""
        self._count = 0
        self.restart()

    def drifted(self, tick: int) -> Slack:
        """By so much it may have drifted since it was last known."""
        return drift(self._sensor, tick - self._known_at)

    def slack(self, estimate: Estimate) -> Slack:
        """It may have drifted since it was last known, and what was subtracted since then may have been a hand's.

        Where the load has turned since, the sensor's gain makes a force of it, and its centre a torque, which is not known
        exactly. All that changes slowly.
        """
        if estimate.tick - self._slack_at >= OFTEN:
            self._slack_at = estimate.tick
            (force, torque), (x, y, z, a, b, c) = self.drifted(estimate.tick), self._taken
            turned = math.dist(load_weight(estimate), self._weight)
            gain = self._sensor.gain * turned
            force, torque = force + norm((x, y, z)) + gain, torque + norm((a, b, c)) + LEVER * gain + CENTRE * turned
            self._slack = Slack(force, torque)
        return self._slack

    def held(self, apart: Wrench, estimate: Estimate) -> bool:
        """The arm comes to rest in the tick of the estimate, and feels so much beyond the baseline, axes of F [N, N·m].

        A hand holds it: this is more than drift, noise, gain, and what was subtracted and was a hand's explain.
        """
        x, y, z = added(apart, self._taken)[:3]
        return norm((x, y, z)) > self.drifted(estimate.tick).force + window_error(self._sensor, estimate, self._weight)

    def rested(self, apart: Wrench) -> bool:
        """One window at rest. It has felt the same for so long that nobody holds it, for a hand trembles."""
        if self._rested == 0 or math.dist(apart[:3], self._first) > TREMOR:
            x, y, z = apart[:3]
            self._rested, self._first = 0, (x, y, z)
        self._rested += 1
        return self._rested > STILL

    def know(self, estimate: Estimate) -> None:
        """What is felt in this tick was all subtracted, and is the sensor's."""
        self._known_at, self._weight = estimate.tick, load_weight(estimate)
        self._taken, self._rested = ZEROS, 0

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
