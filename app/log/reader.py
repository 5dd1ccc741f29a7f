"""Reads log.mcap into numpy, also one that a killed process left without its end, and puts that end back."""

import io
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
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
from numpy.typing import NDArray

from app.files.checked import ABSENT, BadInput
from app.log.container import MAGIC, FileSummary, index_of
from app.log.events_file import EventLine
from app.log.layout import CODES, STATE, TRUTH, record, width
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario

LARGEST = 2**28
"""Largest chunk that is unpacked [bytes]."""

UNREADABLE = (EndOfFile, McapError, struct.error, zstandard.ZstdError, ValueError, KeyError, IndexError, OverflowError)
"""What goes wrong where bytes are not what they should be."""


@dataclass(slots=True)
class Log:
    """A recorded run.

    `state` and `truth` have for each name of app.log.layout an array with a row a tick: (k,) or (k, size); `state` the codes too.
    """

    path: Path
    whole: bool  # it has its end
    run: dict[str, str]  # title, version, robot, seed, hash of the settings
    arm: Arm
    scenario: Scenario
    ticks: NDArray[np.int64]  # (k,)
    state: dict[str, NDArray[Any]]
    truth: dict[str, NDArray[Any]]
    events: list[EventLine]
    pictures: list[dict[str, Any]]  # /pendant, at 60 Hz
    frames: list[dict[str, list[float]]]  # poses in W by name, at the ticks of `pictures`
    settings: list[tuple[int, dict[str, Any]]]  # the tick from which they hold

    @property
    def t(self) -> NDArray[np.float64]:
        """(k,) time of each tick [s]."""
        return np.multiply(self.ticks, TICK, dtype=np.float64)


@dataclass(slots=True)
class Scan:
    """What a pass over a file finds."""

    summary: FileSummary = field(default_factory=FileSummary)
    end: int = 0  # of the last whole record of data [bytes]
    whole: bool = False
    files: dict[str, bytes] = field(default_factory=dict)
    notes: dict[str, dict[str, str]] = field(default_factory=dict)
    messages: dict[str, list[bytes]] = field(default_factory=dict)  # by topic, in order
    packed: dict[str, list[bytes]] = field(default_factory=dict)
    last: set[int] = field(default_factory=set)  # channels of the last chunk


def read(path: Path) -> Log:
    """Read a log.

    Raises:
        BadInput: the file cannot be read, is no log of ours, or is damaged before its last chunk.
    """
    where = path.name
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"cannot be read ({error.strerror})") from None
    scan = scanned(data, where)
    try:
        return _log(path, scan)
    except KeyError as missing:
        raise BadInput(where, "", ABSENT, f"is no recording of pendant: it has no {missing.args[0]}") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise BadInput(where, "", ABSENT, f"is no recording that this version reads ({error})") from None


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
        with path.open("r+b") as file:
            file.truncate(scan.end)
            file.seek(scan.end)
            file.write(scan.summary.write(scan.end))
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
    while at + 9 <= size:
        code, length = data[at], int.from_bytes(data[at + 1 : at + 9], "little")
        stop = at + 9 + length
        if stop > size:
            break
        try:
            if code == Opcode.DATA_END:
                scan.whole = data.endswith(MAGIC) and size > stop
                break
            _take(scan, code, data, at=at, stop=stop)
        except UNREADABLE as error:
            raise BadInput(where, f"byte {at}", ABSENT, f"is damaged ({str(error) or type(error).__name__})") from None
        at = scan.end = stop
    chunks = scan.summary.chunks
    if chunks and not scan.whole and scan.last - chunks[-1].message_index_offsets.keys():
        # Cut between a chunk and its index: with the index goes the chunk, or its messages would be there and not counted.
        return scanned(data[: chunks[-1].chunk_start_offset], where)
    return scan


def _take(scan: Scan, code: int, data: bytes, *, at: int, stop: int) -> None:
    """Take in one record of the file's data."""
    summary = scan.summary
    stream = ReadDataStream(io.BytesIO(data[at + 9 : stop]))
    if code == Opcode.SCHEMA:
        schema = Schema.read(stream)
        summary.schemas[schema.id] = schema
    elif code == Opcode.CHANNEL:
        channel = Channel.read(stream)
        summary.channels[channel.id] = channel
        summary.counts.setdefault(channel.id, 0)
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
        code, length, number = struct.unpack_from("<BQH", body, at)
        scan.last.add(number)
        topic = channels[number].topic
        content = body[at + 31 : at + 9 + length]
        if code != Opcode.MESSAGE or at + 9 + length > len(body):
            raise ValueError("a message is cut")
        kind = scan.packed if channels[number].message_encoding == "cdr" else scan.messages
        kind.setdefault(topic, []).append(content)
        at += 9 + length


def _log(path: Path, scan: Scan) -> Log:
    arm = msgspec.json.decode(scan.files["arm.json"], type=Arm)
    scenario = msgspec.json.decode(scan.files["scenario.json"], type=Scenario)
    topics = {channel.topic for channel in scan.summary.channels.values()}
    for topic in ("/state", "/truth", "/pendant", "/tf", "/events", "/settings"):
        if topic not in topics:
            raise KeyError(topic)
    ticks, state = _columns(scan.packed.get("/state", []), STATE, arm.n, CODES)
    _, truth = _columns(scan.packed.get("/truth", []), TRUTH, arm.n, ())
    said = {topic: [msgspec.json.decode(each) for each in scan.messages.get(topic, [])] for topic in ("/pendant", "/tf")}
    events = [msgspec.json.decode(each, type=EventLine) for each in scan.messages.get("/events", [])]
    settings = [msgspec.json.decode(each) for each in scan.messages.get("/settings", [])]
    return Log(
        path,
        scan.whole,
        scan.notes["run"],
        arm,
        scenario,
        ticks,
        state,
        truth,
        events,
        said["/pendant"],
        [_poses(each) for each in said["/tf"]],
        [(each["tick"], each["values"]) for each in settings],
    )


def _columns(
    rows: list[bytes], fields: tuple[Any, ...], n: int, codes: tuple[str, ...]
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Packed messages as arrays by name, with their ticks."""
    whole = record(width(fields, n), len(codes))
    kind = np.dtype([(name, whole.fields[name][0]) for name in ("cdr", "tick", "numbers", "codes")])  # type: ignore[index]
    if any(len(row) != kind.itemsize for row in rows):
        raise ValueError("messages of another length")
    table = np.frombuffer(b"".join(rows), dtype=kind)
    numbers, columns, at = table["numbers"], {}, 0
    for each in fields:
        size = each.size or n
        columns[each.name] = numbers[:, at] if size == 1 else numbers[:, at : at + size]
        at += size
    columns |= {name: table["codes"][:, i] for i, name in enumerate(codes)}
    return table["tick"].astype(np.int64), columns


def _poses(message: dict[str, Any]) -> dict[str, list[float]]:
    """FrameTransforms as poses by name: position [m], quaternion wxyz."""
    poses: dict[str, list[float]] = {}
    for each in message["transforms"]:
        p, r = each["translation"], each["rotation"]
        poses[each["child_frame_id"]] = [p["x"], p["y"], p["z"], r["w"], r["x"], r["y"], r["z"]]
    return poses
