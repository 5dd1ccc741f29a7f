"""Writes an MCAP file chunk by chunk, each one whole and flushed, so that a killed process leaves all but its last chunk.

The records are the mcap library's; messages that come as numpy rows are laid out here, since one call a message would cost
more than the tick that they record.
"""

import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.records import Chunk as ChunkRecord

from app.files.checked import ABSENT, BadInput

MAGIC = b"\x89MCAP0\r\n"
LEVEL = 1
"""Of compression: fast."""

MESSAGE = struct.Struct("<BQHIQQ")
"""Start of a message: opcode, length, channel, sequence, log and publish time."""

INDEX = struct.Struct("<BQHI")
"""Start of a message index: opcode, length, channel, bytes of the pairs that follow."""

Index = tuple[int, np.ndarray[Any, Any]]
"""A channel and its messages in a chunk, (k, 2): time [ns], offset."""


class FileSummary:
    """What stands at a file's end: found out while writing, or again from a file without its end.

    Attributes:
        chunks: indices of chunks that may still change.
    """

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.chunks: list[ChunkIndex] = []
        self.attachments: list[AttachmentIndex] = []
        self.metadata: list[MetadataIndex] = []
        self.counts: dict[int, int] = {}
        self._done = bytearray()  # indices of chunks that do not change any more, as they will stand in the file
        self._done_count = 0
        self._span: list[int] = []  # times of the first and the last message in them [ns]

    def done(self, chunk: ChunkIndex) -> None:
        """Take the index of a chunk that will not change: as bytes, for in a day there are 345,600 of them."""
        builder = RecordBuilder()
        chunk.write(builder)
        self._done += builder.end()
        self._done_count += 1
        times = (*self._span, chunk.message_start_time, chunk.message_end_time)
        self._span = [min(times), max(times)]

    def write(self, start: int) -> bytes:
        """The end of a file whose data ends at byte `start`: from DataEnd to the closing magic."""
        begin, builder = RecordBuilder(), RecordBuilder()
        DataEnd(data_section_crc=0).write(begin)
        head = begin.end()
        for record in (*self.schemas.values(), *self.channels.values()):
            record.write(builder)
        times = self._span + [time for chunk in self.chunks for time in (chunk.message_start_time, chunk.message_end_time)]
        Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.channels),
            channel_message_counts=self.counts,
            chunk_count=self._done_count + len(self.chunks),
            message_count=sum(self.counts.values()),
            message_start_time=min(times, default=0),
            message_end_time=max(times, default=0),
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        ).write(builder)
        summary = builder.end() + self._done
        for record in (*self.chunks, *self.attachments, *self.metadata):
            record.write(builder)
        summary += builder.end()
        Footer(summary_start=start + len(head), summary_offset_start=0, summary_crc=0).write(begin)
        return head + summary + begin.end() + MAGIC


class Container:
    """An MCAP file being written. Used by one thread at a time.

    Raises:
        BadInput: the file cannot be written.
    """

    def __init__(self, path: Path, library: str) -> None:
        self._path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb")
        except OSError as error:
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._summary = FileSummary()
        self._at = 0
        self._pending: dict[int, list[tuple[int, bytes]]] = {}
        self._sequence: dict[int, int] = {}
        self._compressor = zstandard.ZstdCompressor(level=LEVEL)
        self._put(MAGIC)
        self._record(Header(profile="", library=library))

    def channel(
        self, topic: str, schema: str, text: str, *, encoding: str, of_schema: str, metadata: Mapping[str, str] = {}
    ) -> int:
        """Declare a topic; its number.

        Args:
            topic: such as /state.
            schema: name of its messages' schema.
            text: the schema.
            encoding: of the messages: "cdr" or "json".
            of_schema: "ros2msg" or "jsonschema".
            metadata: texts that go with it.
        """
        summary = self._summary
        known = next((number for number, each in summary.schemas.items() if each.name == schema), None)
        if known is None:
            known = len(summary.schemas) + 1
            summary.schemas[known] = Schema(data=text.encode(), encoding=of_schema, id=known, name=schema)
            self._record(summary.schemas[known])
        number = len(summary.channels) + 1
        summary.channels[number] = Channel(
            id=number, topic=topic, message_encoding=encoding, metadata=dict(metadata), schema_id=known
        )
        self._record(summary.channels[number])
        summary.counts[number] = 0
        return number

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Put a file into the log."""
        start = self._at
        self._record(Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data))
        index = AttachmentIndex(
            offset=start,
            length=self._at - start,
            log_time=0,
            create_time=0,
            data_size=len(data),
            name=name,
            media_type=media_type,
        )
        self._summary.attachments.append(index)

    def note(self, name: str, values: Mapping[str, str]) -> None:
        """Put texts by name into the log."""
        start = self._at
        self._record(Metadata(name=name, metadata=dict(values)))
        self._summary.metadata.append(MetadataIndex(offset=start, length=self._at - start, name=name))

    def add(self, channel: int, time: int, data: bytes) -> None:
        """Add one message [ns] to the chunk that `rows` or `flush` ends."""
        self._pending.setdefault(channel, []).append((time, data))

    def flush(self, rows: list[np.ndarray[Any, Any]]) -> None:
        """End a chunk: the messages of `add`, and blocks of whole message records, a block a channel, then hand it to the system.

        Raises:
            OSError: the disk is full or gone.
        """
        body: list[bytes] = []
        indices: list[Index] = []
        at = 0
        for block in rows:
            if len(block):
                channel = int(block["channel"][0])
                index = np.empty((len(block), 2), dtype="<u8")
                index[:, 0] = block["log_time"]
                index[:, 1] = at + np.arange(len(block)) * block.dtype.itemsize
                indices.append((channel, index))
                body.append(block.tobytes())
                at += len(body[-1])
        for channel, messages in self._pending.items():
            index = np.empty((len(messages), 2), dtype="<u8")
            for k, (time, data) in enumerate(messages):
                sequence = self._sequence[channel] = self._sequence.get(channel, 0) + 1
                index[k] = time, at
                body += [MESSAGE.pack(Opcode.MESSAGE, len(data) + 22, channel, sequence, time, time), data]
                at += MESSAGE.size + len(data)
            indices.append((channel, index))
        self._pending = {}
        if body:
            self._chunk(b"".join(body), indices)
        self._file.flush()

    def close(self) -> None:
        """Write what is pending and the end of the file."""
        self.flush([])
        self._put(self._summary.write(self._at))
        self._file.close()

    def _chunk(self, body: bytes, indices: list[Index]) -> None:
        times = [int(time) for _, index in indices for time in (index[0, 0], index[-1, 0])]
        data = self._compressor.compress(body)
        start = self._at
        chunk = ChunkRecord(
            compression="zstd",
            data=data,
            message_start_time=min(times),
            message_end_time=max(times),
            uncompressed_crc=zlib.crc32(body),
            uncompressed_size=len(body),
        )
        self._record(chunk)
        length = self._at - start
        offsets: dict[int, int] = {}
        for channel, index in indices:
            offsets[channel] = self._at
            self._put(INDEX.pack(Opcode.MESSAGE_INDEX, index.nbytes + 6, channel, index.nbytes) + index.tobytes())
            self._summary.counts[channel] += len(index)
        self._summary.done(index_of(chunk, start, length, offsets=offsets, indices=self._at - start - length))

    def _record(self, record: Any) -> None:
        builder = RecordBuilder()
        record.write(builder)
        self._put(builder.end())

    def _put(self, data: bytes) -> None:
        self._file.write(data)
        self._at += len(data)


def index_of(chunk: ChunkRecord, start: int, length: int, *, offsets: dict[int, int], indices: int) -> ChunkIndex:
    """The index of a chunk at byte `start`, `length` long, followed by `indices` bytes of message indices."""
    return ChunkIndex(
        chunk_length=length,
        chunk_start_offset=start,
        compression=chunk.compression,
        compressed_size=len(chunk.data),
        message_end_time=chunk.message_end_time,
        message_index_length=indices,
        message_index_offsets=offsets,
        message_start_time=chunk.message_start_time,
        uncompressed_size=chunk.uncompressed_size,
    )
