"""What benches measured with one code, and every bar ever missed.

    python -m tools.results out/bench [--digest D]

takes over what benches wrote: a row a bar into docs/results/bars.json, which is in git, each missed bar into history.csv, all
values into out/docs/results.csv. Without a folder, it writes the pages alone, from what is in git: docs/results/README.md with
the figures that a reader wants, out/docs/results.md with all, and out/docs/history.md.
"""

import argparse
import csv
import json
import math
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.arms import USUAL
from benchmarks.common import NO_CASE, bound, shown
from tools.missed import Miss, Unreadable, followed, history, line, remember
from tools.reliability import NAME, draw, points

ROOT = Path(__file__).parent.parent
PAGES = ROOT / "docs" / "results"
BUILT = ROOT / "out" / "docs"

HEADER = """\
# Results

Written by `python -m tools.results` from [bars.json](bars.json), a row a bar. Times are of the machine that ran the benches. To
measure again:

```
make bench SEED=14000
make bench SEED=15000
python -m tools.results out/bench
```

`make bench-full` takes hours; `make soak` is an hour by itself. Results of different code never stand on one page: they are keyed
by a digest of all files of `sim/`, `pendant/`, `app/`, `assets/` and `benchmarks/`. The digest of the code as it is:
`python -c "from benchmarks.common import code_digest; print(code_digest())"`. `make docs` builds `out/docs/results.md` with every
bar, and `out/docs/history.md` with every bar that was ever missed, from [history.csv](history.csv) and
[led_to.yaml](led_to.yaml).
"""

HOW_TO_READ = """\
*n* is the number of cases, of all seed bases together; *worst* is the worst value of a base. *95 % bound* is what a share is at
least, or at most, by all cases of all bases (one-sided, Clopper-Pearson, as if each case were drawn by itself).
"""

WANTED = {
    "Force that keeps a freed arm at 0.1 m/s": ("free_drive_forces", "force to keep 0.1 m/s, p95"),
    "Force that starts a freed arm from rest": ("free_drive_forces", "force that starts it from rest, p95"),
    "The same force at the elbow, to keep 0.1 m/s": ("free_drive_forces", "force at the elbow to keep 0.1 m/s, p95"),
    "Time to rest after a hand lets go": ("free_drive_forces", "rest after letting go, worst"),
    "Drift in 10 s without a hand": ("free_drive_forces", "drift hands off, 10 s, worst"),
    "Guided minutes in which free-drive ends by itself": (
        "guided",
        "guided minutes in which free-drive ends although a hand leads",
    ),
    "Displacement while nobody holds a freed arm": ("guided", "way while nobody holds the arm, largest"),
    "Right payloads accepted": ("payload", "right payloads alone, accepted"),
    "Payloads wrong by 1 kg or more refused": ("payload", "sensor: wrong by 1 kg or more, refused"),
    "The same by 2 kg without the force sensor": ("payload", "no sensor: wrong by 2 kg or more, refused"),
    "Displacement until a wrong payload is refused": ("payload", "sensor: way until refused or entered, largest"),
    "STOP after a part of 2 kg or more drops": ("drop", "drops of 2 kg or more: STOP after, longest"),
    "Rise of the arm after such a drop": ("drop", "drops of 2 kg or more: rise beyond stopping"),
    "Touches that activate free-drive and must not": (
        "intent",
        "all sources, handshake: touches that must not, activations",
    ),
    "Contacts of a hand on a link told within 100 ms": ("link_hands", "ur5e: reported within 100 ms"),
    "The right link named": ("link_hands", "ur5e: the right link"),
    "Displacement of a freed arm at a step of the sensor": ("drift", "step: way of the flange, largest"),
}
"""What a reader wants to know first: the bench and its figure."""

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


class Bar(NamedTuple):
    """A bar of a bench in one size, at the worst of its seed bases, as text."""

    figure: str
    unit: str
    n: str  # cases of all bases
    bar: str
    worst: str
    base: str  # at which it was worst
    bound: str  # of a share, 95 %
    held: str


class Measured(NamedTuple):
    """A bench in one size, with one code."""

    bench: str
    size: str
    bases: list[int]
    bars: list[Bar]


class Summary(NamedTuple):
    """What bars.json holds."""

    digest: str  # of the code; empty where nothing was measured
    of: str  # its commits, settings and arms, in words
    benches: list[Measured]


def summary(documents: list[Document], digest: str) -> Summary:
    """The bars of one code."""
    documents = [document for document in documents if document["digest"] == digest]
    groups: dict[tuple[str, str], list[Document]] = {}
    for document in sorted(documents, key=lambda document: (document["bench"], document["size"], document["seed"])):
        groups.setdefault((document["bench"], document["size"]), []).append(document)
    found = [
        Measured(bench, size, [document["seed"] for document in some], figures(some)) for (bench, size), some in groups.items()
    ]
    return Summary(digest, _of_commits(documents), found)


def write_summary(found: Summary, path: Path) -> None:
    """Write bars.json, a line a bar."""
    benches = ",\n".join(
        f'{{"bench": {json.dumps(each.bench)}, "size": {json.dumps(each.size)}, "bases": {json.dumps(each.bases)}, "bars": [\n'
        + ",\n".join(json.dumps(bar, ensure_ascii=False, separators=(",", ":")) for bar in each.bars)
        + "\n]}"
        for each in found.benches
    )
    text = f'{{"digest": {json.dumps(found.digest)}, "of": {json.dumps(found.of)}, "benches": [\n{benches}\n]}}\n'
    path.write_text(text, encoding="utf-8")


def read_summary(path: Path) -> Summary:
    """What `write_summary` wrote; nothing measured where there is no file.

    Raises:
        Unreadable: the file is not such a summary.
    """
    if not path.exists():
        return Summary("", "", [])
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        benches = [
            Measured(each["bench"], each["size"], each["bases"], [Bar(*bar) for bar in each["bars"]]) for each in found["benches"]
        ]
        return Summary(found["digest"], found["of"], benches)
    except (ValueError, KeyError, TypeError) as error:
        raise Unreadable(
            f"{path.name}: expected digest, of and benches, as `python -m tools.results` writes them ({error})"
        ) from None


def brief(found: Summary) -> str:
    """The page with what a reader wants: the figures of `WANTED`, each missed bar, and how many bars each bench held."""
    lines = [HEADER, *_code(found), ""]
    if found.benches:
        lines += [HOW_TO_READ, "## What a reader wants to know", ""]
        lines += [line(["", "worst", "bar", "n", "95 % bound", "bench, size"]), "|---|---|---|---:|---:|---|"]
        for words, (bench, figure) in WANTED.items():
            rows = [
                line([words, f"{bar.worst} {bar.unit}".strip(), bar.bar, bar.n, bar.bound, f"`{bench}`, {each.size}"])
                for each in found.benches
                for bar in each.bars
                if (each.bench, bar.figure) == (bench, figure)
            ]
            lines += rows or [line([words, "not measured", "", "", "", f"`{bench}`"])]
        lines += ["", "## Missed", ""]
        missed = [
            line([f"`{each.bench}`, {each.size}", bar.figure, f"{bar.worst} {bar.unit}".strip(), bar.bar, bar.n, bar.base])
            for each in found.benches
            for bar in each.bars
            if bar.held == MISSED
        ]
        columns = [line(["bench, size", "figure", "worst", "bar", "n", "at base"]), "|---|---|---|---|---:|---:|"]
        lines += [*columns, *missed, ""] if missed else ["None.", ""]
        lines += ["## Bars of each bench", "", line(["bench, size", "seed bases", *ANSWERS.values()]), "|---|---|---:|---:|---:|"]
        for each in found.benches:
            answers = [bar.held for bar in each.bars]
            counts = [str(answers.count(answer)) for answer in ANSWERS]
            lines.append(line([f"`{each.bench}`, {each.size}", ", ".join(map(str, each.bases)), *counts]))
        lines.append("")
    return "\n".join([*lines, *_reliability(PAGES / NAME, NAME), *_not_measured(found)])


def page(found: Summary) -> str:
    """The page with every bar."""
    lines = ["# Every bar", "", *_code(found), ""]
    lines += [HOW_TO_READ] if found.benches else []
    for each in found.benches:
        lines += [f"## {each.bench}, {each.size} size", "", f"Seed bases {', '.join(map(str, each.bases))}.", ""]
        lines += [
            line(["figure", "unit", "n", "bar", "worst", "at base", "95 % bound", "held"]),
            "|---|---|---:|---|---:|---:|---:|---|",
        ]
        lines += [*map(line, each.bars), ""]
    return "\n".join([*lines, *_not_measured(found)])


def _code(found: Summary) -> list[str]:
    """Which code was measured, and how many bars it held."""
    if not found.benches:
        return ["Nothing was measured."]
    held = [bar.held for each in found.benches for bar in each.bars]
    counts = [f"{held.count(answer)} {what}" for answer, what in ANSWERS.items() if answer in held]
    done = {each.bench for each in found.benches}
    said = f"Of {len(done | set(benches()))} benches {len(done)} were measured. Of {len(held)} bars: {', '.join(counts)}."
    return [f"Code `{found.digest}`{found.of}.", said]


def _not_measured(found: Summary) -> list[str]:
    done = {each.bench for each in found.benches}
    missing = [bench for bench in benches() if bench not in done]
    return ["## Not measured with this code", "", ", ".join(missing) + ".", ""] if missing else []


def _reliability(picture: Path, name: str) -> list[str]:
    """The picture of what bench `observer` was told, where there is one."""
    said = "How much of what bench `observer` was told is true; bars are 95 % bounds."
    shows = f"![Share that is true over the probability that was told]({name})"
    return ["## Reliability", "", said, "", shows, ""] if picture.exists() else []


def _of_commits(documents: list[Document]) -> str:
    """A digest may have several: a commit of pages or tests alone changes none."""
    commits = sorted({document["commit"] for document in documents})
    settings = sorted({document["settings"] for document in documents})
    arms = sorted({document.get("arm", USUAL) for document in documents})
    return f", commit {', '.join(commits)}, settings {', '.join(settings)}, arm {', '.join(arms)}" if documents else ""


def figures(documents: list[Document]) -> list[Bar]:
    """All rows with a bar, of one bench in one size at its bases."""
    table: dict[tuple[str, str, str], list[tuple[int, dict[str, Any]]]] = {}
    for document in documents:
        for row in document["rows"]:
            if row["bar"]:
                table.setdefault((row["what"], row["unit"], row["bar"]), []).append((document["seed"], row))
    lines: list[Bar] = []
    for (what, unit, bar), found in table.items():
        seed, worst = max(found, key=lambda each: _beyond(each[1]))
        counts = [row["n"] for _, row in found if row["n"] is not None]
        held = {_holds(row) for _, row in found}
        answer = MISSED if False in held else HELD if True in held else NO_CASE
        rows = [row for _, row in found]
        n = str(sum(counts)) if counts else ""
        lines.append(Bar(what, unit, n, bar, shown(worst["value"]), str(seed), _pooled(rows), answer))
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


def take_over(folder: Path, digest: str | None, out: Path, built: Path) -> None:
    """Put what benches wrote into bars.json and history.csv of `out`, the values into results.csv of `built`.

    Raises:
        Unreadable: a file is not as it should be; nothing is written then.
    """
    documents = read(folder)
    if not documents:
        raise Unreadable(f"{folder}: no bench has written a result there")
    shown_code = digest or str(documents[-1]["digest"])
    remember(misses(documents), out / "history.csv")
    write_summary(summary(documents, shown_code), out / "bars.json")
    write_values(documents, shown_code, built / "results.csv")
    if curves := points([document for document in documents if document["digest"] == shown_code]):
        draw(curves, out / NAME)


def main(arguments: Iterable[str]) -> int:
    """Write pages and summary; 2 where a file is not as it should be, and no page is written then."""
    parser = argparse.ArgumentParser(prog="python -m tools.results", description="What benches measured with one code.")
    parser.add_argument("results", type=Path, nargs="?", help="folder of the benches' JSON files, to be taken over first")
    parser.add_argument("--digest", help="of the code whose results are taken over; else that of the newest file")
    parser.add_argument("--out", type=Path, default=PAGES, help="folder of what is in git")
    parser.add_argument("--built", type=Path, default=BUILT, help="folder of the long pages")
    values = parser.parse_args(list(arguments))
    for folder in (values.out, values.built):
        folder.mkdir(parents=True, exist_ok=True)
    try:
        if values.results is not None:
            take_over(values.results, values.digest, values.out, values.built)
        found = read_summary(values.out / "bars.json")
        known = remember([], values.out / "history.csv")
        led_to = followed(values.out / "led_to.yaml", known)
    except Unreadable as error:
        sys.stderr.write(f"{error}\n")
        return 2
    (values.out / "README.md").write_text(brief(found), encoding="utf-8")
    (values.built / "results.md").write_text(page(found), encoding="utf-8")
    (values.built / "history.md").write_text(history(known, led_to), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
