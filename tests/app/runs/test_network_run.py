"""Programs that a session's client sends: what they say and how they end is judged."""

from typing import Any

import pytest

from app.files.bad_input import BadInput
from app.files.checked import convert
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session

HELLO = 'def hello():\n  textmsg("one")\n  textmsg("two")\nend\n'
ENDLESS = "def on():\n  while True:\n    sync()\n  end\nend\n"


def verdicts(*scripts: dict[str, Any], duration: float = 1.0) -> list[tuple[bool, str]]:
    """Of a session whose client does this."""
    session = convert(
        {"title": "t", "duration": duration, "timeline": [{"do": "script", **each} for each in scripts]}, Session, "t"
    )
    prepared = prepare(session, "t")
    outcome = run(session, prepared, simulate(prepared), None)
    return [(each.passed, each.seen) for each in outcome.verdicts]


def test_what_it_says_and_that_it_ends() -> None:
    assert verdicts({"at": 0.3, "text": HELLO, "tells": ["one", "tw"]}) == [(True, "over"), (True, '"one"'), (True, '"two"')]


@pytest.mark.parametrize("tells", [["one", "three"], ["two"], ["one", "two", "three"]])
def test_what_it_does_not_say_fails(tells: list[str]) -> None:
    found = verdicts({"at": 0.3, "text": HELLO, "tells": tells})
    assert found[0] == (True, "over")
    assert not found[-1][0]


@pytest.mark.parametrize(
    ("text", "trouble", "passes", "seen"),
    [
        ("def bad():\n  nothing()\nend\n", "line 2", True, "line 2"),
        ("def bad():\n  nothing()\nend\n", "", False, "line 2"),
        ("def bad():\n  x = )\nend\n", "line 2", True, "line 2"),
        (HELLO, "line 2", False, "over"),
        (ENDLESS, "", False, "it still runs"),
        (ENDLESS, "line 2", False, "it still runs"),
    ],
)
def test_how_it_ends(text: str, trouble: str, passes: bool, seen: str) -> None:
    ((passed, saw),) = verdicts({"at": 0.3, "text": text, "trouble": trouble})
    assert passed is passes
    assert seen in saw


def test_a_second_one_takes_the_place_of_the_first_and_each_has_its_own_lines() -> None:
    found = verdicts({"at": 0.3, "text": ENDLESS, "tells": ["one"]}, {"at": 0.5, "text": HELLO, "tells": ["one"]})
    assert found == [(True, "over"), (False, '""'), (True, "over"), (True, '"one"')]


def test_a_secondary_one_is_refused() -> None:
    with pytest.raises(BadInput, match=r"timeline\[0\]\.text.*of a secondary one no end is told"):
        verdicts({"at": 0.3, "text": "sec quick():\n  set_standard_digital_out(1, True)\nend\n"})
