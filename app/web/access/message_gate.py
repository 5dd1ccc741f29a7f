"""A connection that hands on only what is admitted, reads no faster than a person acts, and notices when the network stalls."""

import asyncio
import time
from typing import Any, Protocol

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

MAX_BYTES = 64 * 1024
"""Largest message from a client."""

MAX_RATE = 200
"""Messages a second from one client; beyond it, the connection is read no faster."""

PULSE = 0.2
"""Time between two pings of a client, to notice a stalled network (FD-23) [s]."""


class Warden(Protocol):
    """What a gate asks of the guard."""

    silence: float
    """Without an answer for this long a client counts as silent [s]."""

    def client_of(self, gate: "MessageGate") -> int | None:
        """The number that viser gave to the connection."""
        ...

    def admit(self, client: int, raw: str | bytes) -> bytes | None:
        """What to hand on, or None."""
        ...

    def refuse(self, reason: str) -> None:
        """Count a refusal."""
        ...

    def stalled(self, gate: "MessageGate") -> None:
        """The client gives no answer."""
        ...

    def lost(self, gate: "MessageGate") -> None:
        """The connection is no more."""
        ...


class MessageGate(ServerConnection):
    """The connection of one client."""

    def __init__(self, warden: Warden, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._warden = warden
        self._pulse: asyncio.Task[None] | None = None
        self._second = 0
        self._count = 0

    async def recv(self, decode: bool | None = None) -> Any:
        """The next admitted message."""
        if self._pulse is None:
            self._pulse = asyncio.create_task(self._watch())
        client = self._warden.client_of(self)
        while True:
            raw = await super().recv(decode)
            await self._slow_down()
            admitted = None if client is None else self._warden.admit(client, raw)
            if admitted is not None:
                return admitted

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        super().connection_lost(exc)
        self._warden.lost(self)
        if self._pulse is not None:
            self._pulse.cancel()

    async def _slow_down(self) -> None:
        """Read no more than MAX_RATE messages in a second; the rest waits in the sender's network."""
        now = time.monotonic()
        if int(now) != self._second:
            self._second, self._count = int(now), 0
        self._count += 1
        if self._count > MAX_RATE:
            self._warden.refuse("too fast")
            await asyncio.sleep(1.0 - now % 1.0)

    async def _watch(self) -> None:
        """Ping the client as long as it is there; browsers answer without their page."""
        try:
            while True:
                await asyncio.sleep(PULSE)
                answered = await self.ping()
                done, _ = await asyncio.wait([asyncio.ensure_future(answered)], timeout=self._warden.silence)
                if not done:
                    self._warden.stalled(self)
                    await answered
        except ConnectionClosed:
            return
