"""Whether what seems to lead the free arm is an error of the flange sensor's bias: a wrench that does not change (FD-19).

An error of the bias turns with the flange, and is the same in every window but for noise and gain. The wrench of a hand that
leads a moving arm is not. So a wrench that the bias may be wrong by, and that has not changed for as long as an arm may move
without a hand, may be the sensor's. Nothing helps the motion on then, and the arm brakes. A hand that is there pushes more, and
is known by that. An error stays what it is until the arm rests: then it is known, and becomes part of the bias.

What did change in that time has two values x and y of which one at least is a hand's, however wrong the bias b is: of
|x - b| and |y - b| the larger is half of |x - y| or more. So a hand that turns round is known after minutes, too, in which the
sensor may have drifted by more than that hand pushes.
"""

import math
from collections import deque

from pendant.guided.bias_follower import Slack
from pendant.limits.validity import WINDOW
from pendant.sensor.odds import HALF
from pendant.sensor.sensor_errors import LEVER, gain_error, load_weight, noise_error, window_error
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.pose import ORIGIN, Vector, Wrench

OFTEN = WINDOW // 5
"""Ticks from one window's end to the next one's: the windows overlap, so that a hand that lets go is missed soon."""


class SteadyWrench:
    """Compares windows of the wrench, one after the other.

    Attributes:
        steady: it has not changed for so long, while the arm moved.
        changes: within that time it changed as only a hand changes it.
    """

    __slots__ = ("_count", "_first", "_force", "_lately", "_needed", "_sensor", "_weight", "_windows", "changes", "steady")

    def __init__(self, sensor: SensorSpec, needed: int, force: float) -> None:
        """
        Args:
            sensor: what is known of it.
            needed: ticks for which an arm may move without a hand.
            force: a hand's is at least so large [N].
        """
        self._sensor, self._needed, self._force = sensor, -(-needed // OFTEN), force
        self._lately: deque[tuple[Wrench, Vector]] = deque(maxlen=self._needed)  # windows, and the load's weight in each
        self._count = 0  # ticks since a window ended
        self._first: Wrench | None = None  # window since which it is the same, axes of F [N, N·m]
        self._weight: Vector = ORIGIN  # of the load in it, axes of F [N]
        self._windows = 0  # that were the same as it
        self.steady = self.changes = False

    def due(self) -> bool:
        """One tick; whether a window ends with it."""
        self._count = (self._count + 1) % OFTEN
        return self._count == 0

    def forget(self) -> None:
        """The sensor is not used, or something else moves the arm."""
        self._begin()
        self._lately.clear()
        self.changes = False

    def step(self, apart: Wrench, estimate: Estimate, *, moves: bool, wrong: Slack) -> None:
        """One window.

        Args:
            apart: the wrench without the bias, axes of F [N, N·m].
            estimate: of its last tick.
            moves: the arm does.
            wrong: of the bias at most.
        """
        noise, weight = noise_error(self._sensor, estimate), load_weight(estimate)
        self.changes = self._changes(apart, estimate, noise)
        self._lately.append((apart, weight))
        hand = math.hypot(*apart[:3]) > wrong.force + noise or math.hypot(*apart[3:]) > wrong.torque + LEVER * noise
        if hand or not (moves or self.steady):
            self._begin()
            return
        first = self._first
        if first is not None and self._same(apart, first, estimate):
            self._windows += 1
            self.steady = self._windows >= self._needed
            return
        self._begin()
        self._first, self._weight = apart, weight

    def _begin(self) -> None:
        self._first, self._windows, self.steady = None, 0, False

    def _changes(self, apart: Wrench, estimate: Estimate, noise: float) -> bool:
        """Half of the change is a hand's force, for `noise` [N] and gain do not explain it."""
        least = self._force / HALF + noise
        for then, weight in self._lately:
            change = max(math.dist(apart[:3], then[:3]), math.dist(apart[3:], then[3:]) / LEVER)
            if change > least and change > least + gain_error(self._sensor, estimate, weight):
                return True
        return False

    def _same(self, apart: Wrench, first: Wrench, estimate: Estimate) -> bool:
        """Noise and gain explain how far apart the two are; as the arm brakes, it may be as far as no hand's force is."""
        error = window_error(self._sensor, estimate, self._weight) + self._force * self.steady
        return math.dist(apart[:3], first[:3]) <= error and math.dist(apart[3:], first[3:]) <= LEVER * error
