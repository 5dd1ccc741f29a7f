"""The same rows whoever does the runs, and whatever dies on the way."""

import subprocess
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil

from app.studies.data_set import parts, read_data_set
from app.studies.row_journal import rows
from benchmarks.common import Report
from benchmarks.sweeps.processes import PATIENCE, cluster, command, end, finished, free_port

KILLS, SCHEDULERS = 10, 2
SMALL = "16k"
"""Size of a disk that becomes full before the study is done."""


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
    """A worker is killed at ten moments, drawn over the study: by how many rows there are, and a part of a run after that."""
    out, n = folder / "killed", read_data_set(folder / "1" / "rows").num_rows
    rng = np.random.default_rng(report.options.seed)
    moments = sorted(rng.choice(int(0.9 * n), KILLS, replace=False).tolist())
    process = command(study, out, "--workers", "2")
    killed: list[int] = []
    while len(killed) < KILLS and process.poll() is None:
        if _kept(out) <= moments[len(killed)] or not (found := _workers_of(process.pid)):
            time.sleep(0.01)
            continue
        time.sleep(float(rng.uniform(0.0, 0.3)))
        with suppress(psutil.NoSuchProcess):
            found[int(rng.integers(len(found)))].kill()
            killed.append(_kept(out))
    finished(process)
    report.row("workers killed", len(killed), "", at_least=KILLS)
    report.row("workers killed: numbers of rows at which", len(set(killed)), "", n=n)
    report.row("workers killed: bytes of rows that differ", _differing(wanted, rows_of(out)), "B", at_most=0)
    report.row("workers killed: rows lost or twice", _lost_or_twice(out, n), "", at_most=0, n=n)


def _lost_or_twice(out: Path, n: int) -> int:
    """How many numbers of runs are not there exactly once."""
    numbers = read_data_set(out / "rows")["run"].to_pylist()
    return sum(numbers.count(k) != 1 for k in range(n)) + sum(not 0 <= number < n for number in numbers)


def _kept(out: Path) -> int:
    return sum(1 for _ in rows(out / "journal"))


def _workers_of(pid: int) -> list[psutil.Process]:
    """The processes that do the runs, or start up to do them."""
    with suppress(psutil.NoSuchProcess):
        return [each for each in psutil.Process(pid).children() if "spawn_main" in " ".join(each.cmdline())]
    return []


def all_killed(report: Report, folder: Path, study: Path, wanted: bytes) -> None:
    """The sweep itself is killed with all its workers, and the same command goes on."""
    out, lost, n = folder / "gone", 0, read_data_set(folder / "1" / "rows").num_rows
    while lost < n:
        process = command(study, out, "--workers", "2")
        until = time.monotonic() + PATIENCE
        start = _kept(out)
        while process.poll() is None and _kept(out) < start + 12 and time.monotonic() < until:
            time.sleep(0.1)
        if process.poll() is not None:
            finished(process)
            break
        end(process.pid)
        process.wait()
        lost += 1
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
