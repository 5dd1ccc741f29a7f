"""Programs that a session's client sends: what they say and how they end is judged."""

import socket
import threading
from typing import Any

import pytest

from app.files.bad_input import BadInput
from app.files.checked import convert
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from tests.app.web.raw_client import until

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


def test_what_scripts_have_begun_ends_with_the_session() -> None:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(1)
        opens = f'  socket_open("127.0.0.1", {server.getsockname()[1]})\n  modbus_add_signal("127.77.1.3", 255, 0, 2, "a")\n'
        text = ENDLESS.replace("def on():\n", f'def on():\n{opens}  textmsg("there")\n')
        assert verdicts({"at": 0.3, "text": text, "tells": ["there"]}) == [(False, "it still runs"), (True, '"there"')]
        server.settimeout(10.0)
        connection, _ = server.accept()
        connection.settimeout(10.0)
        with connection:
            assert connection.recv(1) == b""
    until(lambda: not any(thread.name == "modbus 127.77.1.3" for thread in threading.enumerate()), "its thread has ended")
