"""Functions of a server that a script calls by XML-RPC (URScript manual, "Remote procedure call").

A call waits in a thread of its own, so that a server that is slow, or wrong, holds up no tick: the script looks every tick
whether the answer is there.
"""

import contextlib
import http.client
import socket
import threading
import xmlrpc.client
from collections.abc import Generator, Iterator
from typing import Any
from urllib.parse import urlsplit
from xml.parsers.expat import ExpatError

from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, builtin, text
from app.urscript.machine.values import (
    POSE_MEMBERS,
    PoseValue,
    RemoteHandle,
    StructValue,
    Value,
    joined_text,
    kind,
    made_list,
    number_made,
)
from app.urscript.outside.hosts import AllowedHosts
from pendant.tick.modes import TICK_RATE

PATIENCE = 60.0
"""Time that a server has for an answer [s]. A robot waits without end; what a camera or a gripper needs is seconds."""

CONNECTING = 2.0
"""Time in which a server must be there [s]."""

MAX_ANSWER_BYTES = 1 << 20

SHOWN = 200
"""Characters of what a server says that an error shows."""

EXPECTED = "expected http://ADDRESS:PORT/PATH"

CLOSE = "closeXMLRPCClientConnection"
"""What ends the connection of a handle (URScript manual). Here each call has one of its own."""


class _Transport(xmlrpc.client.Transport):
    """One HTTP connection to an address, with a limit of time for each piece and of size for the answer."""

    accept_gzip_encoding = False

    def __init__(self, address: str, port: int, patience: float) -> None:
        super().__init__()
        self.user_agent = "robot"
        self._http = http.client.HTTPConnection(address, port, timeout=patience)

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        return self._http

    def parse_response(self, response: Any) -> Any:
        parser, unmarshaller = self.getparser()
        data = response.read(MAX_ANSWER_BYTES + 1)
        if len(data) > MAX_ANSWER_BYTES:
            raise ValueError(f"it has more than {MAX_ANSWER_BYTES} bytes")
        parser.feed(data)
        parser.close()
        return unmarshaller.close()

    def cut(self) -> None:
        """End the connection, also while another thread waits for an answer."""
        connection = self._http.sock
        if connection is not None:
            with contextlib.suppress(OSError):  # it may have ended by itself
                connection.shutdown(socket.SHUT_RDWR)


class _Exchange(threading.Thread):
    """One question and its answer. `done` says that `answer` or `problem` is there; `late`: the problem of a server that is."""

    def __init__(self, transport: _Transport, host: str, path: str, question: str, *, late: str) -> None:
        super().__init__(name="xml-rpc", daemon=True)
        self._transport, self._host, self._path, self._question, self._late = transport, host, path, question, late
        self.done, self.answer, self.problem = False, None, ""

    def run(self) -> None:
        try:
            found = self._transport.request(self._host, self._path, self._question.encode())
            self.answer = found[0] if isinstance(found, tuple) and len(found) == 1 else found
        except xmlrpc.client.Fault as fault:
            self.problem = f"the server says: {str(fault.faultString)[:SHOWN]}"
        except xmlrpc.client.ProtocolError as error:
            self.problem = f"the server answers with HTTP {error.errcode} {str(error.errmsg)[:SHOWN]}"
        except TimeoutError:
            self.problem = self._late
        except ConnectionRefusedError:
            self.problem = f"there is no server at {self._host}"
        except OSError as error:
            self.problem = f"the connection to {self._host} broke: {error.strerror or error}"
        except (xmlrpc.client.Error, http.client.HTTPException, ExpatError, ValueError, TypeError, KeyError) as error:
            self.problem = f"the answer is no XML-RPC: {str(error)[:SHOWN] or type(error).__name__}"
        finally:
            self.done = True


class XmlRpcServer(RemoteHandle):
    """A server at an address that may be called.

    Args:
        address: its IP address.
        port: its port.
        path: on it.
        patience: time that it has for an answer [s].
    """

    __slots__ = ("_address", "_path", "_patience", "_port")

    def __init__(self, address: str, port: int, path: str, *, patience: float) -> None:
        self._address, self._port, self._path, self._patience = address, port, path, patience

    @property
    def host(self) -> str:
        """Address and port, as texts show them."""
        return f"[{self._address}]:{self._port}" if ":" in self._address else f"{self._address}:{self._port}"

    def connect(self) -> Generator[None, None, None]:
        """Wait until the server is there. Raises Misuse: it is not."""
        with contextlib.suppress(OSError):  # no socket, or an address that is none for this machine
            connection = socket.socket(socket.AF_INET6 if ":" in self._address else socket.AF_INET, socket.SOCK_STREAM)
            with connection:
                connection.setblocking(False)
                for _ in range(round(CONNECTING * TICK_RATE)):
                    number = connection.connect_ex((self._address, self._port))
                    if number in (0, 106):  # done, EISCONN
                        return
                    if number not in (11, 114, 115):  # EAGAIN, EALREADY, EINPROGRESS
                        break
                    yield
        raise Misuse(f"there is no server at {self.host}")

    def call(self, name: str, arguments: list[Value]) -> Generator[None, None, Value]:
        """See `RemoteHandle.call`."""
        if name == CLOSE:
            return _nothing()
        given = tuple(_sent(value) for value in arguments)
        return self._called(xmlrpc.client.dumps(given, name))

    def _called(self, question: str) -> Generator[None, None, Value]:
        transport = _Transport(self._address, self._port, self._patience)
        late = f"the server at {self.host} has not answered for {self._patience:g} s"
        exchange = _Exchange(transport, self.host, self._path, question, late=late)
        exchange.start()
        try:
            for _ in range(round(self._patience * TICK_RATE)):
                if exchange.done:
                    break
                yield
            answered = exchange.done
        finally:
            transport.cut()
        if not answered:
            raise Misuse(late)
        if exchange.problem:
            raise Misuse(exchange.problem)
        return _received(exchange.answer)


def _nothing() -> Generator[None, None, Value]:
    return
    yield


def _sent(value: Value) -> Any:
    """A value as the protocol takes it; a pose is a struct of its six numbers, as UR's own examples have it."""
    if type(value) is PoseValue:
        return dict(zip(POSE_MEMBERS, map(float, value), strict=True))
    if type(value) is tuple:
        return [_sent(each) for each in value]
    if isinstance(value, StructValue):
        return {name: _sent(each) for name, each in value.members.items()}
    if type(value) in (bool, int, str):
        return value
    if type(value) is float and abs(value) != float("inf") and value == value:
        return value
    raise Misuse(f"{value if type(value) is float else kind(value)} cannot be sent")


def _received(value: Any) -> Value:
    """What a server gave, as a value of the language."""
    if value is None or type(value) in (bool, float):
        return value
    if type(value) is int:
        return number_made(value)
    if type(value) is str:
        return joined_text(value, "")
    if type(value) in (list, tuple):
        return made_list([_received(each) for each in value])
    if type(value) is dict:
        if set(value) == set(POSE_MEMBERS) and all(type(each) in (int, float) for each in value.values()):
            return PoseValue(float(value[name]) for name in POSE_MEMBERS)
        return StructValue({str(name): _received(each) for name, each in value.items()})
    raise Misuse(f"the answer holds {type(value).__name__}, for which there is no value")


def of_remote_calls(hosts: AllowedHosts) -> Iterator[Builtin]:
    """rpc_factory; what it gives is called as `handle.function()`."""

    def factory(protocol: str, url: str) -> Generator[None, None, Value]:
        if protocol != "xmlrpc":
            raise Misuse(f'type: {protocol[:SHOWN]!r}; expected "xmlrpc"')
        try:
            parts = urlsplit(url)
            port = parts.port or 80
        except ValueError:
            raise Misuse(f"url: {url[:SHOWN]!r}; {EXPECTED}") from None
        if parts.scheme != "http" or not parts.hostname or any(map(str.isspace, url)):
            raise Misuse(f"url: {url[:SHOWN]!r}; {EXPECTED}")
        path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        return _connected(XmlRpcServer(hosts.address(parts.hostname), port, path, patience=PATIENCE))

    yield builtin("rpc_factory", factory, Taken("type", text), Taken("url", text), takes_time=True)


def _connected(server: XmlRpcServer) -> Generator[None, None, Value]:
    yield from server.connect()
    return server
