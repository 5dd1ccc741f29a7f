"""A port: who may speak, how many at once, and that nobody who floods keeps others waiting."""

import asyncio
import socket
import time
from collections.abc import Awaitable, Callable

import pytest

from app.robot_interface.transport import tcp_port as module
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from app.robot_interface.transport.tcp_port import MOST_CONNECTIONS, WEB, Farewell, TcpPort
from sim.run.troubles import Troubles


class Echo:
    """Says what it hears; "bye" ends it."""

    ended = 0

    def __init__(self, peer: Peer, outbox: Outbox) -> None:
        self._outbox = outbox

    async def hear(self, data: bytes) -> None:
        if data == b"bye":
            raise Farewell("it said goodbye")
        if data.startswith(b"work"):
            time.sleep(0.002)
        self._outbox.send(data)

    def over(self) -> None:
        Echo.ended += 1


Talk = Callable[[TcpPort, tuple[str, int], Peers], Awaitable[None]]


def served(talk: Talk) -> None:
    """Runs `talk` with a port that listens."""

    async def run() -> None:
        listening = socket.create_server(("127.0.0.1", 0))
        listening.setblocking(False)
        where, peers = listening.getsockname(), Peers()
        port = TcpPort("echo", peers, Echo, Troubles(lambda kind, values: None))
        task = asyncio.create_task(port.listen(listening))
        try:
            await talk(port, where, peers)
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    asyncio.run(asyncio.wait_for(run(), 20.0))


def test_what_is_said_is_heard_and_answered() -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        reader, writer = await asyncio.open_connection(*where)
        writer.write(b"hello")
        assert await reader.readexactly(5) == b"hello"
        assert peers.count("echo") == 1
        writer.write(b"bye")
        assert await reader.read() == b""
        assert peers.all() == []
        assert peers.said()[-1].text == "disconnected: it said goodbye"
        assert Echo.ended > 0

    served(talk)


@pytest.mark.parametrize("method", WEB)
def test_a_web_page_cannot_speak_to_a_robot(method: bytes) -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        reader, writer = await asyncio.open_connection(*where)
        writer.write(method + b"/ HTTP/1.1\r\nHost: x\r\n\r\npower off\n")
        assert await reader.read() == b""
        assert "web browser" in peers.said()[-1].text

    served(talk)


def test_a_gripper_may_be_asked_before_anything_is_set() -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        reader, writer = await asyncio.open_connection(*where)
        writer.write(b"GET STA\n")
        assert await reader.readexactly(8) == b"GET STA\n"

    served(talk)


def test_one_connection_too_many_is_turned_away_and_the_others_stay() -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        inside = [await asyncio.open_connection(*where) for _ in range(MOST_CONNECTIONS)]
        while peers.count("echo") < MOST_CONNECTIONS:
            await asyncio.sleep(0.01)
        reader, _ = await asyncio.open_connection(*where)
        assert await reader.read() == b""
        inside[0][1].write(b"still here")
        assert await inside[0][0].readexactly(10) == b"still here"
        for _, writer in inside:
            writer.close()

    served(talk)


def test_a_cut_cable_ends_connections_and_lets_none_begin_for_a_while() -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        reader, writer = await asyncio.open_connection(*where)
        writer.write(b"x")
        await reader.readexactly(1)
        port.cut(0.3)
        assert await reader.read() == b""
        reader, _ = await asyncio.open_connection(*where)
        assert await reader.read() == b""
        await asyncio.sleep(0.35)
        reader, writer = await asyncio.open_connection(*where)
        writer.write(b"again")
        assert await reader.readexactly(5) == b"again"

    served(talk)


def test_a_delay_is_that_of_what_is_heard() -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        reader, writer = await asyncio.open_connection(*where)
        port.delay = 0.2
        begun = time.perf_counter()
        writer.write(b"x")
        await reader.readexactly(1)
        assert time.perf_counter() - begun >= 0.2

    served(talk)


def test_who_floods_is_read_more_slowly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the network's time a connection takes a share: for each second heard it waits four."""
    waits: list[float] = []
    sleep = asyncio.sleep

    async def noted(seconds: float) -> None:
        waits.append(seconds)
        await sleep(0)

    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        reader, writer = await asyncio.open_connection(*where)
        monkeypatch.setattr(module.asyncio, "sleep", noted)
        writer.write(b"work" * 5000)
        await reader.readexactly(20000)
        monkeypatch.setattr(module.asyncio, "sleep", sleep)

    served(talk)
    assert max(waits) >= 0.002 / module.SHARE


def test_who_never_reads_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    async def talk(port: TcpPort, where: tuple[str, int], peers: Peers) -> None:
        _, writer = await asyncio.open_connection(*where)
        while peers.count("echo") == 0:
            await asyncio.sleep(0.01)
        box = peers.all()[0].outbox
        for _ in range(100):
            box.send(bytes(1 << 18))
        while peers.count("echo"):
            await asyncio.sleep(0.01)
        assert peers.said()[-1].text == "disconnected: it does not read"
        writer.close()

    served(talk)
