"""Whether a session and a seed give the same events, byte for byte: every bundled session twice, some of them in real time."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from app.files.checked import load
from app.runs.jobs import Job, run_all
from app.session.session_file import Session, bundled, find
from benchmarks.common import Report, main

REALTIME = ("activation-too-short", "contact-3c", "let-go-too-early")
"""Sessions that also keep the pace of the clock. In the full size all of them."""


def differing(names: Sequence[str], realtime: bool) -> tuple[list[str], int]:
    """Run sessions twice, each in a process of its own.

    Args:
        names: of bundled sessions.
        realtime: keep the pace of the clock the second time.

    Returns:
        The names whose events.jsonl or figures of expectations are not the same, and the bytes that were compared.
    """
    sessions = [load(find(name), Session) for name in names]
    with TemporaryDirectory() as out:
        folders = [(Path(out) / name / "once", Path(out) / name / "again") for name in names]
        jobs: list[Job] = []
        for name, session, (once, again) in zip(names, sessions, folders, strict=True):
            jobs.append(Job(name, session, once, recorded=False))
            jobs.append(Job(name, session, again, realtime=realtime, recorded=False))
        outcomes = dict(run_all(jobs))
        pairs = [[(folder / "events.jsonl").read_bytes() for folder in pair] for pair in folders]
    wrong = [
        name
        for place, (name, (once, again)) in enumerate(zip(names, pairs, strict=True))
        if once != again or outcomes[2 * place].verdicts != outcomes[2 * place + 1].verdicts
    ]
    return wrong, sum(len(once) for once, _ in pairs)


def measure(report: Report) -> None:
    """Fill the report."""
    names = bundled("sessions")
    for what, chosen, realtime in (
        ("twice", names, False),
        ("again in real time", names if report.options.full else list(REALTIME), True),
    ):
        wrong, size = differing(chosen, realtime)
        report.row(f"bundled sessions {what}: different events", len(wrong), "sessions", at_most=0, n=len(chosen))
        report.row(f"bundled sessions {what}: events compared", size / 1000, "kB", n=len(chosen))
        report.notes += [f"{what}: different events of {name}" for name in wrong]


if __name__ == "__main__":
    main("determinism", measure)
