"""Messages of the primary interface as bytes: version, text, keys, errors, safety mode (client interfaces 5.23)."""

import struct
from enum import IntEnum
from typing import NamedTuple
from unicodedata import normalize

from app.robot_interface.controller.robot_words import VERSION, SafetyMode

ROBOT_MESSAGE = 20

FROM_CONTROLLER = -2
"""Source of a message: the robot controller."""


class MessageType(IntEnum):
    """Of a robot message."""

    TEXT = 0
    POPUP = 2
    VERSION = 3
    SAFETY_MODE = 5
    ERROR = 6
    KEY = 7
    REQUEST_VALUE = 9
    RUNTIME_EXCEPTION = 10


def _message(clock: float, kind: MessageType, body: bytes) -> bytes:
    content = struct.pack(">QbB", int(clock * 1e6), FROM_CONTROLLER, kind) + body
    return struct.pack(">iB", len(content) + 5, ROBOT_MESSAGE) + content


def version_message(clock: float) -> bytes:
    """What a client is told first."""
    name = b"URControl"
    numbers = struct.pack(">BBii", *VERSION)
    return _message(clock, MessageType.VERSION, bytes([len(name)]) + name + numbers + b"Nov 23 2026, 12:00:00")


def text_of(clock: float, text: str) -> bytes:
    """A text for people."""
    return _message(clock, MessageType.TEXT, _ascii(text))


def key_message(clock: float, title: str, text: str) -> bytes:
    """Something that programs wait for, such as PROGRAM_XXX_STARTED with the program's name."""
    name = title.encode()
    return _message(clock, MessageType.KEY, struct.pack(">iiB", 0, 0, len(name)) + name + _ascii(text))


class Code(NamedTuple):
    """Of an error, as C157A2 is code 157 with argument 2; clients print it so."""

    number: int = 0  # 0: ours, which a UR's list does not have
    argument: int = 0


OURS = Code()


def error_message(clock: float, level: int, text: str, code: Code = OURS) -> bytes:
    """An error for people; `level` 1 is a note, 2 a warning, 3 a stop."""
    return _message(clock, MessageType.ERROR, struct.pack(">iiiII", *code, level, 0, 0) + _ascii(text))


def safety_message(clock: float, mode: SafetyMode) -> bytes:
    """The safety mode is another."""
    return _message(clock, MessageType.SAFETY_MODE, struct.pack(">iiBII", 0, 0, mode, 0, 0))


def exception_message(clock: float, line: int, column: int, text: str) -> bytes:
    """A program cannot go on."""
    return _message(clock, MessageType.RUNTIME_EXCEPTION, struct.pack(">ii", line, column) + _ascii(text))


def popup_message(clock: float, title: str, text: str, level: str) -> bytes:
    """A message that the robot shows; `level` is "", "warning" or "error"."""
    name = _ascii(title)[:255]
    head = struct.pack(">IB???", 0, 3, level == "warning", level == "error", False)
    return _message(clock, MessageType.POPUP, head + bytes([len(name)]) + name + _ascii(text))


REQUESTED = ("boolean", "integer", "float", "string")
"""Types of a value that is asked for, by their numbers."""


def question_message(clock: float, text: str, kind: str) -> bytes:
    """A program waits for a value from people; `kind` is one of `REQUESTED`."""
    return _message(clock, MessageType.REQUEST_VALUE, struct.pack(">II", 0, REQUESTED.index(kind)) + _ascii(text))


PLAIN = str.maketrans(
    {
        **{"·": "", "±": "+-", "°": " deg", "²": "^2", "³": "^3", "µ": "u", "×": "x", "ß": "ss"},
        **{"\u2026": "...", "\u2192": "->", "\u2264": "<=", "\u2265": ">=", "\u2013": "-", "\u2014": "-"},
        **{"\u2018": "'", "\u2019": "'", "\u201c": '"', "\u201d": '"'},
    }
)
"""How signs that are not in ASCII are told: a controller's messages have no others."""


def _ascii(text: str) -> bytes:
    return normalize("NFKD", text.translate(PLAIN)).encode("ascii", "ignore")
