"""Opens an MCAP file: finds the places of its parts, and reads none of its messages.

They are in the summary at the file's end. In a file without its end they are found by reading record after record.
"""

import os
import struct
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import AttachmentIndex, Header, MetadataIndex, Statistics

from app.files.bad_input import ABSENT, BadInput
from app.files.regular_file import open_regular
from app.mcap_file.chunk_table import HEAD, UNREADABLE, ChunkTable, bounded, damaged, declare, stream, take_chunk, take_note
from app.mcap_file.file_summary import MAGIC, FileSummary
from app.mcap_file.walk import Walk

CHUNK_INDEX, ENTRY = struct.Struct("<QQQQI"), struct.Struct("<HQ")
"""A chunk's index: times of its first and last message, place, length, bytes of its entries. An entry: channel, place of its
message index."""

LONGEST_HEADER = 1 << 16
"""Largest length of the first record, the header [bytes]."""

FOOTER = struct.Struct("<BQQQI")
"""Opcode, length, place of the summary, place of its offsets, check sum."""


def open_table(path: Path) -> ChunkTable:
    """Open a file.

    Raises:
        BadInput: it cannot be read, is no MCAP file, or is damaged before its last record.
    """
    table = _opened(path)
    try:
        if not _by_its_end(table):
            Walk(table).through(lambda chunk: None)
    except BaseException:
        table.close()
        raise
    return table


def summary_of_cut(path: Path) -> tuple[FileSummary, ChunkTable] | None:
    """The summary that is missing at the end of a file, and its table; None: it is not missing. Raises BadInput as
    `open_table`."""
    table = _opened(path)
    if _by_its_end(table):
        table.close()
        return None
    walk = Walk(table)
    walk.through(walk.summary.done)
    return walk.summary, table


def _opened(path: Path) -> ChunkTable:
    file = open_regular(path)
    table = ChunkTable(path, file, os.fstat(file.fileno()).st_size)
    if os.pread(file.fileno(), len(MAGIC), 0) != MAGIC:
        table.close()
        raise BadInput(path.name, "", ABSENT, "is no MCAP file")
    try:
        _must_begin(table)
    except UNREADABLE as error:
        table.close()
        raise damaged(path, len(MAGIC), error) from None
    return table


def _must_begin(table: ChunkTable) -> None:
    """Read the first record. Raises one of UNREADABLE: this is not a header."""
    head = table.read(len(MAGIC), HEAD)
    length = int.from_bytes(head[1:], "little")
    if head[0] != Opcode.HEADER or length > LONGEST_HEADER:
        raise ValueError("no header")
    Header.read(stream(table.read(len(MAGIC) + HEAD, length)))


def _by_its_end(table: ChunkTable) -> bool:
    """Take in the summary at the file's end; False: it is missing or damaged, or does not list the chunks."""
    tail = FOOTER.size + len(MAGIC)
    if table.size < len(MAGIC) + tail:
        return False
    last = table.read(table.size - tail, tail)
    code, length, start, *_ = FOOTER.unpack_from(last)
    if not last.endswith(MAGIC) or code != Opcode.FOOTER or length != FOOTER.size - HEAD:
        return False
    if not len(MAGIC) <= start <= table.size - tail:
        return False
    try:
        if _summary(table, table.read(start, table.size - tail - start)):
            table.end = start
            return True
    except UNREADABLE:
        pass
    table.forget()
    return False


def _summary(table: ChunkTable, data: bytes) -> bool:
    """Take in the records of the summary. Returns whether they list all chunks."""
    at, chunks, counted = 0, 0, -1
    while at < len(data):
        code, length = data[at], int.from_bytes(data[at + 1 : at + HEAD], "little")
        body = data[at + HEAD : at + HEAD + length]
        if len(body) != length:
            raise EOFError
        if code == Opcode.CHUNK_INDEX:
            _, _, place, length_, size = CHUNK_INDEX.unpack_from(body)
            indices = ENTRY.iter_unpack(body[CHUNK_INDEX.size : CHUNK_INDEX.size + size])
            take_chunk(table, place, length_, indices)
            chunks += 1
        elif code == Opcode.ATTACHMENT_INDEX:
            index = AttachmentIndex.read(stream(body))
            table.attachments[index.name] = (index.offset, index.length)
        elif code == Opcode.METADATA_INDEX:
            place = MetadataIndex.read(stream(body))
            take_note(table, table.read(place.offset, bounded(place.length))[HEAD:])
        elif code == Opcode.STATISTICS:
            counted = Statistics.read(stream(body)).chunk_count
        else:
            declare(table, code, body)
        at += HEAD + length
    return chunks == counted
