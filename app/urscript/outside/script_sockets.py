"""Connections that a script opens. Nothing here waits: a script looks every tick whether something has come."""

import contextlib
import re
import socket
import struct
from abc import ABC, abstractmethod

from app.robot_interface.gripper.gripper_registers import NUMBER, GripperLines, GripperRegisters
from app.urscript.language.trouble import Misuse
from app.urscript.outside.hosts import AllowedHosts

MOST = 16
"""Connections of a script."""
FULL = 1 << 16
"""Bytes that are kept, each way: the other side has to wait then."""
CHUNK = 4096
LOCAL = "127.0.0.1"
"""Where a program finds what runs in the robot itself."""


class ScriptSocket(ABC):
    """One connection."""

    def __init__(self) -> None:
        self.open = False
        self.broken = False
        self.data = bytearray()  # came, and was not read
        self.in_a_row = 0  # reads without a tick between them

    @abstractmethod
    def connected(self, address: tuple[str, int]) -> bool:
        """Whether the connection stands by now."""

    @abstractmethod
    def look(self) -> None:
        """Take what has come, and send what waits."""

    @abstractmethod
    def send(self, data: bytes) -> bool:
        """Send; False: the connection is broken, or the other side does not read."""

    def close(self) -> None:
        """End it."""
        self.open = False

    def integers(self, count: int) -> list[int] | None:
        """So many integers of four bytes, big-endian, or None as long as they have not all come."""
        if len(self.data) < 4 * count:
            return None
        found = struct.unpack(f">{count}i", self.data[: 4 * count])
        del self.data[: 4 * count]
        return list(found)

    def octets(self, count: int) -> list[int] | None:
        """So many bytes, or None."""
        if len(self.data) < count:
            return None
        found = list(self.data[:count])
        del self.data[:count]
        return found

    def floats(self) -> list[float] | None:
        """The numbers between the next pair of brackets, or None."""
        end = self.data.find(b")")
        if end < 0:
            return None
        text = bytes(self.data[:end]).decode("ascii", "replace")
        del self.data[: end + 1]
        found = text[text.rfind("(") + 1 :] if "(" in text else ""
        try:
            return [float(word) for word in re.split(r"[,\s]+", found.strip()) if word]
        except ValueError:
            return []

    def text(self, prefix: bytes, suffix: bytes) -> str | None:
        """Up to a suffix, from a prefix on; without a suffix all that has come; None: not yet."""
        start = self.data.find(prefix) if prefix else 0
        if start < 0 or (not suffix and len(self.data) <= start + len(prefix)):
            return None
        begun = start + len(prefix)
        end = self.data.find(suffix, begun) if suffix else len(self.data)
        if end < 0:
            return None
        found = bytes(self.data[begun : min(end, begun + 1023)]).decode("utf-8", "replace")
        del self.data[: end + len(suffix)]
        return found


class TcpSocket(ScriptSocket):
    """A connection to a server."""

    def __init__(self, connection: socket.socket) -> None:
        super().__init__()
        self._socket = connection
        self._out = bytearray()  # was sent, and has not left

    def connected(self, address: tuple[str, int]) -> bool:
        """See `ScriptSocket.connected`."""
        if not self.open and not self.broken:
            try:
                number = self._socket.connect_ex(address)
            except OSError:  # the address is none for this machine
                self.broken = True
                return False
            if number in (0, 106):  # done, EISCONN
                self.open = True
            elif number not in (11, 114, 115):  # EAGAIN, EALREADY, EINPROGRESS
                self.broken = True
        return self.open

    def look(self) -> None:
        """See `ScriptSocket.look`."""
        self._push()
        while self.open and len(self.data) < FULL:
            try:
                found = self._socket.recv(CHUNK)
            except BlockingIOError:
                return
            except OSError:
                self.broken = True
                return
            if not found:
                self.broken = True
                return
            self.data += found
            if len(found) < CHUNK:
                return

    def send(self, data: bytes) -> bool:
        """See `ScriptSocket.send`."""
        if not self.open or self.broken or len(self._out) + len(data) > FULL:
            return False
        self._out += data
        self._push()
        return not self.broken

    def _push(self) -> None:
        while self._out and not self.broken:
            try:
                count = self._socket.send(self._out)
            except BlockingIOError:
                return
            except OSError:
                self.broken = True
                return
            del self._out[:count]

    def close(self) -> None:
        """See `ScriptSocket.close`."""
        with contextlib.suppress(OSError):
            self._push()
            self._socket.close()
        super().close()


class GripperSocket(ScriptSocket):
    """A connection to the robot's own gripper, whose port is in the robot itself: answers are there at once."""

    def __init__(self, registers: GripperRegisters) -> None:
        super().__init__()
        self._lines = GripperLines(registers)

    def connected(self, address: tuple[str, int]) -> bool:
        """See `ScriptSocket.connected`."""
        self.open = True
        return True

    def look(self) -> None:
        """All has come already."""

    def send(self, data: bytes) -> bool:
        """Send; False: a line is too long, or too many answers were not read."""
        answer = self._lines.hear(data)
        if answer is None or not self.open or len(self.data) + len(answer) > FULL:
            self.broken = True
            return False
        self.data += answer
        return True


class ScriptSockets:
    """All connections of a script.

    Args:
        hosts: that it may connect to.
        gripper: what the port of the robot's own gripper answers.
    """

    def __init__(self, hosts: AllowedHosts, gripper: GripperRegisters | None = None) -> None:
        self._hosts, self._gripper = hosts, gripper
        self._sockets: dict[str, ScriptSocket] = {}

    def begin(self, host: str, port: int, name: str) -> tuple[ScriptSocket, tuple[str, int]] | None:
        """Begin a connection; one of the same name is ended. None: the host may not be called, or this machine has
        no socket for it.

        Raises:
            Misuse: there are too many.
        """
        self.close(name)
        address = self._hosts.reached(host)
        if address is None:
            return None
        if len(self._sockets) >= MOST:
            raise Misuse(f"more than {MOST} sockets")
        if port == NUMBER and address == LOCAL and self._gripper is not None and self._gripper.there:
            self._sockets[name] = own = GripperSocket(self._gripper)
            return own, (address, port)
        try:
            connection = socket.socket(socket.AF_INET6 if ":" in address else socket.AF_INET, socket.SOCK_STREAM)
        except OSError:  # without IPv6, or with too many files
            return None
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._sockets[name] = made = TcpSocket(connection)
        return made, (address, port)

    def get(self, name: str) -> ScriptSocket | None:
        """The connection of a name."""
        return self._sockets.get(name)

    def close(self, name: str) -> None:
        """End one."""
        found = self._sockets.pop(name, None)
        if found is not None:
            found.close()

    def end(self) -> None:
        """End all."""
        for name in list(self._sockets):
            self.close(name)
