"""A port that listens, and its connections: read in turn, so that nobody who floods one keeps the others waiting."""

import asyncio
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from sim.run.troubles import Troubles, reason_of

CHUNK = 4096
"""Bytes read at once."""

SHARE = 0.2
"""Of the network's time that one connection may take: whoever asks for more is read more slowly."""

MOST_CONNECTIONS = 16
"""To one port."""

BREATH = 0.5
"""After a connection that could not be taken, until the next one is [s]: files may be free again."""

WEB = (b"GET /", b"POST ", b"PUT ", b"HEAD ", b"OPTIONS ", b"DELETE ", b"CONNECT ", b"PATCH ", b"TRACE ")
"""How a browser's request begins: a web page must not be able to speak to a robot. `GET POS` is a line to a gripper."""


class Conversation(Protocol):
    """What an interface says and does in one connection. All methods are called on the network's thread."""

    async def hear(self, data: bytes) -> None:
        """Bytes have come. Raises Farewell: the connection is to end."""
        ...

    def over(self) -> None:
        """The connection is over."""
        ...


class Farewell(Exception):
    """A conversation is over; the text says why."""


Opening = Callable[[Peer, Outbox], Conversation]


class TcpPort:
    """Listens on one port, for one interface.

    Args:
        name: of the interface.
        peers: who is connected, all in all.
        open_: begins the conversation of a new connection.
        troubles: what does not work.
    """

    def __init__(self, name: str, peers: Peers, open_: Opening, troubles: Troubles) -> None:
        self.name = name
        self._peers, self._open, self._troubles = peers, open_, troubles
        self._cut_until = 0.0  # no connection until then
        self.delay = 0.0  # of what is heard [s]
        self._tasks: set[asyncio.Task[None]] = set()

    async def listen(self, listening: socket.socket) -> None:
        """Accept connections until cancelled."""
        loop = asyncio.get_running_loop()
        try:
            while True:
                try:
                    connection, address = await loop.sock_accept(listening)
                except OSError as error:  # too many files are open, for example
                    self._troubles.failed(f"new connections to {self.name}", error)
                    await asyncio.sleep(BREATH)
                    continue
                task = loop.create_task(self._converse(connection, f"{address[0]}:{address[1]}"))
                self._tasks.add(task)
                task.add_done_callback(self._tasks.discard)
        finally:
            listening.close()
            for task in list(self._tasks):
                task.cancel()

    def cut(self, seconds: float) -> None:
        """End all connections, and take no new one for some time: the cable is out."""
        self._cut_until = time.monotonic() + seconds
        for task in list(self._tasks):
            task.cancel()

    async def _converse(self, connection: socket.socket, address: str) -> None:
        full = self._peers.count(self.name) >= MOST_CONNECTIONS
        if full or time.monotonic() < self._cut_until:
            if full:
                self._peers.note(self.name, 0, f"{address} refused: {MOST_CONNECTIONS} are connected already")
            connection.close()
            return
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        outbox = Outbox(connection)
        peer = self._peers.join(self.name, address, outbox)
        why, conversation = "it left", None
        try:
            conversation = self._open(peer, outbox)
            why = await self._read(connection, outbox, conversation)
        except Farewell as farewell:
            why = str(farewell)
        except OSError:
            why = "the connection broke"
        except asyncio.CancelledError:
            why = "cut off"
        except Exception as error:  # noqa: BLE001 - of this conversation alone
            why = f"an error of the robot's own: {reason_of(error)}"
            self._troubles.failed(f"a connection to {self.name}", error)
        finally:
            if conversation is not None:
                conversation.over()
            self._peers.leave(peer, why)
            with suppress(OSError):
                connection.close()

    async def _read(self, connection: socket.socket, outbox: Outbox, conversation: Conversation) -> str:
        """Hear what comes until the other side leaves; returns why it ends."""
        loop, first = asyncio.get_running_loop(), True
        reading: asyncio.Task[bytes] = loop.create_task(loop.sock_recv(connection, CHUNK))
        try:
            while True:
                done, _ = await asyncio.wait((reading,), timeout=0.01 if outbox.full else 0.5)
                outbox.flush()
                if outbox.dead:
                    return outbox.dead
                if not done:
                    continue
                data = reading.result()
                if not data:
                    return "it left"
                if first and data.startswith(WEB):
                    return "a web browser has no business here"
                first = False
                if self.delay:
                    await asyncio.sleep(self.delay)
                begun = time.perf_counter()
                await conversation.hear(data)
                await asyncio.sleep(min((time.perf_counter() - begun) / SHARE, 0.5) if len(data) >= CHUNK // 4 else 0)
                reading = loop.create_task(loop.sock_recv(connection, CHUNK))
        finally:
            reading.cancel()
