"""What the pendant begins with, as a whole: a golden table (tests/pendant/states.py)."""

import json

import pytest

from tests.pendant import states


@pytest.fixture(scope="module")
def known() -> dict[str, list[str]]:
    return json.loads(states.FILE.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def now() -> dict[str, list[str]]:
    return states.found()


@pytest.mark.parametrize("situation", states.SITUATIONS)
def test_the_pendant_begins_as_it_did(situation: str, known: dict[str, list[str]], now: dict[str, list[str]]) -> None:
    """After a change that is meant: python -m tests.pendant.states, and look at the difference."""
    assert now[situation] == known[situation]


def test_the_table_has_every_situation(known: dict[str, list[str]]) -> None:
    assert known.keys() == states.SITUATIONS.keys()
    assert len(known["fresh"]) > 300
