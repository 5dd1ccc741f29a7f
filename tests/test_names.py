"""A name that a user has written in a file stays a name."""

import json

from tests.names import FILE, GONE, names


def test_no_name_is_gone_without_a_word() -> None:
    before, now = json.loads(FILE.read_text(encoding="utf-8")), set(names())
    assert len(before) > 1400
    # What belongs to a name that is gone, like the fields of an expectation, goes with it.
    assert [name for name in before if name not in now and not any(name.startswith(gone) for gone in GONE)] == []


def test_what_is_called_gone_was_there_and_is_gone() -> None:
    before, now = json.loads(FILE.read_text(encoding="utf-8")), set(names())
    assert set(GONE) <= set(before)
    assert not set(GONE) & now
