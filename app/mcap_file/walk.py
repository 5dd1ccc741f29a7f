"""Reads an MCAP file record by record, also a file that a killed process left without its end."""

import os
import struct
from collections.abc import Callable

from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, ChunkIndex, MetadataIndex

from app.mcap_file.chunk_body import CHUNK, chunk_body, head_of, records_of
from app.mcap_file.chunk_table import HEAD, UNREADABLE, ChunkTable, bounded, damaged, declare, stream, take_chunk, take_note
from app.mcap_file.file_summary import MAGIC, FileSummary


class Walk:
    """Reads the records of a file; the last record may be cut."""

    def __init__(self, table: ChunkTable) -> None:
        self._table = table
        self.summary = FileSummary()
        self._chunk: ChunkIndex | None = None  # the chunk whose message indices follow
        self._counts: dict[int, int] = {}  # number of its messages, by channel

    def through(self, done: Callable[[ChunkIndex], None]) -> None:
        """Take in all records; `done` is called with each whole chunk. Raises BadInput: the file is damaged before its last
        record."""
        table, at = self._table, len(MAGIC)
        ended = False
        while at + HEAD <= table.size:
            head = table.read(at, HEAD)
            code, length = head[0], int.from_bytes(head[1:], "little")
            stop = at + HEAD + length
            if stop > table.size:
                break
            try:
                if code == Opcode.DATA_END:
                    ended = table.size > stop and os.pread(table.file.fileno(), len(MAGIC), table.size - len(MAGIC)) == MAGIC
                    break
                self._take(code, at, stop, done)
            except UNREADABLE as error:
                raise damaged(table.path, at, error) from None
            at = stop
        # If a message index is cut, its chunk is dropped, too: else the file would have messages that are not counted.
        last = self._chunk
        table.end = at
        try:
            if last is not None and not ended and channels_of(self._body(last)) - last.message_index_offsets.keys():
                table.end = last.chunk_start_offset
                self._chunk = None
            self._finish(done)
        except UNREADABLE as error:
            raise damaged(table.path, at, error) from None
        table.lost = -1 if ended else table.size - table.end
        self.summary.schemas, self.summary.channels = dict(table.schemas), dict(table.channels)
        self.summary.counts = {channel: self.summary.counts.get(channel, 0) for channel in table.channels}

    def _take(self, code: int, at: int, stop: int, done: Callable[[ChunkIndex], None]) -> None:
        table = self._table
        if code == Opcode.CHUNK:
            self._finish(done)
            self._chunk, self._counts = _index(table, at, stop), {}
            return
        if code == Opcode.MESSAGE_INDEX:
            channel, size = struct.unpack("<HI", table.read(at + HEAD, 6))
            last = self._chunk
            if last is None:
                raise ValueError("a message index without its chunk")
            last.message_index_offsets[channel] = at
            last.message_index_length += stop - at
            self._counts[channel] = size // 16
            return
        self._finish(done)
        body = table.read(at + HEAD, bounded(stop - at - HEAD))
        if code == Opcode.ATTACHMENT:
            self._attachment(body, at, stop)
        elif code == Opcode.METADATA:
            self.summary.metadata.append(MetadataIndex(offset=at, length=stop - at, name=take_note(table, body)))
        else:
            declare(table, code, body)

    def _attachment(self, body: bytes, at: int, stop: int) -> None:
        found = Attachment.read(stream(body))
        self._table.attachments[found.name] = (at, stop - at)
        self.summary.attachments.append(
            AttachmentIndex(
                offset=at,
                length=stop - at,
                log_time=found.log_time,
                create_time=found.create_time,
                data_size=len(found.data),
                name=found.name,
                media_type=found.media_type,
            )
        )

    def _finish(self, done: Callable[[ChunkIndex], None]) -> None:
        """Take in the last chunk, whose message indices are complete."""
        chunk, self._chunk = self._chunk, None
        if chunk is None:
            return
        if chunk.message_index_offsets.keys() - self._table.channels.keys():  # other writers declare channels inside chunks
            for code, body in records_of(self._body(chunk)):
                declare(self._table, code, body)
        take_chunk(self._table, chunk.chunk_start_offset, chunk.chunk_length, chunk.message_index_offsets.items())
        for channel, count in self._counts.items():
            self.summary.counts[channel] = self.summary.counts.get(channel, 0) + count
        done(chunk)

    def _body(self, chunk: ChunkIndex) -> bytes:
        return chunk_body(self._table.read(chunk.chunk_start_offset, chunk.chunk_length))


def channels_of(body: bytes) -> set[int]:
    """The channels that have messages in a chunk."""
    return {int.from_bytes(each[:2], "little") for code, each in records_of(body) if code == Opcode.MESSAGE}


def _index(table: ChunkTable, at: int, stop: int) -> ChunkIndex:
    """The index of a chunk, without the fields that its message indices give."""
    head = head_of(table.read(at, min(CHUNK, stop - at)))
    return ChunkIndex(
        chunk_length=stop - at,
        chunk_start_offset=at,
        compression=head.compression,
        compressed_size=head.compressed_size,
        message_end_time=head.last,
        message_index_length=0,
        message_index_offsets={},
        message_start_time=head.first,
        uncompressed_size=head.uncompressed_size,
    )
