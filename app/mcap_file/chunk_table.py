"""The places of chunks, attachments and metadata in an open MCAP file."""

import io
import os
import struct
from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata, Schema
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.mcap_file.file_summary import MAGIC

UNREADABLE = (EndOfFile, McapError, struct.error, ValueError, KeyError, IndexError, OverflowError, EOFError)
"""Errors that damaged bytes raise."""

HEAD = 9
"""Size of the opcode and length before each record [bytes]."""

LARGEST = 1 << 28
"""Largest record other than a chunk that is read [bytes]."""


@dataclass(slots=True)
class ChunkTable:
    """An open file, and where its parts are."""

    path: Path
    file: FileIO
    size: int  # [bytes]
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    attachments: dict[str, tuple[int, int]] = field(default_factory=dict)  # place and length of each by its name
    notes: dict[str, dict[str, str]] = field(default_factory=dict)
    indices: dict[int, "array[int]"] = field(default_factory=dict)
    # for each channel a flat list of triples: place and length of a chunk with its messages, place of their index
    end: int = len(MAGIC)  # of the last whole record of data
    lost: int = -1  # bytes that follow it without making a whole chunk; -1: the file's end follows

    @property
    def whole(self) -> bool:
        """The file has its end, with the summary."""
        return self.lost < 0

    def read(self, at: int, length: int) -> bytes:
        """`length` bytes of the file from `at` on. Raises EOFError: the file is too short."""
        data = os.pread(self.file.fileno(), length, at)
        if len(data) != length:
            raise EOFError
        return data

    def attachment(self, name: str) -> bytes:
        """Content of an attached file. Raises KeyError: there is none of this name; BadInput: it cannot be read."""
        at, length = self.attachments[name]
        try:
            return Attachment.read(stream(self.read(at, length)[HEAD:])).data
        except UNREADABLE as error:
            raise damaged(self.path, at, error) from None

    def channel_of(self, topic: str) -> int:
        """The number of a topic's channel. Raises KeyError: there is none."""
        found = [number for number, each in self.channels.items() if each.topic == topic]
        if not found:
            raise KeyError(topic)
        return found[0]

    def chunks_of(self, channel: int) -> NDArray[np.int64]:
        """(k, 3) place and length of each chunk with messages of a channel, and place of the index of these messages."""
        return np.array(self.indices.get(channel, ()), dtype=np.int64).reshape(-1, 3)

    def forget(self) -> None:
        """Forget all places."""
        for found in (self.schemas, self.channels, self.attachments, self.notes, self.indices):
            found.clear()

    def close(self) -> None:
        """Close the file."""
        self.file.close()


def damaged(path: Path, at: int, error: BaseException) -> BadInput:
    """The error for damaged bytes at a place of a file."""
    return BadInput(path.name, f"byte {at}", ABSENT, f"is damaged ({str(error) or type(error).__name__})")


def take_chunk(table: ChunkTable, place: int, length: int, indices: Iterable[tuple[int, int]]) -> None:
    """Take in a chunk: its place and length, and of each channel in it the place of its message index."""
    if not len(MAGIC) <= place <= table.size - length:
        raise ValueError("a chunk beyond the file")
    for channel, at in indices:
        table.indices.setdefault(channel, array("q")).extend((place, length, at))


def take_note(table: ChunkTable, body: bytes) -> str:
    """Take in a metadata record, texts by name. Returns the record's name."""
    note = Metadata.read(stream(body))
    table.notes[note.name] = note.metadata
    return note.name


def declare(table: ChunkTable, code: int, body: bytes) -> None:
    """Take in a schema or a channel; other records are ignored."""
    if code == Opcode.SCHEMA:
        schema = Schema.read(stream(body))
        table.schemas[schema.id] = schema
    elif code == Opcode.CHANNEL:
        channel = Channel.read(stream(body))
        table.channels[channel.id] = channel


def bounded(length: int) -> int:
    """The length of a record, checked before the record is read. Raises ValueError: it is too large."""
    if length > LARGEST:
        raise ValueError("a record that is too large")
    return length


def stream(data: bytes) -> Any:
    """The bytes as a stream of the mcap library."""
    return ReadDataStream(io.BytesIO(data))
