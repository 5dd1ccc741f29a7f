"""The history of missed bars, to which it only adds: docs/results/history.csv, and its page. `tools.results` writes them."""

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import yaml

HISTORY = """\
# History

Every bar that was ever missed at a seed base, with the code that missed it and what the miss led to. `python -m tools.results`
writes it from [history.csv](../../docs/results/history.csv), to which it only adds, and from
[led_to.yaml](../../docs/results/led_to.yaml), which is written by hand.
The digest `none` is of the time before results had one: the commit is that of the page which showed the miss first.
"""


class Unreadable(ValueError):
    """A file is not as a bench, this program or its reader's hand should have written it."""


class Miss(NamedTuple):
    """A bar missed at a seed base, as history.csv has it."""

    digest: str
    commit: str
    bench: str
    size: str
    seed: str
    figure: str
    value: str
    bar: str  # with its unit

    def key(self) -> tuple[str, ...]:
        """What a second run of the same has in common with it: not the value, for times differ."""
        return self.digest, self.bench, self.size, self.seed, self.figure

    def name(self) -> str:
        """Its key in docs/results/led_to.yaml."""
        return f"{self.digest} {self.bench} {self.seed} {self.figure}"


def line(cells: Iterable[str]) -> str:
    """A line of a table."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def remember(found: list[Miss], path: Path) -> list[Miss]:
    """Add to history.csv what is not in there yet; all of its rows.

    Raises:
        Unreadable: it is no table of misses.
    """
    known: list[Miss] = []
    if path.exists():
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        if not rows or tuple(rows[0]) != Miss._fields or any(len(row) != len(Miss._fields) for row in rows):
            raise Unreadable(f"{path.name}: expected the columns {', '.join(Miss._fields)}")
        known = [Miss(*row) for row in rows[1:]]
    else:
        path.write_text(",".join(Miss._fields) + "\n", encoding="utf-8")
    seen = {miss.key() for miss in known}
    with path.open("a", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        for miss in found:
            if miss.key() not in seen:
                seen.add(miss.key())
                known.append(miss)
                table.writerow(miss)
    return known


def followed(path: Path, known: list[Miss]) -> dict[str, str]:
    """What misses led to, by their names.

    Raises:
        Unreadable: it is no list of texts, or speaks of a miss that the history does not have: one of the two has lost it.
    """
    led_to = yaml.safe_load(path.read_text(encoding="utf-8")) if path.exists() else {}
    if not isinstance(led_to, dict) or not all(isinstance(text, str) for text in led_to.values()):
        raise Unreadable(f"{path.name}: expected a text for each 'digest bench seed figure'")
    names = {miss.name() for miss in known}
    lost = [name for name in led_to if name not in names]
    if lost:
        raise Unreadable(f"{path.name}: not in the history: {lost[0]}")
    return led_to


def history(known: list[Miss], led_to: dict[str, str]) -> str:
    """The page of all misses, the oldest first."""
    lines = [
        HISTORY,
        line(["code", "commit", "bench", "size", "base", "figure", "value", "bar", "what it led to"]),
        "|---" * 9 + "|",
    ]
    for miss in known:
        lines.append(line([f"`{miss.digest}`", *miss[1:], led_to.get(miss.name(), "nothing is written down")]))
    return "\n".join([*lines, ""])
