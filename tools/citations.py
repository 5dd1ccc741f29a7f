"""What files of the repository cite: requirements by their ids, and other files by their names."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
REQUIREMENTS = ROOT / "docs" / "reference" / "requirements.md"

ID = re.compile(r"\b(?:FD|VW|HF|CD|AF|RL|GR)-\d+[a-z]?\b")
RANGE = re.compile(rf"({ID.pattern})\s+to\s+({ID.pattern})")
ROW = re.compile(rf"^\| ({ID.pattern}) \| (.+) \|$", re.MULTILINE)


class Comment(NamedTuple):
    """A comment in a module."""

    line: int
    column: int
    text: str


def rows() -> list[tuple[str, str]]:
    """Every requirement with its text, in the order of its page."""
    return ROW.findall(REQUIREMENTS.read_text(encoding="utf-8"))


ORDER = [ident for ident, _ in rows()]


def cited(text: str) -> set[str]:
    """The ids in a text. A range counts for every row from its first to its last, also for those with a letter.

    Raises:
        ValueError: a range does not end behind its beginning, in the same group.
    """
    found = set(ID.findall(text))
    for first, last in RANGE.findall(text):
        if first in ORDER and last in ORDER:  # else each of the two is told as unknown
            between = ORDER[ORDER.index(first) : ORDER.index(last) + 1]
            if len(between) < 2 or first[:2] != last[:2]:
                raise ValueError(f"{first} to {last} is no range")
            found.update(between)
    return found


def comments(source: str) -> list[Comment]:
    """Every comment of a module."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return [Comment(*token.start, token.string) for token in tokens if token.type == tokenize.COMMENT]


@cache
def prose(source: str) -> str:
    """What a module says in words: its docstrings, those of attributes too, and its comments."""
    strings = [
        node.value.value
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    ]
    return "\n\n".join([*strings, *(comment.text for comment in comments(source))])


def files(*tops: str, ends: tuple[str, ...] = (".py",)) -> Iterator[Path]:
    """Files of some folders with one of these endings, in order."""
    for top in tops:
        yield from sorted(path for path in (ROOT / top).rglob("*") if path.suffix in ends)
