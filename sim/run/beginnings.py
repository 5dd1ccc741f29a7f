"""Which simulation is to begin: any thread asks, the loop's begins it. The newest wish counts; who asked learns how it went."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import NamedTuple, Protocol

from pendant.decision import Decision
from sim.exchange.desk import Wishes
from sim.exchange.snapshot import Snapshot
from sim.simulation import Simulation


class Script(Protocol):
    """What acts by itself: a session's time line."""

    def wishes(self, tick: int, snapshot: Callable[[], Snapshot]) -> Wishes:
        """The wishes for `tick`, counted from 1; `snapshot` copies the tick before."""
        ...

    def see(self, tick: int, decision: Decision) -> None:
        """Take in what the robot decided in `tick`."""
        ...


class Origin(NamedTuple):
    """What a simulation begins from, each time anew."""

    make: Callable[[], Simulation]
    write: Callable[[], Script] | None = None  # gives the script that acts in it


class Beginnings:
    """The slot for the next one. Every method may be called from any thread.

    Attributes:
        waiting: one is asked for; read without the lock.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._next: tuple[Origin, Future[None]] | None = None
        self._closed = False
        self.waiting = False

    def ask(self, origin: Origin) -> "Future[None]":
        """Ask for one.

        Returns:
            Done when its first tick is. It fails with what broke the start, and is cancelled where another took its place or the
            loop has ended; who cancels it before it begins takes it back.
        """
        begun: Future[None] = Future()
        with self._lock:
            before, self._next = self._next, (origin, begun)
            self.waiting = True
            closed = self._closed
        if before is not None:
            before[1].cancel()
        if closed:
            begun.cancel()
        return begun

    def begin(self, start: Callable[[Origin], None]) -> bool:
        """Begin the one that was asked for with `start`, on the loop's thread; False: it was taken back."""
        with self._lock:
            found, self._next, self.waiting = self._next, None, False
        if found is None or not found[1].set_running_or_notify_cancel():
            return False
        origin, begun = found
        try:
            start(origin)
        except Exception as error:
            begun.set_exception(error)
            raise
        begun.set_result(None)
        return True

    def close(self) -> None:
        """The loop has ended: none begins any more."""
        with self._lock:
            found, self._next, self.waiting, self._closed = self._next, None, False, True
        if found is not None:
            found[1].cancel()
