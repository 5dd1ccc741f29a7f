"""RTDE's packages as bytes: uint16 size, uint8 type, payload; all big-endian (RTDE guide)."""

import struct
from collections.abc import Iterator
from enum import IntEnum

LEAST, MOST = 3, 8192
"""Sizes of a package [bytes]; a list of names has at most 2,048."""

MOST_NAMES = 2048
"""Length of a list of names [bytes]."""


class Package(IntEnum):
    """Types of packages."""

    REQUEST_PROTOCOL_VERSION = ord("V")
    GET_URCONTROL_VERSION = ord("v")
    TEXT_MESSAGE = ord("M")
    DATA_PACKAGE = ord("U")
    SETUP_OUTPUTS = ord("O")
    SETUP_INPUTS = ord("I")
    START = ord("S")
    PAUSE = ord("P")


class Level(IntEnum):
    """Of a text message."""

    EXCEPTION = 0
    ERROR = 1
    WARNING = 2
    INFO = 3


class Malformed(Exception):
    """What came is no RTDE; the text says why."""


def packed(kind: int, payload: bytes = b"") -> bytes:
    """A package."""
    return struct.pack(">HB", len(payload) + 3, kind) + payload


def text_message(text: str, level: Level, version: int) -> bytes:
    """A message for people: at most 255 bytes, from "pendant"."""
    message, source = text.encode("ascii", "replace")[:255], b"pendant"
    if version == 1:
        return packed(Package.TEXT_MESSAGE, bytes([level]) + message)
    return packed(Package.TEXT_MESSAGE, bytes([len(message)]) + message + bytes([len(source)]) + source + bytes([level]))


def heard_text(payload: bytes, version: int) -> str:
    """What a client's text message says, as far as it is whole."""
    if version == 1:
        return payload[1:].decode("ascii", "replace")
    return payload[1 : 1 + payload[0]].decode("ascii", "replace") if payload else ""


def names(payload: bytes) -> list[str]:
    """The names in a recipe; empty ones, as after a trailing comma, do not count.

    Raises:
        Malformed: it is too long, or not ASCII.
    """
    if len(payload) > MOST_NAMES:
        raise Malformed(f"a recipe of {len(payload)} bytes, at most {MOST_NAMES}")
    try:
        text = payload.decode("ascii")
    except UnicodeDecodeError:
        raise Malformed("a recipe that is not ASCII") from None
    return [name for name in (part.strip() for part in text.split(",")) if name]


class Reader:
    """Cuts what comes into packages."""

    def __init__(self) -> None:
        self._left = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[int, bytes]]:
        """Types and payloads of the packages that are whole now.

        Raises:
            Malformed: no package has such a size.
        """
        left = self._left
        left += data
        while len(left) >= LEAST:
            size, kind = struct.unpack_from(">HB", left)
            if not LEAST <= size <= MOST:
                raise Malformed(f"a package of {size} bytes, allowed: {LEAST} .. {MOST}")
            if len(left) < size:
                return
            payload = bytes(left[LEAST:size])
            del left[:size]
            yield kind, payload
