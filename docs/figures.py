"""Writes docs/figures.md: all bars of all benches, seed bases side by side. Run as `python -m docs.figures` after the benches."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "figures.md"
RESULTS = ROOT / "out" / "bench"

HEADER = """\
# Figures

What the benches measured against their bars, a column for each seed base; neither tuning nor an earlier measurement used them.
Rows without a bar are in the files of the benches only. Where a bench was run in its full size that stands in place of its quick
one. Times are of the machine that ran them: compare them with each other. To remake this page:

```
make bench SEED=14000
make bench SEED=15000
make bench SEED=16000
python -m docs.figures
```

`make bench-full` takes hours; `make soak` is an hour by itself.
"""


class Figure(NamedTuple):
    """What tells a row of one bench from the others."""

    bench: str
    size: str
    what: str
    unit: str
    bar: str


Measured = dict[Figure, dict[int, tuple[float | str, bool | None]]]
"""Of each figure, by seed base: the value, and whether it is within its bar."""


class Unreadable(ValueError):
    """A file is none that a bench wrote."""


def results(folder: Path) -> list[dict[str, Any]]:
    """The documents that benches wrote, in the order of their files' names; of each bench and base the one of full size, if any.

    Raises:
        Unreadable: there is none, or one is no JSON, or lacks what a bench writes.
    """
    found = [_read(path) for path in sorted(folder.glob("*.json"))]
    if not found:
        raise Unreadable(f"{folder}: no results of benches; run `make bench` first")
    full = {(document["bench"], document["seed"]) for document in found if document["size"] == "full"}
    return [each for each in found if each["size"] == "full" or (each["bench"], each["seed"]) not in full]


def _read(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise Unreadable(f"{path.name}: no JSON ({error})") from None
    rows = document.get("rows") if isinstance(document, dict) else None
    if not isinstance(rows, list) or not {"bench", "size", "seed", "settings"} <= document.keys():
        raise Unreadable(f"{path.name}: expected bench, size, seed, settings and rows, as benchmarks/common.py writes them")
    for i, row in enumerate(rows):
        if not isinstance(row, dict) or not {"what", "value", "unit", "bar", "held"} <= row.keys():
            raise Unreadable(f"{path.name}: rows[{i}]: expected what, value, unit, bar and held")
    return document


def measured(documents: list[dict[str, Any]]) -> Measured:
    """The rows with a bar, in the order of the benches and of their rows."""
    table: Measured = {}
    for document in documents:
        for row in document["rows"]:
            if row["bar"]:
                figure = Figure(document["bench"], document["size"], row["what"], row["unit"], row["bar"])
                table.setdefault(figure, {})[int(document["seed"])] = (row["value"], row["held"])
    return dict(sorted(table.items(), key=lambda entry: entry[0].bench))


def page(documents: list[dict[str, Any]]) -> str:
    """The page of these documents."""
    table = measured(documents)
    seeds = sorted({int(document["seed"]) for document in documents})
    held = sum(_holds(values) for values in table.values())
    lines = [HEADER, f"{held} of {len(table)} bars are held at every seed base measured. {_settings(documents)}", ""]
    columns = ["bench", "figure", "bar", *(f"base {seed}" for seed in seeds), "held"]
    lines += [_row(columns), _row(["---"] * 3 + ["---:"] * len(seeds) + ["---"])]
    for figure, values in table.items():
        bench = figure.bench if figure.size == "full" else f"{figure.bench} ({figure.size})"
        bar = f"{figure.bar} {figure.unit}".strip()
        cells = [_shown(*values[seed]) if seed in values else "–" for seed in seeds]
        lines.append(_row([bench, figure.what, bar, *cells, "yes" if _holds(values) else "**no**"]))
    return "\n".join([*lines, ""])


def _holds(values: dict[int, tuple[float | str, bool | None]]) -> bool:
    """What could not be measured does not hold a bar."""
    return all(held is True for _, held in values.values())


def _settings(documents: list[dict[str, Any]]) -> str:
    """With which settings; more than one digest means that not all of it was measured with the same product."""
    used: dict[str, set[str]] = {}
    for document in documents:
        used.setdefault(document["settings"], set()).add(document["bench"])
    if len(used) == 1:
        return f"Settings `{next(iter(used))}`."
    return "Settings " + ", ".join(f"`{digest}` ({', '.join(sorted(names))})" for digest, names in sorted(used.items())) + "."


def _shown(value: float | str, held: bool | None) -> str:
    text = f"{value:.4g}" if isinstance(value, float) else str(value)
    return text if held else f"**{text}**"


def _row(cells: list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def main(arguments: list[str]) -> int:
    """Write the page; 2 where there is nothing to write it from."""
    parser = argparse.ArgumentParser(prog="python -m docs.figures", description=__doc__)
    parser.add_argument("--results", type=Path, default=RESULTS, help="folder of the benches' JSON files")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page to write")
    values = parser.parse_args(arguments)
    try:
        text = page(results(values.results))
    except Unreadable as error:
        sys.stderr.write(f"{error}\n")
        return 2
    values.out.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
