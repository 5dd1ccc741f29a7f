"""What around the loop does not work: told once in the log, and to whoever looks, for as long as it lasts."""

import logging
import threading
import time
from collections.abc import Callable

from pendant.events.event import Kind, Values

CALM = 5.0
"""What has not failed for so long works again [s]."""

AGAIN = 60.0
"""What fails on and on is told again after so long [s]."""

LONGEST_REASON = 300
"""Of what is told of a failure [characters]."""


def reason_of(error: BaseException) -> str:
    """An error as one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"[:LONGEST_REASON]


class Troubles:
    """Parts that failed. Every method may be called from any thread.

    Args:
        tell: logs an event.
        clock: seconds, rising.
    """

    def __init__(self, tell: Callable[[Kind, Values], None], clock: Callable[[], float] = time.monotonic) -> None:
        self._tell, self._clock = tell, clock
        self._lock = threading.Lock()
        self._failed: dict[str, tuple[str, float]] = {}  # of a part: why, and when it failed last, infinite: it is over
        self._told: dict[tuple[str, str], float] = {}  # when a part was told with a reason

    def failed(self, part: str, error: BaseException, *, for_good: bool = False) -> None:
        """A part has failed. The first time it is logged, with where it happened.

        Args:
            part: in words that follow "does not work:", such as "the tab Script".
            error: why.
            for_good: it is not tried again.
        """
        reason, now = reason_of(error), self._clock()
        with self._lock:
            self._failed[part] = (reason, float("inf") if for_good else now)
            fresh = now - self._told.get((part, reason), -AGAIN) >= AGAIN
            if fresh:
                self._told[part, reason] = now
        if fresh:
            logging.getLogger(__name__).error("does not work: %s", part, exc_info=error)
            self._tell(Kind.PART_BROKEN, {"part": part, "reason": reason})

    def now(self) -> dict[str, str]:
        """The parts that do not work now, and why."""
        with self._lock:
            late = self._clock() - CALM
            self._failed = {part: (reason, last) for part, (reason, last) in self._failed.items() if last > late}
            return {part: reason for part, (reason, _) in self._failed.items()}

    def lasts(self, part: str) -> bool:
        """Whether a part does not work now."""
        return bool(self._failed) and part in self.now()
