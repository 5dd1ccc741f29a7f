"""Goes through the bytes of a recording, also of one that a killed process left without its end, and puts that end back."""

import io
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import zstandard
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    Header,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
)

from app.files.checked import ABSENT, BadInput
from app.log.container import MAGIC, FileSummary, index_of
from app.log.integrity import MENDED

LARGEST = 2**28
"""Largest chunk that is unpacked [bytes]."""

UNREADABLE = (EndOfFile, McapError, struct.error, zstandard.ZstdError, ValueError, KeyError, IndexError, OverflowError)
"""What goes wrong where bytes are not what they should be."""


@dataclass(slots=True)
class Scan:
    """What a pass over a file finds."""

    summary: FileSummary = field(default_factory=FileSummary)
    end: int = 0  # of the last whole record of data [bytes]
    lost: int = -1  # bytes that follow it without making a whole chunk; -1: the file's end follows
    files: dict[str, bytes] = field(default_factory=dict)
    notes: dict[str, dict[str, str]] = field(default_factory=dict)
    messages: dict[str, list[tuple[int, bytes]]] = field(default_factory=dict)  # by topic, in order, with their times [ns]
    packed: dict[str, list[bytes]] = field(default_factory=dict)
    last: set[int] = field(default_factory=set)  # channels of the last chunk

    @property
    def whole(self) -> bool:
        """The file has its end."""
        return self.lost < 0


def repair(path: Path) -> bool:
    """Put back the end that a killed process did not write; True if it was missing. What follows the last whole chunk is cut.

    Raises:
        BadInput: the file cannot be read or written, or is no log.
    """
    try:
        data = path.read_bytes()
        scan = scanned(data, path.name)
        if scan.whole:
            return False
        note = RecordBuilder()
        Metadata(name=MENDED, metadata={"lost": str(len(data) - scan.end)}).write(note)
        record = note.end()
        scan.summary.metadata.append(MetadataIndex(offset=scan.end, length=len(record), name=MENDED))
        with path.open("r+b") as file:
            file.truncate(scan.end)
            file.seek(scan.end)
            file.write(record + scan.summary.write(scan.end + len(record)))
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"cannot be repaired ({error.strerror})") from None
    return True


def scanned(data: bytes, where: str) -> Scan:
    """Go through the records of a file; the last one may be cut.

    Raises:
        BadInput: it is no MCAP file, or damaged before its last record.
    """
    if not data.startswith(MAGIC):
        raise BadInput(where, "", ABSENT, "is no MCAP file")
    scan, at, size = Scan(end=len(MAGIC)), len(MAGIC), len(data)
    ended = False
    while at + 9 <= size:
        code, length = data[at], int.from_bytes(data[at + 1 : at + 9], "little")
        stop = at + 9 + length
        if stop > size:
            break
        try:
            if code == Opcode.DATA_END:
                ended = data.endswith(MAGIC) and size > stop
                break
            _take(scan, code, data, at=at, stop=stop)
        except UNREADABLE as error:
            raise BadInput(where, f"byte {at}", ABSENT, f"is damaged ({str(error) or type(error).__name__})") from None
        at = scan.end = stop
    scan.lost = -1 if ended else size - scan.end
    chunks = scan.summary.chunks
    if chunks and not ended and scan.last - chunks[-1].message_index_offsets.keys():
        # Cut between a chunk and its index: with the index goes the chunk, or its messages would be there and not counted.
        shorter = scanned(data[: chunks[-1].chunk_start_offset], where)
        shorter.lost = size - shorter.end
        return shorter
    return scan


def _take(scan: Scan, code: int, data: bytes, *, at: int, stop: int) -> None:
    """Take in one record of the file's data."""
    summary = scan.summary
    stream = ReadDataStream(io.BytesIO(data[at + 9 : stop]))
    if code in (Opcode.SCHEMA, Opcode.CHANNEL):
        _declare(summary, code, stream)
    elif code == Opcode.ATTACHMENT:
        attachment = Attachment.read(stream)
        scan.files[attachment.name] = attachment.data
        index = AttachmentIndex(
            offset=at,
            length=stop - at,
            log_time=attachment.log_time,
            create_time=attachment.create_time,
            data_size=len(attachment.data),
            name=attachment.name,
            media_type=attachment.media_type,
        )
        summary.attachments.append(index)
    elif code == Opcode.METADATA:
        note = Metadata.read(stream)
        scan.notes[note.name] = note.metadata
        summary.metadata.append(MetadataIndex(offset=at, length=stop - at, name=note.name))
    elif code == Opcode.CHUNK:
        chunk = Chunk.read(stream)
        _unpack(scan, chunk)
        summary.chunks.append(index_of(chunk, at, stop - at, offsets={}, indices=0))
    elif code == Opcode.MESSAGE_INDEX:
        index = MessageIndex.read(stream)
        last: ChunkIndex = summary.chunks[-1]
        last.message_index_offsets[index.channel_id] = at
        last.message_index_length += stop - at
        summary.counts[index.channel_id] += len(index.records)
    elif code == Opcode.HEADER:
        Header.read(stream)


def _declare(summary: FileSummary, code: int, stream: ReadDataStream) -> None:
    """Take in a schema or a channel."""
    if code == Opcode.SCHEMA:
        schema = Schema.read(stream)
        summary.schemas[schema.id] = schema
    else:
        channel = Channel.read(stream)
        summary.channels[channel.id] = channel
        summary.counts.setdefault(channel.id, 0)


def _unpack(scan: Scan, chunk: Chunk) -> None:
    if chunk.uncompressed_size > LARGEST or chunk.compression != "zstd":
        raise ValueError("a chunk that is too large, or packed in another way")
    body = zstandard.ZstdDecompressor().decompress(chunk.data, max_output_size=chunk.uncompressed_size)
    if len(body) != chunk.uncompressed_size or zlib.crc32(body) != chunk.uncompressed_crc:
        raise ValueError("wrong check sum")
    at = 0
    channels = scan.summary.channels
    scan.last = set()
    while at < len(body):
        code, length = struct.unpack_from("<BQ", body, at)
        if code in (Opcode.SCHEMA, Opcode.CHANNEL):  # other writers put them into the chunks
            _declare(scan.summary, code, ReadDataStream(io.BytesIO(body[at + 9 : at + 9 + length])))
            at += 9 + length
            continue
        (number,) = struct.unpack_from("<H", body, at + 9)
        scan.last.add(number)
        topic = channels[number].topic
        content = body[at + 31 : at + 9 + length]
        if code != Opcode.MESSAGE or at + 9 + length > len(body):
            raise ValueError("a message is cut")
        if channels[number].message_encoding == "cdr":
            scan.packed.setdefault(topic, []).append(content)
        else:
            (time,) = struct.unpack_from("<Q", body, at + 15)
            scan.messages.setdefault(topic, []).append((time, content))
        at += 9 + length
