"""What the engine costs beside the ticks of the sessions that it runs, in time and in memory; and what a large study costs."""

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import psutil

from app.api import session
from app.engine import spreading
from app.files.checked import convert
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.studies.data_set import write_data_set
from app.studies.one_run import CaseOutcome
from app.studies.plan import Plan
from app.studies.row_journal import rows, sealed
from app.studies.study_file import Study
from app.studies.study_report import write_study_report
from app.studies.sweep import begun, row_of
from benchmarks.common import ROOT, Report
from benchmarks.sweeps.processes import environment

POSTURE = [0.0, -1.3, 1.6, -1.9, -1.6, 0.0]
BASE: dict[str, Any] = {
    "title": "asked for free-drive",
    "posture": POSTURE,
    "timeline": [{"at": 0.05, "do": "press", "control": "free_drive"}],
}
LARGE = 100_000


def study_fields(runs: int, duration: float) -> dict[str, Any]:
    """A study of two factors; some of its runs end with an error, since the arm cannot stand so."""
    return {
        "title": "bench",
        "session": {**BASE, "duration": duration},
        "factors": [
            {"name": "mass", "kind": "list", "field": "payload_true.mass", "values": [0.0, 1.0]},
            {"name": "angle", "kind": "uniform", "field": "posture[1]", "from": -1.5, "to": -1.0},
        ],
        "samples": runs // 2,
        "measures": [
            {"name": "way", "measure": "displacement"},
            {"name": "refused", "measure": "happens", "kinds": ["refused_*"]},
        ],
        "show": [{"show": "curve", "of": "refused", "over": "angle", "by": "mass"}, {"show": "sensitivity", "of": "way"}],
        "worst": {"of": "way"},
    }


class Timed(NamedTuple):
    """A session's run."""

    ticks: float  # time in its ticks [s]
    pid: int
    memory: int  # of the process, after it [B]
    processor: float  # time of the process so far [s]


def timed(work: tuple[Session, int]) -> Timed:
    """Run a session with a seed."""
    made = msgspec.structs.replace(work[0], seed=work[1])
    prepared = prepare(made, "bench")
    outcome = run(made, prepared, simulate(prepared), None)
    return Timed(outcome.took, os.getpid(), psutil.Process().memory_info().rss, time.process_time())


PLAIN = """
import sys, time
import msgspec
from app.api import session
from benchmarks.sweeps.costs import BASE, timed
base, count = session(BASE, duration=float(sys.argv[1])), int(sys.argv[2])
timed((base, 0))
print("ready", flush=True)
sys.stdin.readline()
before = time.process_time()
for seed in range(count):
    timed((base, seed))
print(time.process_time() - before, flush=True)
"""


def plain(duration: float, count: int) -> tuple[float, float]:
    """Time of two plain loops at once, started up before, and the processor time of both [s]."""
    arguments = [sys.executable, "-c", PLAIN, str(duration), str(count)]
    loops = [
        subprocess.Popen(arguments, cwd=ROOT, env=environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    for loop in loops:
        assert loop.stdout is not None
        loop.stdout.readline()
    start = time.perf_counter()
    for loop in loops:
        assert loop.stdin is not None
        loop.stdin.write("go\n")
        loop.stdin.flush()
    processor = sum(float(loop.communicate()[0]) for loop in loops)
    return time.perf_counter() - start, processor


def cost(report: Report) -> None:
    """Sessions of 5 s on two workers against two plain loops, in turns; and where the time goes."""
    rounds, count, duration = (5, 50, 5.0) if report.options.full else (3, 20, 5.0)
    base = session(BASE, duration=duration)
    start = time.perf_counter()
    spent = {each.pid: each.processor for _, each in spreading.spread(timed, [(base, 0)] * 6, workers=2)}
    report.row("workers and kernels ready, once", time.perf_counter() - start, "s")
    engine = loops = in_ticks = own = theirs = plainly = 0.0
    for k in range(rounds):
        for turn in ((0, 1), (1, 0))[k % 2]:
            if turn:
                took, processor = plain(duration, count)
                loops, plainly = loops + took, plainly + processor
                continue
            start, cpu = time.perf_counter(), time.process_time()
            found = list(spreading.spread(timed, ((base, seed) for seed in range(2 * count)), workers=2))
            engine += time.perf_counter() - start
            own += time.process_time() - cpu
            in_ticks += sum(each.ticks for _, each in found)
            for pid in {each.pid for _, each in found}:
                now = max(each.processor for _, each in found if each.pid == pid)
                theirs += now - spent.get(pid, 0.0)
                spent[pid] = now
    n = 2 * rounds * count
    report.row("time over that of two plain loops", engine / loops, "", at_most=1.1, n=n)
    report.row("processor time over that of two plain loops", (theirs + own) / plainly, "", at_most=1.1, n=n)
    report.row("worker time beside ticks", 100.0 * (1.0 - in_ticks / (2.0 * engine)), "%", at_most=5.0, n=n)
    report.row("processor time of scheduler and sender", 100.0 * own / (2.0 * engine), "%", at_most=5.0, n=n)


def memory(report: Report) -> None:
    """Many short sessions: what the processes hold after a third of them, and at the end."""
    count = 3000 if report.options.full else 600
    base = session(BASE, duration=0.1)
    held: dict[int, list[int]] = {}
    own: list[int] = []
    for k, (_, each) in enumerate(spreading.spread(timed, ((base, seed) for seed in range(count)), workers=2)):
        held.setdefault(each.pid, []).append(each.memory)
        if k % 10 == 0:
            own.append(psutil.Process().memory_info().rss)
    workers = max(max(values) / max(values[: len(values) // 3]) for values in held.values())
    report.row("memory of a worker: whole over first third", workers, "", at_most=1.05, n=count)
    report.row("memory of scheduler and sender: whole over first third", max(own) / max(own[: len(own) // 3]), "", at_most=1.05)


def large(report: Report, folder: Path) -> None:
    """A study of 100 000 rows: plans, resumes, settles and reports."""
    study = convert(study_fields(LARGE, 1.0), Study, "bench")
    base = session({**BASE, "duration": 1.0})
    out, rng = folder / "large", np.random.default_rng(report.options.seed)
    start = time.perf_counter()
    plan = Plan(study, base, "bench")
    begun(plan, out)
    report.row("100 000 rows: plan", planned := time.perf_counter() - start, "s")
    with (out / "journal").open("wb") as file:
        for case in plan.cases():
            outcome = CaseOutcome(case, (float(rng.uniform()), bool(rng.uniform() < 0.5)), "ok")
            file.write(sealed(msgspec.json.encode(row_of(study, outcome))))
    start = time.perf_counter()
    there = begun(plan, out)
    report.row("100 000 rows: resume", resumed := time.perf_counter() - start, "s")
    assert sum(there) == LARGE
    start = time.perf_counter()
    write_data_set(out / "rows", study, lambda: rows(out / "journal"))
    report.row("100 000 rows: data set", settled := time.perf_counter() - start, "s")
    start = time.perf_counter()
    write_study_report(plan, out, out / "rows")
    report.row("100 000 rows: report", reported := time.perf_counter() - start, "s")
    report.row("100 000 rows: overhead in all", planned + resumed + settled + reported, "s", at_most=60.0, n=LARGE)
