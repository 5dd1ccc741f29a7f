"""The flange sensor's bias in free-drive: its drift and its steps are no user force and must not drive the arm (FD-19).

Drift is slower than a hand that wants something. While nobody moves the arm, changes up to the speed of drift are subtracted,
unless the joints measure them, too: else a hand that rests on the arm would count as drift, and would seem to push the other
way when it lets go. What was subtracted just before the arm moves is added again, because a hand pushes a little before the
joints show it (rollback). A sensor that steps is not used any more: how likely that is, the estimator says.
"""

import math
from collections import deque
from typing import NamedTuple

from pendant.events.event import Event, Kind
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import ZEROS
from pendant.limits.validity import WINDOW, WrenchMean, in_flange
from pendant.sensor.hand_model import SLOWEST, TOUCH, TREMOR
from pendant.sensor.odds import HALF, KNOWN
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER, gain_error, load_weight, window_noise
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, Wrench, dot, flat, norm, turned

SMOOTH = 1.0 / WINDOW
"""Weight of a tick in what the joints feel: their mean over a window."""

BEGINS = TOUCH // WINDOW
"""Windows of the mean for which a hand may push before the arm is seen to move: as long as a touch."""


class Slack(NamedTuple):
    """What the sensor may have drifted by itself since that was last followed: an uncertainty of what it tells."""

    force: float  # [N]
    torque: float  # [N·m]


SURE = Slack(0.0, 0.0)


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
        seconds = TICK * (tick - self._quiet)
        return Slack(self._sensor.drift_force * seconds, self._sensor.drift_torque * seconds)

    def slack(self, tick: int) -> Slack:
        """At this tick: it may have drifted since the arm came to rest, or what was subtracted then was a hand's."""
        (force, torque), (x, y, z, a, b, c) = self.drifted(tick), self._taken
        return Slack(max(force, norm((x, y, z))), max(torque, norm((a, b, c))))

    def begin(self, apart: Wrench, estimate: Estimate) -> Wrench | None:
        """The arm has come to rest in the tick of the estimate, and feels so much beyond the baseline, axes of F [N, N·m].

        Returns:
            What of it the sensor drifted by while the arm was moved; None while a hand holds the arm, for it is more than drift,
            noise and gain explain.
        """
        slack, sensor = self.slack(estimate.tick), self._sensor
        wrong = gain_error(sensor, estimate, self._weight) + FALSE_ALARM * window_noise(sensor, estimate)
        if norm((apart[0], apart[1], apart[2])) > slack.force + wrong:
            return None
        self._quiet, self._weight = estimate.tick, load_weight(estimate)
        self._taken = taken = (*_within(list(apart[:3]), slack.force), *_within(list(apart[3:]), slack.torque))
        return taken

    def give_back(self) -> list[Wrench]:
        """What was subtracted lately was a hand's force, axes of F [N, N·m]."""
        lately = list(self.lately)
        self.lately.clear()
        for gone in lately:
            self._taken = _sum(self._taken, gone, -1.0)
        return lately

    def keep(self, gone: Wrench) -> None:
        """So much was subtracted, axes of F [N, N·m]."""
        self.lately.append(gone)
        self._taken = _sum(self._taken, gone)

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
        gone = (*_within(change[:3], SLOWEST * time), *_within(change[3:], LEVER * SLOWEST * time))
        # What was too fast may be noise, up to a hand's tremor, and waits for the next windows; more is a hand's.
        rest = [whole - part for whole, part in zip(change, gone, strict=True)]
        later = (*_within(rest[:3], TREMOR), *_within(rest[3:], LEVER * TREMOR))
        self._followed = tuple([now - part for now, part in zip(mean, later, strict=True)])
        return gone


def _within(change: list[float], most: float) -> Vector:
    """A change of three numbers, at most so large."""
    x, y, z = change
    share = most / max(math.sqrt(x * x + y * y + z * z), most, 1e-12)
    return share * x, share * y, share * z


def _sum(one: Wrench, other: Wrench, factor: float = 1.0) -> Wrench:
    return tuple([a + factor * b for a, b in zip(one, other, strict=True)])


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


class SensorBias:
    """The part of F_user that is the sensor's bias: from the activation sequence on, or from entry, to leaving.

    Attributes:
        used: the flange sensor is; it was valid in every tick since.
        baseline: F_user in the beginning, and what the sensor drifted by, axes of F [N, N·m]; zeros without the sensor.
        drifted: what the sensor drifted by since, axes of F [N, N·m]; None: nothing was subtracted yet.
        sensor: what is known of it.
    """

    __slots__ = ("_drift", "_felt", "_since", "baseline", "drifted", "sensor", "used")

    def __init__(self, sensor: SensorSpec) -> None:
        self.sensor = sensor
        self.used = False
        self.baseline: Wrench = ZEROS
        self.drifted: Wrench | None = None
        self._drift = BiasFollower(sensor)
        self._since = 0  # tick of the beginning
        self._felt: Vector = ORIGIN  # by the joints, mean over a window, axes of B [N]

    def begin(self, estimate: Estimate, wrench_ok: bool, mean: WrenchMean) -> None:
        """The sequence or free-drive begins; `mean` of F_user is what was felt before."""
        self.used, self.baseline, self.drifted = wrench_ok, in_flange(estimate, mean.mean()), None
        self._drift, self._since = BiasFollower(self.sensor, estimate.tick, load_weight(estimate)), estimate.tick
        x, y, z = estimate.F_joints.tolist()
        self._felt = (x, y, z)

    def leave(self) -> None:
        """The sensor is not used any more."""
        self.used, self.baseline, self.drifted = False, ZEROS, None

    def felt(self, estimate: Estimate) -> Wrench | None:
        """F_user without what the sensor drifted by, axes of B [N, N·m]; None where the sensor is not used."""
        if not self.used:
            return None
        wrench = tuple(estimate.F_user.tolist())
        if self.drifted is None:
            return wrench
        x, y, z, a, b, c = self.drifted
        R_BF = flat(estimate.R_BF)
        drifted = (*turned(R_BF, (x, y, z)), *turned(R_BF, (a, b, c)))
        return tuple([value - part for value, part in zip(wrench, drifted, strict=True)])

    def slack(self, estimate: Estimate) -> Slack:
        """Of what is told at the flange now."""
        return self._drift.slack(estimate.tick)

    def step(
        self, estimate: Estimate, hand: UserForce, mean: WrenchMean, *, waits: bool, still: bool, force: float
    ) -> Event | None:
        """One tick of free-drive with a valid sensor: its drift is subtracted.

        One that steps, or has drifted far, is not used any more; that is returned.

        Args:
            estimate: of this tick.
            hand: after its step.
            mean: of F_user.
            waits: nobody is known to move the arm.
            still: no joint moves.
            force: a hand's is at least so large, if the sensor has not drifted [N], so that a smaller step moves nothing.
        """
        least = force + self._drift.drifted(estimate.tick).force
        x, y, z = estimate.F_joints.tolist()
        fx, fy, fz = self._felt
        self._felt = (fx + SMOOTH * (x - fx), fy + SMOOTH * (y - fy), fz + SMOOTH * (z - fz))
        if estimate.step_odds >= KNOWN and estimate.step_force >= least:
            self.leave()
            return Event(Kind.SENSOR_STEPPED, estimate.tick, {"force": estimate.step_force})
        if not waits:
            self._drift.pause()
            # A sensor that has drifted far seems to be a hand as well, but moves nothing.
            if self._drift.lately and not still:
                for taken in self._drift.give_back():
                    self._take_off(tuple([-value for value in taken]), hand)
        elif self._drift.due():
            now = mean.mean()
            if not self._drift.begun:
                apart = [value - part for value, part in zip(in_flange(estimate, now), self.baseline, strict=True)]
                meanwhile = self._drift.begin(tuple(apart), estimate)
                if meanwhile is None:
                    return None
                self._take_off(meanwhile, hand)
            gone = self._drift.step(now, self._felt, least)
            if gone is not None:
                gone = in_flange(estimate, gone)
                self._drift.keep(gone)
                x, y, z, a, b, c = self._take_off(gone, hand)
                far, turn = norm((x, y, z)), norm((a, b, c))
                # So far a good one does not; or a hand presses slowly on an arm at rest, and would seem to push the other way
                # when it lets go.
                sensor, seconds = self.sensor, TICK * (estimate.tick - self._since)
                most = sensor.offset_force + sensor.drift_force * seconds
                if far >= most or turn >= LEVER * sensor.offset_force + sensor.drift_torque * seconds:
                    self.leave()
                    return Event(Kind.SENSOR_DRIFTED, estimate.tick, {"force": far, "torque": turn})
        return None

    def _take_off(self, gone: Wrench, hand: UserForce) -> Wrench:
        """So much, axes of F [N, N·m], is an offset of the sensor. Returns what it drifted by in all."""
        hand.shift((gone[0], gone[1], gone[2]))
        self.drifted = drifted = _sum(self.drifted or ZEROS, gone)
        self.baseline = _sum(self.baseline, gone)
        return drifted
