"""The benches can be run: each file of the folder has the shape that `make bench` relies on."""

import importlib
import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks import common, realtime, recording, tick
from benchmarks.common import Options, Report

FOLDER = Path(common.__file__).parent
HELPERS = {"__init__", "common", "postures", "viewer"}
BENCHES = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem not in HELPERS)


def report(out: Path) -> Report:
    return Report("tried", Options(full=False, seed=1000, out=out))


@pytest.mark.parametrize("name", BENCHES)
def test_a_bench_says_what_it_measures_and_has_a_measure(name: str) -> None:
    module = importlib.import_module(f"benchmarks.{name}")
    assert module.__doc__
    assert callable(module.measure)
    assert (FOLDER / f"{name}.py").read_text().rstrip().endswith(f'if __name__ == "__main__":\n    main("{name}", measure)')


def test_make_bench_runs_all_of_them() -> None:
    makefile = (FOLDER.parent / "Makefile").read_text()
    assert f"filter-out {' '.join(sorted(HELPERS))}," in makefile


@pytest.mark.parametrize(
    ("value", "limits", "held"),
    [
        (2.0, {"at_most": 2.0}, True),
        (2.1, {"at_most": 2.0}, False),
        (0.99, {"at_least": 0.99, "at_most": 1.01}, True),
        (0.98, {"at_least": 0.99, "at_most": 1.01}, False),
        (1.02, {"at_least": 0.99, "at_most": 1.01}, False),
        (float("nan"), {"at_most": 1.0}, False),
        (5.0, {}, None),
    ],
)
def test_a_bar_is_held_or_missed(value: float, limits: dict[str, float], held: bool | None, tmp_path: Path) -> None:
    tried = report(tmp_path)
    tried.row("figure", value, "m", **limits)
    assert tried.rows[0]["held"] is held
    assert tried.finish() == (1 if held is False else 0)
    written: dict[str, Any] = json.loads((tmp_path / "tried-quick-1000.json").read_text())
    assert len(written["settings"]) == 8
    assert [row["held"] for row in written["rows"]] == [held]


def test_the_bench_of_the_tick_measures(tmp_path: Path) -> None:
    tried = report(tmp_path)
    tick.measure(tried, ticks=20, runs=1)
    rows = {row["what"]: row["value"] for row in tried.rows}
    for scene in ("NORMAL", "RUN", "FREE_DRIVE guided"):
        assert rows[f"ur5e, {scene}: share of ticks in that mode"] == 1.0
        assert rows[f"ur5e, {scene}: tick over bare physics, median of 9"] > 1.0


def test_a_drag_is_followed_to_the_first_picture_of_a_tick_that_used_it() -> None:
    window = realtime.Window(10.0, 5.0, 0, realtime.np.zeros(1), 0.0, realtime.Counter(), 0.0)
    frames = [(8, [0.0, 0.0, 0.1]), (16, [0.0, 0.0, 0.2]), (24, [0.0, 0.0, 0.3])]
    sent = [(11.00, [0.0, 0.0, 0.1]), (11.03, [0.0, 0.0, 0.3])]  # the second picture was replaced before it left
    used = [(5, 10.99), (8, 10.98), (9, 11.005), (25, 11.02), (5, 9.0)]  # the last came before the window
    assert realtime.latencies(used, frames, sent, window) == pytest.approx([0.01, 0.02, 0.025])


def test_a_late_joiner_that_lacks_something_is_found_out() -> None:
    full = {"picture": {"/arm": {"position": [1.0]}, "/floor": {}}}
    own = {"picture": {**full["picture"], "own strip": {}}}
    assert realtime.missing(own, [own, full]) == (0, 0)
    assert realtime.missing({"picture": {"/arm": {"position": [2.0]}}}, [own, full]) == (1, 1)


def test_the_bench_of_the_recording_measures(tmp_path: Path) -> None:
    tried = report(tmp_path)
    recording.measure(tried, ticks=50, turns=1)
    rows = {row["what"]: row["value"] for row in tried.rows}
    assert rows["its share of a tick"] > 0.0
    assert all(rows[f"session {name} with recording, median of 1"] > 0.0 for name in recording.SESSIONS)
