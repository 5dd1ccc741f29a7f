"""Whether what the flange sensor feels changes as only a hand changes it, however wrong its bias is (FD-19).

An error of the bias turns with the flange, and is the same in every window but for noise and gain. The wrench of a hand that
leads a moving arm is not. What changed has two values x and y of which one at least is a hand's, however wrong the bias b is: of
|x - b| and |y - b| the larger is half of |x - y| or more. So a hand that turns round is known after minutes, too, in which the
sensor may have drifted by more than that hand pushes. The same holds since an arm went on its own: who changes less than that
while it goes as far as it may alone cannot be told from an error.
"""

import math
from collections import deque
from operator import sub

from pendant.guided.bias_follower import OFTEN
from pendant.limits.parameters import ZEROS
from pendant.sensor.odds import HALF
from pendant.sensor.sensor_errors import LEVER, gain_error, load_weight, noise_error
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.pose import ORIGIN, Vector, Wrench


class ChangingWrench:
    """Compares windows of the wrench, one after the other.

    Attributes:
        changes: within the time that an arm may move without a hand it changed as only a hand changes it.
        turned: it did since the way began (`begin_way`).
    """

    __slots__ = ("_count", "_force", "_high", "_lately", "_low", "_sensor", "_way_weight", "changes", "turned")

    def __init__(self, sensor: SensorSpec, needed: int, force: float) -> None:
        """
        Args:
            sensor: what is known of it.
            needed: ticks for which an arm may move without a hand.
            force: a hand's is at least so large [N].
        """
        self._sensor, self._force = sensor, force
        self._lately: deque[tuple[Wrench, Vector]] = deque(maxlen=-(-needed // OFTEN))  # windows, and the load's weight in each
        self._count = 0  # ticks since a window ended
        self._low: Wrench | None = None  # the least of each axis since the way began, axes of F [N, N·m]; None: no window yet
        self._high: Wrench = ZEROS  # the most
        self._way_weight: Vector = ORIGIN  # of the load as it began, axes of F [N]
        self.changes = self.turned = False

    def begin_way(self) -> None:
        """An arm goes on its own from here."""
        self._low, self.turned = None, False

    def due(self) -> bool:
        """One tick; whether a window ends with it. Windows overlap, so that a hand that lets go is missed soon."""
        self._count = (self._count + 1) % OFTEN
        return self._count == 0

    def forget(self) -> None:
        """The sensor is not used, or something else moves the arm."""
        self._lately.clear()
        self.changes = False
        self.begin_way()

    def step(self, apart: Wrench, estimate: Estimate) -> None:
        """One window.

        Args:
            apart: the wrench without the bias, axes of F [N, N·m].
            estimate: of its last tick.
        """
        noise, weight = noise_error(self._sensor, estimate), load_weight(estimate)
        least = self._force / HALF + noise  # of a change that is a hand's: half of it is its force [N]
        self.changes = self._changes(apart, estimate, least)
        self._lately.append((apart, weight))
        self.turned = self._turns(apart, estimate, least, weight)

    def _changes(self, apart: Wrench, estimate: Estimate, least: float) -> bool:
        """It changes by `least` [N], and more than gain explains."""
        for then, weight in self._lately:
            change = max(math.dist(apart[:3], then[:3]), math.dist(apart[3:], then[3:]) / LEVER)
            if change > least and change > least + gain_error(self._sensor, estimate, weight):
                return True
        return False

    def _turns(self, apart: Wrench, estimate: Estimate, least: float, weight: Vector) -> bool:
        """The same since the way began: of its windows the extremes of each axis are kept. The load's weight is so [N] now."""
        low, high = self._low, self._high
        if low is None:
            self._low = self._high = apart
            self._way_weight = weight
            return False
        self._low, self._high = low, high = tuple(map(min, low, apart)), tuple(map(max, high, apart))
        x, y, z, a, b, c = map(sub, high, low)
        change = max(x, y, z, max(a, b, c) / LEVER)
        return change > least and change > least + gain_error(self._sensor, estimate, self._way_weight)
