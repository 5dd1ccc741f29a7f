"""The benches can be run: each file of the folder has the shape that `make bench` relies on."""

import importlib
import json
import math
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.files.library import load_arm
from app.runs.runner import RunOutcome, simulate
from app.session.prepare import prepare
from benchmarks import arms, common, drift, free_drive_forces, imported, realtime, recording, tick
from benchmarks.common import Options, Report
from pendant.events.event import Event, Kind
from tests.items import each_of

FOLDER = Path(common.__file__).parent
HELPERS = {"__init__", "arms", "common", "network_clients", "postures", "viewer"}
BENCHES = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem not in HELPERS)


def report(out: Path) -> Report:
    return Report("tried", Options(full=False, seed=1000, out=out))


@each_of(BENCHES)
def test_a_bench_says_what_it_measures_and_has_a_measure(name: str) -> None:
    module = importlib.import_module(f"benchmarks.{name}")
    assert module.__doc__
    assert callable(module.measure)
    assert (FOLDER / f"{name}.py").read_text().rstrip().endswith(f'if __name__ == "__main__":\n    main("{name}", measure)')


@each_of(sorted(FOLDER.rglob("*.py")), lambda path: path.stem)
def test_no_row_has_a_count_in_its_name(path: Path) -> None:
    """It would be another row at every seed base; what is counted goes into `n`."""
    assert re.findall(r"report\.(?:row|share)\(\s*f\"[^\"]*\{(?:len\(|n\}|count\})", path.read_text()) == []


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
    written: dict[str, Any] = json.loads((tmp_path / f"tried-quick-1000-{common.code_digest()}.json").read_text())
    assert len(written["settings"]) == 8
    assert (written["digest"], written["commit"]) == (common.code_digest(), common.commit())
    assert [row["held"] for row in written["rows"]] == [held]


def run(monkeypatch: pytest.MonkeyPatch, name: str, *arguments: str) -> None:
    """Run a bench of one row from the command line."""
    monkeypatch.setattr(sys, "argv", [name, *arguments])
    with pytest.raises(SystemExit, match=r"^0$"):
        common.main(name, lambda tried: tried.row("payload", arms.heaviest(tried.options.arm), "kg"))


def test_results_of_another_arm_name_it_and_stand_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for arm in ((), ("--arm", "ur3e")):
        run(monkeypatch, "drop", "--out", str(tmp_path), *arm)
    found = {path.parent: json.loads(path.read_text()) for path in tmp_path.rglob("*.json")}
    assert {folder: (document["arm"], document["rows"][0]["value"]) for folder, document in found.items()} == {
        tmp_path: ("ur5e", 5.0),
        tmp_path / "ur3e": ("ur3e", 3.0),
    }


def test_a_bench_that_chooses_its_own_arms_takes_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["hold", "--out", str(tmp_path), "--arm", "ur3e"])
    with pytest.raises(SystemExit, match=r"^2$"):
        common.main("hold", lambda tried: None)
    assert set(BENCHES) > arms.BENCHES


@pytest.mark.parametrize("name", sorted(arms.BENCHES))
def test_a_bench_that_takes_an_arm_draws_its_cases_on_it(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module(f"benchmarks.{name}")
    drawn: list[str] = []

    class Enough(Exception):
        pass

    def spread(work: object, cases: Any) -> None:
        for case in cases:
            while not hasattr(case, "arm"):
                case = case.case if hasattr(case, "case") else case[0]
            drawn.append(case.arm)
        raise Enough

    monkeypatch.setattr(module, "spread", spread)
    with pytest.raises(Enough):
        module.measure(Report(name, Options(full=False, seed=1000, out=tmp_path, arm="ur3e")))
    assert set(drawn) == {"ur3e"}


def test_a_variant_has_another_flange_sensor_and_the_controller_knows(tmp_path: Path) -> None:
    usual, noisy, none = (arms.load(name) for name in ("ur5e", "ur5e-noisy-sensor", "ur5e-without-sensor"))
    first, other = usual.sensors.force_torque, noisy.sensors.force_torque
    assert first is not None
    assert other is not None
    assert other.force.noise == pytest.approx(3.0 * first.force.noise)
    assert other.torque.noise == pytest.approx(3.0 * first.torque.noise)
    assert none.sensors.force_torque is None
    assert [arms.senses(name) for name in arms.names()] == [name not in {"ur5e-without-sensor", "iiwa7"} for name in arms.names()]
    tried = report(tmp_path)
    tried.options = replace(tried.options, arm="ur5e-without-sensor")
    drift.measure(tried)
    assert tried.rows == [], "what does not apply is no bar that was held"


@pytest.mark.parametrize(
    ("arm", "strength", "rubs", "missed"),
    [
        ("ur5e", 1.0, (1.0, 1.0, 1.0), 0.0),
        ("ur5e-noisy-sensor", 1.0, (1.0, 1.0, 1.0), 0.0),
        ("ur5e-without-sensor", 1.0, (1.0, 1.0, 1.0), 2.2),  # 0.1 mrad of the encoder times 22 kN·m/rad of the shoulder
        ("ur3e", 0.6, (1.0, 1.0, 1.0), 0.0),  # 3 of 5 kg; a light arm does not get a lighter hand
        # The wrist at 0.3 rad/s: 3.78, 3.89, 3.41 N·m (UR10e) and 2.73, 2.98, 2.81 (UR16e), of 2.01, 1.72, 1.82.
        ("ur10e", 1.0, (1.30, 1.0, 2.0), 0.0),
        ("ur16e", 1.0, (1.59, 1.31, 1.54), 0.0),
    ],
)
def test_what_an_arm_can_be_asked_for_follows_from_its_numbers(
    arm: str, strength: float, rubs: tuple[float, float, float], missed: float
) -> None:
    elbow, flange, wrist = arms.rubs(arm, "elbow", 0.1), arms.rubs(arm, "flange", 0.1), arms.rubs(arm, "wrist", 0.3)
    assert (arms.strength(arm), elbow, flange, wrist, arms.missed(arm)) == pytest.approx((strength, *rubs, missed), abs=0.01)
    bars = [free_drive_forces.allowed(name, usual, arm) for name, _, _, usual in free_drive_forces.FORCES]
    felt = missed / arms.LEVER
    assert bars == pytest.approx([12.0 * flange + felt, 2.0 * wrist + missed, 30.0 * elbow + felt, 15.0 * flange + felt])


@pytest.mark.parametrize("arm", ["ur5e", "ur5e-without-sensor"])
def test_an_end_that_looks_like_a_fall_is_counted_by_itself_where_it_can_be_one(arm: str, tmp_path: Path) -> None:
    tried = report(tmp_path)
    tried.options = replace(tried.options, arm=arm)
    free_drive_forces.report_ends(tried, "lead", np.array([3.0, free_drive_forces.ENDED, free_drive_forces.FALL, 4.0]))
    ended, falls = tried.rows[0], tried.rows[1:]
    assert (ended["value"], ended["held"]) == (0.25, False)
    assert [row["value"] for row in falls] == ([] if arms.senses(arm) else [0.25])


def binomial(hits: int, n: int, share: float) -> float:
    """Chance of at most so many hits."""
    return sum(math.comb(n, k) * share**k * (1.0 - share) ** (n - k) for k in range(hits + 1))


@pytest.mark.parametrize(("hits", "n"), [(0, 59), (3, 40), (39, 40), (497, 500)])
def test_the_bound_of_a_share_is_where_the_count_becomes_unlikely(hits: int, n: int) -> None:
    assert binomial(hits, n, common.bound(hits, n, upper=True)) == pytest.approx(0.05)
    if hits:
        assert 1.0 - binomial(hits - 1, n, common.bound(hits, n, upper=False)) == pytest.approx(0.05)


def test_all_or_none_bounds_a_share_on_one_side_only() -> None:
    assert (common.bound(0, 9, upper=False), common.bound(9, 9, upper=True)) == (0.0, 1.0)


def test_a_share_is_bounded_towards_its_bar(tmp_path: Path) -> None:
    tried = report(tmp_path)
    tried.share("accepted", 99, 100, at_least=0.98)
    tried.share("stopped", 1, 100, at_most=0.02)
    tried.share("seen", 1, 4)
    tried.share("named", 0, 0, at_least=1.0)
    assert [(row["value"], row["n"], row["held"]) for row in tried.rows] == [
        (0.99, 100, True),
        (0.01, 100, True),
        (0.25, 4, None),
        ("no case", 0, None),
    ]
    assert [row["bound"] for row in tried.rows] == [
        pytest.approx(0.95344, abs=1e-5),
        pytest.approx(0.04656, abs=1e-5),
        None,
        None,
    ]


def test_the_table_says_how_many_cases_and_with_which_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tried = report(tmp_path)
    tried.share("accepted", 59, 59, at_least=0.9)
    tried.finish()
    said = capsys.readouterr().out
    assert f"code {common.code_digest()}, commit {common.commit()}" in " ".join(said.split())
    assert [cell.strip() for cell in said.splitlines()[-2].split("│")[1:-1]] == [
        "accepted",
        "59",
        "1",
        "",
        "0.9505",
        ">= 0.9",
        "yes",
    ]


def test_what_was_measured_while_the_code_changed_is_no_result(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = report(tmp_path / "out")
    before = tried.digest
    monkeypatch.setattr(common, "code_digest", lambda: "c0ffee000000")
    assert tried.finish() == 2
    assert capsys.readouterr().err == f"tried: the code changed while it was measured ({before}, now c0ffee000000): no result\n"
    assert not (tmp_path / "out").exists()


def code(root: Path) -> Path:
    """A folder as the project's, with a file in each folder that a figure depends on."""
    for folder in common.CODE:
        (root / folder).mkdir(parents=True)
        (root / folder / "file.py").write_text(folder)
    return root


@pytest.mark.parametrize("folder", common.CODE)
def test_the_digest_is_of_names_and_bytes(folder: str, tmp_path: Path) -> None:
    root = code(tmp_path)
    digests = [common.code_digest(root)]
    (root / folder / "file.py").write_text("other")
    digests.append(common.code_digest(root))
    (root / folder / "file.py").rename(root / folder / "name.py")
    digests.append(common.code_digest(root))
    (root / folder / "new.yaml").write_text("")
    digests.append(common.code_digest(root))
    assert len(set(digests)) == 4
    (root / folder / "__pycache__").mkdir()
    (root / folder / "__pycache__" / "file.pyc").write_text("compiled")
    (root / "README.md").write_text("no code")
    assert common.code_digest(root) == digests[-1]


def test_the_commit_says_whether_the_code_is_as_committed(tmp_path: Path) -> None:
    root = code(tmp_path / "project")
    assert common.commit(root) == "unknown"
    for command in (["init", "-q"], ["add", "."], ["-c", "user.name=x", "-c", "user.email=x@y", "commit", "-qm", "all"]):
        subprocess.run(["git", *command], cwd=root, check=True)
    name = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=root, check=True, capture_output=True, text=True).stdout
    (root / "notes.txt").write_text("no code")
    assert common.commit(root) == name.strip()
    (root / "sim" / "new.py").write_text("")
    assert common.commit(root) == name.strip() + "+"
    inside = code(root / "unpacked")
    assert common.commit(inside) == "unknown", "an archive that was unpacked in somebody's repository is not of its commit"


def test_the_bench_of_the_tick_measures(tmp_path: Path) -> None:
    tried = report(tmp_path)
    tick.measure(tried, ticks=20, runs=1)
    rows = {row["what"]: row["value"] for row in tried.rows}
    for scene in ("NORMAL", "RUN", "FREE_DRIVE guided"):
        assert rows[f"ur5e, {scene}: share of ticks in that mode"] == 1.0
        assert rows[f"ur5e, {scene}: tick over bare physics, median"] > 1.0


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
    assert all(rows[f"session {name} with recording, median"] > 0.0 for name in recording.SESSIONS)


def test_the_bench_of_imported_arms_has_sessions_that_can_be_run(tmp_path: Path) -> None:
    paths = imported.small_arms(tmp_path)
    assert imported.arms_in(tmp_path / "arms") == sorted(paths)
    for path in paths:
        for what in imported.WHATS:
            session = imported.session_of(imported.Case(str(path), what, 1000), load_arm(path))
            simulate(prepare(session, what))


def test_a_touch_counts_as_told_soon_after_it() -> None:
    told = RunOutcome(events=[Event(Kind.COLLISION, 120, {})])
    assert imported.untold(told, (Kind.COLLISION,), 100) == []
    assert imported.untold(told, (Kind.COLLISION,), 121) == ["told -0.002 s after the touch"]
    assert imported.untold(told, (Kind.CONTACT_GAINED,), 100) == ["the touch was not told"]
    assert imported.untold(told, (Kind.COLLISION,), 0) == ["nothing was touched"]
