"""One file of a recording: what it says of itself, and where its ticks and pictures are; nothing of these is read yet."""

from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.log.events_file import EventLine
from app.log.foxglove import NANOSECONDS
from app.log.layout import CODES, STATE, TRUTH
from app.log.recorded_messages import SettingsMessage
from app.log_reading.packed_topic import PackedTopic, Table, must_rise
from app.mcap_file.chunk_table import ChunkTable
from app.mcap_file.opening import open_table
from app.mcap_file.runs import Runs
from app.mcap_file.topic_messages import Messages
from pendant.events.event import Kind
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.arm_problems import problems

T = TypeVar("T")

TOPICS = {"/state": "cdr", "/truth": "cdr", "/pendant": "json", "/tf": "json", "/events": "json", "/settings": "json"}
"""What a recording has, and how its messages are packed."""

RENAMED = {"reduced_exceeded": Kind.LIMIT_EXCEEDED.value}
"""Kinds of events in recordings of earlier versions, by what they are called now."""


@dataclass(slots=True)
class LogFile:
    """A file that is open.

    Rows are its ticks: each message of /state with what /truth said then, or last, where that is recorded more seldom.
    """

    path: Path
    table: ChunkTable
    run: dict[str, str]  # title, version, robot, seed, hash of the settings
    rates: dict[str, str]  # of a topic that is thinned: ticks from one message to the next
    arm: Arm
    scenario: Scenario
    state: PackedTopic
    truth: PackedTopic
    ticks: Runs  # of the rows
    pictures: Messages  # of /pendant
    frames: Messages  # of /tf
    picture_ticks: NDArray[np.int64]  # (m,) of those that both topics have
    picture_rows: NDArray[np.int64]  # (m, 2) their numbers in /pendant and in /tf
    events: list[EventLine]
    settings: list[SettingsMessage]

    def state_rows(self, begin: int, end: int) -> Table:
        """/state in the file's rows `begin` to before `end`. Raises BadInput: they are damaged."""
        return self._rows(self.state, begin, end)

    def truth_rows(self, begin: int, end: int) -> Table:
        """/truth in these rows. Raises BadInput: they are damaged."""
        return self._rows(self.truth, begin, end)

    def _rows(self, topic: PackedTopic, begin: int, end: int) -> Table:
        numbers = topic.ticks.at_or_before(self.ticks.between(begin, end))
        if not len(numbers):
            return topic_rows(self, topic, 0, 0)
        first, last = int(numbers[0]), int(numbers[-1]) + 1
        found = topic_rows(self, topic, first, last)
        return found if last - first == len(numbers) else found[numbers - first]


def topic_rows(file: LogFile, topic: PackedTopic, begin: int, end: int) -> Table:
    """Messages of a topic by their numbers. Raises BadInput: they are damaged, or not as they should be."""
    try:
        return topic.rows(begin, end)
    except ValueError as error:
        raise not_ours(file.path, error) from None


def open_log_file(path: Path) -> LogFile:
    """Open a recording's file.

    Raises:
        BadInput: it cannot be read, is no recording of ours, or is damaged where it says what is in it.
    """
    table = open_table(path)
    try:
        return _opened(path, table)
    except KeyError as missing:
        raise BadInput(path.name, "", ABSENT, f"is no recording of pendant: it has no {missing.args[0]}") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise not_ours(path, error) from None


def not_ours(path: Path, error: Exception) -> BadInput:
    """What is said of a file whose container is sound and whose contents are not."""
    return BadInput(path.name, "", ABSENT, f"is no recording that this version reads ({error})")


def decoded(messages: Messages, begin: int, end: int, *, kind: type[T], topic: str) -> list[T]:
    """Messages that are JSON. Raises ValueError: one is none of `kind`; BadInput: they are damaged."""
    try:
        return [msgspec.json.decode(content, type=kind) for content in messages.contents(begin, end)]
    except msgspec.MsgspecError as error:
        raise ValueError(f"{topic}: {error}") from None


def _opened(path: Path, table: ChunkTable) -> LogFile:
    arm = msgspec.json.decode(table.attachment("arm.json"), type=Arm)
    scenario = msgspec.json.decode(table.attachment("scenario.json"), type=Scenario)
    for field_name, value, allowed in problems(arm):
        raise ValueError(f"arm.json: {field_name} = {value!r}: {allowed}")
    for topic, encoding in TOPICS.items():
        kind = table.channels[table.channel_of(topic)].message_encoding
        if kind != encoding:
            raise ValueError(f"{topic} is {kind}, not {encoding}")
    run = table.notes["run"]
    state, truth = PackedTopic(table, "/state", STATE, arm.n, codes=CODES), PackedTopic(table, "/truth", TRUTH, arm.n)
    pictures, frames = Messages(table, "/pendant", NANOSECONDS), Messages(table, "/tf", NANOSECONDS)
    must_rise(pictures.times, "/pendant")
    must_rise(frames.times, "/tf")
    both, *numbers = np.intersect1d(pictures.times.all(), frames.times.all(), assume_unique=True, return_indices=True)
    rates = table.notes.get("rates", {})
    events = [replace(event, kind=RENAMED.get(event.kind, event.kind)) for event in _all(table, "/events", EventLine)]
    for event in events:
        Kind(event.kind)
    return LogFile(
        path,
        table,
        run,
        rates,
        arm,
        scenario,
        state,
        truth,
        _kept(state, truth, int(rates.get("truth", "1"))),
        pictures,
        frames,
        both,
        np.stack(numbers, axis=1),
        events,
        _all(table, "/settings", SettingsMessage),
    )


def _kept(state: PackedTopic, truth: PackedTopic, every: int) -> Runs:
    """Ticks of /state of which /truth says something: then, or not longer before than it is recorded."""
    if every < 1:
        raise ValueError(f"rates: truth = {every}")
    ticks, there = state.ticks.all(), truth.ticks.all()
    rows = truth.ticks.at_or_before(ticks)
    known = rows >= 0
    known[known] = ticks[known] - there[rows[known]] < every
    return Runs(ticks[known])


def _all(table: ChunkTable, topic: str, kind: type[T]) -> list[T]:
    messages = Messages(table, topic, NANOSECONDS)
    return decoded(messages, 0, len(messages), kind=kind, topic=topic)
