"""Run every session that shows a claim: at all seeds, without its switch, and with its mutants.

    python -m tools.claims [--seeds 1-12] [--mutants-at 1,2,7] [--out out/claims]

It writes claims.md and claims.json. Exit code 1: a claim is not shown.
"""

import argparse
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from app.ending import ending
from app.files.bad_input import BadInput
from app.runs.progress import counting
from app.runs.seed_runs import seeds_in
from tools.claims.claim_mutants import declared, run_mutants
from tools.claims.coverage import Seeds, cover, totals, with_trials, write


def main(arguments: list[str] | None = None) -> int:
    """Run them, write what was seen, and print what is not shown."""
    parser = argparse.ArgumentParser(prog="python -m tools.claims", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seeds", default="1-12", help="seeds with the switch on")
    parser.add_argument("--mutants-at", default="1,2", help="seeds without the switch and with each mutant")
    parser.add_argument("--out", type=Path, default=Path("out/claims"), help="folder for claims.md, claims.json and the runs")
    asked = parser.parse_args(arguments)
    try:
        seeds = Seeds(tuple(seeds_in(asked.seeds)), tuple(seeds_in(asked.mutants_at)))
    except BadInput as refusal:
        parser.error(str(refusal))
    with ending(interrupts=True), counting("claims") as told:
        rows = with_trials(cover(asked.out, seeds, told), run_mutants(declared(), seeds.changed, told))
        write(rows, seeds, asked.out)
    console = Console()
    for row in rows:
        if row.session is not None and not row.shown:
            console.print(f"[red]{row.claim.name}[/red] {escape(f'{row.session}: {row.state} {row.why}')}")
    counts = ", ".join(f"{number} {state}" for state, number in totals(rows).items())
    console.print(f"{len(rows)} rows: {counts}; see {escape(str(asked.out / 'claims.md'))}")
    return 0 if all(row.shown for row in rows) else 1


if __name__ == "__main__":
    raise SystemExit(main())
