"""What all benches share: sizes, seeds, the settings they ran with, a table, a JSON file, exit code."""

import argparse
import json
import multiprocessing
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.table import Table

from pendant.all_settings import Settings, digest

T = TypeVar("T")
R = TypeVar("R")

BASES = (1000, 2000, 3000)
"""Seed bases that figures are reported at; tuning uses 0 to 9."""


@dataclass(frozen=True, slots=True)
class Options:
    """How a bench was called."""

    full: bool
    seed: int
    out: Path


@dataclass(slots=True)
class Report:
    """Rows of one bench: what, measured, bar, held or not. A row without a bar is information."""

    name: str
    options: Options
    rows: list[dict[str, Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def row(
        self, what: str, value: float | str, unit: str = "", at_most: float | None = None, at_least: float | None = None
    ) -> None:
        """Add a row."""
        held: bool | None = None
        if isinstance(value, float | int):
            if at_most is not None:
                held = value <= at_most
            if at_least is not None:
                held = (held is not False) and value >= at_least
        bar = " ".join(f"{sign} {limit:g}" for sign, limit in ((">=", at_least), ("<=", at_most)) if limit is not None)
        self.rows.append({"what": what, "value": value, "unit": unit, "bar": bar, "held": held})

    def finish(self) -> int:
        """Print the table, write the JSON file; 1 if a bar was missed."""
        size = "full" if self.options.full else "quick"
        table = Table(title=f"{self.name} ({size}, seed base {self.options.seed}, settings {digest(Settings())})")
        for column in ("figure", "measured", "unit", "bar", "held"):
            table.add_column(column)
        for row in self.rows:
            value = f"{row['value']:.4g}" if isinstance(row["value"], float) else str(row["value"])
            held = {True: "yes", False: "NO", None: ""}[row["held"]]
            table.add_row(row["what"], value, row["unit"], row["bar"], held)
        Console(width=140).print(table)
        for note in self.notes:
            print(note)
        self.options.out.mkdir(parents=True, exist_ok=True)
        path = self.options.out / f"{self.name}-{size}-{self.options.seed}.json"
        document = {"bench": self.name, "size": size, "seed": self.options.seed, "settings": digest(Settings())}
        path.write_text(json.dumps({**document, "rows": self.rows, "notes": self.notes}, indent=1) + "\n", encoding="utf-8")
        return 1 if any(row["held"] is False for row in self.rows) else 0


def main(name: str, measure: Callable[[Report], None]) -> None:
    """Run one bench from the command line."""
    parser = argparse.ArgumentParser(prog=f"python -m benchmarks.{name}", description=sys.modules["__main__"].__doc__)
    parser.add_argument("--full", action="store_true", help="the full size, up to 30 minutes")
    parser.add_argument("--seed", type=int, default=BASES[0], help="seed base")
    parser.add_argument("--out", type=Path, default=Path("out/bench"), help="folder of the JSON file")
    values = parser.parse_args()
    report = Report(name, Options(values.full, values.seed, values.out))
    start = time.perf_counter()
    measure(report)
    report.notes.append(f"took {time.perf_counter() - start:.0f} s")
    sys.exit(report.finish())


def spread(work: Callable[[T], R], cases: Iterable[T]) -> list[R]:
    """`work` over all cases on both cores, results in order."""
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        return pool.map(work, list(cases), chunksize=1)
