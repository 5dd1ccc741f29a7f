"""Writes docs/reference/claims.md: each claim, its session, its mutants, and what was seen. Run: `python -m tools.claims_page`.

What was seen is what `make claims` has written last: `python -m tools.claims_page FILE`, given its claims.json, takes that over.
"""

import sys
from pathlib import Path
from typing import Any

import msgspec

from app.runs.claim_mutants import Mutant, declared
from app.runs.coverage import claiming
from app.session.claims import CLAIMS, Claim
from app.session.measures import watch
from app.session.prepare import prepare
from app.session.session_file import Session

ROOT = Path(__file__).parents[1]
PAGE, SEEN = ROOT / "docs/reference/claims.md", ROOT / "docs/results/claims.json"

HEAD = """# Claims

Written by `python -m tools.claims_page`. A claim is shown where its session meets what it expects, and does not with its
switch off, nor with any of its mutants: the smallest changes of code that take away what the claim says (`assets/mutants/`).
Behind each mutant stands the expectation that is not met with it, and what was seen in the last `make claims`. A row says `yes`
in its last column if all of that was seen then, and `not run` where something of it is newer.

"""

NOT_RUN = "not run"


def page() -> str:
    """The page."""
    sessions, mutants = claiming(), declared()
    expected = {name: checks(session, name) for name, session in sessions.items()}
    rows: list[dict[str, Any]] = msgspec.json.decode(SEEN.read_bytes())
    seen: dict[tuple[str, str], dict[str, Any]] = {(row["name"], row["session"]): row for row in rows}
    lines = [
        "| claim | to show | ids | session | it expects | switch | mutants, and what was seen | shown |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for claim in CLAIMS.values():
        for name, session in sessions.items():
            if claim.name in session.claims:
                own = [mutant for mutant in mutants if mutant.session == name and claim.name in mutant.claims]
                row = seen.get((claim.name, name))
                lines.append(_row(claim, name, expected[name], switch=session.switch, mutants=own, row=row))
    return HEAD + "\n".join(lines) + "\n"


def checks(session: Session, name: str) -> list[str]:
    """What a session expects, in words."""
    joints = prepare(session, name).arm.chain.joints
    return [watch(expectation, joints).expected() for expectation in session.expectations]


def _row(
    claim: Claim, name: str, checks: list[str], *, switch: str | None, mutants: list[Mutant], row: dict[str, Any] | None
) -> str:
    link = f"[{name}](../../assets/sessions/{name}.yaml)"
    tried: list[dict[str, Any]] = [] if row is None else row["mutants"]
    seen: dict[tuple[str, str], Any] = {(mutant["what"], mutant["file"]): mutant for mutant in tried}
    told = [_told(mutant, seen.get((mutant.what, mutant.file))) for mutant in mutants]
    cells = [claim.name, claim.text, claim.ids, link, "<br>".join(checks), switch or "-", "<br>".join(told) or "-"]
    cells.append(_shown(mutants, row, seen, checks))
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _told(mutant: Mutant, seen: dict[str, Any] | None) -> str:
    return f"{mutant.what} (`{mutant.file}`) - not met: {mutant.fails}" + ("" if seen is None else f"; seen: {seen['seen']}")


def _shown(mutants: list[Mutant], row: dict[str, Any] | None, seen: dict[tuple[str, str], Any], checks: list[str]) -> str:
    """Whether the row is shown: by a run of the session as it is, and of all of the mutants."""
    if row is None or row["checks"] != checks or any((mutant.what, mutant.file) not in seen for mutant in mutants):
        return NOT_RUN
    noticed = all(seen[mutant.what, mutant.file]["noticed"] for mutant in mutants)
    return "yes" if row["passed"] and row["failed_when_off"] and noticed else "no"


if __name__ == "__main__":
    if len(sys.argv) > 1:
        SEEN.write_bytes(Path(sys.argv[1]).read_bytes())
    PAGE.write_text(page(), encoding="utf-8")
