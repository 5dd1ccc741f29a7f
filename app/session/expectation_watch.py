"""Follows what a session expects through its run. A failed expectation says what was expected, what was seen, and when."""

from collections.abc import Callable
from dataclasses import dataclass, field

from app.session.expectations import State
from app.session.triggers import NEVER, Trigger
from pendant.decision import Decision
from pendant.tick.modes import TICK
from sim.exchange.scoring import Scored


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of an expectation."""

    passed: bool
    expected: str
    seen: str  # with the time at which it was seen
    looked: bool = True  # its moment or interval came, so that something could be seen
    margin: float | None = None  # how far within the nearest of its bounds, as a share of that bound; None: no number is bounded


@dataclass(slots=True)
class Watch:
    """Base: one expectation, followed through a run. Call `see` with ticks counted from 1, then `verdict` once.

    Ticks for which `needs` says no may be left out, but for the last of the run.
    """

    joints: list[str]
    trigger: Trigger
    begin: int = 0  # ticks after the trigger
    end: int | None = None  # ticks after the trigger; None: the session's end
    last: int = -1  # the last tick seen
    due: int = 0  # the next tick to be shown
    ends_alone: bool = False  # looks at the first and the last tick of its interval, and at none between
    events_alone: bool = False  # looks at nothing but events
    deaf: bool = False  # from now on a tick without an event tells it nothing

    def needs(self, tick: int, quiet: bool) -> bool:
        """Whether it has to see a tick, which is `quiet` without an event."""
        return tick >= self.due and not (quiet and self.deaf)

    def see(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """Take in one tick; `glance` reads it, and is called only where the tick is in the interval and it is needed."""
        self.last = tick
        start = self.trigger.happened
        if start is None:
            self.trigger.see(tick, decision)
            start = self.trigger.happened
            if start is None:
                return
        self.deaf = self.events_alone
        begin, end = start + self.begin, None if self.end is None else start + self.end
        if begin <= tick and (end is None or tick <= end):
            self.look(tick, decision, glance)
        if end is not None and tick >= end:
            self.due = NEVER
        elif self.ends_alone and tick >= begin:
            self.due = NEVER if end is None else end
        else:
            self.due = max(begin, tick + 1)

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """Take in one tick of the interval."""
        raise NotImplementedError

    def verdict(self) -> Verdict:
        """The end of the run: what became of it."""
        start = self.trigger.happened
        if start is None:
            return Verdict(False, self.expected(), f'"{self.trigger.after}" never came (time {self.trigger.nth})', False)
        if self.last < start + (self.end if self.end is not None else self.begin) and not self.settled():
            return Verdict(False, self.expected(), f"the session ended at {at(self.last)}, before the interval did", False)
        passed, seen = self.judge()
        return Verdict(passed, self.expected(), seen, margin=self.margin())

    def margin(self) -> float | None:
        """How far what was seen lies within the nearest bound, as a share of that bound; None where no number is bounded."""
        return None

    def settled(self) -> bool:
        """Whether the verdict cannot change any more, although the interval has not ended."""
        return False

    def over(self, tick: int) -> bool:
        """Whether the verdict waits for nothing that comes after a tick."""
        start = self.trigger.happened
        return start is not None and (self.settled() or (self.end is not None and tick >= start + self.end))

    def expected(self) -> str:
        """The expectation, in words."""
        raise NotImplementedError

    def judge(self) -> tuple[bool, str]:
        """Whether it is met, and what was seen."""
        raise NotImplementedError

    def span(self) -> str:
        """The interval, in words."""
        since = "" if self.trigger.after is None else f' after "{self.trigger.after}"'
        until = "the end" if self.end is None else at(self.end)
        return (f"at {until}" if self.begin == self.end else f"from {at(self.begin)} to {until}") + since


def margin_within(value: float, least: float | None, most: float | None) -> float | None:
    """How far `value` lies within the nearest of two bounds, as a share of that bound: negative beyond it.

    None where neither is a number but zero, for of zero there is no share; and where both are one: it is met, or it is not.
    """
    if least == most:
        return None
    found = [(value - bound) * sign / abs(bound) for bound, sign in ((least, 1.0), (most, -1.0)) if bound]
    return min(found) if found else None


@dataclass(slots=True)
class StateWatch(Watch):
    """Follows `State`."""

    wanted: State = field(kw_only=True)
    met: int | None = None  # first tick of the interval in which it held
    broken: int | None = None  # first in which it did not
    seen: tuple[int, Decision] | None = None  # the last tick in the interval, or the first wrong one

    def look(self, tick: int, decision: Decision, glance: Callable[[], Scored]) -> None:
        """See `Watch.look`."""
        wanted = self.wanted
        holds = (
            wanted.mode in (None, decision.mode)
            and wanted.phase in (None, decision.phase)
            and wanted.safety in (None, decision.safety.name)
        )
        if holds and self.met is None:
            self.met = tick
        if self.broken is None:
            self.seen = tick, decision
            if not holds and wanted.by is None:
                self.broken = tick

    def settled(self) -> bool:
        """See `Watch.settled`."""
        return self.broken is not None if self.wanted.by is None else self.met is not None

    def expected(self) -> str:
        """See `Watch.expected`."""
        wanted = self.wanted
        words = [("mode", wanted.mode), ("phase", wanted.phase), ("safety", wanted.safety)]
        state = ", ".join(f"{word} {name}" for word, name in words if name is not None)
        since = "" if self.trigger.after is None else f' after "{self.trigger.after}"'
        return f"{state} by {wanted.by:g} s{since}" if wanted.by is not None else f"{state} {self.span()}"

    def margin(self) -> float | None:
        """See `Watch.margin`."""
        if self.wanted.by is None or self.met is None or self.trigger.happened is None:
            return None
        return margin_within((self.met - self.trigger.happened) * TICK, None, self.wanted.by)

    def judge(self) -> tuple[bool, str]:
        """See `Watch.judge`."""
        if self.wanted.by is not None and self.met is not None:
            return True, f"reached at {at(self.met)}"
        passed = self.wanted.by is None and self.broken is None
        if self.seen is None:
            return passed, ""
        tick, now = self.seen
        return passed, f"mode {now.mode.value}, phase {now.phase.value}, safety {now.safety.name} at {at(tick)}"


def at(tick: int) -> str:
    """The time of a tick, in words."""
    return f"{tick * TICK:.3f} s"
