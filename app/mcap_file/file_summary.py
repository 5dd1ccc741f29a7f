"""The summary at the end of an MCAP file, by which a reader finds the rest; made while writing, or again from a cut file."""

from mcap.data_stream import RecordBuilder
from mcap.records import (
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    MetadataIndex,
    Schema,
    Statistics,
)
from mcap.records import Chunk as ChunkRecord

MAGIC = b"\x89MCAP0\r\n"


class FileSummary:
    """The summary at a file's end: made while writing, or again from a file without its end.

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
        self._done = bytearray()  # indices of chunks that do not change any more, as bytes of the file
        self._done_count = 0
        self._span: list[int] = []  # times of the first and the last message in them [ns]

    def done(self, chunk: ChunkIndex) -> None:
        """Add the index of a chunk that will not change. It is kept as bytes, because a day has 345,600 of them."""
        builder = RecordBuilder()
        chunk.write(builder)
        self._done += builder.end()
        self._done_count += 1
        times = (*self._span, chunk.message_start_time, chunk.message_end_time)
        self._span = [min(times), max(times)]

    @property
    def size(self) -> int:
        """Approximate size of the result of `write` [bytes]."""
        return len(self._done) + sum(len(each.data) for each in self.schemas.values()) + (1 << 12)

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
