"""Runs many sessions at once, each in a process of its own, on all cores."""

import multiprocessing
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import NamedTuple

from app.log.reader import read
from app.report.files import write_report
from app.runs.runner import Progress, RunOutcome, record, run, silent, simulate
from app.session.prepare import prepare
from app.session.session_file import Session


class Job(NamedTuple):
    """A session to run."""

    name: str  # of its file, for messages
    session: Session
    out: Path  # folder for the results
    realtime: bool = False
    recorded: bool = True  # with log.mcap, summary.json and report.html; otherwise events.jsonl alone


def work(job: Job, progress: Progress = silent) -> RunOutcome:
    """Run one job in this process. Raises BadInput: what the session says cannot be used."""
    prepared = prepare(job.session, job.name)
    if not job.recorded:
        return run(job.session, prepared, simulate(prepared), job.out, realtime=job.realtime, progress=progress)
    outcome = record(job.session, prepared, job.out, realtime=job.realtime, progress=progress)
    write_report(read(job.out / "log.mcap"), job.out, outcome.verdicts)
    return outcome


def run_all(jobs: Iterable[Job]) -> Iterator[tuple[int, RunOutcome]]:
    """Run all jobs; gives the place of each in `jobs` with its outcome, in the order in which they end.

    Raises:
        BadInput: a job's, after the rest that has begun is done.
    """
    jobs = list(jobs)
    if len(jobs) <= 1:  # not worth a process
        yield from ((0, work(job)) for job in jobs)
        return
    # A fresh interpreter each: a copy of this process would inherit its threads' locks.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(len(jobs), os.cpu_count() or 1), mp_context=context) as pool:
        places = {pool.submit(work, job): place for place, job in enumerate(jobs)}
        try:
            for done in as_completed(places):
                yield places[done], done.result()
        finally:
            pool.shutdown(cancel_futures=True)
