"""Values drawn from the types of a schema: within the bounds that the types give, and often right at them."""

import enum
import math
import types
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec
from hypothesis import strategies as st

EXTREME = (0.0, 1e-300, -1e-300, 5e-324, 1e-9, 1.0, -1.0, 1e9, 1e300, -1e300, 1.7e308)
"""Numbers that are legal wherever a type has no bounds."""

TEXT = st.text(st.characters(exclude_categories=("Cs",)), max_size=30)
Path = tuple[Any, ...]


def values(kind: Any) -> st.SearchStrategy[Any]:
    """Plain values (dict, list, str, ...) of type `kind`, as a file would say them."""
    bare, metas = _split(kind)
    origin, args = get_origin(bare), get_args(bare)
    if origin in (Union, types.UnionType):
        return st.one_of([values(arg) for arg in args])
    if origin is Literal:
        return st.sampled_from(args)
    if origin in (list, tuple, set, frozenset):
        return _sequences(origin, args, metas)
    if origin is dict:
        return st.dictionaries(values(args[0]), values(args[1]), max_size=4)
    if isinstance(bare, type) and issubclass(bare, enum.Enum):
        return st.sampled_from([member.value for member in bare])
    if isinstance(bare, type) and issubclass(bare, msgspec.Struct):
        return st.deferred(lambda: _struct(bare))
    simple = {bool: st.booleans(), type(None): st.none(), str: _texts(metas), int: _integers(metas), float: _floats(metas)}
    return simple.get(bare, st.one_of(st.none(), st.booleans(), TEXT, st.sampled_from(EXTREME)))


def places(raw: Any, kind: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Every place in a value of type `kind`, with the type that stands there."""
    bare, _ = _split(kind)
    origin, args = get_origin(bare), get_args(bare)
    if origin in (Union, types.UnionType):
        bare = next((arg for arg in args if _is(raw, arg)), None)
        origin, args = get_origin(_split(bare)[0]), get_args(_split(bare)[0])
        bare = _split(bare)[0]
    if isinstance(raw, dict) and isinstance(bare, type) and issubclass(bare, msgspec.Struct):
        hints = _hints(bare)
        for name in raw:
            if name in hints:
                yield (*path, name), hints[name]
                yield from places(raw[name], hints[name], (*path, name))
    elif isinstance(raw, list) and args:
        for index, value in enumerate(raw):
            inner = args[0] if origin is list or args[-1] is Ellipsis else args[min(index, len(args) - 1)]
            yield (*path, index), inner
            yield from places(value, inner, (*path, index))
    elif isinstance(raw, dict) and origin is dict:
        for name in raw:
            yield (*path, name), args[1]


def edited(raw: Any, kind: Any) -> st.SearchStrategy[Any]:
    """`raw`, of type `kind`, with one to four of its places filled anew."""
    found = list(places(raw, kind))
    one = st.sampled_from(range(len(found))).flatmap(lambda k: st.tuples(st.just(found[k][0]), values(found[k][1])))
    return st.lists(one, min_size=1, max_size=4).map(lambda changes: _with(raw, changes))


def _with(raw: Any, changes: list[tuple[Path, Any]]) -> Any:
    made = msgspec.json.decode(msgspec.json.encode(raw))
    for path, value in changes:
        target = made
        try:
            for step in path[:-1]:
                target = target[step]
            target[path[-1]] = value
        except (KeyError, IndexError, TypeError):  # an earlier change took the place away
            continue
    return made


def _is(raw: Any, kind: Any) -> bool:
    """Whether a value fits a member of a union; structs by their tag."""
    bare, _ = _split(kind)
    if isinstance(bare, type) and issubclass(bare, msgspec.Struct):
        config = bare.__struct_config__
        return isinstance(raw, dict) and (config.tag_field is None or raw.get(config.tag_field) == config.tag)
    try:
        msgspec.convert(raw, kind)
    except msgspec.ValidationError:
        return False
    return True


def _split(kind: Any) -> tuple[Any, tuple[msgspec.Meta, ...]]:
    if get_origin(kind) is not Annotated:
        return kind, ()
    bare, *metas = get_args(kind)
    inner, more = _split(bare)
    return inner, (*more, *(meta for meta in metas if isinstance(meta, msgspec.Meta)))


def _bound(metas: tuple[msgspec.Meta, ...], *names: str) -> Any:
    found = [getattr(meta, name) for meta in metas for name in names if getattr(meta, name) is not None]
    return found[-1] if found else None


def _floats(metas: tuple[msgspec.Meta, ...]) -> st.SearchStrategy[float]:
    low, high = _bound(metas, "ge", "gt"), _bound(metas, "le", "lt")
    if low is None and high is None:
        return st.one_of(st.sampled_from(EXTREME), st.floats(allow_nan=False, allow_infinity=False))
    low, high = -1e300 if low is None else float(low), 1e300 if high is None else float(high)
    ends = [low, high, math.nextafter(low, high), math.nextafter(high, low), *(each for each in EXTREME if low <= each <= high)]
    return st.one_of(st.sampled_from(ends), st.floats(low, high))


def _integers(metas: tuple[msgspec.Meta, ...]) -> st.SearchStrategy[int]:
    low, high = _bound(metas, "ge", "gt"), _bound(metas, "le", "lt")
    return st.integers(-(2**63) if low is None else low, 2**63 - 1 if high is None else high)


def _texts(metas: tuple[msgspec.Meta, ...]) -> st.SearchStrategy[str]:
    least, most, pattern = _bound(metas, "min_length") or 0, _bound(metas, "max_length"), _bound(metas, "pattern")
    if pattern is not None:
        return st.from_regex(pattern, fullmatch=True).filter(lambda text: len(text) <= (most or 30))
    return st.text(st.characters(exclude_categories=("Cs",)), min_size=least, max_size=min(most or 30, 30))


def _sequences(origin: Any, args: tuple[Any, ...], metas: tuple[msgspec.Meta, ...]) -> st.SearchStrategy[Any]:
    if origin is tuple and args[-1] is not Ellipsis:
        return st.tuples(*(values(arg) for arg in args)).map(list)
    least, most = _bound(metas, "min_length") or 0, _bound(metas, "max_length")
    return st.lists(values(args[0]), min_size=least, max_size=min(most or 5, max(least, 5)))


def _struct(kind: type[msgspec.Struct]) -> st.SearchStrategy[dict[str, Any]]:
    hints, config = _hints(kind), kind.__struct_config__
    fields = {field.encode_name: field for field in msgspec.structs.fields(kind)}
    needed = {name: values(hints[name]) for name, field in fields.items() if field.required}
    others = {name: values(hints[name]) for name in fields if name not in needed}
    if config.tag_field is not None:
        needed[config.tag_field] = st.just(config.tag)
    return st.fixed_dictionaries(needed, optional=others)


def _hints(kind: type[msgspec.Struct]) -> dict[str, Any]:
    hints = get_type_hints(kind, include_extras=True)
    return {field.encode_name: hints[field.name] for field in msgspec.structs.fields(kind)}
