"""Writes docs/reference/claims.md: each claim, its session, and what its mutants take away. Run: `python -m tools.claims_page`.

What was seen, with and without, is in the claims.json of `make claims`.
"""

from pathlib import Path

from app.runs.claim_mutants import Mutant, declared
from app.runs.coverage import claiming
from app.session.claims import CLAIMS, Claim
from app.session.measures import watch
from app.session.prepare import prepare
from app.session.session_file import Session

PAGE = Path(__file__).parents[1] / "docs/reference/claims.md"

HEAD = """# Claims

Written by `python -m tools.claims_page`. A claim is shown where its session meets what it expects, and does not with its
switch off, nor with any of its mutants: the smallest changes of code that take away what the claim says (`assets/mutants/`).
Behind each mutant stands the expectation that is not met with it. `make claims` runs them all, and writes what was seen.

"""


def page() -> str:
    """The page."""
    sessions, mutants = claiming(), declared()
    checks = {name: _checks(session, name) for name, session in sessions.items()}
    lines = ["| claim | to show | ids | session | it expects | switch | mutants |", "|---|---|---|---|---|---|---|"]
    for claim in CLAIMS.values():
        for name, session in sessions.items():
            if claim.name in session.claims:
                lines.append(_row(claim, name, checks[name], switch=session.switch, mutants=_of(mutants, name, claim)))
    return HEAD + "\n".join(lines) + "\n"


def _checks(session: Session, name: str) -> list[str]:
    joints = prepare(session, name).arm.chain.joints
    return [watch(expectation, joints).expected() for expectation in session.expectations]


def _of(mutants: list[Mutant], name: str, claim: Claim) -> list[str]:
    own = [mutant for mutant in mutants if mutant.session == name and claim.name in mutant.claims]
    return [f"{mutant.what} (`{mutant.file}`) - not met: {mutant.fails}" for mutant in own]


def _row(claim: Claim, name: str, checks: list[str], *, switch: str | None, mutants: list[str]) -> str:
    link = f"[{name}](../../assets/sessions/{name}.yaml)"
    cells = [claim.name, claim.text, claim.ids, link, "<br>".join(checks), switch or "-", "<br>".join(mutants) or "-"]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
