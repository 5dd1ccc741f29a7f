"""The requirements: every id that is cited is one, the page of who cites them is up to date, and cited files are there."""

import re
from collections import Counter
from pathlib import Path

import pytest

from tools import citations, traceability
from tools.citations import ID, ORDER, ROOT, cited, files, prose

TOPS = ("app", "sim", "pendant", "benchmarks", "tests", "docs", "assets", "examples", "tools")
NO_REQUIREMENT = {"FD-99"}
"""What tests write for an id that is none."""

FILE = re.compile(r"(?<![\w./<>*-])(?:[\w.-]+/)*[\w-]+\.(?:py|md|yaml|yml|toml|json|jsonl|txt|pdf|html|mcap)\b(?!\()")
MADE = {"claims.json", "claims.md", "events.jsonl", "log.mcap", "report.html", "summary.json"}
"""What the command line writes."""


def said(path: Path) -> str:
    """What a module or a data file says beside its code and data; of a page all."""
    text = path.read_text(encoding="utf-8")
    match path.suffix:
        case ".py":
            return prose(text)
        case ".yaml":
            return "\n".join(re.findall(r"#.*", text))
    return text


def missing(text: str, here: Path, names: set[str]) -> list[str]:
    """The files that a text cites and that are neither in the repository nor made by it."""
    found = [name for name in FILE.findall(text) if name not in MADE and name not in names]
    return [name for name in found if not any((folder / name).exists() for folder in (ROOT, ROOT / "tests", here))]


def test_every_cited_id_is_a_requirement() -> None:
    pages = [ROOT / "README.md", ROOT / "CHANGELOG.md", *files(*TOPS, ends=(".py", ".md", ".yaml"))]
    unknown = {
        path.relative_to(ROOT).as_posix(): sorted(ids)
        for path in pages
        if (ids := set(ID.findall(path.read_text(encoding="utf-8"))) - set(ORDER) - NO_REQUIREMENT)
    }
    assert unknown == {}


def test_every_id_has_one_row_with_a_sentence_in_the_order_of_its_group() -> None:
    assert [ident for ident, count in Counter(ORDER).items() if count > 1] == []
    assert [ident for ident, text in citations.rows() if not text.endswith(".")] == []
    groups = {
        group: [ident for ident in ORDER if ident.startswith(group)] for group in ("FD", "VW", "HF", "CD", "AF", "RL", "GR")
    }
    assert [ident for group in groups.values() for ident in group] == ORDER
    for group in groups.values():
        parts = [re.fullmatch(r"\w+-(\d+)([a-z]?)", ident) for ident in group]
        keys = [(int(part[1]), part[2]) for part in parts if part]
        assert keys == sorted(keys)
        assert {number for number, _ in keys} == set(range(keys[0][0], keys[-1][0] + 1))


def test_the_page_of_who_cites_them_has_a_row_for_each() -> None:
    assert re.findall(r"^\| (\w+-\w+) \|", traceability.page(), re.MULTILINE) == ORDER


def test_no_docstring_comment_or_page_cites_a_file_that_is_not_there() -> None:
    names = {path.name for path in files(*TOPS, ends=(".py", ".md", ".json"))}
    gone: list[tuple[str, str]] = []
    for path in files(*TOPS, ends=(".py", ".yaml", ".md")):
        found = [name for name in missing(said(path), path.parent, names) if not name.startswith("out/")]  # `make docs` writes it
        if path.suffix == ".md":  # what a user may call their own file is no module and no page
            found = [name for name in found if name.endswith((".py", ".md"))]
        gone += [(path.relative_to(ROOT).as_posix(), name) for name in found]
    assert gone == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("see notes/limits.md 3", ["notes/limits.md"]),
        ("see `limits.py` and docs/README.md", ["limits.py"]),
        ("writes log.mcap, in out", []),
        ("of traceability.py", []),
    ],
)
def test_a_file_that_is_not_there_is_found(text: str, found: list[str]) -> None:
    assert missing(text, ROOT / "tests", {"traceability.py"}) == found


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("held (FD-7, FD-8a)", "FD-7 FD-8a"),
        ("FD-7 to FD-9", "FD-7 FD-8 FD-8a FD-9"),
        ("FD-12 to\n    FD-13", "FD-12 FD-12a FD-12b FD-12c FD-13"),
        ("FD-5c to FD-5e", "FD-5c FD-5d FD-5e"),
        ("XFD-7, FD-7b9, FD-x", ""),
        ("FD-7 to FD-99", "FD-7 FD-99"),
    ],
)
def test_a_range_cites_every_row_from_its_first_to_its_last(text: str, ids: str) -> None:
    assert cited(text) == set(ids.split())


@pytest.mark.parametrize("text", ["FD-9 to FD-7", "FD-9 to FD-9", "FD-25 to VW-2"])
def test_a_range_that_is_none_is_named(text: str) -> None:
    with pytest.raises(ValueError, match="is no range"):
        cited(text)


def test_names_that_differ_in_the_middle_alone_are_one() -> None:
    few = ["limits.a.on", "limits.b.on", "limits.c.on"]
    assert traceability.grouped(few) == few
    assert traceability.grouped([*few, "limits.d.on", "walls.on"]) == ["limits.*.on", "walls.on"]


def test_a_row_of_the_event_table_stands_for_what_the_comment_above_or_behind_it_cites() -> None:
    told = traceability.events()
    assert told["FD-6a"] == ["`pushed`"]
    assert told["FD-18"] == ["`left_limit`", "`stopped_limit`"]


def test_a_session_shows_what_its_claims_and_its_switch_stand_for() -> None:
    link = "[free-drive](../../assets/sessions/free-drive.yaml)"  # claims A 1, A 21; switch FD-9
    shown = traceability.sessions()
    assert link in shown["FD-2"]
    assert link in shown["FD-9"]
    assert link not in shown["VW-1"]
