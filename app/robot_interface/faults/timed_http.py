"""HTTP of the control channel: who does not say a whole request in time is told so, and costs nobody else; errors are JSON."""

import asyncio
from typing import Any

import h11
import msgspec
from uvicorn.protocols.http.h11_impl import H11Protocol

from app.robot_interface.faults.channel_messages import WHERE

HEAD_TIME = 5.0
"""Time in which the head of a request must have come [s]."""

MOST_WAITING = 64
"""Connections whose request has not come; when one more comes, the one that has waited longest is ended."""


class TimedHttp(H11Protocol):
    """A connection. Lives on the network's event loop; uvicorn makes one for each client."""

    def __init__(self, *args: Any, waiting: "dict[TimedHttp, None]", **options: Any) -> None:
        """`waiting`: connections whose request has not come, those of all clients, in the order in which they began to wait."""
        super().__init__(*args, **options)
        self._waiting = waiting
        self._late: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """A client has come."""
        super().connection_made(transport)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """It has gone."""
        self._wait_no_more()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what it says."""
        super().data_received(data)
        if self.conn.their_state is not h11.IDLE:
            self._wait_no_more()
        elif self._late is None and not self.transport.is_closing():
            self._wait()

    def send_400_response(self, msg: str) -> None:
        """Answer what is no HTTP, and end the connection."""
        self._refuse(400, "not a request of HTTP/1.1")

    def _wait(self) -> None:
        self._waiting[self] = None
        self._late = self.loop.call_later(HEAD_TIME, self._too_late)
        if len(self._waiting) > MOST_WAITING:
            next(iter(self._waiting))._too_late()

    def _wait_no_more(self) -> None:
        self._waiting.pop(self, None)
        if self._late is not None:
            self._late.cancel()
            self._late = None

    def _too_late(self) -> None:
        self._wait_no_more()
        self._refuse(408, f"no whole request came in {HEAD_TIME:g} s, or others needed the place")

    def _refuse(self, status: int, why: str) -> None:
        """Answer in one line, and end the connection; where an answer is under way already, only that."""
        if not self.transport.is_closing():
            body = msgspec.json.encode({"error": f"{WHERE}: {why}"})
            headers = [("content-type", "application/json"), ("content-length", str(len(body))), ("connection", "close")]
            try:
                for event in (h11.Response(status_code=status, headers=headers), h11.Data(data=body), h11.EndOfMessage()):
                    self.transport.write(self.conn.send(event) or b"")
            except h11.LocalProtocolError:
                pass
            self.transport.close()
