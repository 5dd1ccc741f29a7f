"""Runs sessions as jobs: one in this process, many on the engine."""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from app.engine.spreading import spread
from app.files.bad_input import BadInput
from app.log_reading.reader import read
from app.report.files import write_report
from app.runs.runner import Progress, RunOutcome, record, run, silent, simulate
from app.session.expectation_watch import Verdict
from app.session.prepare import prepare
from app.session.session_file import Session


class Job(NamedTuple):
    """A session to run."""

    name: str  # name of its file, for messages
    session: Session
    out: Path | None  # folder for the results; None: no results are kept
    realtime: bool = False
    recorded: bool = True  # with log.mcap, summary.json and report.html; otherwise only events.jsonl
    enough: Callable[[Verdict], bool] | None = None  # argument of `run`; used only if nothing is recorded


def work(job: Job, progress: Progress = silent) -> RunOutcome:
    """Run one job in this process. Raises BadInput: the session cannot be used."""
    prepared = prepare(job.session, job.name)
    if job.out is None or not job.recorded:
        simulation = simulate(prepared)
        return run(job.session, prepared, simulation, job.out, realtime=job.realtime, progress=progress, enough=job.enough)
    outcome = record(job.session, prepared, job.out, realtime=job.realtime, progress=progress)
    write_report(read(job.out / "log.mcap"), job.out, outcome.verdicts)
    return outcome


def tried(job: Job) -> RunOutcome | BadInput:
    """Run one job; returns the error if the session cannot be used."""
    try:
        return work(job)
    except BadInput as error:
        return error


def run_each(jobs: Iterable[Job]) -> Iterator[tuple[int, RunOutcome | BadInput]]:
    """As `run_all`, but a job that cannot be run does not end the others."""
    return spread(tried, jobs)


def run_all(jobs: Iterable[Job]) -> Iterator[tuple[int, RunOutcome]]:
    """Run all jobs on all cores; gives the place of each in `jobs` with its outcome, in the order in which they end.

    Raises BadInput: a job raises it.
    """
    return spread(work, jobs)
