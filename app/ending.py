"""The end of a process by Ctrl-C or SIGTERM: in order as far as that goes, and within LONGEST whatever hangs."""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)

LONGEST = 2.7
"""From the signal to the end of the process, at most [s]."""

STUCK = 2.9
"""By then the system ends the process by SIGALRM, also where no Python can run any more [s]."""

ORDERLY = 2.0
"""What has not ended in order by then is left, but for what must be finished [s]."""

_asked: list[int] = []  # the signals that came, in this process


class ProcessEnd:
    """Watches for the signals of one process, on a thread of its own: the main thread may be in a library that never comes back.

    Attributes:
        asked: set when the first signal comes.
        number: of that signal; 0: none came.
    """

    def __init__(self) -> None:
        self.asked = threading.Event()
        self.number = 0
        self._must: list[Callable[[float], object]] = []
        self._closed = False
        self._read, self._write = os.pipe()
        os.set_blocking(self._write, False)
        self._thread = threading.Thread(target=self._watch, name="end", daemon=True)
        self._thread.start()

    @property
    def wakeup(self) -> int:
        """The file into which Python writes the number of each signal as it comes, whatever the main thread does."""
        return self._write

    def see_to(self, work: Callable[[float], object]) -> None:
        """Have `work` done before the process ends, even where the main thread hangs; it is given the time that is left [s]."""
        self._must.append(work)

    def close(self) -> None:
        """The process goes on, or ends by itself from here on."""
        self._closed = True
        with suppress(OSError):
            os.write(self._write, b"\0")
        self._thread.join()
        if self.number:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        os.close(self._read)
        os.close(self._write)

    def _watch(self) -> None:
        number = os.read(self._read, 1)[0]
        if not number:  # `close` says so; a signal that came before it counts, however late this thread sees it
            return
        until = time.monotonic() + LONGEST
        signal.setitimer(signal.ITIMER_REAL, STUCK)
        self.number = number
        _asked.append(number)
        self.asked.set()
        while not self._closed and time.monotonic() < until - (LONGEST - ORDERLY):
            time.sleep(0.01)
        if self._closed:
            return
        for work in self._must:
            with suppress(Exception):
                work(max(0.0, until - time.monotonic()))
        end_now(128 + number)


@contextmanager
def ending(*, interrupts: bool = False) -> Iterator[ProcessEnd]:
    """Within it, Ctrl-C and SIGTERM end the process; on the main thread.

    Args:
        interrupts: the main thread gets a KeyboardInterrupt, wherever it is; otherwise it must look at `asked`.
    """
    watch = ProcessEnd()
    before = {number: signal.getsignal(number) for number in SIGNALS}
    wakeup = signal.set_wakeup_fd(watch.wakeup, warn_on_full_buffer=False)
    for number in SIGNALS:
        signal.signal(number, _interrupt if interrupts else _nothing)
    try:
        yield watch
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(wakeup)
        watch.close()


def signal_that_came() -> int:
    """The number of the first signal that asked this process to end; 0: none has."""
    return _asked[0] if _asked else 0


def end_now(code: int) -> None:
    """End the process without waiting for threads: one of them may hang."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    os._exit(code)


def _nothing(_: int, __: FrameType | None) -> None:
    """Python writes the signal's number into the file of `ProcessEnd`; there is nothing else to do."""


def _interrupt(_: int, __: FrameType | None) -> None:
    for each in SIGNALS:  # the second Ctrl-C of somebody who is impatient would break what the first began
        signal.signal(each, _nothing)
    raise KeyboardInterrupt
