"""Which claims are shown: every session that names some, at many seeds, with its switch off, and with its mutants.

The result is claims.md and claims.json.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from app.files.checked import ABSENT, BadInput
from app.runs.jobs import Job, run_all
from app.runs.runner import RunOutcome, missed
from app.session.claims import CLAIMS, Claim
from app.session.prepare import claiming, without
from app.session.session_file import Session
from tools.claims.claim_mutants import Trial

STATES = ("shown", "fails", "holds without its switch", "holds with a mutant", "has no mutant", "missing")


class Seeds(NamedTuple):
    """Seeds at which each session runs."""

    on: tuple[int, ...]  # with its switch on
    changed: tuple[int, ...]  # with its switch off, and with each of its mutants


class Outcomes(NamedTuple):
    """What a session came to, by seed."""

    on: dict[int, RunOutcome]
    off: dict[int, RunOutcome]


@dataclass(frozen=True, slots=True)
class ClaimRow:
    """A claim and a session that shows it; without a session, nothing does."""

    claim: Claim
    session: str | None = None
    checks: tuple[str, ...] = ()  # what the session expects, in words
    switch: str | None = None
    failed: tuple[int, ...] = ()  # seeds at which it fails with the switch on
    held: tuple[int, ...] = ()  # seeds at which it holds with the switch off
    why: str = ""  # the first expectation that was not met with the switch on
    trials: tuple[Trial, ...] = ()  # of the row's mutants
    untried: bool = False  # the claim has no mutant

    @property
    def shown(self) -> bool:
        """Whether the claim holds at each seed, and at none without its switch or with one of its mutants."""
        return self.state == "shown"

    @property
    def state(self) -> str:
        """In a word."""
        if self.session is None:
            return "missing"
        if self.failed or not self.checks:
            return "fails"
        if self.held:
            return "holds without its switch"
        if self.untried:
            return "has no mutant"
        return "shown" if all(trial.noticed for trial in self.trials) else "holds with a mutant"


def cover(out: Path, seeds: Seeds, told: Callable[[int, int], None] = lambda done, of: None) -> list[ClaimRow]:
    """Run all claiming sessions, on and off, in parallel; their events go into folders of `out`.

    Args:
        out: folder for the results.
        seeds: at which they run.
        told: how many runs are done, of how many.

    Raises:
        BadInput: a session cannot be used, or a result cannot be written.
    """
    sessions = claiming()
    outcomes = {name: Outcomes({}, {}) for name in sessions}
    jobs: list[Job] = []
    places: list[tuple[dict[int, RunOutcome], int]] = []
    for name, session in sessions.items():
        off = without(session)
        for seed in seeds.on:
            jobs.append(Job(f"{name}.yaml", _at(session, seed), out / name / f"{seed}", recorded=False))
            places.append((outcomes[name].on, seed))
        for seed in seeds.changed:
            jobs.append(Job(f"{name}.yaml", _at(off, seed), out / name / f"{seed}-off", recorded=False, enough=missed))
            places.append((outcomes[name].off, seed))
    for done, (place, outcome) in enumerate(run_all(jobs), 1):
        found, seed = places[place]
        found[seed] = outcome
        told(done, len(jobs))
    return rows_of(sessions, outcomes)


def _at(session: Session, seed: int) -> Session:
    return msgspec.structs.replace(session, seed=seed)


def rows_of(sessions: dict[str, Session], outcomes: dict[str, Outcomes]) -> list[ClaimRow]:
    """A row for each claim and session that shows it, in the order of the claims; one without a session where there is none."""
    rows: list[ClaimRow] = []
    for claim in CLAIMS.values():
        names = [name for name, session in sessions.items() if claim.name in session.claims]
        rows += [_row(claim, name, sessions[name], outcomes[name]) for name in names] or [ClaimRow(claim)]
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


def _row(claim: Claim, name: str, session: Session, outcomes: Outcomes) -> ClaimRow:
    checks = tuple(verdict.expected for verdict in next(iter(outcomes.on.values())).verdicts)
    failed = tuple(sorted(seed for seed, outcome in outcomes.on.items() if not outcome.passed))
    held = tuple(sorted(seed for seed, outcome in outcomes.off.items() if not outcome.unmet))
    unmet = [verdict for seed in failed[:1] for verdict in outcomes.on[seed].verdicts if not verdict.passed]
    why = f"at seed {failed[0]}: {unmet[0].expected}: {unmet[0].seen}" if unmet else ""
    return ClaimRow(claim, name, checks, session.switch, failed, held, why)


def write(rows: list[ClaimRow], seeds: Seeds, out: Path) -> None:
    """Write `out`/claims.md and `out`/claims.json.

    Raises:
        BadInput: they cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / "claims.md").write_text(markdown(rows, seeds), encoding="utf-8")
        (out / "claims.json").write_bytes(msgspec.json.format(msgspec.json.encode(as_json(rows, seeds)), indent=1) + b"\n")
    except OSError as error:
        raise BadInput(str(out), "", ABSENT, f"cannot be written ({error.strerror})") from None


def as_json(rows: list[ClaimRow], seeds: Seeds) -> list[dict[str, Any]]:
    """The content of claims.json."""
    return [
        {
            "name": row.claim.name,
            "to_show": row.claim.text,
            "ids": row.claim.ids.split(),
            "session": row.session,
            "seeds": seeds.on,
            "failed": row.failed,
            "checks": row.checks,
            "switch": row.switch,
            "changed_seeds": seeds.changed,
            "held_when_off": row.held,
            "why": row.why,
            "mutants": [
                {"what": t.mutant.what, "file": t.mutant.file, "not_noticed": t.not_noticed, "seen": t.seen} for t in row.trials
            ],
        }
        for row in rows
    ]


def totals(rows: list[ClaimRow]) -> dict[str, int]:
    """How many rows are in each state."""
    return {state: sum(row.state == state for row in rows) for state in STATES}


def in_short(seeds: Iterable[int]) -> str:
    """Seeds as `seeds_in` reads them, in ascending order: [1, 2, 3, 7] is "1-3,7"; none is ""."""
    parts: list[list[int]] = []
    for seed in sorted(seeds):
        if parts and parts[-1][-1] == seed - 1:
            parts[-1][1:] = [seed]
        else:
            parts.append([seed])
    return ",".join("-".join(map(str, part)) for part in parts)


def markdown(rows: list[ClaimRow], seeds: Seeds) -> str:
    """The content of claims.md."""
    counts = ", ".join(f"{number} {state}" for state, number in totals(rows).items())
    lines = [
        "# Claims",
        "",
        f"Written by `make claims`. A row is shown when its session meets what it expects at seeds {in_short(seeds.on)}, and at "
        f"seeds {in_short(seeds.changed)} does not with its switch off, nor with any of its mutants: the smallest changes of "
        "code that take away what the claim says.",
        "",
        f"{len(rows)} rows: {counts}.",
        "",
        "| claim | to show | ids | session | checks | switch | fails at | holds when off at | mutants, and what was seen | |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        cells = [
            row.claim.name,
            row.claim.text,
            row.claim.ids,
            row.session or "-",
            "<br>".join(row.checks) or "-",
            row.switch or "-",
            in_short(row.failed) or "-",
            in_short(row.held) or "-",
            "<br>".join(_told(trial) for trial in row.trials) or "-",
            row.state + (f": {row.why}" if row.why else ""),
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _told(trial: Trial) -> str:
    noticed = "noticed" if trial.noticed else f"NOT NOTICED at {in_short(trial.not_noticed)}"
    return f"{trial.mutant.what} (`{trial.mutant.file}`): {noticed}; {trial.seen}"
