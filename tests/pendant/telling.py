"""What every event must be, whichever module tells it."""

from collections.abc import Sequence

from pendant.event_table import TABLE, render
from pendant.events.event import Event


def whole(events: Sequence[Event], tick: int) -> list[Event]:
    """The events of a tick, once each is found to name it and to carry the values that its row of the table declares, no others;
    its texts can be made of them (FD-22)."""
    for event in events:
        assert event.tick == tick
        assert set(event.values) == set(TABLE[event.kind].keys)
        render(event)
    return list(events)
