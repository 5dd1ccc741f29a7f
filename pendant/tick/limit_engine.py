"""Values against limits: one engine for every limit of every stage (FD-12a, FD-25)."""

import math
from typing import NamedTuple

import msgspec


class Excess(NamedTuple):
    """A parameter beyond its limit."""

    parameter: str
    part: str  # joint or part
    value: float
    limit: float
    unit: str


class Monitored(msgspec.Struct, frozen=True, gc=False):
    """A parameter that is being checked, for interfaces to draw against its limit."""

    name: str
    part: str  # joint or part
    value: float
    low: float  # smallest value within
    high: float  # largest value within
    unit: str

    @property
    def limit(self) -> float:
        """The limit, low or high, that the value exceeds or is nearer to."""
        return self.low if self.value - self.low < self.high - self.value else self.high


class Gauge:
    """One limit: a maximum, a minimum or a range, with the time that a value may be beyond it.

    A value equal to its limit does not exceed it; what is not a number does.
    """

    __slots__ = ("_allowed", "base", "beyond", "high", "low", "name", "part", "stop", "unit", "value")

    def __init__(
        self, name: str, unit: str, *, low: float = -math.inf, high: float = math.inf, allowed: int = 0, stop: bool = False
    ) -> None:
        """
        Args:
            name: of the parameter, for texts.
            unit: of value and limit.
            low: smallest value within.
            high: largest value within.
            allowed: longest time beyond [ticks].
            stop: the reaction to it is a stop.
        """
        self.name = name
        self.unit = unit
        self.low = low
        self.high = high
        self.base = high  # as set; `high` may change with the load
        self.stop = stop
        self.value = 0.0
        self.part = ""
        self._allowed = allowed
        self.beyond = 0  # ticks in a row beyond

    def judge(self, value: float, part: str, patience: float = 1.0) -> bool:
        """Take the value of this tick, of `part`. Returns whether it was beyond its limit for longer than `patience` (0 to 1)
        times the allowed time (FD-12b)."""
        self.value, self.part = value, part
        if self.low <= value <= self.high:
            self.beyond = 0
            return False
        self.beyond += 1
        return self.beyond > self._allowed * patience

    @property
    def excess(self) -> Excess:
        """The last value and its limit, as a fact."""
        return Excess(self.name, self.part, self.value, self.monitored.limit, self.unit)

    @property
    def monitored(self) -> Monitored:
        """The last value and its limits, to draw."""
        return Monitored(self.name, self.part, self.value, self.low, self.high, self.unit)
