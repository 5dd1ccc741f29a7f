"""What is on its way to one client. Sending never waits: who reads late misses packages, who never reads is dropped."""

import socket
import threading
import time

MOST = 1 << 20
"""Bytes that may wait for a client."""

PATIENCE = 2.0
"""Time for which something may wait before the client counts as one that never reads [s]."""


class Outbox:
    """The sending side of a connection. Every method may be called from any thread."""

    def __init__(self, connection: socket.socket) -> None:
        connection.setblocking(False)
        self._socket = connection
        self._lock = threading.Lock()
        self._waiting = bytearray()
        self._since = 0.0  # that something waits
        self.patient = False  # with a client that never reads: it only sends, and misses what does not fit
        self.dead = ""  # why nothing can be sent any more
        self.skipped = 0  # packages that were not sent because older ones waited
        self.sent = 0  # bytes

    @property
    def full(self) -> bool:
        """Something waits."""
        return bool(self._waiting)

    def send(self, data: bytes) -> None:
        """Send what must arrive."""
        with self._lock:
            if self._push():
                self._give(data)
            elif len(self._waiting) + len(data) > MOST:
                self.skipped += 1
                if not self.patient:
                    self.dead = "it does not read"
            else:
                self._waiting += data

    def offer(self, data: bytes) -> bool:
        """Send a package of which only the newest counts; False: it was skipped, because older ones wait."""
        with self._lock:
            if self._push():
                self._give(data)
                return True
            self.skipped += 1
            return False

    def flush(self) -> None:
        """Send what waits, as far as it goes."""
        with self._lock:
            self._push()

    def _push(self) -> bool:
        """Whether nothing waits any more."""
        if not self._waiting:
            return not self.dead
        waiting, self._waiting = self._waiting, bytearray()
        self._give(waiting)
        if self._waiting and not self.patient and time.monotonic() - self._since > PATIENCE:
            self.dead = self.dead or "it does not read"
        return not self._waiting and not self.dead

    def _give(self, data: bytes | bytearray) -> None:
        try:
            count = self._socket.send(data)
        except (BlockingIOError, InterruptedError):
            count = 0
        except OSError:
            self.dead = self.dead or "the connection is broken"
            return
        self.sent += count
        if count < len(data):
            if count or not self._since:
                self._since = time.monotonic()
            self._waiting = bytearray(data[count:])
        else:
            self._since = 0.0
