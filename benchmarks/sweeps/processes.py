"""Sweeps, schedulers and workers as processes of their own, which can be killed."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

from benchmarks.common import ROOT

PATIENCE = 300.0  # [s] for one sweep of this bench


def command(study: Path | str, out: Path, *more: str) -> subprocess.Popen[bytes]:
    """`pendant sweep` in a process of its own."""
    call = "import sys\nif __name__ == '__main__':\n    from app.cli import main\n    main()"
    arguments = [sys.executable, "-c", call, "sweep", str(study), "--out", str(out), *more]
    return subprocess.Popen(arguments, cwd=ROOT, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def environment() -> dict[str, str]:
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
            end(process.pid)
            process.wait()


def _dask(*arguments: str) -> subprocess.Popen[bytes]:
    call = [sys.executable, "-m", "dask", *arguments]
    return subprocess.Popen(call, cwd=ROOT, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def end(pid: int) -> None:
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
