"""The state of a part: all that the part remembers, as values that can be compared and that no later tick changes.

The state is derived from the fields of the part and of the parts that it holds, so it includes a new field without more code.
"""

from collections import deque
from enum import Enum

import msgspec
import numpy as np

State = tuple[object, ...]

VALUES = (float, int, str, bytes, frozenset, Enum)


def state_of(part: object) -> State:
    """The state of `part` and of every part that it holds or knows, each once. Parts with equal states behave equally from then
    on.

    A class names in `NOT_STATE` the fields that are left out, and says why.

    Raises:
        TypeError: the content of a field is neither a value nor a part.
    """
    return _part(part, {})


def _part(part: object, seen: dict[int, int]) -> State:
    """A part, described by its class and fields; by its number if it was `seen` before, because parts know each other."""
    number = seen.get(id(part))
    if number is not None:
        return (type(part).__name__, number)
    seen[id(part)] = len(seen)
    left_out = getattr(type(part), "NOT_STATE", ())
    names = [name for name in _fields(part) if name not in left_out]
    return (type(part).__name__, *[(name, _frozen(getattr(part, name), seen)) for name in names])


def _fields(part: object) -> list[str]:
    slots = [name for each in reversed(type(part).__mro__) for name in getattr(each, "__slots__", ())]
    return [*slots, *getattr(part, "__dict__", ())]


def _frozen(value: object, seen: dict[int, int]) -> object:
    """A value as it is now."""
    if value is None or isinstance(value, VALUES) or (isinstance(value, msgspec.Struct) and value.__struct_config__.frozen):
        return value
    if isinstance(value, tuple | list | deque):
        return tuple([_frozen(each, seen) for each in value])
    if isinstance(value, dict):
        return tuple([(key, _frozen(each, seen)) for key, each in value.items()])
    if isinstance(value, np.ndarray):
        return (value.shape, value.tobytes())
    if isinstance(value, type(state_of)) and "<" not in getattr(value, "__qualname__", "<"):
        return value  # a function of a module, not one that was defined within another
    if type(value).__module__.startswith("pendant."):
        return _part(value, seen)
    raise TypeError(f"{value!r} is neither a value nor a part: hold its values, or name its field in NOT_STATE")
