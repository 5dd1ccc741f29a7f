"""Spells in which the loop does not keep up with the clock: each is told once, however often the machine stalls in it."""

from pendant.events.event import Event, Kind

CALM = 10.0
"""A spell is over when the loop has kept up for this long [s]."""

LONGEST = 60.0
"""A spell that goes on for this long is told all the same, and another begins [s]."""


class Lateness:
    """One spell after the other. Times are seconds of one rising clock, given by the caller."""

    def __init__(self) -> None:
        self.times = 0  # that time was dropped in the running spell; 0: there is none
        self._worst = 0.0  # [s]
        self._lost = 0.0  # [s]
        self._first = 0.0
        self._last = 0.0

    def drop(self, late: float, now: float) -> None:
        """The loop was late by `late` [s], and drops that time."""
        if self.times == 0:
            self._first, self._worst, self._lost = now, 0.0, 0.0
        self.times += 1
        self._worst = max(self._worst, late)
        self._lost += late
        self._last = now

    def over(self, now: float) -> bool:
        """Whether there is a spell to tell of."""
        return self.times > 0 and (now - self._last >= CALM or now - self._first >= LONGEST)

    def tell(self, tick: int) -> Event:
        """The spell as an event of `tick`; it is over with that."""
        times, span = self.times, self._last - self._first
        self.times = 0
        return Event(
            Kind.OVERRUN,
            tick,
            {
                "late": round(1000.0 * self._worst, 1),
                "lost": round(self._lost, 3),
                "often": "once" if times == 1 else f"{times} times in {max(span, 1.0):.0f} s",
            },
        )
