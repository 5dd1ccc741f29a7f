"""One connection to the dashboard server."""

import asyncio

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.dashboard.dashboard_commands import BANNER, DashboardCommands, Pending
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from app.robot_interface.transport.tcp_port import Farewell

LONGEST = 1024
"""Of a line [bytes]."""

PATIENCE = 2.0
"""Time in which the robot must have done a tick [s]: a client waits no longer than 2.5 s for an answer."""

LEAVING = {"quit": "Disconnected", "shutdown": "Shutting down"}
"""Commands that end the connection, with their answers. The robot itself goes on: other clients need it."""


class DashboardSession:
    """See `app.robot_interface.transport.tcp_port.Conversation`."""

    def __init__(self, cabinet: Cabinet, commands: DashboardCommands, peers: Peers, peer: Peer, *, outbox: Outbox) -> None:
        self._cabinet, self._commands, self._peers, self._peer, self._outbox = cabinet, commands, peers, peer, outbox
        self._remote = cabinet.state.remote  # as it was when the client came: to change it, it has to come again
        self._left = b""
        self._say(BANNER)

    async def hear(self, data: bytes) -> None:
        """Answer the lines that are whole."""
        *lines, self._left = (self._left + data).split(b"\n")
        if len(self._left) > LONGEST or any(len(line) > LONGEST for line in lines):
            raise Farewell(f"a line of more than {LONGEST} bytes")
        for line in lines:
            await self._answer(line.decode("utf-8", "replace").strip())

    def over(self) -> None:
        """Nothing is kept for a client."""

    async def _answer(self, line: str) -> None:
        if not line:
            return
        if line.lower() in LEAVING:
            self._say(LEAVING[line.lower()])
            raise Farewell("it said goodbye")
        answer = self._commands.answer(line, self._remote)
        if isinstance(answer, Pending):
            asked = asyncio.wrap_future(answer.asked)
            done, _ = await asyncio.wait((asked,), timeout=PATIENCE)
            given = bool(done) and not asked.cancelled()
            asked.cancel()
            answer = answer.answer(asked.result()) if given else f"Failed to execute: {line}"
        self._peers.note(self._peer.interface, self._peer.number, f"{line} -> {answer}")
        self._say(answer)

    def _say(self, text: str) -> None:
        self._outbox.send(text.encode() + b"\n")
