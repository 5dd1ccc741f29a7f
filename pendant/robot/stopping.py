"""A stop from its cause to standstill: stop category, drive power, time and way (IEC 60204-1)."""

from pendant.events.event import Event, Kind, Values
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK

LONGEST = ticks(1.0)
"""A category 1 stop removes the power after this time at the latest, whether the arm is known to stand or not."""


class Stopping:
    """Category 0 removes the power at once, 1 when the arm stands, 2 never. The brakes then hold until a reset."""

    __slots__ = ("_category", "_cause", "_distance", "_measuring", "_ticks", "off")

    def __init__(self) -> None:
        self.off = False  # the drive power is removed
        self._category: int | None = None
        self._cause = ""
        self._measuring = False
        self._ticks = 0  # since the stop began
        self._distance = 0.0  # way of the tool centre point since then [m]

    def begin(self, kind: Kind, category: int, static: bool) -> None:
        """An event of `kind` stops the arm. A second stop on top of a first can only be harder.

        Args:
            kind: the cause.
            category: 0, 1 or 2.
            static: the arm stands already, so there is nothing to measure.
        """
        if self._category is None:
            if static and category == 2:
                return
            self._cause, self._ticks, self._distance = kind, 0, 0.0
            self._measuring = not static
            self._category = category
        self._category = min(category, self._category)
        self.off = self.off or self._category == 0 or (self._category == 1 and static)

    def step(self, estimate: Estimate, still: int, enough: int) -> list[Event]:
        """One tick; returns the measured stop in the tick in which the arm is seen to stand.

        Args:
            estimate: of this tick. With invalid joint values nothing can be measured.
            still: ticks in a row in which every joint was slow.
            enough: so many of them make it static.
        """
        if self._category is None:
            return []
        self._ticks += 1
        static = still >= enough
        if self._category == 1 and (static or self._ticks >= LONGEST):
            self.off = True
        if not self._measuring:
            return []
        if not estimate.joints_valid:
            self._over()
            return []
        self._distance += estimate.v_tcp * TICK
        if not static:
            return []
        time = max(self._ticks - still, 0) * TICK
        values: Values = {"time": time, "distance": self._distance, "category": self._category, "cause": self._cause}
        self._over()
        return [Event(Kind.STOPPED, estimate.tick, values)]

    def _over(self) -> None:
        """Nothing is left to measure; a stop that keeps the power on is forgotten."""
        self._measuring = False
        if self._category == 2:
            self._category = None

    def end(self) -> None:
        """A reset gives the power back."""
        self._category = None
        self._measuring = False
        self.off = False
