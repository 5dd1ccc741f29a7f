import sys
from pathlib import Path

import pytest

from app import cli
from app.api import run, session


def export(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["pendant", "export", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return int(ended.value.code or 0)


def test_a_led_arm_becomes_a_data_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    timeline = [
        {"at": 0.1, "do": "press", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.1, "do": "hold", "for": 1.0, "carry": [0.0, 0.1, 0.0]},
    ]
    settings = {"activation.period": 0.2, "sequence.period": 0.25}
    run(session({"title": "led", "duration": 2.6, "timeline": timeline, "settings": settings}), tmp_path / "log")
    monkeypatch.setenv("COLUMNS", "300")
    assert export(monkeypatch, str(tmp_path / "log"), "--out", str(tmp_path / "set"), "--rate", "50", "--task", "Go.") == 0
    assert "1 demonstrations, " in capsys.readouterr().out
    assert (tmp_path / "set/meta/info.json").is_file()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["gone.mcap"], "gone.mcap: expected an existing file"),
        ([], "Missing argument 'RECORDING...'"),
        (["x.mcap", "--rate", "a"], "--rate"),
    ],
)
def test_what_cannot_be_exported_is_one_line(
    arguments: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert export(monkeypatch, *arguments) == 2
    told = capsys.readouterr().err
    assert says in told
    assert told.strip().count("\n") == 0
