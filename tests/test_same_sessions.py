"""The comparison of sessions between two checkouts finds what is not the same."""

from pathlib import Path

import pytest

from app.runs.runner import record
from app.session.prepare import prepare
from app.session.session_file import Session
from tools.same_sessions import SessionRecord, differences, read

BEFORE = SessionRecord(('[5, "entered", {"gain": 1.0}]', '[9, "left_period", {}]'), 500, "a1")


@pytest.mark.parametrize(
    ("after", "word"),
    [
        (BEFORE._replace(events=('[5, "entered", {"gain": 1.5}]', BEFORE.events[1])), "1.5"),
        (BEFORE._replace(events=('[6, "entered", {"gain": 1.0}]', BEFORE.events[1])), "[6"),
        (BEFORE._replace(events=BEFORE.events[:1]), "2 events are now 1"),
        (BEFORE._replace(ticks=499), "numbers"),
        (BEFORE._replace(digest="a2"), "numbers"),
    ],
)
def test_another_number_tick_or_event_is_found(after: SessionRecord, word: str) -> None:
    assert differences(BEFORE, BEFORE) == ""
    assert word in differences(BEFORE, after)


def test_a_run_is_known_by_its_numbers(tmp_path: Path) -> None:
    runs: list[SessionRecord] = []
    for number, seed in enumerate((1, 1, 2)):
        session = Session(title="x", seed=seed, duration=0.2)
        folder = tmp_path / str(number)
        folder.mkdir()
        record(session, prepare(session, "x"), folder)
        runs.append(read(folder))
    assert runs[0].ticks == 100
    assert runs[0] == runs[1]
    assert differences(runs[0], runs[2])
