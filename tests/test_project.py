"""The project as a newcomer meets it: README, the build's entry points, the wheel's contents."""

import os
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from pendant_sim import Robot

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


@pytest.mark.parametrize("command", ["make run", "make test"])
def test_the_readme_names_the_two_commands_and_they_exist(command: str) -> None:
    assert command in (ROOT / "README.md").read_text()
    assert re.search(rf"^{command.split()[1]}:", (ROOT / "Makefile").read_text(), re.MULTILINE)


@pytest.mark.parametrize("document", ["US 12384019 B2", "US 12384030 B2", "71737980"])
def test_the_readme_names_its_sources(document: str) -> None:
    assert document in (ROOT / "README.md").read_text().partition("## Sources")[2]


def test_the_readme_example_session_is_valid_and_passes(tmp_path: Path) -> None:
    from app.files.checked import load
    from app.runs.runner import run, simulate
    from app.session.prepare import prepare
    from app.session.session_file import Session

    match = re.search(r"```yaml\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert match is not None
    path = tmp_path / "readme.yaml"
    path.write_text(match[1])
    session = load(path, Session)
    prepared = prepare(session, path.name)
    outcome = run(session, prepared, simulate(prepared), tmp_path)
    assert [verdict for verdict in outcome.verdicts if not verdict.passed] == []


def test_the_readme_example_tests_pass(robot: Robot) -> None:
    examples = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    names: dict[str, Any] = {}
    for example in examples:
        exec(example, names)
    tests = {name for name in names if name.startswith("test_")}
    assert tests == {"test_the_arm_holds", "test_the_program_moves_the_arm_and_sets_its_output"}, "each is run here"
    names["test_the_arm_holds"]()
    names["test_the_program_moves_the_arm_and_sets_its_output"](robot)


def test_ci_runs_make_test() -> None:
    script = ROOT / ".ci" / "run"
    assert os.access(script, os.X_OK)
    assert "make test" in script.read_text().splitlines()
    assert "set -eu" in script.read_text().splitlines()


def test_the_wheel_takes_all_rooms_and_installs_the_command() -> None:
    wheel = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert set(wheel["packages"]) == {"pendant_sim", "app", "sim", "pendant", "assets"}
    assert PROJECT["project"]["scripts"] == {"pendant": "pendant_sim.start:main"}


def test_the_changelog_begins_with_the_version() -> None:
    headings = re.findall(r"^## \[(.+?)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert headings[0] == PROJECT["project"]["version"]


def test_the_licence_is_mit() -> None:
    assert (ROOT / "LICENSE").read_text().startswith("MIT License\n\nCopyright (c) 2026 The pendant authors")
    assert PROJECT["project"]["license"] == "MIT"


def test_no_file_names_the_machine_it_was_made_on() -> None:
    suffixes = {".py", ".md", ".toml", ".yaml", ""}
    folders = ["app", "sim", "pendant", "assets", "benchmarks", "docs", "tools"]
    files = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file() and path.suffix in suffixes]
    assert len(files) > 40
    assert [path for path in files if re.search(r"/(home|root|Users)/|/work/", path.read_text(errors="replace"))] == []
