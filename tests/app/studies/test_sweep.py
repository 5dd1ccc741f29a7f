"""Whole sweeps in this process: what is done stays, what is not is done, what changed is refused."""

import fcntl
import os
from pathlib import Path
from typing import Any

import msgspec
import pytest

from app.files.bad_input import BadInput
from app.studies import sweep as sweeping
from app.studies.data_set import parts, read_data_set
from app.studies.one_run import CaseOutcome, Task
from app.studies.row_journal import RowJournal, rows
from app.studies.sweep import Swept, Workers, sweep
from tests.app.command_line import pendant
from tests.app.studies.study_fakes import BASE, FIELDS, base, study

ONE = Workers(1)


def quick_run(task: Task) -> CaseOutcome:
    """Stands for a simulation where only rows matter."""
    return CaseOutcome(task.case, (task.case.number / 7, task.case.number % 3 == 0), "ok")


def swept(out: Path, **fields: Any) -> Swept:
    return sweep(study(**fields), base(), out, where="study.yaml", workers=ONE)


def bytes_of(out: Path) -> bytes:
    return b"".join(path.read_bytes() for path in parts(out / "rows"))


def test_a_study_runs_and_has_its_answer(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    done = sweep(study(), base(), tmp_path, where="s", workers=ONE, told=lambda done, of: told.append((done, of)))
    assert done == Swept(16, 0, 16, 0)
    assert told == [(k, 16) for k in range(17)]
    table = read_data_set(tmp_path / "rows")
    assert table["run"].to_pylist() == list(range(16))
    assert set(table["exit"].to_pylist()) == {"ok"}
    assert "16 of 16 runs" in (tmp_path / "report.html").read_text()
    assert len(list((tmp_path / "worst").glob("*.yaml"))) == 10
    assert not (tmp_path / "journal").exists()
    before = bytes_of(tmp_path)
    assert swept(tmp_path) == Swept(16, 16, 0, 0)
    assert bytes_of(tmp_path) == before


def test_two_workers_give_the_same_bytes(tmp_path: Path) -> None:
    swept(tmp_path / "one")
    sweep(study(), base(), tmp_path / "two", where="s", workers=Workers(2))
    assert bytes_of(tmp_path / "one") == bytes_of(tmp_path / "two") != b""


@pytest.mark.parametrize("ends", [KeyboardInterrupt, BadInput("disk", "", 0, "full"), MemoryError])
def test_a_sweep_that_is_ended_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ends: Any) -> None:
    monkeypatch.setattr(sweeping, "run_case", quick_run)
    swept(tmp_path / "whole")
    calls = 0

    def ending(task: Task) -> CaseOutcome:
        nonlocal calls
        calls += 1
        if calls == 6:
            raise ends
        return quick_run(task)

    monkeypatch.setattr(sweeping, "run_case", ending)
    with pytest.raises(ends if isinstance(ends, type) else type(ends)):
        swept(tmp_path / "ended")
    assert read_data_set(tmp_path / "ended" / "rows").num_rows == 5
    assert swept(tmp_path / "ended") == Swept(16, 5, 11, 0)
    assert bytes_of(tmp_path / "ended") == bytes_of(tmp_path / "whole")


def test_a_process_that_was_killed_left_its_journal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeping, "run_case", quick_run)
    swept(tmp_path / "whole")
    kept = [row for row in read_data_set(tmp_path / "whole" / "rows").to_pylist() if row["run"] in (3, 9)]
    (tmp_path / "killed").mkdir()
    with RowJournal(tmp_path / "killed" / "journal") as journal:
        for row in kept:
            journal.append(row)
    with (tmp_path / "killed" / "journal").open("ab") as file:
        file.write(b"half a li")
    assert swept(tmp_path / "killed") == Swept(16, 2, 14, 0)
    assert bytes_of(tmp_path / "killed") == bytes_of(tmp_path / "whole")


def test_a_crash_between_data_set_and_journal_makes_no_row_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeping, "run_case", quick_run)
    swept(tmp_path)
    whole = bytes_of(tmp_path)
    with RowJournal(tmp_path / "journal") as journal:
        for row in read_data_set(tmp_path / "rows").to_pylist()[:4]:
            journal.append(row)
    assert swept(tmp_path) == Swept(16, 16, 0, 0)
    assert bytes_of(tmp_path) == whole
    assert list(rows(tmp_path / "journal")) == []


def test_a_changed_study_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeping, "run_case", quick_run)
    swept(tmp_path)
    factors = [{**FIELDS["factors"][0], "values": [0.0, 1.5]}, *FIELDS["factors"][1:]]
    with pytest.raises(BadInput, match=r"study.factors\[0\].values\[1\]: the study was changed"):
        swept(tmp_path, factors=factors)
    with pytest.raises(BadInput, match=r"study\.session\.duration"):
        sweep(study(), base(duration=0.2), tmp_path, where="s", workers=ONE)
    monkeypatch.setattr("app.studies.plan.source_digest", lambda: "c0ffee")
    with pytest.raises(BadInput, match="made by another source"):
        swept(tmp_path)


@pytest.mark.parametrize("content", [b"{", b"", b"[]", b"\xff", b"3"])
def test_a_description_that_is_none_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "study.json").write_bytes(content)
    with pytest.raises(BadInput, match=r"study\.json: describes no study") as refused:
        swept(tmp_path)
    assert "\n" not in str(refused.value)


def test_a_description_that_cannot_be_opened_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "study.json")
    with pytest.raises(BadInput, match="is a pipe; expected a regular file"):
        swept(tmp_path)


def test_a_row_of_something_else_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeping, "run_case", quick_run)
    with RowJournal(tmp_path / "journal") as journal:
        journal.append({"run": 3, "id": "of another study"})
    with pytest.raises(BadInput, match="is no row of this study"):
        swept(tmp_path)


def test_one_sweep_at_a_time_writes(tmp_path: Path) -> None:
    with (tmp_path / ".lock").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(BadInput, match="another sweep writes there"):
            swept(tmp_path)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    session = {**BASE, "posture": [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]}
    (tmp_path / "s.yaml").write_bytes(msgspec.yaml.encode({**FIELDS, "session": session}))
    monkeypatch.setattr(sweeping, "run_case", quick_run)
    call = ["sweep", str(tmp_path / "s.yaml"), "--workers", "1", "--out", str(tmp_path / "out")]
    assert pendant(monkeypatch, *call) == 0
    assert "16 runs; the rows are in" in " ".join(capsys.readouterr().out.split())
    assert pendant(monkeypatch, *call) == 0
    assert "16 runs, 16 of them before" in " ".join(capsys.readouterr().out.split())
    assert pendant(monkeypatch, *call, "--seed", "3") == 2
    said = capsys.readouterr().err
    assert "the study was changed" in said
    assert said.strip().count("\n") == 0


def test_the_command_tells_of_errors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "s.yaml").write_bytes(
        msgspec.yaml.encode({**FIELDS, "session": {**BASE, "posture": [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]}})
    )
    monkeypatch.setattr(sweeping, "run_case", lambda task: CaseOutcome(task.case, (None, None), "error", "a < b"))
    assert pendant(monkeypatch, "sweep", str(tmp_path / "s.yaml"), "--workers", "1", "--out", str(tmp_path / "out")) == 1
    assert "a &lt; b" in (tmp_path / "out" / "report.html").read_text()
