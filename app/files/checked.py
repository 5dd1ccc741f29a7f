"""Files and raw values into checked types: the one wrapper round msgspec and PyYAML. Anything wrong is one clear line."""

import difflib
import math
import re
from pathlib import Path
from typing import TypeVar

import msgspec

from app.files.bad_input import ABSENT, BadInput
from app.files.explain import described, explained, is_struct, names_of
from app.files.yaml_text import DEEPEST, parsed, read

__all__ = ["ABSENT", "BadInput", "convert", "load", "parse"]

T = TypeVar("T")


def load(path: str | Path, kind: type[T]) -> T:
    """Reads the YAML file at `path` as a value of type `kind`.

    A file that has none of the fields of `kind` is another kind of file: nothing of it is quoted, for it may be anybody's.

    Raises:
        BadInput: the file is missing, is not UTF-8 or YAML, repeats a key, or does not fit `kind`.
    """
    where = Path(path).name or str(path)
    text = read(Path(path), where)
    if is_struct(kind) and not _looks_like(text, kind):
        raise BadInput(where, "", ABSENT, f"is another kind of file; expected {described(kind)}")
    return convert(parsed(text, where), kind, where)


def convert(raw: object, kind: type[T], where: str) -> T:
    """Turns plain values (dict, list, str, float, ...) into a value of type `kind`; `where` names their origin in messages.

    Raises:
        BadInput: a value is missing, unknown, of the wrong type, out of range or not finite.
    """
    _refuse_odd(raw, "", where, 0)
    if not isinstance(raw, dict) and is_struct(kind):
        raise BadInput(where, "", raw, f"expected {described(kind)}")
    try:
        return msgspec.convert(raw, kind)
    except msgspec.ValidationError as error:
        raise explained(error, raw, kind, where) from None


def parse(text: str, kind: type[T], where: str) -> T:
    """Reads YAML `text` as a value of type `kind`; errors as `load`."""
    return convert(parsed(text, where), kind, where)


def _looks_like(text: str, kind: type) -> bool:
    """Whether one of the fields of `kind`, or nearly one, stands at the beginning of a line, or of the whole in JSON."""
    names = names_of(kind)
    found = {match[1] for match in re.finditer(r"""(?m)^[ \t{]*["']?([A-Za-z_]{1,40})["']?[ \t]*:(?:\s|$|["'\[{\d])""", text)}
    return any(name in names or difflib.get_close_matches(name, names, n=1) for name in found)


def _refuse_odd(raw: object, field: str, where: str, depth: int) -> None:
    """What no type of ours can express: numbers that are not finite, keys that are no text, endless nesting."""
    if depth > DEEPEST:
        raise BadInput(where, field, ABSENT, f"expected at most {DEEPEST} levels of nesting")
    if isinstance(raw, float) and not math.isfinite(raw):
        raise BadInput(where, field, raw, "expected a finite number")
    if isinstance(raw, int) and abs(raw) > 2**63:
        raise BadInput(where, field, raw, "expected a number below 2^63")
    if isinstance(raw, dict):
        for key, value in raw.items():
            if not isinstance(key, str):
                raise BadInput(where, field, key, "expected a text as key")
            _refuse_odd(value, f"{field}.{key}" if field else key, where, depth + 1)
    elif isinstance(raw, list | tuple):
        for index, value in enumerate(raw):
            _refuse_odd(value, f"{field}[{index}]", where, depth + 1)
