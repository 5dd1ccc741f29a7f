"""Which claims are shown: every session that names some runs with its switch on and off, and with its mutants.

The result is claims.md and claims.json.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from app.files.checked import ABSENT, BadInput, load
from app.runs.claim_mutants import Trial
from app.runs.jobs import Job, run_all
from app.runs.runner import RunOutcome, missed
from app.session.claims import CLAIMS, Claim
from app.session.prepare import prepare, without
from app.session.session_file import Session, bundled, find

STATES = ("shown", "fails", "holds without its switch", "holds with a mutant", "has no mutant", "missing")


@dataclass(frozen=True, slots=True)
class ClaimRow:
    """A claim and a session that shows it; without a session, nothing does."""

    claim: Claim
    session: str | None = None
    seed: int | None = None  # that the session ran with
    checks: tuple[str, ...] = ()  # what the session expects, in words
    switch: str | None = None
    passed: bool | None = None  # with the switch on
    failed_when_off: bool | None = None
    why: str = ""  # the first expectation that was not met with the switch on
    trials: tuple[Trial, ...] | None = None  # of the row's mutants; None: they were not asked for
    untried: bool = False  # they were, and the claim has none

    @property
    def shown(self) -> bool:
        """Whether the claim holds, and neither without its switch nor with one of its mutants."""
        noticed = self.trials is None or all(trial.noticed for trial in self.trials)
        return self.passed is True and self.failed_when_off is True and noticed and not self.untried

    @property
    def state(self) -> str:
        """In a word."""
        if self.session is None:
            return "missing"
        if self.shown:
            return "shown"
        if not self.passed:
            return "fails"
        if not self.failed_when_off:
            return "holds without its switch"
        return "has no mutant" if self.untried else "holds with a mutant"


def claiming() -> dict[str, Session]:
    """The bundled sessions that name a switch, by name, checked.

    Raises:
        BadInput: one of them cannot be used.
    """
    found: dict[str, Session] = {}
    for name in bundled("sessions"):
        session = load(find(name), Session)
        if session.switch is not None:
            prepare(session, f"{name}.yaml")
            found[name] = session
    return found


def cover(out: Path, told: Callable[[int, int], None] = lambda done, of: None) -> list[ClaimRow]:
    """Run all claiming sessions, on and off, in parallel; their results go into folders of `out`.

    Args:
        out: folder for the results.
        told: how many runs are done, of how many.

    Raises:
        BadInput: a session cannot be used, or a result cannot be written.
    """
    sessions = claiming()
    jobs: list[Job] = []
    for name, session in sessions.items():
        jobs.append(Job(f"{name}.yaml", session, out / name / "on", recorded=False))
        jobs.append(Job(f"{name}.yaml", without(session), out / name / "off", recorded=False, enough=missed))
    outcomes: dict[int, RunOutcome] = {}
    for place, outcome in run_all(jobs):
        outcomes[place] = outcome
        told(len(outcomes), len(jobs))
    pairs = {name: (outcomes[2 * i], outcomes[2 * i + 1]) for i, name in enumerate(sessions)}
    return rows_of(sessions, pairs)


def rows_of(sessions: dict[str, Session], pairs: dict[str, tuple[RunOutcome, RunOutcome]]) -> list[ClaimRow]:
    """A row for each claim and session that shows it, in the order of the claims; one without a session where there is none."""
    rows: list[ClaimRow] = []
    for claim in CLAIMS.values():
        names = [name for name, session in sessions.items() if claim.name in session.claims]
        rows += [_row(claim, name, sessions[name], on=pairs[name][0], off=pairs[name][1]) for name in names] or [ClaimRow(claim)]
    return rows


def with_trials(rows: list[ClaimRow], trials: list[Trial]) -> list[ClaimRow]:
    """The rows, each with the trials of its claim and session.

    Where several sessions show a claim, one of them at least has mutants.
    """
    tried = {claim for trial in trials for claim in trial.mutant.claims}
    found: list[ClaimRow] = []
    for row in rows:
        own = tuple(t for t in trials if t.mutant.session == row.session and row.claim.name in t.mutant.claims)
        found.append(replace(row, trials=own, untried=row.claim.name not in tried))
    return found


def _row(claim: Claim, name: str, session: Session, *, on: RunOutcome, off: RunOutcome) -> ClaimRow:
    checks = tuple(verdict.expected for verdict in on.verdicts)
    unmet = next((f"{verdict.expected}: {verdict.seen}" for verdict in on.verdicts if not verdict.passed), "")
    passed = on.passed and bool(checks)
    return ClaimRow(claim, name, session.seed, checks, session.switch, passed, failed_when_off=off.unmet, why=unmet)


def write(rows: list[ClaimRow], out: Path) -> None:
    """Write `out`/claims.md and `out`/claims.json.

    Raises:
        BadInput: they cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / "claims.md").write_text(markdown(rows), encoding="utf-8")
        (out / "claims.json").write_bytes(msgspec.json.format(msgspec.json.encode(as_json(rows)), indent=1) + b"\n")
    except OSError as error:
        raise BadInput(str(out), "", ABSENT, f"cannot be written ({error.strerror})") from None


def as_json(rows: list[ClaimRow]) -> list[dict[str, Any]]:
    """The content of claims.json."""
    return [
        {
            "name": row.claim.name,
            "to_show": row.claim.text,
            "ids": row.claim.ids.split(),
            "session": row.session,
            "seed": row.seed,
            "checks": row.checks,
            "switch": row.switch,
            "passed": row.passed,
            "failed_when_off": row.failed_when_off,
            "why": row.why,
            "mutants": [
                {"what": t.mutant.what, "file": t.mutant.file, "noticed": t.noticed, "seen": t.seen} for t in row.trials or ()
            ],
        }
        for row in rows
    ]


def totals(rows: list[ClaimRow]) -> dict[str, int]:
    """How many rows are in each state."""
    return {state: sum(row.state == state for row in rows) for state in STATES}


def markdown(rows: list[ClaimRow]) -> str:
    """The content of claims.md."""
    counts = ", ".join(f"{number} {state}" for state, number in totals(rows).items())
    lines = [
        "# Claims",
        "",
        "Written by `pendant claims --mutants`. A row is shown when its session meets what it expects, and does not with its "
        "switch off, nor with any of its mutants: the smallest changes of code that take away what the claim says.",
        "",
        f"{len(rows)} rows: {counts}.",
        "",
        "| claim | to show | ids | session | checks | switch | passed | failed when off | mutants, and what was seen | |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        checks = "<br>".join(row.checks).replace("|", "\\|")
        cells = [row.claim.name, row.claim.text, row.claim.ids, row.session or "-", checks or "-", row.switch or "-"]
        cells += [
            _word(row.passed),
            _word(row.failed_when_off),
            "<br>".join(_told(trial) for trial in row.trials or ()).replace("|", "\\|") or "-",
            row.state + (f": {row.why}" if row.why else "").replace("|", "\\|"),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _told(trial: Trial) -> str:
    noticed = "noticed" if trial.noticed else "NOT NOTICED"
    return f"{trial.mutant.what} (`{trial.mutant.file}`): {noticed}; {trial.seen}"


def _word(value: bool | None) -> str:
    return {True: "yes", False: "no", None: "-"}[value]
