"""Functions of sockets (URScript manual, module interfaces). A timeout of 0 waits for as long as it takes."""

import re
from collections.abc import Callable, Generator, Iterator
from typing import Any

from app.urscript.machine.signature import Builtin, Taken, anything, boolean, builtin, integer, number, text, within
from app.urscript.machine.values import Value, shown
from app.urscript.outside.script_sockets import ScriptSocket, ScriptSockets
from pendant.tick.modes import TICK_RATE

NAME = Taken("socket_name", text, "socket_0")
TIMEOUT = Taken("timeout", number, 2.0)
MOST_READ = 30
"""Numbers that are read at once (URScript manual, socket_read_binary_integer)."""

MOST_IN_A_ROW = 4
"""Reads of what has come already with no tick between them: a client that floods a program neither ends nor blocks it."""

ABSENT = 2.0
"""socket_open() takes so long for a host that is not there, where its timeout says no time [s]: that of the default."""

WHOLE_NUMBER = re.compile(r"-?\d{1,9}", re.ASCII)
"""What socket_get_var() takes for a value."""

Reading = Generator[None, None, Value]


def of_sockets(sockets: ScriptSockets) -> Iterator[Builtin]:
    """All of them."""

    def opened(address: str, port: int, name: str, timeout: float) -> Reading:
        begun = sockets.begin(address, port, name)
        if begun is None:
            for _ in _ticks(timeout if timeout > 0.0 else ABSENT):
                yield
            return False
        connection, where = begun
        for _ in _ticks(timeout or ABSENT):
            if connection.connected(where):
                return True
            if connection.broken:
                break
            yield
        if sockets.get(name) is connection:  # else another thread has opened one of this name meanwhile
            sockets.close(name)
        return False

    def read(name: str, timeout: float, take: Callable[[ScriptSocket], Any], failed: Value) -> Reading:
        for _ in _ticks(timeout):
            connection = sockets.get(name)
            if connection is None:
                return failed
            found = take(connection)
            if found is None:
                connection.look()
                found = take(connection)
            if found is not None:
                connection.in_a_row += 1
                if connection.in_a_row > MOST_IN_A_ROW:
                    connection.in_a_row = 0
                    yield
                return found
            if connection.broken:
                return failed
            connection.in_a_row = 0
            yield
        return failed

    def listed(count: int, name: str, timeout: float, take: Callable[[ScriptSocket], Any], *, fill: Value) -> Reading:
        found = yield from read(name, timeout, take, None)
        if not found:
            return (0, *[fill] * count)
        found = found[:count]
        return (len(found), *found, *[fill] * (count - len(found)))

    def integers(count: int, name: str, timeout: float) -> Reading:
        return listed(count, name, timeout, lambda c: c.integers(count), fill=-1)

    def octets(count: int, name: str, timeout: float) -> Reading:
        return listed(count, name, timeout, lambda c: c.octets(count), fill=-1)

    def floats(count: int, name: str, timeout: float) -> Reading:
        return listed(count, name, timeout, lambda c: c.floats(), fill=0.0)

    def string(*given: Value) -> Reading:
        name, prefix, suffix, escape, timeout = given
        first, last = (_escaped(part) if escape else part for part in (prefix, suffix))
        return read(name, timeout, lambda c: c.text(first.encode(), last.encode()), "")

    def line(name: str, timeout: float) -> Reading:
        return read(name, timeout, lambda c: c.text(b"", b"\n"), "")

    def variable(name: str, socket: str, timeout: float) -> Reading:
        connection = sockets.get(socket)
        if connection is None or not connection.send(f"GET {name}\n".encode()):
            return 0
        answer = yield from read(socket, timeout, lambda c: c.text(b"", b"\n"), "")
        words = str(answer).split()
        return int(words[-1]) if words and WHOLE_NUMBER.fullmatch(words[-1]) else 0

    def send(data: bytes, name: str) -> bool:
        connection = sockets.get(name)
        return connection is not None and connection.send(data)

    count = Taken("number", within(integer, 1, MOST_READ))
    port = Taken("port", within(integer, 1, 65535))
    yield builtin("socket_open", opened, Taken("address", text), port, NAME, TIMEOUT, takes_time=True)
    yield builtin("socket_close", sockets.close, NAME)
    yield builtin("socket_read_binary_integer", integers, count, NAME, TIMEOUT, takes_time=True)
    yield builtin("socket_read_byte_list", octets, count, NAME, TIMEOUT, takes_time=True)
    yield builtin("socket_read_ascii_float", floats, count, NAME, TIMEOUT, takes_time=True)
    yield builtin(
        "socket_read_string",
        string,
        NAME,
        Taken("prefix", text, ""),
        Taken("suffix", text, ""),
        Taken("interpret_escape", boolean, False),
        TIMEOUT,
        takes_time=True,
    )
    yield builtin("socket_read_line", line, NAME, TIMEOUT, takes_time=True)
    yield builtin("socket_get_var", variable, Taken("name", text), NAME, TIMEOUT, takes_time=True)
    value = Taken("value", integer)
    yield builtin("socket_set_var", lambda n, v, s: send(f"SET {n} {v}\n".encode(), s), Taken("name", text), value, NAME)
    yield builtin("socket_send_byte", lambda v, n: send(bytes([v & 0xFF]), n), value, NAME)
    yield builtin("socket_send_int", lambda v, n: send((v & 0xFFFFFFFF).to_bytes(4, "big"), n), value, NAME)
    yield builtin("socket_send_string", lambda v, n: send(shown(v).encode(), n), Taken("str", anything), NAME)
    yield builtin("socket_send_line", lambda v, n: send(shown(v).encode() + b"\n", n), Taken("str", anything), NAME)


def _ticks(timeout: float) -> Iterator[int]:
    """Ticks until a timeout; one more look is had than ticks pass."""
    count, most = 0, round(min(timeout, 1e6) * TICK_RATE) if timeout > 0.0 else None
    while most is None or count <= most:
        yield count
        count += 1


def _escaped(part: str) -> str:
    return part.replace("\\n", "\n").replace("\\r", "\r").replace("\\t", "\t")
