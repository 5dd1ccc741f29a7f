"""Functions of strings (URScript manual, module internals)."""

import re
from collections.abc import Iterator

from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, anything, builtin, integer, text
from app.urscript.machine.values import GREATEST, LEAST, Value, joined_text, shown

NUMBER = re.compile(r"\s*([+-]?)(0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\Z")


def of_texts() -> Iterator[Builtin]:
    """All of them."""
    source, index = Taken("src", text), Taken("index", integer)
    yield builtin("str_at", _at, source, index)
    yield builtin("str_cat", joined_text, Taken("op1", anything), Taken("op2", anything))
    yield builtin("str_empty", lambda s: not s, Taken("str", text))
    yield builtin("str_find", _find, source, Taken("target", text), Taken("start_from", integer, 0))
    yield builtin("str_len", lambda s: len(s.encode()), Taken("str", text))
    yield builtin("str_sub", _part, source, index, Taken("len", integer, None))
    yield builtin("to_num", _to_number, Taken("str", text))
    yield builtin("to_str", shown, Taken("val", anything))


def _at(source: str, index: int) -> str:
    data = source.encode()
    if not data:
        raise Misuse("src: the string is empty")
    if not 0 <= index < len(data):
        raise Misuse(f"index {index} out of range: the string has {len(data)} characters")
    return data[index : index + 1].decode("latin-1")


def _find(source: str, target: str, start: int) -> int:
    return source.encode().find(target.encode(), max(start, 0))


def _part(source: str, index: int, length: int | None) -> str:
    data = source.encode()
    if not 0 <= index <= len(data):
        raise Misuse(f"index {index} out of range: the string has {len(data)} characters")
    if length is not None and length < 0:
        raise Misuse(f"len {length} is out of range, allowed: 0 or more")
    return data[index : None if length is None else index + length].decode("utf-8", "replace")


def _to_number(source: str) -> Value:
    found = NUMBER.match(source)
    if found is None:
        raise Misuse(f"{source[:30]!r} is no valid number")
    sign, digits = found.groups()
    if any(c in digits for c in ".eE") and digits[:2] not in ("0x", "0X"):
        return float(sign + digits)
    value = int(sign + digits, 0 if digits[:2] in ("0x", "0X") else 10)
    if not LEAST <= value <= GREATEST:
        raise Misuse(f"{source[:30]!r} is beyond what an integer holds")
    return value
