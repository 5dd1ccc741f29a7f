"""All events of a loop in order. The loop's thread writes; any thread reads."""

import threading
from collections.abc import Callable, Iterable

from pendant.events.event import Event

Listener = Callable[[Event], None]


class EventLog:
    """Events that ticks decided, and others: a start that failed, a disk that is full.

    A list only grows at its end, and a slice of it is one step of the interpreter: who reads needs no lock.
    """

    def __init__(self) -> None:
        self._events: list[Event] = []
        self._lock = threading.Lock()  # of the listeners
        self._listeners: tuple[Listener, ...] = ()

    def since(self, index: int) -> list[Event]:
        """Events from an index on."""
        return self._events[index:]

    def extend(self, events: Iterable[Event]) -> None:
        """Add what a tick decided; on the loop's thread."""
        self._events.extend(events)

    def note(self, event: Event) -> None:
        """Add what no tick decided, and tell the listeners; on the loop's thread."""
        self._events.append(event)
        for listener in self._listeners:
            listener(event)

    def listen(self, listener: Listener) -> None:
        """Have somebody told of each event that no tick decides; from any thread. A listener must not raise."""
        with self._lock:
            self._listeners = (*self._listeners, listener)

    def forget(self, listener: Listener) -> None:
        """Tell somebody no more."""
        with self._lock:
            self._listeners = tuple(each for each in self._listeners if each != listener)
