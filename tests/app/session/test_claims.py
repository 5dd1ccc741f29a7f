"""Every bundled session that names a switch: with it, all is met; without it, something is not."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from app.files.checked import BadInput, convert
from app.runs import coverage
from app.runs.coverage import ClaimRow, claiming, rows_of
from app.runs.runner import RunOutcome, missed, run, simulate
from app.session.claims import CLAIMS
from app.session.expectation_watch import Verdict
from app.session.prepare import prepare, without
from app.session.session_file import Session, find
from tests import golden
from tests.passed import left_out_where_passed

SESSIONS = claiming()
ROOTS = (__name__,)
"""What a run of a session uses: this module, and all that it imports."""

MET = RunOutcome(verdicts=[Verdict(True, "mode TEACH", "at 1 s")])
LATE = RunOutcome(verdicts=[Verdict(False, "mode STOP", "never came", looked=False)])
UNMET = RunOutcome(verdicts=[Verdict(True, "mode TEACH", "at 1 s"), Verdict(False, "mode STOP", "mode TEACH | at 2 s")])


def ran(session: Session, out: Path, enough: Callable[[Verdict], bool] | None = None) -> RunOutcome:
    prepared = prepare(session, "claim")
    return run(session, prepared, simulate(prepared), out, enough=enough)


def made(**fields: Any) -> Session:
    return convert({"title": "t", "duration": 1.0, **fields}, Session, "s.yaml")


@pytest.mark.parametrize("name", SESSIONS)
def test_a_claiming_session_holds(name: str, tmp_path: Path) -> None:
    before = golden.known()[name]
    with left_out_where_passed(f"{name}.on", ROOTS, find(name).read_text(), repr(before)):
        outcome = ran(SESSIONS[name], tmp_path)
        assert outcome.verdicts
        assert [verdict for verdict in outcome.verdicts if not verdict.passed] == []
        assert golden.differences(before, golden.deeds(outcome.events)) == []


@pytest.mark.parametrize("name", SESSIONS)
def test_and_fails_without_its_switch(name: str, tmp_path: Path) -> None:
    with left_out_where_passed(f"{name}.off", ROOTS, find(name).read_text()):
        assert ran(without(SESSIONS[name]), tmp_path, missed).unmet


def test_the_rows_are_those_of_the_sources() -> None:
    count = {group: sum(name.startswith(f"{group} ") and "fig" not in name for name in CLAIMS) for group in "ABC"}
    assert count == {"A": 32, "B": 22, "C": 21}
    assert sum("fig" in name for name in CLAIMS) == 22
    assert [name for name in CLAIMS if name.startswith("B fig 4h")] == ["B fig 4h falling", "B fig 4h rising"]


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"claims": ["A 33"], "switch": "FD-7"}, "s.yaml: claims[0] = A 33: a row of `pendant claims`"),
        ({"claims": ["A 3"]}, "s.yaml: switch: missing"),
        ({"switch": "FD-99"}, "s.yaml: switch = FD-99: one of FD-3"),
        ({"switch": "free_drive.period"}, "switch = free_drive.period"),
    ],
)
def test_what_is_no_claim_and_no_switch_is_refused(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(BadInput) as refused:
        prepare(made(**fields), "s.yaml")
    assert says in str(refused.value)


def test_a_switch_is_a_requirement_or_a_setting() -> None:
    asked = made(switch="joint_control.q_speed", settings={"joint_control.q_speed": True, "free_drive.period": 5.0})
    off = prepare(without(asked), "s.yaml").settings
    assert prepare(asked, "s.yaml").settings.joint_control.q_speed
    assert not off.joint_control.q_speed
    assert off.free_drive.period == 5.0
    by_id = made(switch="FD-14", settings={"free_drive.period": 5.0})
    assert prepare(by_id, "s.yaml").settings.free_drive.period == 5.0
    assert prepare(without(by_id), "s.yaml").settings.free_drive.period == 30.0


def test_rows_say_what_is_shown_and_what_is_missing() -> None:
    session = made(claims=["A 3", "C 2"], switch="FD-7")
    rows = rows_of({"s": session}, {"s": (MET, UNMET)})
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
    return {row.state for row in rows_of({"s": session}, {"s": (on, off)}) if row.session}


def test_claims_are_written_as_a_page_and_as_data(tmp_path: Path) -> None:
    rows = [ClaimRow(CLAIMS["A 4"]), *rows_of({"s": made(claims=["A 3"], switch="FD-7")}, {"s": (UNMET, UNMET)})]
    coverage.write(rows, tmp_path / "new")
    page = (tmp_path / "new" / "claims.md").read_text()
    assert "| A 3 | a signal shorter" in page
    assert "| s | mode TEACH<br>mode STOP | FD-7 | no | yes | - | fails: mode STOP: mode TEACH \\| at 2 s |" in page
    data = msgspec.json.decode((tmp_path / "new" / "claims.json").read_bytes())
    row = next(row for row in data if row["name"] == "A 3")
    assert row["checks"] == ["mode TEACH", "mode STOP"]
    assert (row["switch"], row["passed"], row["failed_when_off"]) == ("FD-7", False, True)
    assert (data[0]["passed"], data[0]["seed"], row["seed"]) == (None, None, made().seed)
    assert row["mutants"] == []
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput):
        coverage.write(rows, tmp_path / "file")


def test_all_claiming_sessions_run_in_parallel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short = made(duration=0.1, claims=["A 3"], switch="FD-7", expectations=[{"expect": "state", "mode": "TEACH", "at": 0.05}])
    monkeypatch.setattr(coverage, "claiming", lambda: {"one": short, "two": short})
    told: list[tuple[int, int]] = []
    rows = coverage.cover(tmp_path, lambda done, of: told.append((done, of)))
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [(row.session, row.passed, row.failed_when_off) for row in rows if row.session] == [
        ("one", True, False),
        ("two", True, False),
    ]
    assert (tmp_path / "two" / "off" / "events.jsonl").is_file()
