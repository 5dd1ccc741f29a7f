"""Servers of well-kept libraries on this machine, and one that is none, for the tests of what leaves a script."""

import asyncio
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from xmlrpc.server import SimpleXMLRPCServer

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice


class Rpc:
    """Python's own XML-RPC server; `open` lets the function `slow` answer."""

    def __init__(self) -> None:
        self.heard: list[tuple[object, ...]] = []
        self.open = threading.Event()
        self._server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True)
        self.port = self._server.server_address[1]
        for function in (self.start, self.echo, self.pose, self.slow, self.fails, self.date):
            self._server.register_function(function)
        self._server.register_function(self.mass, "tool.mass")
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
        self._thread.start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/RPC2"

    def start(self, number: int) -> bool:
        self.heard.append((number,))
        return number == 1

    def echo(self, *values: object) -> object:
        self.heard.append(values)
        return values[0] if len(values) == 1 else list(values)

    def pose(self) -> dict[str, float]:
        return {"x": -0.5, "y": -0.1, "z": 0.4, "rx": 2.22, "ry": 2.22, "rz": 0}

    def mass(self, number: int) -> float:
        self.heard.append((number,))
        return number / 4

    def slow(self) -> str:
        self.open.wait(20.0)
        return "at last"

    def fails(self) -> None:
        raise ValueError("the lens is covered")

    def date(self) -> bytes:
        return b"\0\1"

    def close(self) -> None:
        self.open.set()
        self._server.shutdown()
        self._server.server_close()


class Modbus:
    """pymodbus's own server: 64 coils, 64 inputs, 64 registers of each kind, all of device 255."""

    def __init__(self, port: int = 0) -> None:
        self.port = port or free_port()
        bits = [SimData(0, values=[k % 3 == 0 for k in range(64)], datatype=DataType.BITS)]
        registers = [SimData(0, values=[100 + k for k in range(64)], datatype=DataType.REGISTERS)]
        self._device = SimDevice(255, simdata=(list(bits), list(bits), list(registers), list(registers)))
        self._loop, self._ready = asyncio.new_event_loop(), threading.Event()
        self._server: ModbusTcpServer | None = None
        self.heard: list[int] = []  # function codes
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        assert self._ready.wait(10.0)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_until_complete(self._serve())

    async def _serve(self) -> None:
        def see(sending: bool, pdu: object) -> object:
            if not sending:
                self.heard.append(pdu.function_code)  # type: ignore[attr-defined]
            return pdu

        self._server = ModbusTcpServer(self._device, address=("127.0.0.1", self.port), trace_pdu=see)  # type: ignore[arg-type]
        await self._server.serve_forever(background=True)
        self._ready.set()
        self._over = asyncio.Event()
        await self._over.wait()
        await self._server.shutdown()

    def close(self) -> None:
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._over.set)
            self._thread.join(10.0)


@contextmanager
def raw_server(answer: Callable[[socket.socket], None]) -> Iterator[int]:
    """A server that takes connections and does as it is told with each; its port."""
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen(8)
        listening.settimeout(0.1)
        over = threading.Event()

        def serve() -> None:
            while not over.is_set():
                try:
                    connection, _ = listening.accept()
                except TimeoutError:
                    continue
                except OSError:
                    return
                connection.settimeout(5.0)
                threading.Thread(target=_one, args=(connection, answer), daemon=True).start()

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        try:
            yield listening.getsockname()[1]
        finally:
            over.set()
            thread.join(5.0)


def _one(connection: socket.socket, answer: Callable[[socket.socket], None]) -> None:
    with connection:
        try:
            answer(connection)
        except OSError:
            return


def free_port() -> int:
    """Nobody listens there."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]
