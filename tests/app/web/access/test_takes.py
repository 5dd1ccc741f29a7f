"""What a text control takes: a line, or lines where it has room for them, and no control characters."""

from types import SimpleNamespace
from typing import Any, cast

import pytest
import viser

from app.web.access.messages import Update
from app.web.access.takes import MAX_LINES, MAX_TEXT, reason_against


def reason(value: str, multiline: bool) -> str | None:
    server = viser.ViserServer(port=0, verbose=False)
    try:
        control = server.gui.add_text("t", "", multiline=multiline)
        return reason_against(control, cast("Update", as_update(value)))
    finally:
        server.stop()


def as_update(value: str) -> Any:
    return SimpleNamespace(updates={"value": value})


@pytest.mark.parametrize(
    ("value", "line", "lines"),
    [
        ("x" * MAX_TEXT, True, True),
        ("x" * (MAX_TEXT + 1), False, True),
        ("x" * MAX_LINES, False, True),
        ("x" * (MAX_LINES + 1), False, False),
        ("a\n\tb", False, True),
        ("a\x1bb", False, False),
        ("a\rb", False, False),
    ],
)
def test_a_line_or_lines(value: str, line: bool, lines: bool) -> None:
    assert reason(value, False) == (None if line else "value not allowed")
    assert reason(value, True) == (None if lines else "value not allowed")
