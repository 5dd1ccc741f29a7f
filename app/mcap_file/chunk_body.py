"""The content of a chunk of an MCAP file: unpacked, and checked against its check sum."""

import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

import zstandard

LARGEST = 1 << 28
"""Largest chunk that is unpacked [bytes]."""

HEAD = struct.Struct("<BQQQQII")
"""Opcode, length, times of the first and the last message [ns], unpacked size, check sum, length of the compression's name."""

CHUNK = 64
"""Bytes at the start of a chunk's record that are enough to read its head."""


class ChunkHead(NamedTuple):
    """The head of a chunk: the fields before its content."""

    first: int  # time [ns]
    last: int
    uncompressed_size: int  # [bytes]
    check_sum: int
    compression: str
    compressed_size: int
    begin: int  # of the content in the record


def head_of(record: bytes) -> ChunkHead:
    """The head of a chunk, from its record or the first bytes of it. Raises struct.error or ValueError: the bytes are not a
    chunk's."""
    _, _, first, last, size, check_sum, length = HEAD.unpack_from(record)
    if length > 16:
        raise ValueError("a chunk that is packed in another way")
    compression = record[HEAD.size : HEAD.size + length].decode("ascii")
    (compressed,) = struct.unpack_from("<Q", record, HEAD.size + length)
    return ChunkHead(first, last, size, check_sum, compression, compressed, HEAD.size + length + 8)


def chunk_body(record: bytes) -> bytes:
    """The content of a whole record of a chunk.

    Raises:
        ValueError, struct.error: it cannot be unpacked, or its check sum is wrong.
    """
    head = head_of(record)
    if head.uncompressed_size > LARGEST or head.compression not in ("zstd", ""):
        raise ValueError("a chunk that is too large, or packed in another way")
    packed = record[head.begin :]
    if len(packed) != head.compressed_size:
        raise ValueError("a chunk that is cut")
    try:
        body = packed
        if head.compression:
            body = zstandard.ZstdDecompressor().decompress(packed, max_output_size=head.uncompressed_size)
    except zstandard.ZstdError as error:
        raise ValueError(str(error)) from None
    if len(body) != head.uncompressed_size or (head.check_sum and zlib.crc32(body) != head.check_sum):
        raise ValueError("wrong check sum")
    return body


def records_of(body: bytes) -> Iterator[tuple[int, bytes]]:
    """Opcode and content of each record in a chunk. Raises ValueError: the last one is cut."""
    at = 0
    while at < len(body):
        if at + 9 > len(body):
            raise ValueError("a message is cut")
        code, length = struct.unpack_from("<BQ", body, at)
        if at + 9 + length > len(body):
            raise ValueError("a message is cut")
        yield code, body[at + 9 : at + 9 + length]
        at += 9 + length
