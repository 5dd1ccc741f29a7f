"""Writes out/docs/claims.md: a row a claim, then all that was expected and seen.

Run: `python -m tools.claims.claims_page`. Given the claims.json that `make claims` wrote last, it takes over first what that run
showed, into docs/results/claims.csv.
"""

import csv
import hashlib
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from app.session.claims import CLAIMS
from app.session.measures import watch
from app.session.prepare import claiming, prepare
from app.session.session_file import Session
from tools.claims.claim_mutants import Mutant, declared
from tools.claims.coverage import in_short

ROOT = Path(__file__).parents[2]
PAGE, SHOWN, RUN = ROOT / "out/docs/claims.md", ROOT / "docs/results/claims.csv", ROOT / "out/claims/claims.json"

HEAD = """# Claims

Written by `python -m tools.claims.claims_page` from the sessions, the mutants and [claims.csv](../../docs/results/claims.csv). A
claim is shown where its session (`assets/sessions/`) meets what it expects at all seeds, and at three of them does not with its
switch off, nor with any of its mutants: the smallest changes of code that take away what the claim says
(`tools/claims/mutants/`). `yes`: the last `make claims` saw all of that. `not run`: expectations or mutants are newer than it.
The second table has what each session expects, each mutant, and what was seen.

| claim | to show | ids | sessions: seeds, mutants, shown |
|---|---|---|---|
"""

LONG_HEAD = """
## All that is expected and was seen

| claim | session | switch | it expects | mutants, and what was seen | shown |
|---|---|---|---|---|---|
"""

NOT_RUN = "not run"

Row = dict[str, Any]
"""Of claims.json: a claim and a session, what was expected, and what was seen, with and without each mutant."""


class Seen(NamedTuple):
    """A row of claims.csv: what the last run says of a claim and a session. Seeds are as `in_short` writes them."""

    claim: str
    session: str
    passed: str  # seeds at which the session met what it expects
    failed: str  # seeds at which it did not
    held: str  # seeds at which it did with its switch off
    mutants: int
    not_noticed: int  # of these, at one seed at least
    of: str  # digest of what ran

    @property
    def shown(self) -> str:
        """ "yes" or "no"."""
        return "no" if self.failed or self.held or self.not_noticed else "yes"


def digest(checks: Iterable[str], mutants: Iterable[tuple[str, str]]) -> str:
    """Of what a row runs: what is expected in words, and each mutant in words with its file. 8 hexadecimal digits."""
    return hashlib.sha256(msgspec.json.encode([list(checks), sorted(mutants)])).hexdigest()[:8]


def seen_in(rows: Iterable[Row]) -> list[Seen]:
    """The rows of claims.json in short; a claim that no session shows has none."""
    found: list[Seen] = []
    for row in rows:
        if row["session"] is not None:
            tried = [(mutant["what"], mutant["file"]) for mutant in row["mutants"]]
            passed = in_short(set(row["seeds"]) - set(row["failed"]))
            missed = sum(bool(mutant["not_noticed"]) for mutant in row["mutants"])
            seeds = passed, in_short(row["failed"]), in_short(row["held_when_off"])
            found.append(Seen(row["name"], row["session"], *seeds, len(tried), missed, digest(row["checks"], tried)))
    return found


def read_seen(path: Path = SHOWN) -> dict[tuple[str, str], Seen]:
    """claims.csv, by claim and session."""
    with path.open(encoding="utf-8", newline="") as file:
        read = csv.reader(file)
        next(read)
        rows = [Seen(row[0], row[1], row[2], row[3], row[4], int(row[5]), int(row[6]), row[7]) for row in read]
    return {(row.claim, row.session): row for row in rows}


def write_seen(rows: Iterable[Seen], path: Path = SHOWN) -> None:
    """Write claims.csv."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Seen._fields)
        writer.writerows(rows)


class Expected(NamedTuple):
    """What shows a claim."""

    claim: str
    session: str
    switch: str
    checks: list[str]
    mutants: list[Mutant]

    @property
    def of(self) -> str:
        """See `digest`."""
        return digest(self.checks, [(mutant.what, mutant.file) for mutant in self.mutants])


def expected() -> list[Expected]:
    """What shows each claim, in the order of the claims."""
    sessions, mutants = claiming(), declared()
    words = {name: checks(session, name) for name, session in sessions.items()}
    return [
        Expected(
            claim,
            name,
            session.switch or "",
            words[name],
            [mutant for mutant in mutants if mutant.session == name and claim in mutant.claims],
        )
        for claim in CLAIMS
        for name, session in sessions.items()
        if claim in session.claims
    ]


def checks(session: Session, name: str) -> list[str]:
    """What a session expects, in words."""
    joints = prepare(session, name).arm.chain.joints
    return [watch(expectation, joints).expected() for expectation in session.expectations]


def shown(each: Expected, seen: Seen | None) -> str:
    """Whether a run has shown it as it is now."""
    return NOT_RUN if seen is None or seen.of != each.of else seen.shown


def page(wanted: list[Expected], seen: dict[tuple[str, str], Seen]) -> str:
    """The claims, a row each."""
    lines: list[str] = []
    for claim in CLAIMS.values():
        own = [each for each in wanted if each.claim == claim.name]
        told = [f"`{each.session}`: {_in_short(each, seen.get((each.claim, each.session)))}" for each in own]
        lines.append(_line([claim.name, claim.text, claim.ids, "<br>".join(told) or "none"]))
    return HEAD + "\n".join(lines) + "\n"


def _in_short(each: Expected, seen: Seen | None) -> str:
    """The seeds at which it passed, mutants that were noticed of all, and whether it is shown."""
    if seen is None or seen.of != each.of:
        return f"-, {len(each.mutants)}, {NOT_RUN}"
    return f"{seen.passed or '-'}, {seen.mutants - seen.not_noticed} of {seen.mutants}, {seen.shown}"


def details(wanted: list[Expected], seen: dict[tuple[str, str], Seen], rows: Iterable[Row]) -> str:
    """All that is expected and was seen; `rows` are of the run that is at hand, maybe none."""
    run = {(row["name"], row["session"]): row for row in rows}
    lines: list[str] = []
    for each in wanted:
        row = run.get((each.claim, each.session))
        tried: dict[tuple[str, str], Row] = {} if row is None else {(m["what"], m["file"]): m for m in row["mutants"]}
        told = [_told(mutant, tried.get((mutant.what, mutant.file))) for mutant in each.mutants]
        state = shown(each, seen.get((each.claim, each.session)))
        cells = [each.claim, each.session, each.switch or "-", "<br>".join(each.checks), "<br>".join(told) or "-", state]
        lines.append(_line(cells))
    return LONG_HEAD + "\n".join(lines) + "\n"


def _told(mutant: Mutant, seen: Row | None) -> str:
    return f"{mutant.what} (`{mutant.file}`) - not met: {mutant.fails}" + ("" if seen is None else f"; seen: {seen['seen']}")


def _line(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def main(arguments: list[str]) -> None:
    """Write the page, and claims.csv where a run is given."""
    run = Path(arguments[0]) if arguments else RUN
    rows: list[Row] = msgspec.json.decode(run.read_bytes()) if arguments or run.exists() else []
    if arguments:
        write_seen(seen_in(rows))
    wanted, seen = expected(), read_seen()
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(page(wanted, seen) + details(wanted, seen, rows), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
