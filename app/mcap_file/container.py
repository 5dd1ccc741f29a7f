"""Writes an MCAP file chunk by chunk, each one whole, so that after a crash or on a full disk only the last ones are lost.

The records are the mcap library's; messages that come as numpy rows are laid out here, since one call a message would cost
more than the tick that they record.
"""

import os
import stat
import struct
import zlib
from collections.abc import Mapping
from contextlib import suppress
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, Channel, ChunkIndex, Header, Metadata, MetadataIndex, Schema
from mcap.records import Chunk as ChunkRecord

from app.files.bad_input import ABSENT, BadInput
from app.mcap_file.file_summary import MAGIC, FileSummary, index_of

LEVEL = 1
"""Level of compression: the fastest."""

MESSAGE = struct.Struct("<BQHIQQ")
"""Start of a message: opcode, length, channel, sequence, log and publish time."""

INDEX = struct.Struct("<BQHI")
"""Start of a message index: opcode, length, channel, bytes of the pairs that follow."""

Index = tuple[int, np.ndarray[Any, Any]]
"""A channel, and time [ns] and offset of each of its messages in a chunk, (k, 2)."""


class Container:
    """An MCAP file being written. Used by one thread at a time.

    Raises:
        BadInput: the file cannot be written.
    """

    def __init__(self, path: Path, library: str) -> None:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NONBLOCK | os.O_CLOEXEC  # a pipe would wait for its reader
            self._file = FileIO(os.open(path, flags, 0o644), "w")
        except OSError as error:
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._regular = stat.S_ISREG(os.fstat(self._file.fileno()).st_mode)
        self._summary = FileSummary()
        self._at = 0  # end of the last whole record [bytes]
        self._together: dict[int, str] = {}  # of each channel: `together` as declared
        self._pending: dict[str, list[tuple[int, int, bytes]]] = {}
        self._sequence: dict[int, int] = {}
        self._compressor = zstandard.ZstdCompressor(level=LEVEL)
        try:
            self._put(MAGIC)
            self._record(Header(profile="", library=library))
        except OSError as error:
            self._file.close()
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None

    @property
    def end(self) -> int:
        """Approximate size of the file's end [bytes]."""
        return self._summary.size

    def channel(
        self,
        topic: str,
        schema: str,
        text: str,
        *,
        encoding: str,
        of_schema: str,
        together: str,
        metadata: Mapping[str, str] = {},
    ) -> int:
        """Declare a topic. Returns the number of its channel.

        Args:
            topic: such as /state.
            schema: name of its messages' schema.
            text: the schema.
            encoding: of the messages: "cdr" or "json".
            of_schema: "ros2msg" or "jsonschema".
            together: topics with the same word share their chunks; a reader of other topics need not read these.
        """
        summary = self._summary
        known = next((number for number, each in summary.schemas.items() if each.name == schema), None)
        if known is None:
            known = len(summary.schemas) + 1
            summary.schemas[known] = Schema(data=text.encode(), encoding=of_schema, id=known, name=schema)
            self._record(summary.schemas[known])
        number = len(summary.channels) + 1
        summary.channels[number] = Channel(id=number, topic=topic, message_encoding=encoding, metadata={}, schema_id=known)
        self._record(summary.channels[number])
        summary.counts[number] = 0
        self._together[number] = together
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
        """Add one message [ns] to those that `flush` writes."""
        self._pending.setdefault(self._together[channel], []).append((channel, time, data))

    def flush(self, rows: list[np.ndarray[Any, Any]]) -> None:
        """Write blocks of whole message records, each of one channel, and the messages of `add`. Each block becomes a chunk, and
        so does each group of added messages whose channels share chunks. Afterwards all of it is in the file, or nothing.

        Raises:
            OSError: the disk is full or gone.
        """
        ready = [_of_rows(block) for block in rows if len(block)]
        ready += [self._of_messages(messages) for messages in self._pending.values()]
        self._pending = {}
        out, chunks = bytearray(), list[tuple[ChunkIndex, list[Index]]]()
        for body, indices in ready:
            chunks.append((self._chunk(out, body, indices), indices))
        self._put(out)
        for chunk, indices in chunks:
            self._summary.done(chunk)
            for channel, index in indices:
                self._summary.counts[channel] += len(index)

    def close(self) -> None:
        """Write what is pending and the end of the file. Raises OSError: the disk is full or gone."""
        self.flush([])
        self._put(self._summary.write(self._at))
        self._file.close()

    def abandon(self) -> None:
        """End the file after its last whole record, because nothing more can be written; with its end if there is room for it."""
        with suppress(OSError):
            self._put(self._summary.write(self._at))
        with suppress(OSError):
            self._file.close()

    def _of_messages(self, messages: list[tuple[int, int, bytes]]) -> tuple[bytes, list[Index]]:
        body: list[bytes] = []
        places: dict[int, list[tuple[int, int]]] = {}
        at = 0
        for channel, time, data in messages:
            sequence = self._sequence[channel] = self._sequence.get(channel, 0) + 1
            places.setdefault(channel, []).append((time, at))
            body += [MESSAGE.pack(Opcode.MESSAGE, len(data) + 22, channel, sequence, time, time), data]
            at += MESSAGE.size + len(data)
        return b"".join(body), [(channel, np.array(found, dtype="<u8")) for channel, found in places.items()]

    def _chunk(self, out: bytearray, body: bytes, indices: list[Index]) -> ChunkIndex:
        """Append a chunk with its message indices to `out`."""
        times = [int(time) for _, index in indices for time in (index[0, 0], index[-1, 0])]
        chunk = ChunkRecord(
            compression="zstd",
            data=self._compressor.compress(body),
            message_start_time=min(times),
            message_end_time=max(times),
            uncompressed_crc=zlib.crc32(body),
            uncompressed_size=len(body),
        )
        start = len(out)
        out += _bytes_of(chunk)
        length = len(out) - start
        offsets: dict[int, int] = {}
        for channel, index in indices:
            offsets[channel] = self._at + len(out)
            out += INDEX.pack(Opcode.MESSAGE_INDEX, index.nbytes + 6, channel, index.nbytes) + index.tobytes()
        return index_of(chunk, self._at + start, length, offsets=offsets, indices=len(out) - start - length)

    def _record(self, record: Any) -> None:
        self._put(_bytes_of(record))

    def _put(self, data: bytes | bytearray) -> None:
        """Write all of it, or raise OSError with the file as it was before."""
        left = memoryview(data)
        try:
            while left:
                left = left[self._file.write(left) or 0 :]
        except OSError:
            if self._regular:
                with suppress(OSError):
                    self._file.truncate(self._at)
                    self._file.seek(self._at)
            raise
        self._at += len(data)


def _bytes_of(record: Any) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()


def _of_rows(block: np.ndarray[Any, Any]) -> tuple[bytes, list[Index]]:
    index = np.empty((len(block), 2), dtype="<u8")
    index[:, 0] = block["log_time"]
    index[:, 1] = np.arange(len(block)) * block.dtype.itemsize
    return block.tobytes(), [(int(block["channel"][0]), index)]
