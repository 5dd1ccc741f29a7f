"""Writes docs/results/: what benches measured with one code, and every bar ever missed. Run as `python -m tools.results`."""

import argparse
import csv
import json
import math
import re
import sys
from pathlib import Path
from typing import Any

from benchmarks.arms import USUAL
from benchmarks.common import NO_CASE, bound, code_digest, shown
from tools.missed import Miss, Unreadable, followed, history, line, remember
from tools.reliability import NAME, draw, points

ROOT = Path(__file__).parent.parent
PAGES = ROOT / "docs" / "results"
RESULTS = ROOT / "out" / "bench"

HEADER = """\
# Results

Written by `python -m tools.results` from what the benches wrote. Times are of the machine that ran them. To measure again:

```
make bench SEED=14000
make bench SEED=15000
python -m tools.results
```

`make bench-full` takes hours; `make soak` is an hour by itself. Results of different code never stand on one page: they are keyed
by a digest of all files of `sim/`, `pendant/`, `app/`, `assets/` and `benchmarks/`. The digest of the code as it is:
`python -c "from benchmarks.arms import USUAL
from benchmarks.common import code_digest; print(code_digest())"`.
"""

HOW_TO_READ = """\
A row is a figure with a bar. *n* is the number of its cases, of all bases together; *worst* is the worst value of a base, and the
next column says of which. *95 % bound* is what a share is at least, or at most, by all cases of all bases (one-sided,
Clopper-Pearson, as if each case were drawn by itself). Figures without a bar, and the values of each base, are in
[results.csv](results.csv).
"""

HELD, MISSED = "yes", "**no**"
ANSWERS = {HELD: "held at every base", MISSED: "missed", NO_CASE: "without a case"}
"""What a table says of a bar, and the page in sum."""


Document = dict[str, Any]
"""What a bench wrote."""


def benches() -> list[str]:
    """All that there are."""
    found = (
        re.search(r'^    main\("(\w+)", measure\)$', path.read_text(), re.MULTILINE) for path in ROOT.glob("benchmarks/**/*.py")
    )
    return sorted(match[1] for match in found if match is not None)


def read(folder: Path) -> list[Document]:
    """The documents that benches wrote, the oldest first; those from before there was a digest are left out, and that is said.

    Raises:
        Unreadable: one is no JSON, or lacks what a bench writes.
    """
    paths = sorted(folder.glob("*.json"), key=lambda path: (path.stat().st_mtime_ns, path.name))
    documents = {path.name: _document(path) for path in paths}
    old = [name for name, document in documents.items() if "digest" not in document]
    if old:
        sys.stderr.write(f"left out, for nobody knows of which code they are: {', '.join(sorted(old))}\n")
    return [document for name, document in documents.items() if name not in old]


def _document(path: Path) -> Document:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise Unreadable(f"{path.name}: no JSON ({error})") from None
    rows = document.get("rows") if isinstance(document, dict) else None
    if not isinstance(rows, list) or not {"bench", "size", "seed", "settings"} <= document.keys():
        raise Unreadable(f"{path.name}: expected bench, size, seed, settings and rows, as benchmarks/common.py writes them")
    if "digest" not in document:
        return document
    if "commit" not in document:
        raise Unreadable(f"{path.name}: expected a commit beside the digest")
    fields = {"what", "n", "value", "unit", "bound", "at_most", "at_least", "bar", "held"}
    for i, row in enumerate(rows):
        if not isinstance(row, dict) or not fields <= row.keys():
            raise Unreadable(f"{path.name}: rows[{i}]: expected {', '.join(sorted(fields))}")
    return document


def page(documents: list[Document], digest: str) -> str:
    """The page of the results of one code."""
    documents = [document for document in documents if document["digest"] == digest]
    groups: dict[tuple[str, str], list[Document]] = {}
    for document in sorted(documents, key=lambda document: (document["bench"], document["size"], document["seed"])):
        groups.setdefault((document["bench"], document["size"]), []).append(document)
    tables = {group: figures(some) for group, some in groups.items()}
    done = {bench for bench, _ in groups}
    missing = [bench for bench in benches() if bench not in done]
    held = [held for table in tables.values() for *_, held in table]
    lines = [HEADER, f"Code `{digest}`{_of_commits(documents)}."]
    if groups:
        counts = [f"{held.count(answer)} {what}" for answer, what in ANSWERS.items() if answer in held]
        lines.append(
            f"Of {len(done) + len(missing)} benches {len(done)} were measured. Of {len(held)} bars: {', '.join(counts)}."
        )
    lines += ["All misses of all code: [history.md](history.md).", ""]
    lines += [HOW_TO_READ] if groups else []
    for (bench, size), table in tables.items():
        seeds = ", ".join(str(document["seed"]) for document in groups[bench, size])
        lines += [f"## {bench}, {size} size", "", f"Seed bases {seeds}.", ""]
        lines += [
            line(["figure", "unit", "n", "bar", "worst", "at base", "95 % bound", "held"]),
            "|---|---|---:|---|---:|---:|---:|---|",
        ]
        lines += [*map(line, table), ""]
    if points(documents):
        lines += [
            "## Reliability",
            "",
            "How much of what bench `observer` was told is true; bars are 95 % bounds.",
            "",
        ]
        lines += [f"![Share that is true over the probability that was told]({NAME})", ""]
    if missing:
        lines += ["## Not measured with this code", "", ", ".join(missing) + ".", ""]
    return "\n".join(lines)


def _of_commits(documents: list[Document]) -> str:
    """A digest may have several: a commit of pages or tests alone changes none."""
    commits = sorted({document["commit"] for document in documents})
    settings = sorted({document["settings"] for document in documents})
    arms = sorted({document.get("arm", USUAL) for document in documents})
    return f", commit {', '.join(commits)}, settings {', '.join(settings)}, arm {', '.join(arms)}" if documents else ""


def figures(documents: list[Document]) -> list[list[str]]:
    """The cells of all rows with a bar, of one bench in one size at its bases."""
    table: dict[tuple[str, str, str], list[tuple[int, dict[str, Any]]]] = {}
    for document in documents:
        for row in document["rows"]:
            if row["bar"]:
                table.setdefault((row["what"], row["unit"], row["bar"]), []).append((document["seed"], row))
    lines: list[list[str]] = []
    for (what, unit, bar), found in table.items():
        seed, worst = max(found, key=lambda each: _beyond(each[1]))
        counts = [row["n"] for _, row in found if row["n"] is not None]
        held = {_holds(row) for _, row in found}
        answer = MISSED if False in held else HELD if True in held else NO_CASE
        rows = [row for _, row in found]
        lines.append(
            [what, unit, str(sum(counts)) if counts else "", bar, shown(worst["value"]), str(seed), _pooled(rows), answer]
        )
    return lines


def _beyond(row: dict[str, Any]) -> float:
    """How far a value is beyond its bar; below zero within it. What could not be measured is worst, and no case is best."""
    value = row["value"]
    if value == NO_CASE:
        return -math.inf
    if not isinstance(value, float | int) or math.isnan(value):
        return math.inf
    above = value - row["at_most"] if row["at_most"] is not None else -math.inf
    below = row["at_least"] - value if row["at_least"] is not None else -math.inf
    return max(above, below)


def _holds(row: dict[str, Any]) -> bool | None:
    """Whether a bar is held; None where there was no case. What could not be measured holds none."""
    return None if row["value"] == NO_CASE else row["held"] is True


def _pooled(rows: list[dict[str, Any]]) -> str:
    """The bound of a share over the cases of all bases."""
    shares = [row for row in rows if row["bound"] is not None]
    hits = sum(round(row["value"] * row["n"]) for row in shares)
    n = sum(row["n"] for row in shares)
    return shown(bound(hits, n, upper=shares[0]["at_most"] is not None)) if shares else ""


COLUMNS = ("bench", "size", "seed", "commit", "digest", "figure", "unit", "n", "value", "bar", "bound", "held")


def write_values(documents: list[Document], digest: str, path: Path) -> None:
    """Write all rows of one code, with or without a bar."""
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for document in sorted(documents, key=lambda document: (document["bench"], document["size"], document["seed"])):
            if document["digest"] == digest:
                for row in document["rows"]:
                    cells = {**document, **row, "figure": row["what"], "held": {True: "yes", False: "no", None: ""}[row["held"]]}
                    table.writerow([cells[column] for column in COLUMNS])


def misses(documents: list[Document]) -> list[Miss]:
    """The bars that were missed, in the order in which that was measured."""
    found: list[Miss] = []
    for document in documents:
        digest, commit, bench, size, seed = (str(document[name]) for name in ("digest", "commit", "bench", "size", "seed"))
        for row in document["rows"]:
            if row["bar"] and _holds(row) is False:
                bar = f"{row['bar']} {row['unit']}".strip()
                found.append(Miss(digest, commit, bench, size, seed, row["what"], shown(row["value"]), bar))
    return found


def main(arguments: list[str]) -> int:
    """Write the pages and tables; 2 where a file is not as it should be, and no page is written then."""
    parser = argparse.ArgumentParser(prog="python -m tools.results", description=__doc__)
    parser.add_argument("--results", type=Path, default=RESULTS, help="folder of the benches' JSON files")
    parser.add_argument("--digest", help="of the code whose results the page shows; else that of the newest file")
    parser.add_argument("--out", type=Path, default=PAGES, help="folder of the pages")
    values = parser.parse_args(arguments)
    try:
        documents = read(values.results)
        digest = values.digest or (documents[-1]["digest"] if documents else code_digest())
        values.out.mkdir(parents=True, exist_ok=True)
        known = remember(misses(documents), values.out / "history.csv")
        led_to = followed(values.out / "led_to.yaml", known)
    except Unreadable as error:
        sys.stderr.write(f"{error}\n")
        return 2
    (values.out / "README.md").write_text(page(documents, digest), encoding="utf-8")
    write_values(documents, digest, values.out / "results.csv")
    if curves := points([document for document in documents if document["digest"] == digest]):
        draw(curves, values.out / NAME)
    (values.out / "history.md").write_text(history(known, led_to), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
