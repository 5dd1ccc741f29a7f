"""Studies: the same rows whoever does the runs; no row lost whatever dies; what it costs beside the sessions' own ticks."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
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
from app.studies.data_set import parts, read_data_set, write_data_set
from app.studies.one_run import CaseOutcome
from app.studies.plan import Plan
from app.studies.row_journal import rows, sealed
from app.studies.study_file import Study, open_study
from app.studies.study_report import write_study_report
from app.studies.sweep import begun, row_of
from benchmarks.common import ROOT, Report, main

BASE: dict[str, Any] = {"title": "asked for free-drive", "timeline": [{"at": 0.05, "do": "press", "control": "free_drive"}]}
KILLS, SCHEDULERS = 10, 2
PATIENCE = 300.0  # [s] for one sweep of this bench
SMALL = 60_000  # bytes of a disk that becomes full, about a half of the rows
LARGE = 100_000
COLUMNS = {
    "measures": [{"name": "way", "measure": "displacement"}, {"name": "refused", "measure": "happens", "kinds": ["refused_*"]}]
}


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
        **COLUMNS,
        "show": [{"show": "curve", "of": "refused", "over": "angle", "by": "mass"}, {"show": "sensitivity", "of": "way"}],
        "worst": {"of": "way"},
    }


def written(folder: Path, fields: dict[str, Any]) -> Path:
    """The study as a file."""
    fields["session"]["posture"] = [0.0, -1.3, 1.6, -1.9, -1.6, 0.0]
    path = folder / "study.yaml"
    path.write_bytes(msgspec.yaml.encode(fields))
    return path


def command(study: Path, out: Path, *more: str) -> subprocess.Popen[bytes]:
    """`pendant sweep` in a process of its own."""
    call = "import sys\nif __name__ == '__main__':\n    from app.cli import main\n    main()"
    arguments = [sys.executable, "-c", call, "sweep", str(study), "--out", str(out), *more]
    return subprocess.Popen(arguments, cwd=ROOT, env=_environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


@contextmanager
def cluster(port: int, workers: int = 2) -> Iterator[list[subprocess.Popen[bytes]]]:
    """A scheduler and workers, each started apart."""
    started = [_dask("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")]
    started += [_dask("worker", f"tcp://127.0.0.1:{port}", "--nthreads", "1", "--no-dashboard") for _ in range(workers)]
    try:
        yield started
    finally:
        for process in started:
            _end(process.pid)
            process.wait()


def _dask(*arguments: str) -> subprocess.Popen[bytes]:
    call = [sys.executable, "-m", "dask", *arguments]
    return subprocess.Popen(call, cwd=ROOT, env=_environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _end(pid: int) -> None:
    """Kill a process that this bench started, with its children."""
    try:
        family = [*psutil.Process(pid).children(recursive=True), psutil.Process(pid)]
    except psutil.NoSuchProcess:
        return
    for each in family:
        with suppress(psutil.NoSuchProcess):
            each.kill()


def free_port() -> int:
    """A port that nobody has."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def finished(process: subprocess.Popen[bytes]) -> int:
    """The exit code; what it said on the way goes to our own error output if it failed."""
    _, said = process.communicate(timeout=PATIENCE)
    if process.returncode not in (0, 1):
        sys.stderr.write(said.decode(errors="replace"))
    return process.returncode


def rows_of(out: Path) -> bytes:
    """The data set's bytes; empty without one."""
    return b"".join(path.read_bytes() for path in parts(out / "rows"))


def same_rows(report: Report, folder: Path, study: Path) -> bytes:
    """One worker, two, and a scheduler with two workers; gives the rows."""
    ways: dict[str, bytes] = {}
    for name in ("1", "2"):
        finished(command(study, folder / name, "--workers", name))
        ways[name] = rows_of(folder / name)
    port = free_port()
    with cluster(port):
        finished(command(study, folder / "remote", "--scheduler", f"tcp://127.0.0.1:{port}"))
    ways["remote"] = rows_of(folder / "remote")
    n = read_data_set(folder / "1" / "rows").num_rows
    report.row("2 workers: rows as with 1, bytes that differ", _differing(ways["1"], ways["2"]), "B", at_most=0, n=n)
    report.row("scheduler and two workers apart: bytes that differ", _differing(ways["1"], ways["remote"]), "B", at_most=0, n=n)
    return ways["1"]


def _differing(a: bytes, b: bytes) -> int:
    return abs(len(a) - len(b)) + sum(x != y for x, y in zip(a, b, strict=False))


def workers_killed(report: Report, folder: Path, study: Path, wanted: bytes) -> None:
    """A worker is killed, ten times, while the study runs."""
    process = command(study, folder / "killed", "--workers", "2")
    rng, killed = np.random.default_rng(report.options.seed), 0
    while killed < KILLS and process.poll() is None:
        time.sleep(float(rng.uniform(0.5, 1.5)))
        found = _workers_of(process.pid)
        if found and _kept(folder / "killed") > killed:  # spread over the study
            with suppress(psutil.NoSuchProcess):
                found[int(rng.integers(len(found)))].kill()
                killed += 1
    finished(process)
    report.row("workers killed", killed, "", at_least=KILLS)
    report.row("workers killed: bytes of rows that differ", _differing(wanted, rows_of(folder / "killed")), "B", at_most=0)


def _kept(out: Path) -> int:
    return sum(1 for _ in rows(out / "journal"))


def _workers_of(pid: int) -> list[psutil.Process]:
    """The processes that do the runs: those that Dask's nannies spawned."""
    with suppress(psutil.NoSuchProcess):
        return [each for each in psutil.Process(pid).children(recursive=True) if "spawn_main" in " ".join(each.cmdline())]
    return []


def all_killed(report: Report, folder: Path, study: Path, wanted: bytes) -> None:
    """The sweep itself is killed with all its workers, and the same command goes on."""
    out, lost, before = folder / "gone", 0, -1
    while before < len(wanted):
        process = command(study, out, "--workers", "2")
        until = time.monotonic() + PATIENCE
        start = _kept(out)
        while process.poll() is None and _kept(out) < start + 8 and time.monotonic() < until:
            time.sleep(0.1)
        if process.poll() is not None:
            finished(process)
            break
        _end(process.pid)
        process.wait()
        lost += 1
        before = _kept(out)
    report.row("machine gone: times", lost, "", at_least=1)
    report.row("machine gone: bytes of rows that differ", _differing(wanted, rows_of(out)), "B", at_most=0)


def scheduler_killed(report: Report, folder: Path, study: Path, wanted: bytes) -> None:
    """The scheduler and its workers go, twice, and come again at the same address."""
    port, out, times = free_port(), folder / "restarted", 0
    process = None
    for _ in range(SCHEDULERS):
        with cluster(port):
            process = process or command(study, out, "--scheduler", f"tcp://127.0.0.1:{port}")
            start, until = _kept(out), time.monotonic() + PATIENCE
            while process.poll() is None and _kept(out) < start + 5 and time.monotonic() < until:
                time.sleep(0.1)
        times += process.poll() is None
    assert process is not None
    with cluster(port):
        finished(process)
    report.row("scheduler killed", times, "", at_least=SCHEDULERS)
    report.row("scheduler killed: bytes of rows that differ", _differing(wanted, rows_of(out)), "B", at_most=0)


def disk_full(report: Report, folder: Path, study: Path, wanted: bytes) -> None:
    """The results lie on a disk that becomes full; with room again the same command goes on."""
    out = folder / "full"
    out.mkdir()
    mounted = (
        subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={SMALL}", "none", str(out)], capture_output=True, check=False
        ).returncode
        == 0
    )
    if not mounted:
        report.notes.append("disk full: no right to mount a small disk here; not measured")
        return
    try:
        code = finished(command(study, out, "--workers", "2"))
        kept = _kept(out) or (read_data_set(out / "rows").num_rows if parts(out / "rows") else 0)
        subprocess.run(["mount", "-o", "remount,size=50m", str(out)], check=True)
        finished(command(study, out, "--workers", "2"))
        found = rows_of(out)
    finally:
        subprocess.run(["umount", str(out)], check=True)
    report.row("disk full: exit code of the first sweep", code, "", at_least=2, at_most=2)
    report.row("disk full: rows kept", kept, "")
    report.row("disk full: bytes of rows that differ", _differing(wanted, found), "B", at_most=0)


class Timed(NamedTuple):
    """A session's run."""

    ticks: float  # time in its ticks [s]
    pid: int
    memory: int  # of the process, after it [B]


def timed(work: tuple[Session, int]) -> Timed:
    """Run a session with a seed."""
    made = msgspec.structs.replace(work[0], seed=work[1])
    prepared = prepare(made, "bench")
    outcome = run(made, prepared, simulate(prepared), None)
    return Timed(outcome.took, os.getpid(), psutil.Process().memory_info().rss)


PLAIN = """
import sys, time
import msgspec
from app.api import session
from benchmarks.sweep import BASE, timed
base, count = session(BASE, duration=float(sys.argv[1])), int(sys.argv[2])
timed((base, 0))
print("ready", flush=True)
sys.stdin.readline()
for seed in range(count):
    timed((base, seed))
print("done", flush=True)
"""


def plain(duration: float, count: int) -> float:
    """Time of two plain loops at once, started up before [s]."""
    arguments = [sys.executable, "-c", PLAIN, str(duration), str(count)]
    loops = [
        subprocess.Popen(arguments, cwd=ROOT, env=_environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
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
    for loop in loops:
        loop.communicate()
    return time.perf_counter() - start


def cost(report: Report) -> None:
    """Sessions of 5 s on two workers against two plain loops, in turns; and where the time goes."""
    rounds, count, duration = (5, 50, 5.0) if report.options.full else (3, 8, 5.0)
    base = session(BASE, duration=duration)
    start = time.perf_counter()
    list(spreading.spread(timed, [(base, 0)] * 4, workers=2))
    report.row("workers and kernels ready, once", time.perf_counter() - start, "s")
    engine = loops = in_ticks = own = 0.0
    for k in range(rounds):
        for turn in ((0, 1), (1, 0))[k % 2]:
            if turn:
                loops += plain(duration, count)
                continue
            start, cpu = time.perf_counter(), time.process_time()
            found = list(spreading.spread(timed, ((base, seed) for seed in range(2 * count)), workers=2))
            engine += time.perf_counter() - start
            own += time.process_time() - cpu
            in_ticks += sum(each.ticks for _, each in found)
    n = 2 * rounds * count
    report.row("time over that of two plain loops", engine / loops, "", at_most=1.1, n=n)
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
    base = session({**BASE, "duration": 1.0, "posture": [0.0, -1.3, 1.6, -1.9, -1.6, 0.0]})
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


def bundled_study(report: Report) -> None:
    """How many runs the quick sizes have."""
    for name in ("contact-delay", "friction-temperature", "letting-go", "sequence-limit"):
        study, base = open_study(name, quick=True)
        report.row(f"{name}, quick: runs", Plan(study, base, name).size, "")


def measure(report: Report) -> None:
    """Fill the report."""
    with TemporaryDirectory() as folder:
        here = Path(folder)
        large(report, here)
        study = written(here, study_fields(120 if report.options.full else 60, 1.0))
        wanted = same_rows(report, here, study)
        workers_killed(report, here, study, wanted)
        all_killed(report, here, study, wanted)
        scheduler_killed(report, here, study, wanted)
        disk_full(report, here, study, wanted)
        shutil.rmtree(here / "large")
    memory(report)
    cost(report)
    bundled_study(report)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    main("sweep", measure)
