"""Follows numbers that a session wants within bounds: quantities and displacements. `watch` picks the watch of an expectation."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from app.session.event_watch import watch_told
from app.session.expectation_watch import StateWatch, Watch, at, margin_within
from app.session.expectations import (
    AnyExpectation,
    Compared,
    ContactDelay,
    Countdown,
    Displacement,
    Happens,
    Heard,
    Never,
    Period,
    Reaches,
    State,
    Value,
    bounds,
)
from app.session.triggers import Trigger
from pendant.decision import Decision
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.exchange.scoring import Scored, point_of
from sim.plant.touch import Triple

UNITS = {
    "flange_speed": "m/s",
    "tcp_speed": "m/s",
    "elbow_speed": "m/s",
    "joint_angle": "rad",
    "joint_speed": "rad/s",
    "tracking_error": "rad",
    "friction_error": "N·m",
    "torque_error": "N·m",
    "user_force": "N",
    "user_torque": "N·m",
    "payload_configured": "kg",
    "payload_true": "kg",
}


SLIDING = 0.05
"""Friction is compared above this speed [rad/s]: a standing joint has none of its own."""


def control_error(now: Scored, quantity: str, joint: int) -> float:
    """Size of an error of the joint control against the truth: for scoring alone."""
    estimate = now.estimate
    if quantity == "tracking_error":
        return abs(float(now.truth_q[joint] - now.wanted_q[joint])) if now.wanted_q.size else 0.0
    if quantity == "torque_error":
        return abs(float(estimate.tau_J[joint] - now.truth_tau_J[joint]))
    if abs(float(estimate.theta_d[joint])) < SLIDING:
        return 0.0
    return abs(float(estimate.friction[joint] - now.truth_friction[joint]))


@dataclass(slots=True)
class BoundsWatch(Watch):
    """Base of what follows numbers within bounds."""

    min: float | None = field(kw_only=True)
    max: float | None = field(kw_only=True)
    low: tuple[float, int] = (math.inf, 0)  # the smallest seen, and its tick
    high: tuple[float, int] = (-math.inf, 0)

    def number(self, value: float, tick: int) -> None:
        """Take in a number. One that is not finite counts as out of bounds."""
        if value < self.low[0] or math.isnan(value):
            self.low = (value, tick)
        if value > self.high[0] or math.isnan(value):
            self.high = (value, tick)

    def unit(self) -> str:
        """The numbers' unit."""
        raise NotImplementedError

    def name(self) -> str:
        """What is measured, in words."""
        raise NotImplementedError

    def expected(self) -> str:
        """See `Watch.expected`."""
        return f"{self.name()} {bounds(self.min, self.max)} {self.unit()} {self.span()}"

    def margin(self) -> float | None:
        """See `Watch.margin`."""
        if self.min == self.max:
            return None  # as in margin_within
        found = [margin_within(self.low[0], self.min, None), margin_within(self.high[0], None, self.max)]
        return min((share for share in found if share is not None and math.isfinite(share)), default=None)

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        if self.high[0] == -math.inf:
            return False, "nothing was measured"
        low, high = self.min, self.max
        too_low = low is not None and not self.low[0] >= low
        too_high = high is not None and not self.high[0] <= high
        if too_high or (high is not None and not too_low):
            return not too_high, f"{self.high[0]:.6g} {self.unit()} at {at(self.high[1])}"
        return not too_low, f"{self.low[0]:.6g} {self.unit()} at {at(self.low[1])}"


@dataclass(slots=True)
class ValueWatch(BoundsWatch):
    """Follows `Value`."""

    wanted: Value = field(kw_only=True)
    place: Triple | None = None  # of the flange, a tick before

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        now = glance()
        estimate = now.estimate
        match self.wanted.of:
            case "flange_speed":
                place = point_of(now, self.joints, "flange")
                if self.place is not None:
                    self.number(math.dist(place, self.place) / TICK, tick)
                self.place = place
            case "tcp_speed":
                self.number(estimate.v_tcp, tick)
            case "elbow_speed":
                self.number(estimate.v_elbow, tick)
            case "joint_angle":
                self.number(float(estimate.q[self.joints.index(self.wanted.joint or "")]), tick)
            case "joint_speed":
                self.number(float(estimate.qd[self.joints.index(self.wanted.joint or "")]), tick)
            case "tracking_error" | "friction_error" | "torque_error":
                self.number(control_error(now, self.wanted.of, self.joints.index(self.wanted.joint or "")), tick)
            case "user_force":
                self.number(math.hypot(*estimate.F_user[:3]), tick)
            case "user_torque":
                self.number(math.hypot(*estimate.F_user[3:]), tick)
            case "payload_configured":
                self.number(now.configured_mass, tick)
            case "payload_true":
                self.number(now.truth_payload_mass, tick)

    def unit(self) -> str:
        """See `BoundsWatch.unit`."""
        return UNITS[self.wanted.of]

    def name(self) -> str:
        """See `BoundsWatch.name`."""
        return self.wanted.of.replace("_", " ") + (f" of {self.wanted.joint}" if self.wanted.joint else "")


@dataclass(slots=True)
class ComparedWatch(ValueWatch):
    """Follows `Compared` in one of the two runs; `against` makes the verdict of both."""

    wanted: Compared = field(kw_only=True)  # pyright: ignore[reportIncompatibleVariableOverride]
    squares: float = 0.0
    count: int = 0
    other: float = math.nan  # the same measure in the other run

    def number(self, value: float, tick: int) -> None:
        """See `BoundsWatch.number`."""
        BoundsWatch.number(self, abs(value), tick)
        self.squares += value * value
        self.count += 1

    @property
    def measured(self) -> float:
        """The measure of the quantity in this run, in its unit."""
        if self.wanted.measure == "mean_square":
            return math.sqrt(self.squares / self.count) if self.count else math.nan
        return self.high[0]

    def over(self, tick: int) -> bool:
        """See `Watch.over`: the other run comes after this one."""
        return False

    def expected(self) -> str:
        """See `Watch.expected`."""
        wanted = self.wanted
        settings = ", ".join(f"{name} {str(value).lower()}" for name, value in wanted.settings.items())
        measure = "root mean square of" if wanted.measure == "mean_square" else "largest"
        return f"{measure} {self.name()} {bounds(self.min, self.max)} times that with {settings} {self.span()}"

    @property
    def ratio(self) -> float:
        """The measure over what it is in the other run; nan where there is nothing to compare."""
        return self.measured / self.other if self.count and self.other > 0.0 else math.nan

    def margin(self) -> float | None:
        """See `Watch.margin`."""
        return None if math.isnan(self.ratio) else margin_within(self.ratio, self.min, self.max)

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        ratio = self.ratio
        if math.isnan(ratio):
            return False, "nothing was measured"
        within = (self.min is None or ratio >= self.min) and (self.max is None or ratio <= self.max)
        return within, f"{ratio:.3g} times, {self.measured:.4g} {self.unit()} over {self.other:.4g} {self.unit()}"


@dataclass(slots=True)
class ReachWatch(ValueWatch):
    """Follows `Reaches`."""

    met: int | None = None  # first tick of the interval in which it was within bounds
    best: float = -math.inf  # the largest margin of a tick

    def number(self, value: float, tick: int) -> None:
        """See `BoundsWatch.number`."""
        BoundsWatch.number(self, value, tick)
        share = margin_within(value, self.min, self.max)
        if share is not None and share > self.best:
            self.best = share
        above = self.min is None or value >= self.min
        if self.met is None and above and (self.max is None or value <= self.max):
            self.met = tick

    def settled(self) -> bool:
        """See `Watch.settled`."""
        return self.met is not None

    def name(self) -> str:
        """See `BoundsWatch.name`."""
        return ValueWatch.name(self) + " at some time"

    def margin(self) -> float | None:
        """See `Watch.margin`: of the tick that was farthest within."""
        return self.best if math.isfinite(self.best) else None

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        if self.met is not None:
            return True, f"reached at {at(self.met)}"
        return False, f"{self.low[0]:.6g} to {self.high[0]:.6g} {self.unit()}"


def displacement(place: Triple, begin: Triple, along: Sequence[float] | None) -> float:
    """The distance from `begin` to `place`; with a direction, its part along that, with its sign [m]. All in one frame."""
    (x, y, z), (i, j, k) = place, begin
    if along is None:
        return math.hypot(x - i, y - j, z - k)
    return ((x - i) * along[0] + (y - j) * along[1] + (z - k) * along[2]) / math.hypot(*along)


@dataclass(slots=True)
class DisplacementWatch(BoundsWatch):
    """Follows `Displacement`."""

    wanted: Displacement = field(kw_only=True)
    place: Triple | None = None  # of the part, at the interval's begin

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        now = point_of(glance(), self.joints, self.wanted.part)
        if self.place is None:
            self.place = now
        distance = displacement(now, self.place, self.wanted.along)
        if self.wanted.measure == "final":
            self.low = self.high = (distance, tick)
        else:
            # The largest way is one number at the interval's end, so that `min` asks for a part that has moved that far.
            if distance > self.high[0] or math.isnan(distance):
                self.high = (distance, tick)
            self.low = self.high

    def unit(self) -> str:
        """See `BoundsWatch.unit`."""
        return "m"

    def name(self) -> str:
        """See `BoundsWatch.name`."""
        along = "" if self.wanted.along is None else f" along {self.wanted.along}"
        return f"{self.wanted.measure} displacement of {self.wanted.part}{along}"


def watch(expectation: AnyExpectation, joints: list[str]) -> Watch:
    """The watch that follows an expectation, for an arm with these joint names."""
    trigger = Trigger(expectation.after, expectation.nth)
    match expectation:
        case State(at=float(time)):
            moment = max(ticks(time), 1 if expectation.after is None else 0)  # there is no tick before the first
            return StateWatch(joints, trigger, moment, moment, wanted=expectation)
        case State(by=float(time)):
            return StateWatch(joints, trigger, 0, ticks(time), wanted=expectation)
        case State():
            return StateWatch(joints, trigger, ticks(expectation.begin or 0.0), ticks(expectation.end or 0.0), wanted=expectation)
        case Period() | Heard() | Happens() | Never() | Countdown() | ContactDelay():
            return watch_told(expectation, joints, trigger)
    begin, end = ticks(expectation.begin), None if expectation.end is None else ticks(expectation.end)
    match expectation:
        case Compared():
            return ComparedWatch(joints, trigger, begin, end, wanted=expectation, min=expectation.min, max=expectation.max)
        case Reaches():
            return ReachWatch(joints, trigger, begin, end, wanted=expectation, min=expectation.min, max=expectation.max)
        case Value():
            return ValueWatch(joints, trigger, begin, end, wanted=expectation, min=expectation.min, max=expectation.max)
        case Displacement():
            found = DisplacementWatch(joints, trigger, begin, end, wanted=expectation, min=expectation.min, max=expectation.max)
            found.ends_alone = expectation.measure == "final"
            return found
    raise AssertionError(f"{type(expectation).__name__} has no case here")
