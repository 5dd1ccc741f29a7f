"""Files and raw values into checked types: the one wrapper round msgspec and PyYAML. Anything wrong is one clear line."""

import difflib
import enum
import functools
import math
import re
import types
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, Union, get_args, get_origin, get_type_hints

import msgspec
import yaml

T = TypeVar("T")

LARGEST = 4_000_000
"""Largest file that is read [bytes]."""

DEEPEST = 40
"""Deepest nesting that is accepted; below what the parser's recursion bears."""


class BadInput(Exception):
    """Input that cannot be used. `str` is one line: where: field = value: what is allowed.

    Args:
        where: the file, option or message that holds the input.
        field: dotted path of the field; empty for the whole.
        value: what stands there; `ABSENT` for nothing.
        allowed: what may stand there.
    """

    def __init__(self, where: str, field: str, value: object, allowed: str) -> None:
        super().__init__(where, field, value, allowed)
        self.where = where
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        shown = "" if self.value is ABSENT else f" = {_shown(self.value)}" if self.field else f" {_shown(self.value)}"
        return " ".join(f"{self.where}: {self.field}{shown}: {self.allowed}".replace(": :", ":").split())


class _Absent:
    def __repr__(self) -> str:
        return "nothing"


ABSENT = _Absent()
"""The value of a `BadInput` where there is none to show."""


def load(path: str | Path, kind: type[T]) -> T:
    """Reads the YAML file at `path` as a value of type `kind`.

    Raises:
        BadInput: the file is missing, is not UTF-8 or YAML, repeats a key, or does not fit `kind`.
    """
    where = Path(path).name or str(path)
    return convert(_parsed(_text(Path(path), where), where), kind, where)


def convert(raw: object, kind: type[T], where: str) -> T:
    """Turns plain values (dict, list, str, float, ...) into a value of type `kind`; `where` names their origin in messages.

    Raises:
        BadInput: a value is missing, unknown, of the wrong type, out of range or not finite.
    """
    _refuse_odd(raw, "", where, 0)
    if not isinstance(raw, dict) and _is_struct(kind):
        raise BadInput(where, "", raw, f"expected {_described([_Hint(kind)])}")
    try:
        return msgspec.convert(raw, kind)
    except msgspec.ValidationError as error:
        raise _explained(error, raw, kind, where) from None


def parse(text: str, kind: type[T], where: str) -> T:
    """Reads YAML `text` as a value of type `kind`; errors as `load`."""
    return convert(_parsed(text, where), kind, where)


# Reading ---------------------------------------------------------------------------------------------------------------------


def _text(path: Path, where: str) -> str:
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except FileNotFoundError:
        raise BadInput(str(path), "", ABSENT, "expected an existing file") from None
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"expected a readable file ({error.strerror})") from None
    if len(data) > LARGEST:
        raise BadInput(where, "", ABSENT, f"expected at most {LARGEST} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise BadInput(where, f"line {line}", data[error.start : error.start + 4], "expected text in UTF-8") from None


class _Loader(yaml.SafeLoader):
    """YAML 1.2's plain forms: no aliases, no repeated keys, `1e3` is a number; yes, no, on and off are words."""

    yaml_implicit_resolvers = {
        first: [(tag, pattern) for tag, pattern in rules if not tag.endswith((":bool", ":float", ":int", ":timestamp"))]
        for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }
    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            raise _Refused(event.start_mark.line, event.anchor, "expected no anchors and aliases")
        self.depth += 1
        if self.depth > DEEPEST:
            raise _Refused(event.start_mark.line, ABSENT, f"expected at most {DEEPEST} levels of nesting")
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        seen: dict[str, int] = {}
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.tag != "tag:yaml.org,2002:str":
                raise _Refused(key.start_mark.line, getattr(key, "value", ABSENT), "expected a text as key")
            if key.value in seen:
                raise _Refused(key.start_mark.line, key.value, f"expected each key once, it stands on line {seen[key.value]} too")
            seen[key.value] = key.start_mark.line + 1
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|false|True|False)$"), list("tfTF"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^[-+]?[0-9]+$"), list("-+0123456789"))
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(?:\.[0-9]+|[0-9]+\.[0-9]*|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?$|^[-+]?\.(?:inf|Inf|INF)$|^\.(?:nan|NaN|NAN)$"),
    list("-+0123456789."),
)


def _number(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> int:
    text = loader.construct_scalar(node)
    if len(text) > 30:
        raise _Refused(node.start_mark.line, text, "expected a number of at most 30 digits")
    return int(text)


_Loader.add_constructor("tag:yaml.org,2002:int", _number)  # base 10: YAML 1.1 would read 010 as 8


class _Refused(Exception):
    """A line (counted from 0), what stands there, what is allowed."""


def _parsed(text: str, where: str) -> object:
    try:
        return yaml.load(text, Loader=_Loader)  # noqa: S506 (a SafeLoader)
    except _Refused as refused:
        line, value, allowed = refused.args
        raise BadInput(where, f"line {line + 1}", value, allowed) from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f"line {mark.line + 1}" if mark else ""
        raise BadInput(where, line, ABSENT, f"expected YAML ({error.problem or error.context})") from None
    except yaml.YAMLError as error:
        raise BadInput(where, "", ABSENT, f"expected YAML ({error})") from None
    except (ValueError, OverflowError) as error:  # a tagged scalar that is not what its tag says
        raise BadInput(where, "", ABSENT, f"expected YAML ({error})") from None


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


# Explaining ------------------------------------------------------------------------------------------------------------------


class _Hint(NamedTuple):
    """One alternative of a type hint: the bare type and the constraints on it."""

    kind: Any
    metas: tuple[msgspec.Meta, ...] = ()


def _explained(error: msgspec.ValidationError, raw: object, kind: Any, where: str) -> BadInput:
    """msgspec says what is wrong and where; this adds the value that stands there and what is allowed."""
    message, _, path = str(error).partition(" - at ")
    field, value, hints = _walk(raw, kind, path)
    structs = [hint.kind for hint in hints if _is_struct(hint.kind)]
    if unknown := re.search(r"unknown field `(.*)`", message):
        allowed = sorted({name for struct in _matching(structs, value) for name in _names(struct)})
        near = difflib.get_close_matches(unknown[1], allowed, n=1)
        hint = f"did you mean {near[0]}? " if near else ""
        return BadInput(where, _join(field, unknown[1]), ABSENT, f"unknown field, {hint}expected one of {', '.join(allowed)}")
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
    if _is_struct(there.kind):
        struct = _matching([there.kind], raw)
        return _alternatives(_hints_of(struct[0])[step]) if struct and step in _names(struct[0]) else []
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


def _is_struct(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, msgspec.Struct)


def _tag_field(kind: Any) -> str | None:
    return kind.__struct_config__.tag_field if _is_struct(kind) else None


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


def _names(struct: Any) -> list[str]:
    tag = _tag_field(struct)
    return ([tag] if tag else []) + list(_hints_of(struct))


def _join(field: str, name: str) -> str:
    return f"{field}.{name}" if field else name


_WORDS: dict[Any, str] = {float: "a number", int: "a whole number", str: "a text", bool: "true or false", type(None): "null"}
_SIGNS = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<", "multiple_of": "a multiple of", "pattern": "like"}


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
    if _is_struct(hint.kind):
        return f"a mapping of {', '.join(_names(hint.kind))}"
    word = _WORDS.get(hint.kind, "a value")
    return " ".join([word, " and ".join(bounds), f"of {count} characters" if count else ""]).strip()


def _shown(value: object) -> str:
    text = value.decode("latin-1").encode("unicode_escape").decode() if isinstance(value, bytes) else str(value)
    text = " ".join(text.split()) if text.strip() else repr(text)
    return text if len(text) <= 80 else f"{text[:77]}..."
