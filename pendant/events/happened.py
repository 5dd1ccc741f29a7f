"""What a state machine of free-drive makes of a tick: what it tells, and what becomes of free-drive."""

from collections.abc import Sequence

import msgspec

from pendant.events.event import Event, Kind
from pendant.tick.words import Word


class Transition(Word):
    """What becomes of free-drive in a tick."""

    STAYS = "stays"  # as it is: off, in the same attempt, in the same free-drive; its phase may be another one
    ENTERED = "entered"  # an attempt has succeeded: free-drive begins
    CANCELLED = "cancelled"  # the signal ended too early: off again, and another attempt may begin at once
    REFUSED = "refused"  # an attempt has failed: off
    LEFT = "left"  # free-drive is over: off


class Happened(msgspec.Struct, frozen=True, gc=False):
    """The events of a tick, in order, and what becomes of free-drive in it."""

    events: list[Event]
    transition: Transition = Transition.STAYS
    cause: Kind | None = None  # of the transition: the kind of the event that tells it; None: it stays

    def after(self, noticed: list[Event]) -> "Happened":
        """The same, and what was `noticed` before."""
        return Happened(noticed + self.events, self.transition, self.cause)


def becomes(transition: Transition, event: Event, noticed: Sequence[Event] = ()) -> Happened:
    """A transition and the `event` that tells it, after what was `noticed` before."""
    return Happened([*noticed, event], transition, event.kind)
