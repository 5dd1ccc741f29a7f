"""The table of the language's functions in docs/reference/script-functions.md, and how it writes a function."""

import re
from pathlib import Path
from typing import NamedTuple

from app.urscript.machine.signature import NEEDED, Builtin
from app.urscript.machine.values import shown

PAGE = Path(__file__).parents[3] / "docs/reference/script-functions.md"

AS_DOCUMENTED, DIFFERENT, NOT_THERE = "as documented", "different", "not there"


class TableRow(NamedTuple):
    """What the table says of a function."""

    signature: str
    here: str
    words: str


def signature(function: Builtin) -> str:
    """Name and parameters, with their defaults; one whose default is told by the robot has `...`."""
    parts = []
    for each in function.parameters:
        default = "..." if each.default is None else shown(each.default)
        parts.append(
            each.name
            if each.default is NEEDED
            else f"{each.name}={default!r}"
            if type(each.default) is str
            else f"{each.name}={default}"
        )
    return f"{function.name}({', '.join(parts)})"


def table() -> dict[str, TableRow]:
    """By name."""
    rows = re.findall(r"^\| `(.+?)` \| (.+?) \|(.*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    return {text.split("(")[0]: TableRow(text, here, words.strip()) for text, here, words in rows}
