"""Who holds the free-drive button. A hold that fell silent is over until the pointer has really been lifted (FD-23)."""

from collections.abc import Sequence

from app.web.running import Running
from pendant.events.event import Event, Kind
from pendant.inputs import Button
from pendant.tick.modes import TICK_RATE

LATE = 2 * TICK_RATE
"""A pointer-up that is heard of within so many ticks after a silence was a plain release, told late by a busy page."""

DEPENDS = frozenset({Kind.ACTIVATION_CANCELLED, Kind.LEFT_RELEASE})
"""What a silence ends: it is told beside them, to say why."""


class ButtonHolds:
    """The holds of all clients; lives on viser's event loop.

    A held button says so again and again, and says once that the pointer was lifted. After a silence the pendant counts it as
    released. What comes after that from the same press must not count as another press: a late page would free the arm again, or
    end free-drive by a "short press" when the finger is lifted at last.
    """

    def __init__(self, loop: Running) -> None:
        self._loop = loop
        self._heard: dict[int, int] = {}  # tick of the last word of each holder
        self._silent: set[int] = set()  # their press is over, their pointer not lifted
        self._lifted = -1  # tick of the last pointer-up
        self._doubt: Event | None = None  # a silence that ended nothing: the pointer may have been lifted

    def hold(self, client: int) -> None:
        """The button of `client` says that it is held."""
        tick = self._loop.latest().tick
        before = self._heard.get(client)
        if before is not None and tick - before > self._loop.settings.hold.silence * TICK_RATE:
            self.silence(client)
        if client in self._silent:
            return
        self._heard[client] = tick
        self._loop.desk.hold(Button.FREE_DRIVE)

    def lift(self, client: int) -> None:
        """The pointer of `client` was lifted from the button."""
        self._silent.discard(client)
        self._lifted = self._loop.latest().tick
        if self._heard.pop(client, None) is not None:
            self._loop.desk.release(Button.FREE_DRIVE)

    def excused(self, fresh: Sequence[Event], tick: int) -> Event | None:
        """The silence that was a plain release, once that is known: it ended nothing, and the pointer was lifted after it began.

        Args:
            fresh: the events since the last call.
            tick: of now.
        """
        ended = {event.tick for event in fresh if event.kind in DEPENDS}
        for event in fresh:
            if event.kind is Kind.HOLD_SILENT:
                self._doubt = None if event.tick in ended else event
        doubt = self._doubt
        if doubt is None:
            return None
        began = doubt.tick - round(float(doubt.values["value"]) * TICK_RATE)
        lifted = began <= self._lifted <= tick
        if lifted or not 0 <= tick - doubt.tick <= LATE:
            self._doubt = None
        return doubt if lifted else None

    def let_go(self, client: int) -> None:
        """Whatever `client` holds is released: it stalled, left, or gave control back. Its press is over."""
        if self._heard.pop(client, None) is not None:
            self._silent.add(client)
            self._loop.desk.release(Button.FREE_DRIVE)

    def forget(self, client: int) -> None:
        """`client` has gone."""
        self.let_go(client)
        self._silent.discard(client)

    def silence(self, client: int | None = None) -> None:
        """The hold of `client`, or of everybody, fell silent: the pendant has released it."""
        for holder in [holder for holder in self._heard if client in (None, holder)]:
            del self._heard[holder]
            self._silent.add(holder)
