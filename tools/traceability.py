"""Writes out/docs/traceability.md: who cites each requirement. Run as `python -m tools.traceability`."""

import ast
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import yaml

from app.session.claims import CLAIMS
from pendant.all_settings import describe
from pendant.events.event import Kind
from tools.citations import ID, ORDER, ROOT, cited, comments, files, prose

PAGE = ROOT / "out" / "docs" / "traceability.md"
BUILT = ("pendant", "sim", "app")
CHECKED = ("tests", "benchmarks")
MANY = 3
"""So many settings that differ in the middle of their names alone are shown as one name with a `*`."""

HEAD = """# Traceability

Written by `python -m tools.traceability`: for each
[requirement](../../docs/reference/requirements.md) the modules whose docstrings and comments cite
it, the settings and rows of the event table that stand for it, and the claims and sessions that show it. `*` stands for names
that differ only there.

| id | built in | checked by | settings | events | claims | sessions |
|---|---|---|---|---|---|---|
"""

Table = dict[str, list[str]]
"""Id -> what cites it."""


def link(path: Path) -> str:
    """A link from the page to a file, under its own name; the name of a package is that of its folder."""
    name = path.parent.name if path.stem == "__init__" else path.stem
    return f"[{name}](../../{path.relative_to(ROOT).as_posix()})"


def modules(tops: Iterable[str]) -> Table:
    """The modules of some rooms."""
    table: Table = defaultdict(list)
    for path in files(*tops):
        source = path.read_text(encoding="utf-8")
        for ident in cited(prose(source)) if ID.search(source) else ():
            table[ident].append(link(path))
    return table


def settings() -> Table:
    """The rows of the schema, those that go together as one name."""
    table: Table = defaultdict(list)
    for row in describe():
        table[row.id].append(row.name)
    return {ident: [f"`{name}`" for name in grouped(names)] for ident, names in table.items()}


def grouped(names: list[str]) -> list[str]:
    """Names, with one name for those that begin and end alike."""
    alike: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name in names:
        first, *_, last = name.split(".")
        alike[first, last].append(name)
    return [text for (first, last), same in alike.items() for text in ([f"{first}.*.{last}"] if len(same) > MANY else same)]


def events() -> Table:
    """The rows of the event table: a comment above rows is about all of them up to the next one, one beside a row about it."""
    table: Table = defaultdict(list)
    for path in files("pendant"):
        if not path.stem.endswith("rows"):
            continue
        source = path.read_text(encoding="utf-8")
        said = comments(source)
        for entries in (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Dict)):
            for key, value in zip(entries.keys, entries.values, strict=True):
                if not (isinstance(key, ast.Attribute) and isinstance(key.value, ast.Name) and key.value.id == Kind.__name__):
                    continue
                above = [each.text for each in said if each.line < key.lineno and each.column == key.col_offset]
                beside = [each.text for each in said if key.lineno <= each.line <= (value.end_lineno or value.lineno)]
                for ident in cited(" ".join([*above[-1:], *beside])):
                    table[ident].append(f"`{Kind[key.attr].value}`")
    return table


def claims() -> Table:
    """The claims, by their ids."""
    table: Table = defaultdict(list)
    for claim in CLAIMS.values():
        for ident in claim.ids.split():
            table[ident].append(claim.name)
    return table


def sessions() -> Table:
    """The sessions: those that show a claim of it, switch it off, or cite it."""
    table: Table = defaultdict(list)
    for path in files("assets/sessions", ends=(".yaml",)):
        text = path.read_text(encoding="utf-8")
        shown = " ".join(CLAIMS[name].ids for name in yaml.load(text, yaml.CSafeLoader).get("claims", []))
        for ident in cited(f"{text}\n{shown}"):
            table[ident].append(link(path))
    return table


def page() -> str:
    """The page as it should be."""
    built = modules(BUILT)
    columns = [built, modules(CHECKED), settings(), events(), claims(), sessions()]
    lines = [f"| {ident} | {' | '.join(', '.join(column.get(ident, [])) for column in columns)} |" for ident in ORDER]
    missing = [ident for ident in ORDER if ident not in built]
    said = ", ".join(missing) if missing else "None."
    return f"{HEAD}{chr(10).join(lines)}\n\n## Not cited\n\nNo module of {', '.join(BUILT[:-1])} or {BUILT[-1]} cites: {said}\n"


if __name__ == "__main__":
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(page(), encoding="utf-8")
