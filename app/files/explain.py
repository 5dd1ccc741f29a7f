"""What msgspec found wrong, with the value that stands there and what is allowed: its own message has neither."""

import difflib
import enum
import functools
import re
import types
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

import msgspec

from app.files.bad_input import ABSENT, BadInput


class _Hint(NamedTuple):
    """One alternative of a type hint: the bare type and the constraints on it."""

    kind: Any
    metas: tuple[msgspec.Meta, ...] = ()


def explained(error: msgspec.ValidationError, raw: object, kind: Any, where: str) -> BadInput:
    """The line to show for `error`, which msgspec raised when it read `raw` as `kind`; `where` names the origin of `raw`."""
    message, _, path = str(error).partition(" - at ")
    field, value, hints = _walk(raw, kind, path)
    structs = [hint.kind for hint in hints if is_struct(hint.kind)]
    if unknown := re.search(r"unknown field `(.*)`", message):
        allowed = sorted({name for struct in _matching(structs, value) for name in names_of(struct)})
        near = difflib.get_close_matches(unknown[1], allowed, n=1)
        hint = f"did you mean {near[0]}? " if near else ""
        return BadInput(
            where, _join(field, unknown[1] or "''"), ABSENT, f"unknown field, {hint}expected one of {', '.join(allowed)}"
        )
    if missing := re.search(r"missing required field `(.*)`", message):
        known = [_hints_of(struct) for struct in _matching(structs, value)]
        tags = [f"one of {', '.join(_tags(structs))}"] if missing[1] in {_tag_field(struct) for struct in structs} else []
        allowed = tags + [_described(_alternatives(hints[missing[1]])) for hints in known if missing[1] in hints]
        return BadInput(where, _join(field, missing[1]), ABSENT, f"missing, expected {' or '.join(allowed) or 'a value'}")
    tag = next((_tag_field(struct) for struct in structs if field.endswith(f".{_tag_field(struct)}")), None)
    if tag and not isinstance(value, dict):
        return BadInput(where, field, value, f"expected one of {', '.join(_tags(structs))}")
    if not message.startswith(("Expected", "Invalid", "Object")):  # a struct's own check of fields against each other
        return BadInput(where, field, ABSENT, message)
    return BadInput(where, field, value, f"expected {_described(hints)}")


def _walk(raw: Any, kind: Any, path: str) -> tuple[str, Any, list[_Hint]]:
    """Follows msgspec's `$.a[2].b`: the dotted field, the value that stands there, and the types that may stand there."""
    field, hints = "", _alternatives(kind)
    for name, index in re.findall(r"\.([^.\[\]`]+)|\[(\d+|\.\.\.)\]", path):
        step: Any = name or index
        if step == "...":  # some entry of a mapping: msgspec does not say which
            step = _offender(raw, hints)
        elif index:
            step = int(index)
        if name and name in {_tag_field(hint.kind) for hint in hints}:
            following = hints
        else:
            following = [hint for there in hints for hint in _inside(there, raw, step)]
        field = f"{field}[{step}]" if isinstance(step, int) else _join(field, str(step))
        hints = following or hints
        try:
            raw = raw[step]
        except (KeyError, IndexError, TypeError):
            raw = ABSENT
    return field, raw, hints


def _inside(there: _Hint, raw: Any, step: Any) -> list[_Hint]:
    """The types that may stand at `step` of a value of type `there`."""
    if is_struct(there.kind):
        struct = _matching([there.kind], raw)
        return _alternatives(_hints_of(struct[0])[step]) if struct and step in names_of(struct[0]) else []
    origin, args = get_origin(there.kind), get_args(there.kind)
    if origin is dict:
        return _alternatives(args[1])
    if origin is tuple and args[-1] is not Ellipsis:
        return _alternatives(args[step]) if isinstance(step, int) and step < len(args) else []
    return _alternatives(args[0]) if origin in (list, tuple, set, frozenset) else []


def _offender(raw: Any, hints: list[_Hint]) -> Any:
    """The first key of a mapping that does not fit, or whose value does not."""
    for there in hints:
        if get_origin(there.kind) is dict and isinstance(raw, dict):
            keys, values = get_args(there.kind)
            for key, value in raw.items():
                if not (_fits(key, keys) and _fits(value, values)):
                    return key
    return "*"


def _fits(value: object, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        return False
    return True


def _alternatives(kind: Any) -> list[_Hint]:
    if get_origin(kind) is Annotated:
        bare, *metas = get_args(kind)
        mine = tuple(meta for meta in metas if isinstance(meta, msgspec.Meta))
        return [_Hint(hint.kind, hint.metas + mine) for hint in _alternatives(bare)]
    if get_origin(kind) in (Union, types.UnionType):
        return [hint for arg in get_args(kind) for hint in _alternatives(arg)]
    return [_Hint(kind)]


def is_struct(kind: Any) -> bool:
    """Whether `kind` is a msgspec struct."""
    return isinstance(kind, type) and issubclass(kind, msgspec.Struct)


def _tag_field(kind: Any) -> str | None:
    return kind.__struct_config__.tag_field if is_struct(kind) else None


def _tags(structs: list[Any]) -> list[str]:
    return sorted(str(struct.__struct_config__.tag) for struct in structs if _tag_field(struct))


def _matching(structs: list[Any], raw: Any) -> list[Any]:
    """Those whose tag stands in `raw`; an untagged one always fits."""
    there = raw if isinstance(raw, dict) else {}
    return [s for s in structs if _tag_field(s) is None or there.get(_tag_field(s)) == s.__struct_config__.tag]


@functools.cache
def _hints_of(struct: Any) -> dict[str, Any]:
    """Type hints by the name that a file uses."""
    hints = get_type_hints(struct, include_extras=True)
    return {field.encode_name: hints[field.name] for field in msgspec.structs.fields(struct)}


def names_of(struct: Any) -> list[str]:
    """The fields of a struct by the names that a file uses, with that of its tag."""
    tag = _tag_field(struct)
    return ([tag] if tag else []) + list(_hints_of(struct))


def _join(field: str, name: str) -> str:
    return f"{field}.{name}" if field else name


_WORDS: dict[Any, str] = {float: "a number", int: "a whole number", str: "a text", bool: "true or false", type(None): "null"}
_SIGNS = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<", "multiple_of": "a multiple of", "pattern": "like"}


def described(kind: Any) -> str:
    """What a value of type `kind` may be, in words."""
    return _described(_alternatives(kind))


def _described(hints: list[_Hint]) -> str:
    """What is allowed, in words."""
    structs = [hint.kind for hint in hints if _tag_field(hint.kind)]
    words = [f"a mapping with {_tag_field(structs[0])} one of {', '.join(_tags(structs))}"] if structs else []
    words += [_described_one(hint) for hint in hints if hint.kind not in structs]
    return " or ".join(words)


def _described_one(hint: _Hint) -> str:
    origin, args = get_origin(hint.kind), get_args(hint.kind)
    bounds = [f"{sign} {getattr(meta, key):g}" if key in ("ge", "gt", "le", "lt") else f"{sign} {getattr(meta, key)}"
              for meta in hint.metas for key, sign in _SIGNS.items() if getattr(meta, key) is not None]  # fmt: skip
    least = max((meta.min_length for meta in hint.metas if meta.min_length is not None), default=None)
    most = min((meta.max_length for meta in hint.metas if meta.max_length is not None), default=None)
    count = f"{least}" if least == most else f"{least or 0} to {most}" if most is not None else f"at least {least}"
    if least is None and most is None:
        count = ""
    if origin is Literal:
        return f"one of {', '.join(map(str, args))}"
    if isinstance(hint.kind, type) and issubclass(hint.kind, enum.Enum):
        return f"one of {', '.join(str(member.value) for member in hint.kind)}"
    if origin in (list, tuple, set, frozenset):
        if origin is tuple and args[-1] is not Ellipsis:
            return f"a list of {len(args)}: {', '.join(_described(_alternatives(arg)) for arg in args)}"
        return f"a list{' of ' + count if count else ''}, each {_described(_alternatives(args[0]))}"
    if origin is dict or hint.kind is dict:
        return "a mapping" + (f" to {_described(_alternatives(args[1]))}" if args else "")
    if is_struct(hint.kind):
        return f"a mapping of {', '.join(names_of(hint.kind))}"
    word = _WORDS.get(hint.kind, "a value")
    return " ".join([word, " and ".join(bounds), f"of {count} characters" if count else ""]).strip()
