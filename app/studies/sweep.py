"""Runs a study: what is not done yet is spread over workers, each row is on the disk before the next, and the end is a report."""

import fcntl
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from app.engine.source import source_commit, source_digest
from app.engine.spreading import spread
from app.files.bad_input import ABSENT, BadInput
from app.files.regular_file import open_regular
from app.session.session_file import Session
from app.studies.data_set import done, whole_file, write_data_set
from app.studies.one_run import CaseOutcome, Common, Task, died, run_case
from app.studies.plan import Case, Plan, changed_field, described
from app.studies.row_journal import RowJournal, rows
from app.studies.study_file import Study
from app.studies.study_report import write_study_report

Told = Callable[[int, int], None]


class Workers(NamedTuple):
    """Who does the runs."""

    processes: int | None = None  # processes of this machine; None: one a core
    scheduler: str | None = None  # address of a Dask scheduler in their place


EVERY_CORE = Workers()


class Swept(NamedTuple):
    """What a sweep did."""

    runs: int  # of the study
    kept: int  # rows that were there before
    made: int  # rows made now
    failed: int  # rows with an error


def sweep(
    study: Study,
    base: Session,
    out: Path,
    *,
    where: str,
    workers: Workers = EVERY_CORE,
    told: Told = lambda done, of: None,
    said: Callable[[str], None] = lambda line: None,
) -> Swept:
    """Do all runs of a study that have no row yet, and write the data set and the report.

    Args:
        study: what to do.
        base: its session.
        out: folder for the rows, what the study is, and its report. One that holds a part of the same study is completed.
        where: name of the study, for messages.
        workers: who does the runs.
        told: how many rows there are, of how many.
        said: what happens on the way, in lines.

    Raises:
        BadInput: the study does not make sense; `out` holds another one, or is in use; a file cannot be written.
            All rows that were made are kept.
    """
    plan = Plan(study, base, where)
    with _locked(out):
        there = begun(plan, out)
        kept = sum(there)
        told(kept, plan.size)
        made = 0
        try:
            with RowJournal(out / "journal") as journal:
                common = msgspec.json.encode(Common(plan.raw, study.measures))
                tasks = (Task(case, common) for case in plan.cases() if not there[case.number])
                for _, outcome in spread(
                    run_case, tasks, workers=workers.processes, scheduler=workers.scheduler, lost=died, told=said
                ):
                    journal.append(row_of(study, outcome))
                    made += 1
                    told(kept + made, plan.size)
        except BaseException:
            with suppress(BadInput):  # what is there can be looked at, however it ended; the journal keeps what cannot be moved
                settle(study, out)
            raise
        settle(study, out)
        failed = write_study_report(plan, out, out / "rows")
    return Swept(plan.size, kept, made, failed)


def begun(plan: Plan, out: Path) -> bytearray:
    """Open the folder of a study; says of each run whether its row is there.

    Raises:
        BadInput: the folder holds another study.
    """
    path, ours = out / "study.json", described(plan)
    if path.exists():
        theirs = _described_there(path)
        field = changed_field(theirs, ours)
        if field == "digest":
            allowed = "its rows were made by another source; take another --out, or go back to that source"
            raise BadInput(str(out), field, theirs["digest"], allowed)
        if field is not None:
            raise BadInput(str(out), field, ABSENT, "the study was changed since its rows were made; take another --out")
    else:
        whole_file(path, lambda place: place.write_bytes(msgspec.json.format(msgspec.json.encode(ours), indent=1) + b"\n"))
    there = bytearray(plan.size)
    for number, ident in (*done(out / "rows"), *((row["run"], row["id"]) for row in rows(out / "journal"))):
        if not 0 <= number < plan.size or plan.case(number).id != ident:
            raise BadInput(str(out), f"run {number}", ident, "is no row of this study; take another --out")
        there[number] = 1
    return there


def _described_there(path: Path) -> dict[str, Any]:
    """What the folder of a study says of it. Raises BadInput: it cannot be read, or describes no study."""
    with open_regular(path) as file:
        text = file.readall()
    try:
        return msgspec.json.decode(text, type=dict[str, Any])
    except msgspec.MsgspecError as error:
        raise BadInput(str(path), "", ABSENT, f"describes no study ({error}); take another --out, or remove it") from None


def row_of(study: Study, outcome: CaseOutcome) -> dict[str, Any]:
    """The row of a run."""
    case: Case = outcome.case
    row: dict[str, Any] = {"run": case.number, "id": case.id, "seed": case.seed}
    row |= {factor.name: value for factor, value in zip(study.factors, case.factors, strict=True)}
    row |= {measure.name: value for measure, value in zip(study.measures, outcome.measures, strict=True)}
    return row | {"exit": outcome.exit, "error": outcome.error, "commit": source_commit(), "digest": source_digest()}


def settle(study: Study, out: Path) -> None:
    """Move the journal's rows into the data set. Raises BadInput: that failed; the journal keeps them."""
    journal = out / "journal"
    write_data_set(out / "rows", study, lambda: rows(journal))
    journal.unlink(missing_ok=True)


class _locked:
    """One sweep at a time writes into a folder; the lock goes with its process."""

    def __init__(self, out: Path) -> None:
        self._out = out

    def __enter__(self) -> None:
        try:
            self._out.mkdir(parents=True, exist_ok=True)
            self._file = (self._out / ".lock").open("w")
        except OSError as error:
            raise BadInput(str(self._out), "", ABSENT, f"cannot be written ({error.strerror})") from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise BadInput(str(self._out), "", ABSENT, "another sweep writes there") from None

    def __exit__(self, *_: object) -> None:
        self._file.close()
