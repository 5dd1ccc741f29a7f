"""The Python interface, and the examples that show it: each runs as a user runs it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from app.learning.demonstrations import demonstrations
from pendant_sim import BadInput, Button, Push, read, run, run_many, session, step, stepped

ROOT = Path(__file__).parents[2]
FIELDS = {"title": "t", "duration": 0.1, "expectations": [{"expect": "state", "mode": "TEACH", "at": 0.05}]}


def example(name: str, folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", f"examples.{name}", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def test_a_session_comes_from_fields_a_name_or_a_file(tmp_path: Path) -> None:
    assert session("hold", seed=9).seed == 9
    assert session(FIELDS).title == "t"
    assert session(session(FIELDS), title="u").title == "u"
    (tmp_path / "s.yaml").write_text("title: x\nduration: 1.0\n")
    assert session(tmp_path / "s.yaml").title == "x"
    with pytest.raises(BadInput, match="duration"):
        session(FIELDS, duration=-1.0)
    with pytest.raises(BadInput, match="ur6"):
        session(FIELDS, robot="ur6")


@pytest.mark.parametrize(("says", "passes"), [("2", True), ("3", False)])
def test_a_program_in_the_robots_language_runs_from_python(says: str, passes: bool) -> None:
    script = {"at": 0.4, "do": "script", "text": "def hello():\n  textmsg(1 + 1)\nend\n", "tells": [says]}
    assert run(session({"title": "hello", "duration": 0.6, "timeline": [script]})).passed is passes


def test_a_run_keeps_its_files_where_asked(tmp_path: Path) -> None:
    assert run(session(FIELDS)).passed
    assert run(session(FIELDS), tmp_path).passed
    log = read(tmp_path / "log.mcap")
    assert len(log.ticks) == 50
    assert (tmp_path / "report.html").is_file()


def test_many_runs_keep_their_order() -> None:
    outcomes = run_many(session(FIELDS, duration=duration) for duration in (0.1, 0.2))
    assert [outcome.seconds for outcome in outcomes] == [0.1, 0.2]


def test_a_simulation_is_stepped_by_hand() -> None:
    simulation = stepped(session(FIELDS))
    step(simulation, 10)
    assert simulation.tick_count == 10
    step(simulation, held=[Button.FREE_DRIVE], touches=[Push("flange", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))])
    assert simulation.snapshot().touches[0][2] == (1.0, 0.0, 0.0)
    assert simulation.snapshot().decision.phase == "ACTIVATION"


def test_an_example_demonstrates_by_hand(tmp_path: Path) -> None:
    assert example("learning.demonstrate", tmp_path, "hands", "1") == " 0: TEACH, FREE_DRIVE\n"
    log = read(tmp_path / "hands/00/log.mcap")
    assert sum(len(way.ticks) for way in demonstrations(log, 25)) > 100  # rows: as long as policies look ahead
