"""Rows of claims: what a session shows at many seeds, with its switch on and off."""

from pathlib import Path

import msgspec
import pytest

from app.files.checked import BadInput
from app.runs.runner import RunOutcome
from app.runs.seed_runs import seeds_in
from app.session.claims import CLAIMS
from app.session.expectation_watch import Verdict
from app.session.session_file import Session
from tests.app.session.test_claims import made
from tools.claims import __main__ as command
from tools.claims import coverage
from tools.claims.coverage import ClaimRow, Outcomes, Seeds, rows_of

SEEDS = Seeds(on=(1, 5), changed=(1,))
MET = RunOutcome(verdicts=[Verdict(True, "mode TEACH", "at 1 s"), Verdict(True, "mode STOP", "at 2 s")])
LATE = RunOutcome(verdicts=[Verdict(False, "mode STOP", "never came", looked=False)])
UNMET = RunOutcome(verdicts=[Verdict(True, "mode TEACH", "at 1 s"), Verdict(False, "mode STOP", "mode TEACH | at 2 s")])


def at(on: RunOutcome, off: RunOutcome) -> Outcomes:
    """What a session came to that holds at the first seed, if it ever does."""
    return Outcomes({1: MET if on is UNMET else on, 5: on}, {1: off})


def test_rows_say_what_is_shown_and_what_is_missing() -> None:
    session = made(claims=["A 3", "C 2"], switch="FD-7")
    rows = rows_of({"s": session}, {"s": at(MET, UNMET)})
    found = {row.claim.name: row.state for row in rows}
    assert len(rows) == len(CLAIMS)
    assert found["A 3"] == found["C 2"] == "shown"
    assert found["A 4"] == "missing"
    assert coverage.totals(rows) == dict.fromkeys(coverage.STATES, 0) | {"shown": 2, "missing": len(CLAIMS) - 2}
    assert _states(session, MET, MET) == {"holds without its switch"}
    assert _states(session, UNMET, UNMET) == {"fails"}
    assert _states(session, MET, LATE) == {"holds without its switch"}  # nothing that it expects was looked at
    assert _states(session, RunOutcome(), UNMET) == {"fails"}  # one that expects nothing shows nothing


def _states(session: Session, on: RunOutcome, off: RunOutcome) -> set[str]:
    return {row.state for row in rows_of({"s": session}, {"s": at(on, off)}) if row.session}


def test_claims_are_written_as_a_page_and_as_data(tmp_path: Path) -> None:
    rows = [ClaimRow(CLAIMS["A 4"]), *rows_of({"s": made(claims=["A 3"], switch="FD-7")}, {"s": at(UNMET, UNMET)})]
    coverage.write(rows, SEEDS, tmp_path / "new")
    page = (tmp_path / "new" / "claims.md").read_text()
    assert "| A 3 | a signal shorter" in page
    assert "| s | mode TEACH<br>mode STOP | FD-7 | 5 | - | - | fails: at seed 5: mode STOP: mode TEACH \\| at 2 s |" in page
    data = msgspec.json.decode((tmp_path / "new" / "claims.json").read_bytes())
    row = next(row for row in data if row["name"] == "A 3")
    assert row["checks"] == ["mode TEACH", "mode STOP"]
    assert (row["switch"], row["seeds"], row["failed"], row["held_when_off"]) == ("FD-7", [1, 5], [5], [])
    assert row["mutants"] == []
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput):
        coverage.write(rows, SEEDS, tmp_path / "file")


def test_all_claiming_sessions_run_at_all_seeds_in_parallel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short = made(duration=0.1, claims=["A 3"], switch="FD-7", expectations=[{"expect": "state", "mode": "TEACH", "at": 0.05}])
    monkeypatch.setattr(coverage, "claiming", lambda: {"one": short, "two": short})
    told: list[tuple[int, int]] = []
    rows = coverage.cover(tmp_path, SEEDS, lambda done, of: told.append((done, of)))
    assert told == [(done, 6) for done in range(1, 7)]
    assert [(row.session, row.failed, row.held) for row in rows if row.session] == [("one", (), (1,)), ("two", (), (1,))]
    assert (tmp_path / "two" / "1-off" / "events.jsonl").is_file()


@pytest.mark.parametrize(("seeds", "text"), [((), ""), ((4,), "4"), ((3, 1, 2, 7), "1-3,7"), ((1, 2, 4, 5, 6, 9), "1-2,4-6,9")])
def test_seeds_in_short_are_read_back(seeds: tuple[int, ...], text: str) -> None:
    assert coverage.in_short(seeds) == text
    assert not text or seeds_in(text) == sorted(seeds)


def test_the_command_says_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(coverage, "claiming", dict)
    monkeypatch.setattr(command, "declared", list)
    assert command.main(["--out", str(tmp_path)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "142 rows: 0 shown, 0 fails, 0 holds without its switch" in said
    assert "0 has no mutant, 142 missing" in said
    assert (tmp_path / "claims.md").is_file()
    with pytest.raises(SystemExit):
        command.main(["--seeds", "12-1"])
    assert "--seeds: '12-1': seeds and ranges" in " ".join(capsys.readouterr().err.split())
