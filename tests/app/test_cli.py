import re
import subprocess
import sys
from pathlib import Path

import pytest

from app.commands.command_options import setting
from app.files.checked import BadInput
from tests.app.command_line import pendant

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("command", ["serve", "run", "export", "check", "replay", "schema", "robots"])
def test_every_command_has_help_with_examples(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert pendant(monkeypatch, command, "--help") == 0
    assert f"pendant {command}" in capsys.readouterr().out.partition("Examples:")[2]


def test_help_lists_only_what_works(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert pendant(monkeypatch) == 0
    shown = capsys.readouterr().out
    assert all(command in shown for command in ("serve", "run", "check", "robots"))


def test_the_version_is_told_with_the_commit(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert pendant(monkeypatch, "--version") == 0
    said = re.fullmatch(r"pendant (\d+\.\d+\.\d+\S*), commit (\S+)\n", capsys.readouterr().out)
    assert said is not None
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert head.startswith(said[2])


def test_robots_shows_the_arms(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    assert pendant(monkeypatch, "robots") == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in ("ur3e", "ur5e", "ur10e", "ur16e", "reach", "source"))
    row = next(line for line in shown.splitlines() if line.startswith("ur5e"))
    assert "0.85" in row
    assert "Universal Robots" in row


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["bogus"], "No such command 'bogus'"),
        (["run"], "Missing argument 'SESSION...'"),
        (["run", "nowhere.yaml"], "nowhere.yaml"),
        (["run", "hold", "--seed", "x"], "--seed"),
        (["run", "hold", "--seed", "-1"], "--seed"),
        (["run", "hold", "--set", "free_drive.period"], "expected KEY=VALUE"),
        (["run", "hold", "--set", "free_drive.perod=2"], "no such setting"),
        (
            ["run", "hold", "--set", "free_drive.period=200"],
            "hold.yaml: settings.free_drive.period = 200.0: a number from 0.5 to 30 s",
        ),
        (["run", "hold", "--set", "free_drive.period=nan"], "settings.free_drive.period"),
        (["run", "hold", "--set", "free_drive.period=true"], "settings.free_drive.period"),
        (["serve", "--port", "99999"], "--port"),
        (["serve", "--robot", "ur6"], "ur6"),
        (["serve", "--config", "nowhere.yaml"], "nowhere.yaml"),
        (["serve", "--host", "203.0.113.7"], "203.0.113.7"),
        (["check", "bad.yaml"], "bad.yaml: duration = soon: expected a number"),
        (["check", "twice.yaml"], "twice.yaml: line 2"),
        (["check", "nan.yaml"], "nan.yaml: seed"),
        (["check", "arm.yaml"], "arm.yaml: "),
        (["check", "config.yaml"], "config.yaml: robots"),
        (["check", "."], "no such file"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    arguments: list[str], says: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "bad.yaml").write_text("title: x\nduration: soon\n")
    (tmp_path / "twice.yaml").write_text("title: x\ntitle: y\nduration: 1\n")
    (tmp_path / "nan.yaml").write_text("title: x\nduration: 1\nseed: .nan\n")
    (tmp_path / "arm.yaml").write_text("name: x\nchain: {}\n")
    (tmp_path / "config.yaml").write_text("robots: ur5e\n")
    monkeypatch.chdir(tmp_path)
    assert pendant(monkeypatch, *arguments) == 2
    out, err = capsys.readouterr()
    assert says in err
    assert err.startswith("pendant: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err + out


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("robot: ur10e\nsettings: {free_drive.period: 5}\n", "configuration"),
        ("title: x\nduration: 1.0\n", "session"),
    ],
)
def test_check_tells_what_a_file_is(
    text: str, kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "file.yaml").write_text(text)
    assert pendant(monkeypatch, "check", str(tmp_path / "file.yaml")) == 0
    assert f"file.yaml: a valid {kind}" in capsys.readouterr().out


def test_check_knows_an_arm(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    from app.files.library import ASSETS

    assert pendant(monkeypatch, "check", str(ASSETS / "robots" / "ur5e.yaml")) == 0
    assert "a valid robot" in capsys.readouterr().out


def test_run_ends_with_0_or_1_and_shows_why(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.yaml").write_text(
        "title: short\nduration: 0.1\nexpectations:\n"
        "  - {expect: state, mode: TEACH, at: 0.05}\n"
        "  - {expect: value, of: payload_true, max: 0.5}\n"
    )
    assert pendant(monkeypatch, "run", "short.yaml", "--out", "results") == 0
    assert (tmp_path / "results" / "events.jsonl").exists()
    assert "2 expectations met, 0 not" in capsys.readouterr().out

    heavy = (tmp_path / "short.yaml").read_text() + "payload_true: {mass: 1.0}\npayload_configured: {mass: 1.0}\n"
    (tmp_path / "heavy.yaml").write_text(heavy)
    assert pendant(monkeypatch, "run", "heavy.yaml") == 1
    shown = capsys.readouterr().out
    assert "payload true at most 0.5 kg" in shown
    assert "1 kg at 0.002 s" in shown


@pytest.mark.parametrize(("text", "value"), [("a", None), ("free_drive.gain=2", 2.0), ("button.hold_to_run=true", True)])
def test_a_setting_is_a_name_and_a_value(text: str, value: object) -> None:
    if value is None:
        with pytest.raises(BadInput):
            setting(text)
    else:
        assert setting(text) == (text.partition("=")[0], value)


def test_the_command_runs_as_a_process_of_its_own() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from app.cli import main; main()", "run", "nowhere"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr.startswith("pendant: nowhere: no such file")
