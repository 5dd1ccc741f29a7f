"""Follows what is told: events, tones, and the periods as interfaces show them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from app.session.expectation_watch import Watch, at, margin_within
from app.session.expectations import ContactDelay, Countdown, Happens, Heard, Never, NumberRange, Period
from app.session.triggers import Trigger
from app.tones import tone_for
from pendant.decision import Decision
from pendant.events.event import Event
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.exchange.scoring import Scored


def _within(event: Event, name: str, span: NumberRange) -> bool:
    value = event.values.get(name)
    return isinstance(value, int | float) and span.holds(value)


@dataclass(slots=True)
class EventWatch(Watch):
    """Follows `Happens` and `Never`."""

    events_alone: bool = True
    wanted: Happens | Never = field(kw_only=True)
    found: list[int] = field(default_factory=list)
    other: str = ""  # the first whose numbers are others
    nearest: float = math.inf  # the smallest margin of a number of those found

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        wanted = self.wanted
        for event in decision.events:
            if event.kind == wanted.kind and all(event.values.get(name) == word for name, word in wanted.values.items()):
                self._take(event, tick)

    def _take(self, event: Event, tick: int) -> None:
        """One of the kind, with the words: it counts if its numbers are in their ranges, too."""
        outside = [(name, event.values.get(name)) for name, span in self.wanted.numbers.items() if not _within(event, name, span)]
        if not outside:
            self.found.append(tick)
            for name, span in self.wanted.numbers.items():
                share = margin_within(float(event.values[name]), span.min, span.max)
                self.nearest = self.nearest if share is None else min(self.nearest, share)
        elif not self.other:
            self.other = f", but {', '.join(f'{name} {value}' for name, value in outside)} at {at(tick)}"

    def margin(self) -> float | None:
        """See `Watch.margin`."""
        return self.nearest if isinstance(self.wanted, Happens) and math.isfinite(self.nearest) else None

    def settled(self) -> bool:
        """See `Watch.settled`."""
        if isinstance(self.wanted, Happens):
            return len(self.found) >= self.wanted.times + self.wanted.exactly
        return bool(self.found)

    def expected(self) -> str:
        """See `Watch.expected`."""
        wanted = self.wanted
        ranges = (f"{name} {span.words()}" for name, span in wanted.numbers.items())
        words = ", ".join([*(f"{name} {word}" for name, word in wanted.values.items()), *ranges])
        event = f"event {wanted.kind.value}{f' ({words})' if words else ''}"
        if isinstance(wanted, Never):
            return f"no {event} {self.span()}"
        times = f" exactly {wanted.times} times" if wanted.exactly else f" {wanted.times} times" if wanted.times > 1 else ""
        return f"{event}{times} {self.span()}"

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        seen = listed(self.found) + self.other
        if isinstance(self.wanted, Never):
            return not self.found, seen
        count, times = len(self.found), self.wanted.times
        return count == times if self.wanted.exactly else count >= times, seen


@dataclass(slots=True)
class ToneWatch(Watch):
    """Follows `Heard`."""

    wanted: Heard = field(kw_only=True)
    before: Decision | None = None  # of the tick before
    found: list[int] = field(default_factory=list)

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        if self.before is not None:
            tone = tone_for(self.before, decision)
            if tone is not None and tone.name == self.wanted.tone:
                self.found.append(tick)
        self.before = decision

    def settled(self) -> bool:
        """See `Watch.settled`."""
        return not self.wanted.exactly and len(self.found) >= self.wanted.times

    def expected(self) -> str:
        """See `Watch.expected`."""
        wanted = self.wanted
        times = f" exactly {wanted.times} times" if wanted.exactly else f" {wanted.times} times" if wanted.times > 1 else ""
        return f"tone {wanted.tone}{times} {self.span()}"

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        count, times = len(self.found), self.wanted.times
        return count == times if self.wanted.exactly else count >= times, listed(self.found)


class PeriodRun(NamedTuple):
    """A run of a period that has ended."""

    first: int  # tick
    length: int  # ticks


@dataclass(slots=True)
class PeriodRuns:
    """The runs of a period: a run is the ticks in which the period is present without its remainder rising.

    Args:
        name: of the period.

    Attributes:
        ended: the runs that have ended, the first one first.
    """

    name: str
    ended: list[PeriodRun] = field(default_factory=list)
    _began: int | None = None
    _before: int = 0  # the remainder a tick before [ticks]

    def see(self, tick: int, decision: Decision) -> None:
        """Take in one tick."""
        left = next((period.ticks for period in decision.periods if period.name == self.name), None)
        if self._began is not None and (left is None or left > self._before):
            self.ended.append(PeriodRun(self._began, tick - self._began))
            self._began = None
        if left is not None:
            self._began = tick if self._began is None else self._began
            self._before = left


@dataclass(slots=True)
class PeriodWatch(Watch):
    """Follows `Period`."""

    wanted: Period = field(kw_only=True)
    runs: PeriodRuns = field(kw_only=True)

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        self.runs.see(tick, decision)

    def expected(self) -> str:
        """See `Watch.expected`."""
        wanted = self.wanted
        return f"period {wanted.name}, run {wanted.run}, lasts {wanted.length:g} s within {wanted.tolerance:g} s"

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        if len(self.runs.ended) < self.wanted.run:
            return False, f"{len(self.runs.ended)} ended runs"
        first, length = self.runs.ended[self.wanted.run - 1]
        # Half a tick of grace, since lengths are whole ticks.
        passed = abs(length * TICK - self.wanted.length) <= self.wanted.tolerance + 0.5 * TICK
        return passed, f"{length * TICK:.3f} s, from {at(first)}"


def listed(found: list[int]) -> str:
    """When something was seen, in words."""
    return "none" if not found else f"{len(found)}, at {', '.join(at(tick) for tick in found[:5])}"


@dataclass(slots=True)
class CountdownWatch(Watch):
    """Follows `Countdown`: the clock of a run begins in its first tick, at the whole period."""

    wanted: Countdown = field(kw_only=True)
    began: int | None = None
    runs: int = 0
    wrong: str = ""  # the first time told that is none
    most: int = 0  # the whole period [ticks]

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        told = next((period for period in decision.periods if period.name == self.wanted.name), None)
        if told is None:
            self._over(tick)
            return
        if self.began is None or told.ticks == told.total:
            self.began, self.most = tick, told.total
            self.runs += 1
        left = self.most - (tick - self.began)
        if not self.wrong and (told.ticks != left or told.total != self.most):
            self.wrong = f"{told.ticks * TICK:.3f} s of {told.total * TICK:.3f} s are left at {at(tick)}, not {left * TICK:.3f} s"

    def _over(self, tick: int) -> None:
        """It is not shown: it has run down before, or was broken off where that may be."""
        if self.began is not None and not self.wrong and self.wanted.runs_down and tick - self.began < self.most:
            self.wrong = f"shown for {(tick - self.began) * TICK:.3f} s of {self.most * TICK:.3f} s, to {at(tick)}"
        self.began = None

    def expected(self) -> str:
        """See `Watch.expected`."""
        return f"remainder of {self.wanted.name} counted down {'to its end ' if self.wanted.runs_down else ''}{self.span()}"

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        if not self.runs:
            return False, "it was never shown"
        return not self.wrong, self.wrong or f"{self.runs} runs, of {self.most * TICK:.3f} s"


@dataclass(slots=True)
class DelayWatch(Watch):
    """Follows `ContactDelay`: the arm has touched an object since the first tick of it, without a tick between."""

    wanted: ContactDelay = field(kw_only=True)
    onset: int | None = None
    touched: bool = False
    delay: int | None = None  # of the first event [ticks]
    early: int | None = None  # an event before anything was touched

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        touched = glance().truth_touched
        if touched is not self.touched and touched == self.wanted.gained and self.delay is None:
            self.onset = tick
        self.touched = touched
        if any(event.kind == self.wanted.kind for event in decision.events) and self.delay is None:
            if self.onset is None:
                self.early = tick
            else:
                self.delay = tick - self.onset

    def expected(self) -> str:
        """See `Watch.expected`."""
        change = "touch" if self.wanted.gained else "parting"
        return f"event {self.wanted.kind.value} at most {self.wanted.max:g} s after the true {change} {self.span()}"

    def margin(self) -> float | None:
        """See `Watch.margin`."""
        return None if self.delay is None or self.early is not None else margin_within(self.delay * TICK, None, self.wanted.max)

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        if self.early is not None:
            return False, f"at {at(self.early)}, before it"
        if self.delay is None:
            return False, "none"
        return self.delay * TICK <= self.wanted.max + 0.5 * TICK, f"{self.delay * TICK:.3f} s after {at(self.onset or 0)}"


def watch_told(
    expectation: Period | Heard | Happens | Never | Countdown | ContactDelay, joints: list[str], trigger: Trigger
) -> Watch:
    """The watch that follows an expectation of what is told; see `measures.watch`."""
    if isinstance(expectation, Period):
        return PeriodWatch(joints, trigger, wanted=expectation, runs=PeriodRuns(expectation.name))
    begin, end = ticks(expectation.begin), None if expectation.end is None else ticks(expectation.end)
    match expectation:
        case Heard():
            return ToneWatch(joints, trigger, begin, end, wanted=expectation)
        case Countdown():
            return CountdownWatch(joints, trigger, begin, end, wanted=expectation)
        case ContactDelay():
            return DelayWatch(joints, trigger, begin, end, wanted=expectation)
        case _:
            return EventWatch(joints, trigger, begin, end, wanted=expectation)
