import os
from pathlib import Path

import pytest

from app.files.bad_input import BadInput
from app.files.regular_file import open_regular
from tests.app.command_line import pendant


@pytest.mark.parametrize(
    "command",
    [
        ["run", "{}"],
        ["check", "{}"],
        ["serve", "--config", "{}"],
        ["robot", "--config", "{}"],
        ["replay", "{}"],
        ["export", "{}", "--out", "data"],
        ["sweep", "{}"],
    ],
    ids=lambda command: command[0],
)
def test_a_pipe_is_refused_by_every_command(
    command: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Who opened it waited for its other end, and neither Ctrl-C nor SIGTERM ended that."""
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.yaml")
    assert pendant(monkeypatch, *(word.format("pipe.yaml") for word in command)) == 2
    assert capsys.readouterr().err.strip() == "pendant: pipe.yaml: is a pipe; expected a regular file"


@pytest.mark.parametrize(
    ("name", "said"),
    [("/dev/null", "a device or a socket"), (".", "a folder"), ("none", "expected an existing file"), ("a\0b", "readable")],
)
def test_what_is_no_regular_file_is_refused(name: str, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        open_regular(Path(name))
