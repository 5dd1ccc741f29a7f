"""Reads log.mcap into numpy, also one that a killed process left without its end."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.files.checked import ABSENT, BadInput
from app.log.events_file import EventLine
from app.log.foxglove import NANOSECONDS
from app.log.integrity import MENDED, Contents, missing, refusal
from app.log.layout import CODES, LATER, STATE, TRUTH, Field, record
from app.log.recorded_messages import FramesMessage, PendantMessage, SettingsMessage
from app.log.scan import Scan, scanned
from pendant.events.event import Kind
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.arm_problems import problems

T = TypeVar("T")

TOPICS = {"/state": "cdr", "/truth": "cdr", "/pendant": "json", "/tf": "json", "/events": "json", "/settings": "json"}
"""What a recording has, and how its messages are packed."""


@dataclass(slots=True)
class Log:
    """A recorded run.

    `state` and `truth` have for each name of app.log.layout an array with a row a tick: (k,) or (k, size); `state` the codes too.
    """

    path: Path
    whole: bool  # it has its end
    missing: str  # what of the run is not there, in words; "" where all of it is
    run: dict[str, str]  # title, version, robot, seed, hash of the settings
    arm: Arm
    scenario: Scenario
    ticks: NDArray[np.int64]  # (k,)
    state: dict[str, NDArray[Any]]
    truth: dict[str, NDArray[Any]]
    events: list[EventLine]
    pictures: list[PendantMessage]  # at 60 Hz
    frames: list[dict[str, list[float]]]  # poses in W by name, at the ticks of `pictures`
    settings: list[tuple[int, dict[str, Any]]]  # the tick from which they hold

    @property
    def t(self) -> NDArray[np.float64]:
        """(k,) time of each tick [s]."""
        return np.multiply(self.ticks, TICK, dtype=np.float64)


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


def _log(path: Path, scan: Scan) -> Log:
    arm = msgspec.json.decode(scan.files["arm.json"], type=Arm)
    scenario = msgspec.json.decode(scan.files["scenario.json"], type=Scenario)
    for field_name, value, allowed in problems(arm):
        raise ValueError(f"arm.json: {field_name} = {value!r}: {allowed}")
    kinds = {channel.topic: channel.message_encoding for channel in scan.summary.channels.values()}
    for topic, encoding in TOPICS.items():
        if topic not in kinds:
            raise KeyError(topic)
        if kinds[topic] != encoding:
            raise ValueError(f"{topic} is {kinds[topic]}, not {encoding}")
    run = scan.notes["run"]
    ticks, state = _columns(scan, "/state", STATE, arm.n, codes=CODES)
    truth_ticks, truth = _columns(scan, "/truth", TRUTH, arm.n)
    pictures = _decoded(scan, "/pendant", PendantMessage)
    frames = {time: each.poses() for time, each in _timed(scan, "/tf", FramesMessage)}
    events = _decoded(scan, "/events", EventLine)
    for event in events:
        Kind(event.kind)
    settings = _decoded(scan, "/settings", SettingsMessage)
    found = Contents(ticks, truth_ticks, state, [each.tick for each in pictures], list(frames.values()))
    why = refusal(found, arm, scenario)
    if why:
        raise ValueError(why)
    gone = missing(found, scan.lost, scan.notes.get(MENDED, {}).get("lost", ""), run.get("planned", ""))
    both, mine, theirs = np.intersect1d(ticks, truth_ticks, return_indices=True)
    pictures = [each for each in pictures if each.tick * NANOSECONDS in frames]
    return Log(
        path,
        scan.whole,
        gone,
        run,
        arm,
        scenario,
        both,
        {name: column[mine] for name, column in state.items()},
        {name: column[theirs] for name, column in truth.items()},
        events,
        pictures,
        [frames[each.tick * NANOSECONDS] for each in pictures],
        [(each.tick, each.values) for each in settings],
    )


def _timed(scan: Scan, topic: str, kind: type[T]) -> list[tuple[int, T]]:
    """The messages of a topic with their times [ns]."""
    try:
        return [(time, msgspec.json.decode(content, type=kind)) for time, content in scan.messages.get(topic, [])]
    except msgspec.MsgspecError as error:
        raise ValueError(f"{topic}: {error}") from None


def _decoded(scan: Scan, topic: str, kind: type[T]) -> list[T]:
    return [message for _, message in _timed(scan, topic, kind)]


def _columns(
    scan: Scan, topic: str, fields: tuple[Field, ...], n: int, *, codes: tuple[str, ...] = ()
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Packed messages of a topic as arrays by name, with their ticks. Which names they have their own schema says."""
    rows, text = scan.packed.get(topic, []), _schema(scan, topic)
    written = [(name, int(size or 1)) for size, name in re.findall(r"^float64(?:\[(\d{1,3})\])? (\w+)", text, re.MULTILINE)]
    known = {name for name, _ in written}
    sizes = {each.name: each.size or n for each in fields}
    wanted = {name: size for name, size in sizes.items() if name not in LATER or name.lower() in known}
    if written != [(name.lower(), size) for name, size in wanted.items()]:
        raise ValueError(f"{topic} has other columns")
    whole = record(sum(wanted.values()), len(codes))
    kind = np.dtype([(name, whole.fields[name][0]) for name in ("cdr", "tick", "numbers", "codes")])  # type: ignore[index]
    if any(len(row) != kind.itemsize for row in rows):
        raise ValueError("messages of another length")
    table = np.frombuffer(b"".join(rows), dtype=kind)
    numbers, columns, at = table["numbers"], {}, 0
    for name, size in sizes.items():
        if name not in wanted:
            columns[name] = np.full((len(rows), size)[: 1 if size == 1 else 2], np.nan)
            continue
        columns[name] = numbers[:, at] if size == 1 else numbers[:, at : at + size]
        at += size
    columns |= {name: table["codes"][:, i] for i, name in enumerate(codes)}
    return table["tick"].astype(np.int64), columns


def _schema(scan: Scan, topic: str) -> str:
    number = next(each.schema_id for each in scan.summary.channels.values() if each.topic == topic)
    if number not in scan.summary.schemas:
        raise ValueError(f"{topic} has no schema")
    return scan.summary.schemas[number].data.decode()
