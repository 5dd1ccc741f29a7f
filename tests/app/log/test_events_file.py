from pathlib import Path

import pytest

from app.files.checked import BadInput
from app.log.events_file import FLUSH, EventsFile, line_of, read
from pendant.events.event import Event, Kind
from pendant.tick.modes import TICK_RATE

CANCELLED = Event(Kind.ACTIVATION_CANCELLED, 750, {"value": 0.5, "limit": 1.0})
RESET = Event(Kind.RESET, 800)


def test_a_line_says_when_what_and_how_it_reads() -> None:
    line = line_of(CANCELLED)
    assert (line.tick, line.t, line.kind) == (750, 1.5, "activation_cancelled")
    assert line.values == {"value": 0.5, "limit": 1.0}
    assert "0.50 s" in line.guidance


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "events.jsonl"
    with EventsFile(path) as file:
        file.write(750, (CANCELLED,))
        file.write(751, ())
        file.write(800, (RESET, CANCELLED))
    assert read(path) == [line_of(CANCELLED), line_of(RESET), line_of(CANCELLED)]


def test_no_more_than_a_second_is_only_in_memory(tmp_path: Path) -> None:
    assert FLUSH < TICK_RATE
    path = tmp_path / "events.jsonl"
    with EventsFile(path) as file:
        file.write(1, (CANCELLED,))
        for tick in range(2, 1 + TICK_RATE):
            file.write(tick, ())
        assert len(read(path)) == 1  # while it is still open


def test_half_a_line_is_dropped_and_nonsense_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    with EventsFile(path) as file:
        file.write(1, (CANCELLED, RESET))
    whole = path.read_bytes()
    path.write_bytes(whole[:-5])
    assert [line.kind for line in read(path)] == ["activation_cancelled"]
    path.write_bytes(b"{}\n" + whole)
    with pytest.raises(BadInput, match="not an events file"):
        read(path)


def test_a_folder_that_cannot_be_made_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be written"):
        EventsFile(tmp_path / "file" / "events.jsonl")
