"""The computer's side of External Control: it sends a program to a robot, which calls back and does what it hears.

It has three connections, all of 32-bit whole numbers. On the first go modes and targets, each with the time in which the next
must follow. On the second go the points of a trajectory, and its result comes back. On the third go commands of the moment, and
what became of a search for contact comes back. Source: the documentation of the UR client library.
"""

import contextlib
import re
import socket
import struct
import threading
import time
from collections.abc import Mapping, Sequence
from enum import IntEnum
from types import TracebackType
from typing import Self

SCALE = 1_000_000
"""Whole numbers to one unit: of an angle, a length, a force, a time."""

ZEROS = (0.0,) * 6
EVERY = 0.004
"""Between two words to the robot [s]."""

KEPT_ALIVE = 15.0
"""Time in which the next word must follow [s]: this machine may be busy."""

PATIENCE = 15.0
"""For an answer of the robot [s]."""


class ControlMode(IntEnum):
    """What the arm does."""

    STOPPED = -2
    IDLE = 0
    SERVO = 1
    SPEED = 2
    FORWARD = 3
    TOOL_SPEED = 4
    POSE = 5
    FREE_DRIVE = 6
    TORQUE = 8


class PointKind(IntEnum):
    """Of a trajectory's point."""

    MOVEJ = 0
    MOVEL = 1
    MOVEP = 2
    MOVEC = 3
    OPTIMOVEJ = 4
    SPLINE = 51


class OneShot(IntEnum):
    """A command of the moment."""

    ZERO_SENSOR = 0
    PAYLOAD = 1
    TOOL_VOLTAGE = 2
    FORCE_MODE = 3
    END_FORCE_MODE = 4
    TOOL_CONTACT = 5
    END_TOOL_CONTACT = 6
    GRAVITY = 9
    TCP = 10
    TARGET_PAYLOAD = 12


DONE, CANCELED, FAILED = 0, 1, 2
"""Results of a trajectory; of a contact the first two."""

START, CANCEL = 1, -1
"""Of a trajectory, of free-drive."""

STREAM_START, STREAM_END = 2, 3
"""Of a trajectory whose length is told at its end."""


class ExternalControlClient:
    """Listens on three ports of this machine, and speaks to the program that calls back."""

    def __init__(self) -> None:
        self._listeners = [socket.create_server(("127.0.0.1", 0)) for _ in range(3)]
        self._connections: list[socket.socket] = []
        self._lock = threading.Lock()
        self._word: bytes | None = None  # that is said again and again
        self._over = threading.Event()
        self._voice = threading.Thread(target=self._speak, daemon=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._over.set()
        if self._voice.is_alive():
            self._voice.join()
        for each in (*self._connections, *self._listeners):
            each.close()

    def values(self) -> dict[str, str]:
        """For the places that a program leaves open, by their names."""
        reverse, trajectory, command = (str(each.getsockname()[1]) for each in self._listeners)
        return {
            "BEGIN_REPLACE": "",
            "JOINT_STATE_REPLACE": str(SCALE),
            "TIME_REPLACE": str(SCALE),
            "SERVO_J_REPLACE": "lookahead_time=0.03, gain=2000",
            "SERVER_IP_REPLACE": "127.0.0.1",
            "SERVER_PORT_REPLACE": reverse,
            "TRAJECTORY_SERVER_PORT_REPLACE": trajectory,
            "SCRIPT_COMMAND_SERVER_PORT_REPLACE": command,
        }

    def upload(self, robot: tuple[str, int], template: str, version: tuple[int, ...]) -> None:
        """Send a program to a client interface of a robot, and wait until it has called back."""
        body = filled(template, self.values(), version)
        lines = "".join(f"\t{line}\n" for line in body.split("\n"))
        for each in self._listeners:
            each.settimeout(PATIENCE)
        with socket.create_connection(robot) as connection:
            connection.sendall(f"stop program\ndef externalControl():\n{lines}end\n".encode())
            self._connections = [each.accept()[0] for each in self._listeners]
        for each in self._connections:
            each.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._voice.start()

    def do(self, mode: ControlMode, values: Sequence[float] = ZEROS, *, alive: float = KEPT_ALIVE) -> None:
        """Say a mode with six numbers from now on."""
        self._say(_word(mode, [round(value * SCALE) for value in values], alive))

    def once(self, mode: ControlMode, action: int, count: int = 0) -> None:
        """Say an action of a mode once, and from then on that nothing changes."""
        self._say(_word(mode, [action, count, 0, 0, 0, 0], KEPT_ALIVE), _word(mode, [0] * 6, KEPT_ALIVE))

    def fall_silent(self) -> None:
        """Say nothing any more."""
        with self._lock:
            self._word = None

    def point(self, kind: PointKind, *blocks: Sequence[float], seconds: float = 0.0, blend: float = 0.0) -> None:
        """A point of a trajectory: up to three blocks of six numbers, the time that it takes, its blend radius."""
        numbers = [round(value * SCALE) for block in (*blocks, ZEROS, ZEROS)[:3] for value in block]
        last = len(blocks) - 1 if kind is PointKind.SPLINE else round(blend * SCALE)  # a spline of 1: cubic, of 2: quintic
        self._connections[1].sendall(struct.pack(">21i", *numbers, round(seconds * SCALE), last, kind))

    def command(self, which: OneShot, *values: float) -> None:
        """A command of the moment."""
        numbers = [round(value * SCALE) for value in values]
        self._connections[2].sendall(struct.pack(">28i", which, *numbers, *[0] * (27 - len(numbers))))

    def result(self) -> int:
        """Of the trajectory."""
        return _heard(self._connections[1])

    def contact(self) -> int:
        """What became of the search for a contact."""
        return _heard(self._connections[2])

    def left(self) -> bool:
        """Whether the program ends its connections in time."""
        self._connections[0].settimeout(PATIENCE)
        with contextlib.suppress(ConnectionResetError):
            return not self._connections[0].recv(1)
        return True

    def _say(self, word: bytes, then: bytes | None = None) -> None:
        with self._lock:
            self._connections[0].sendall(word)
            self._word = then or word

    def _speak(self) -> None:
        while not self._over.is_set():
            with self._lock, contextlib.suppress(OSError):
                if self._word is not None:
                    self._connections[0].sendall(self._word)
            time.sleep(EVERY)


def filled(template: str, values: Mapping[str, str], version: tuple[int, ...]) -> str:
    """A program whose open places have values, without the lines that another version of the robot needs."""
    text = re.sub(r"\{\{\s*([\w-]+)\s*\}\}", lambda found: values[found[1]], template)
    lines: list[str] = []
    open_: list[tuple[bool, bool]] = []  # of each condition: a branch has held; the present one does
    for line in text.split("\n"):
        found = re.search(r"\{%\s*(if|elif|else|endif)\b\s*(.*?)\s*%\}", line)
        if found is None:
            if all(holds for _, holds in open_):
                lines.append(line)
            continue
        word, condition = found.groups()
        before = False if word == "if" else open_.pop()[0]
        if word != "endif":
            holds = not before and (word == "else" or _holds(condition, version))
            open_.append((before or holds, holds))
    return "\n".join(lines)


def _holds(condition: str, version: tuple[int, ...]) -> bool:
    _, operator, number = condition.split()
    wanted = tuple(int(part) for part in number.removeprefix("v").split("."))
    return version < wanted if operator == "<" else version >= wanted


def _word(mode: ControlMode, numbers: Sequence[int], alive: float) -> bytes:
    return struct.pack(">8i", round(alive * 1000.0), *numbers, mode)


def _heard(connection: socket.socket) -> int:
    connection.settimeout(PATIENCE)
    data = b""
    while len(data) < 4:
        part = connection.recv(4 - len(data))
        if not part:
            raise ConnectionError("the program has ended the connection")
        data += part
    return struct.unpack(">i", data)[0]
