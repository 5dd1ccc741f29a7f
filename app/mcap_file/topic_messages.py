"""The messages of one topic in an MCAP file, by their number: read chunk by chunk, as far as they are asked for."""

import struct
from collections import OrderedDict, deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from app.mcap_file.chunk_body import chunk_body
from app.mcap_file.chunk_table import UNREADABLE, ChunkTable, damaged
from app.mcap_file.runs import Runs

KEPT = 4
"""Number of unpacked chunks that are kept: a reader that goes message by message mostly needs the same chunk again."""

UNPACKING = 2
"""Number of threads that unpack chunks, beside the reading thread."""

AHEAD = 6
"""Number of chunks that are unpacked ahead."""

INDEX = struct.Struct("<BQHI")
"""Start of a message index: opcode, length, channel, bytes of the pairs that follow."""

GUESS = INDEX.size + 16 * 160
"""A size that most message indices do not exceed [bytes]."""

MESSAGE = struct.Struct("<BQHIQQ")
"""Start of a message: opcode, length, channel, sequence, log and publish time."""

Offsets = NDArray[np.int64]


class Messages:
    """The messages of a topic. To make this takes a time that grows with the number of chunks; it reads no messages.

    Args:
        table: of the file.
        topic: such as /state.
        unit: of `times` [ns].

    Attributes:
        times: of the messages, from the indices of their chunks, in units.

    Raises:
        BadInput: an index is damaged.
        KeyError: the file has no such topic.
        ValueError: a time is not a whole number of units.
    """

    def __init__(self, table: ChunkTable, topic: str, unit: int) -> None:
        self._table = table
        self.channel = table.channel_of(topic)
        self._chunks = table.chunks_of(self.channel)
        pairs = [self._index(k)[:, 0] for k in range(len(self._chunks))]
        self._first = np.cumsum([0, *map(len, pairs)])  # number of the first message in each chunk, and of all
        times, rest = np.divmod(np.concatenate(pairs) if pairs else np.zeros(0, dtype=np.int64), unit)
        if bool(np.any(rest)):
            raise ValueError(f"{topic} has messages at odd times")
        self.times = Runs(times)
        self._bodies: OrderedDict[int, bytes] = OrderedDict()

    def __len__(self) -> int:
        return int(self._first[-1])

    def rows(self, begin: int, end: int, kind: np.dtype) -> np.ndarray:
        """Whole message records, of a topic whose messages are all of one length.

        Args:
            begin: number of the first.
            end: number after the last.
            kind: of a record, from its opcode on, with the fields opcode, length, channel and log_time.

        Raises:
            BadInput: a chunk is damaged, or its messages are of another length.
        """
        out = np.empty(max(0, end - begin), dtype=kind)
        for first, last, body, offsets in self._blocks(begin, end):
            at = first - begin
            try:
                out[at : at + last - first] = self._records(body, offsets, kind)
            except UNREADABLE as error:
                raise self._damaged(first, error) from None
        return out

    def contents(self, begin: int, end: int) -> Iterator[bytes]:
        """The content of each message from number `begin` to before `end`. Raises BadInput: a chunk is damaged."""
        for first, _, body, offsets in self._blocks(begin, end):
            try:
                found = [self._content(body, int(offset)) for offset in offsets]
            except UNREADABLE as error:
                raise self._damaged(first, error) from None
            yield from found

    def _records(self, body: bytes, offsets: Offsets, kind: np.dtype) -> np.ndarray:
        size = kind.itemsize
        if offsets[0] < 0 or offsets[-1] + size > len(body):
            raise ValueError("a message is cut")
        if bool(np.all(np.diff(offsets) == size)):
            found = np.frombuffer(body, kind, len(offsets), int(offsets[0]))
        else:
            found = np.frombuffer(b"".join(body[offset : offset + size] for offset in offsets.tolist()), kind)
        if not bool(np.all((found["opcode"] == Opcode.MESSAGE) & (found["length"] == size - 9))):
            raise ValueError("messages of another length")
        if not bool(np.all(found["channel"] == self.channel)):
            raise ValueError("messages of another channel")
        return found

    def _content(self, body: bytes, offset: int) -> bytes:
        code, length, channel, *_ = MESSAGE.unpack_from(body, offset)
        stop = offset + 9 + length
        if code != Opcode.MESSAGE or channel != self.channel or stop > len(body):
            raise ValueError("a message is cut")
        return body[offset + MESSAGE.size : stop]

    def _blocks(self, begin: int, end: int) -> Iterator[tuple[int, int, bytes, Offsets]]:
        """For each chunk: number of the first wanted message, number after the last one, content of the chunk, their places in
        it."""
        if end <= begin:
            return
        low = int(np.searchsorted(self._first, begin, side="right")) - 1
        high = int(np.searchsorted(self._first, end, side="left"))
        for k, body in self._unpacked(range(low, high)):
            start = int(self._first[k])
            first, last = max(begin, start), min(end, int(self._first[k + 1]))
            yield first, last, body, self._index(k)[first - start : last - start, 1]

    def _unpacked(self, chunks: range) -> Iterator[tuple[int, bytes]]:
        if len(chunks) <= KEPT:
            for k in chunks:
                yield k, self._kept(k)
            return
        waiting = deque((k, _unpacking().submit(self._body, k)) for k in chunks[:AHEAD])
        for k in chunks:
            number, unpacked = waiting.popleft()
            if k + AHEAD < chunks.stop:
                waiting.append((k + AHEAD, _unpacking().submit(self._body, k + AHEAD)))
            yield number, unpacked.result()

    def _kept(self, k: int) -> bytes:
        body = self._bodies.pop(k, None)
        if body is None:
            body = self._body(k)
        self._bodies[k] = body
        if len(self._bodies) > KEPT:
            self._bodies.popitem(last=False)
        return body

    def _body(self, k: int) -> bytes:
        place, length, _ = self._chunks[k].tolist()
        try:
            return chunk_body(self._table.read(place, length))
        except (*UNREADABLE, OSError) as error:
            raise damaged(self._table.path, place, error) from None

    def _index(self, k: int) -> NDArray[np.int64]:
        """(m, 2) times [ns] and places of the messages in a chunk."""
        place = int(self._chunks[k, 2])
        try:
            data = self._table.read(place, min(GUESS, self._table.size - place))
            code, length, channel, size = INDEX.unpack_from(data)
            if code != Opcode.MESSAGE_INDEX or channel != self.channel or size % 16 or length != size + 6:
                raise ValueError("no index of these messages")
            if INDEX.size + size > len(data):
                data = self._table.read(place, INDEX.size + size)
        except (*UNREADABLE, OSError) as error:
            raise damaged(self._table.path, place, error) from None
        return np.frombuffer(data, "<i8", size // 8, INDEX.size).reshape(-1, 2)

    def _damaged(self, number: int, error: BaseException) -> Exception:
        k = int(np.searchsorted(self._first, number, side="right")) - 1
        return damaged(self._table.path, int(self._chunks[k, 0]), error)


@cache
def _unpacking() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(UNPACKING, thread_name_prefix="unpacking")
