"""What every event must be, whichever module tells it."""

from collections.abc import Sequence

from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import LEAVING, Effect
from pendant.events.happened import Happened, Transition


def whole(events: Sequence[Event], tick: int) -> list[Event]:
    """The events of a tick, once each is found to name it and to carry the values that its row of the table declares, no others;
    its texts can be made of them (FD-22)."""
    for event in events:
        assert event.tick == tick
        assert set(event.values) == set(TABLE[event.kind].keys)
        render(event)
    return list(events)


def whole_transition(happened: Happened, tick: int) -> list[Event]:
    """The events of what happened, each `whole`. The table must say of the last one that it tells this transition, and of no
    other one that it tells any."""
    *noticed, last = happened.events or [None]
    if happened.transition is Transition.STAYS:
        assert happened.cause is None
        noticed = happened.events
    else:
        assert last is not None
        assert happened.cause is last.kind
        assert TRANSITIONS[happened.transition](last.kind)
    assert {TABLE[event.kind].effect for event in noticed} <= {Effect.INFO, Effect.TO_TEACH, Effect.TRY}
    assert Kind.ACTIVATION_CANCELLED not in {event.kind for event in noticed}
    return whole(happened.events, tick)


TRANSITIONS = {
    Transition.ENTERED: lambda kind: TABLE[kind].effect is Effect.ENTER,
    Transition.CANCELLED: lambda kind: kind is Kind.ACTIVATION_CANCELLED,
    Transition.REFUSED: lambda kind: TABLE[kind].effect is Effect.NO_ENTRY or kind is Kind.SEQUENCE_STOPPED,
    Transition.LEFT: lambda kind: TABLE[kind].effect in LEAVING and kind is not Kind.SEQUENCE_STOPPED,
}
"""Which events tell each transition."""
