"""What other threads want done on the loop's thread, between two ticks: so the loop alone writes what it ticks."""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

T = TypeVar("T")


class BetweenTicks:
    """Work that waits for the loop. `ask` and `close` may be called from any thread.

    Attributes:
        waiting: there is some; read without the lock, so that a tick without any costs nothing.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._work: list[tuple[Callable[[], Any], Future[Any]]] = []
        self._closed = False
        self.waiting = False

    def ask(self, work: Callable[[], T]) -> "Future[T]":
        """Have `work` done on the loop's thread, also while it is paused or has broken down.

        Returns:
            What it gives, or the error that it raises; cancelled when the loop has ended before it came to it.
        """
        future: Future[T] = Future()
        with self._lock:
            if self._closed:
                future.cancel()
            else:
                self._work.append((work, future))
                self.waiting = True
        return future

    def do(self) -> None:
        """Do all that waits, on the loop's thread."""
        with self._lock:
            found, self._work, self.waiting = self._work, [], False
        for work, future in found:
            if future.set_running_or_notify_cancel():
                _do(work, future)

    def close(self) -> None:
        """The loop has ended: nothing is done any more, and nobody waits for it."""
        with self._lock:
            found, self._work, self.waiting, self._closed = self._work, [], False, True
        for _, future in found:
            future.cancel()


def _do(work: Callable[[], T], future: "Future[T]") -> None:
    try:
        result = work()
    except Exception as error:  # noqa: BLE001 - it is whoever asked that has to know
        future.set_exception(error)
    else:
        future.set_result(result)
