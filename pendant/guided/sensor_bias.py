"""The flange sensor's bias in free-drive: its drift and its steps are no user force and must not drive the arm (FD-19).

Drift is slower than a hand that wants something. While nobody moves the arm, changes up to the speed of drift are subtracted,
unless the joints measure them, too: else a hand that rests on the arm would count as drift, and would seem to push the other
way when it lets go. What was subtracted just before the arm moves is added again, because a hand pushes a little before the
joints show it (rollback). A sensor that steps ends free-drive: how likely that is, the estimator says.
"""

import math

from pendant.events.event import Event, Kind
from pendant.guided.bias_follower import BiasFollower, Slack, added, drift, within
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import ZEROS
from pendant.limits.validity import WINDOW, WrenchMean, in_flange
from pendant.sensor.hand_model import KNOWN
from pendant.sensor.sensor_errors import LEVER, load_weight
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.pose import ORIGIN, Vector, Wrench, flat, norm, turned

SMOOTH = 1.0 / WINDOW
"""Weight of a tick in what the joints feel: their mean over a window."""


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
        return self._drift.slack(estimate)

    def wrong(self, tick: int) -> Slack:
        """The bias at most: nothing of what was subtracted may be the sensor's, and it may have drifted meanwhile."""
        (force, torque), (x, y, z, a, b, c) = drift(self.sensor, tick - self._since), self.drifted or ZEROS
        return Slack(norm((x, y, z)) + force, norm((a, b, c)) + torque)

    def apart(self, estimate: Estimate, mean: Wrench) -> Wrench:
        """A mean of F_user without the bias, axes of F [N, N·m]."""
        return added(in_flange(estimate, mean), self.baseline, -1.0)

    def step(
        self,
        estimate: Estimate,
        hand: UserForce,
        mean: WrenchMean,
        *,
        waits: bool,
        still: bool,
        force: float,
    ) -> Event | None:
        """One tick of free-drive with a valid sensor: its drift is subtracted.

        Returns what ends free-drive: it steps, or has drifted far.

        Args:
            estimate: of this tick.
            hand: after its step.
            mean: of F_user.
            waits: nobody is known to move the arm.
            still: no joint moves.
            force: a hand's is at least so large, if the sensor has not drifted [N], so that a smaller step moves nothing.
        """
        x, y, z = estimate.F_joints.tolist()
        fx, fy, fz = self._felt
        self._felt = (fx + SMOOTH * (x - fx), fy + SMOOTH * (y - fy), fz + SMOOTH * (z - fz))
        if estimate.whose.step_odds >= KNOWN and estimate.whose.step_force >= self._least(force, estimate.tick):
            return Event(Kind.SENSOR_STEPPED, estimate.tick, {"force": estimate.whose.step_force})
        if not waits:
            self._drift.pause()
            # A sensor that has drifted far seems to be a hand as well, but moves nothing.
            if self._drift.lately and not still:
                for taken in self._drift.give_back():
                    self._take_off(tuple([-value for value in taken]), hand)
        elif self._drift.due():
            now, least = mean.mean(), self._least(force, estimate.tick)
            apart = self.apart(estimate, now)
            if not self._drift.begun:
                if self._drift.held(apart, estimate):
                    return None
            elif self._drift.rested(apart):
                gone, most = self.drifted or ZEROS, drift(self.sensor, estimate.tick - self._since)
                self._know((*_grown(gone[:3], apart[:3], most.force), *_grown(gone[3:], apart[3:], most.torque)), estimate, hand)
            gone = self._drift.step(now, self._felt, least)
            if gone is not None:
                gone = in_flange(estimate, gone)
                self._drift.keep(gone)
                x, y, z, a, b, c = self._take_off(gone, hand)
                far, turn = norm((x, y, z)), norm((a, b, c))
                # So far a good one does not; or a hand presses slowly on an arm at rest, and would seem to push the other way
                # when it lets go.
                offset, drifts = self.sensor.offset_force, drift(self.sensor, estimate.tick - self._since)
                if far >= offset + drifts.force or turn >= LEVER * offset + drifts.torque:
                    return Event(Kind.SENSOR_DRIFTED, estimate.tick, {"force": far, "torque": turn})
        return None

    def _least(self, force: float, tick: int) -> float:
        """A hand's force is at least so large, with what the sensor may have drifted by since its bias was last known [N]."""
        return force + self._drift.drifted(tick).force

    def _know(self, gone: Wrench, estimate: Estimate, hand: UserForce) -> None:
        """So much, axes of F [N, N·m], is all that the sensor has drifted by since its bias was last known."""
        self._take_off(gone, hand)
        self._drift.know(estimate)

    def _take_off(self, gone: Wrench, hand: UserForce) -> Wrench:
        """So much, axes of F [N, N·m], is an offset of the sensor. Returns what it drifted by in all."""
        hand.shift((gone[0], gone[1], gone[2]))
        self.drifted = drifted = added(self.drifted or ZEROS, gone)
        self.baseline = added(self.baseline, gone)
        return drifted


def _grown(gone: tuple[float, ...], more: tuple[float, ...], most: float) -> Vector:
    """What of `more` comes to `gone`, so that the sum is at most so large, or as `gone` was.

    Else rests in which a hand was taken for drift would add up to what no good sensor drifts by.
    """
    x, y, z = within([a + b for a, b in zip(gone, more, strict=True)], max(most, math.hypot(*gone)))
    return x - gone[0], y - gone[1], z - gone[2]
