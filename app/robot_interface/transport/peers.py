"""Who is connected, and what was said: for the page and the control channel."""

import itertools
import threading
import time
from collections import deque
from dataclasses import dataclass, field

from app.robot_interface.transport.outbox import Outbox

KEPT = 200
"""Messages that are remembered."""

LONGEST = 200
"""Of a message that is shown [characters]."""


@dataclass(slots=True, eq=False)
class Peer:
    """One connection."""

    number: int
    interface: str  # "RTDE", "dashboard", ...
    address: str
    outbox: Outbox
    since: float = field(default_factory=time.time)
    about: str = ""  # what it is doing, in a few words


@dataclass(frozen=True, slots=True)
class Said:
    """A message, one short printable line."""

    number: int
    at: float  # seconds since 1970
    interface: str
    peer: int  # 0: the robot itself
    text: str


class Peers:
    """All connections, and their last messages. Every method may be called from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._count = itertools.count(1)
        self._messages = itertools.count(1)
        self._peers: dict[int, Peer] = {}
        self._said: deque[Said] = deque(maxlen=KEPT)

    def join(self, interface: str, address: str, outbox: Outbox) -> Peer:
        """Somebody has connected."""
        with self._lock:
            peer = Peer(next(self._count), interface, address, outbox)
            self._peers[peer.number] = peer
            self._note(interface, peer.number, f"connected from {address}")
            return peer

    def leave(self, peer: Peer, why: str) -> None:
        """The connection is over."""
        with self._lock:
            if self._peers.pop(peer.number, None) is not None:
                self._note(peer.interface, peer.number, f"disconnected: {why}")

    def note(self, interface: str, peer: int, text: str) -> None:
        """Remember a message; `peer` 0 is the robot itself."""
        with self._lock:
            self._note(interface, peer, text)

    def _note(self, interface: str, peer: int, text: str) -> None:
        self._said.append(Said(next(self._messages), time.time(), interface, peer, line(text)))

    def count(self, interface: str) -> int:
        """How many are connected to an interface."""
        return sum(peer.interface == interface for peer in self.all())

    def all(self) -> list[Peer]:
        """Who is connected, in the order of coming."""
        with self._lock:
            return list(self._peers.values())

    def said(self, after: int = 0) -> list[Said]:
        """Messages with numbers above `after`, as far as they are remembered."""
        with self._lock:
            return [each for each in self._said if each.number > after]


def line(text: str) -> str:
    """A text of anybody's as one short line of printable characters."""
    flat = " ".join(text.split())
    shown = "".join(c if c.isprintable() else "?" for c in flat)
    return shown if len(shown) <= LONGEST else f"{shown[: LONGEST - 3]}..."
