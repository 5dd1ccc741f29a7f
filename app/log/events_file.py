"""events.jsonl: one event a line, written as the session runs. No wall time, no path: same session and seed, same bytes."""

from pathlib import Path
from types import TracebackType

import msgspec

from app.files.checked import ABSENT, BadInput
from pendant.event_table import TABLE, render
from pendant.events.event import Event
from pendant.tick.modes import TICK, TICK_RATE

FLUSH = TICK_RATE // 2
"""Ticks between two flushes: half a second, so that a killed process loses less than the last second."""


class EventLine(msgspec.Struct, frozen=True, kw_only=True):
    """One line of the file."""

    tick: int
    t: float  # [s]
    kind: str
    severity: str
    headline: str
    guidance: str
    values: dict[str, float | int | str | bool]


def line_of(event: Event) -> EventLine:
    """The line that stands for an event."""
    headline, guidance = render(event)
    return EventLine(
        tick=event.tick,
        t=round(event.tick * TICK, 6),
        kind=event.kind.value,
        severity=TABLE[event.kind].severity.name,
        headline=headline,
        guidance=guidance,
        values=event.values,
    )


class EventsFile:
    """Writes events to a file. A context manager.

    Args:
        path: of the file; one that is there is replaced.

    Raises:
        BadInput: the file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb")
        except OSError as error:
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._flushed = 0

    def __enter__(self) -> "EventsFile":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._file.close()

    def write(self, tick: int, events: tuple[Event, ...]) -> None:
        """Write the events of `tick`; call it for every tick, since it flushes now and then too."""
        for event in events:
            self._file.write(msgspec.json.encode(line_of(event)) + b"\n")
        if tick - self._flushed >= FLUSH:
            self._file.flush()
            self._flushed = tick


def read(path: Path) -> list[EventLine]:
    """The lines of an events file; half a line at its end, left by a killed process, is dropped.

    Raises:
        BadInput: the file cannot be read, or a whole line of it is none of ours.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"cannot be read ({error.strerror})") from None
    try:
        return [msgspec.json.decode(line, type=EventLine) for line in lines[:-1]]
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise BadInput(path.name, "", ABSENT, f"not an events file ({error})") from None
