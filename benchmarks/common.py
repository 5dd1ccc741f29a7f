"""What all benches share: sizes, seeds, the code and the settings they ran with, a table, a JSON file, exit code."""

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.table import Table
from scipy.special import betaincinv

from app.engine import spreading as engine
from app.engine.source import commit_of, digest_of
from benchmarks import arms
from pendant.all_settings import Settings, digest

T = TypeVar("T")
R = TypeVar("R")

ROOT = Path(__file__).parent.parent
CODE = ("app", "assets", "benchmarks", "pendant", "sim")
"""Folders that a figure depends on."""

CONFIDENCE = 0.95
"""Of the bound of a share, one-sided."""

NO_CASE = "no case"
"""The value of a share of nothing."""

BASES = (1000, 2000, 3000)
"""Seed bases that figures are reported at; tuning uses 0 to 9."""


def code_digest(root: Path = ROOT) -> str:
    """12 hex digits over names and bytes of all files of `CODE`."""
    return digest_of(root, CODE)


def commit(root: Path = ROOT) -> str:
    """The commit, with a `+` where files of `CODE` are not as they are in it; "unknown" without git."""
    return commit_of(root, CODE)


def bound(hits: int, n: int, upper: bool) -> float:
    """One-sided Clopper-Pearson bound of a share at `CONFIDENCE`.

    Args:
        hits: cases that count.
        n: all cases.
        upper: the share is at most this, or else at least.
    """
    if upper:
        return 1.0 if hits >= n else float(betaincinv(hits + 1, n - hits, CONFIDENCE))
    return 0.0 if hits <= 0 else float(betaincinv(hits, n - hits + 1, 1.0 - CONFIDENCE))


@dataclass(frozen=True, slots=True)
class Options:
    """How a bench was called."""

    full: bool
    seed: int
    out: Path
    arm: str = arms.USUAL


@dataclass(slots=True)
class Report:
    """Rows of one bench: what, of how many cases, measured, bar, held or not. A row without a bar is information."""

    name: str
    options: Options
    rows: list[dict[str, Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    digest: str = field(default_factory=code_digest)
    commit: str = field(default_factory=commit)

    def row(
        self,
        what: str,
        value: float | str,
        unit: str = "",
        *,
        at_most: float | None = None,
        at_least: float | None = None,
        n: int | None = None,
    ) -> None:
        """Add a row; `what` is the same at every seed base, so how many cases there were goes into `n`."""
        held: bool | None = None
        if isinstance(value, float | int):
            if at_most is not None:
                held = value <= at_most
            if at_least is not None:
                held = (held is not False) and value >= at_least
        bar = " ".join(f"{sign} {limit:g}" for sign, limit in ((">=", at_least), ("<=", at_most)) if limit is not None)
        limits = {"at_most": at_most, "at_least": at_least, "bar": bar}
        self.rows.append({"what": what, "n": n, "value": value, "unit": unit, "bound": None, **limits, "held": held})

    def share(self, what: str, hits: int, n: int, *, at_most: float | None = None, at_least: float | None = None) -> None:
        """Add the row of a share: `hits` of `n` cases, with its confidence bound towards the bar.

        Of no case there is no share, and its bar is neither held nor missed.
        """
        self.row(what, float(hits / n) if n else NO_CASE, "", at_most=at_most, at_least=at_least, n=n)
        if n and (at_most is None) != (at_least is None):
            self.rows[-1]["bound"] = bound(hits, n, upper=at_most is not None)

    def finish(self) -> int:
        """Print the table, write the JSON file; 1 if a bar was missed, 2 without a file if the code changed meanwhile."""
        after = code_digest()
        if after != self.digest:
            sys.stderr.write(f"{self.name}: the code changed while it was measured ({self.digest}, now {after}): no result\n")
            return 2
        size = "full" if self.options.full else "quick"
        document = {"bench": self.name, "arm": self.options.arm, "size": size, "seed": self.options.seed}
        document |= {"digest": self.digest, "commit": self.commit, "settings": digest(Settings())}
        keys = f"seed base {self.options.seed}, code {self.digest}, commit {self.commit}, settings {document['settings']}"
        table = Table(title=f"{self.name} ({self.options.arm}, {size}, {keys})")
        for column in ("figure", "n", "measured", "unit", f"{100.0 * CONFIDENCE:g} % bound", "bar", "held"):
            table.add_column(column)
        for row in self.rows:
            n = "" if row["n"] is None else str(row["n"])
            held = {True: "yes", False: "NO", None: ""}[row["held"]]
            table.add_row(row["what"], n, shown(row["value"]), row["unit"], shown(row["bound"]), row["bar"], held)
        Console(width=140).print(table)
        for note in self.notes:
            print(note)
        self.options.out.mkdir(parents=True, exist_ok=True)
        path = self.options.out / f"{self.name}-{size}-{self.options.seed}-{self.digest}.json"
        path.write_text(json.dumps({**document, "rows": self.rows, "notes": self.notes}, indent=1) + "\n", encoding="utf-8")
        return 1 if any(row["held"] is False for row in self.rows) else 0


def shown(value: float | str | None) -> str:
    """A value as a table has it."""
    return f"{value:.4g}" if isinstance(value, float) else "" if value is None else str(value)


def main(name: str, measure: Callable[[Report], None]) -> None:
    """Run one bench from the command line."""
    parser = argparse.ArgumentParser(prog=f"python -m benchmarks.{name}", description=sys.modules["__main__"].__doc__)
    parser.add_argument("--full", action="store_true", help="the full size, up to two hours")
    parser.add_argument("--seed", type=int, default=BASES[0], help="seed base")
    parser.add_argument("--out", type=Path, default=Path("out/bench"), help="folder of the JSON file")
    if name in arms.BENCHES:
        parser.add_argument("--arm", choices=arms.names(), default=arms.USUAL, help="another than the UR5e: a folder of its own")
    values = parser.parse_args()
    arm = getattr(values, "arm", arms.USUAL)
    # The results of an arm have a folder, and so a page, of their own: a row's name does not say of which arm it is.
    folder = values.out if arm == arms.USUAL else values.out / arm
    report = Report(name, Options(values.full, values.seed, folder, arm))
    start = time.perf_counter()
    measure(report)
    report.notes.append(f"took {time.perf_counter() - start:.0f} s")
    sys.exit(report.finish())


def spread(work: Callable[[T], R], cases: Iterable[T]) -> list[R]:
    """`work` over all cases on both cores, results in order."""
    found = dict(engine.spread(work, cases, workers=2))
    return [found[place] for place in range(len(found))]
