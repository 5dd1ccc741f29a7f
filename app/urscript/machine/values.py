"""The values of a script. All are immutable, so that an assignment copies, as on the robot, without copying.

A list is a tuple, a matrix a tuple of tuples, a pose a tuple of its own kind.
"""

from collections.abc import Iterator
from typing import Any, Final

from app.urscript.language.trouble import Misuse
from app.urscript.machine.limits import LONGEST_LIST, LONGEST_TEXT

Value = Any

GREATEST, LEAST = (1 << 31) - 1, -(1 << 31)
"""Of a whole number; a result beyond is a number with a decimal point."""


class PoseValue(tuple[float, ...]):
    """A pose: position [m], rotation vector [rad]."""

    __slots__ = ()


POSE_MEMBERS = ("x", "y", "z", "rx", "ry", "rz")
"""What other machines call the numbers of a pose."""


class StructValue:
    """A struct: members by name."""

    __slots__ = ("members",)

    def __init__(self, members: dict[str, Value]) -> None:
        self.members = members

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StructValue) and self.members == other.members

    __hash__ = None  # pyright: ignore[reportAssignmentType]: like a dict


class RemoteHandle:
    """A server whose functions can be called."""

    __slots__ = ()

    def call(self, name: str, arguments: list[Value]) -> Iterator[None]:
        """Call one of its functions: a generator that is asked once a tick until it returns what the function gave.

        Raises:
            Misuse: it cannot be called so; or, while it is waited for, it did not answer as it should.
        """
        raise NotImplementedError


class Unset:
    """What a variable holds before anything was assigned."""

    __slots__ = ()


UNSET: Final = Unset()

KINDS = {bool: "a bool", int: "an integer", float: "a float", str: "a string", tuple: "a list", PoseValue: "a pose"}


def kind(value: Value) -> str:
    """What errors call a value."""
    if value is None:
        return "None"
    if isinstance(value, RemoteHandle):
        return "a handle"
    return KINDS.get(type(value), "a struct")


def shown(value: Value) -> str:
    """A value as text; floats have 6 decimals without zeros at the end (URScript manual, to_str)."""
    text = "".join(_parts(value))
    if len(text) > LONGEST_TEXT:
        raise Misuse(f"a text of {len(text)} characters, allowed: {LONGEST_TEXT}")
    return text


def joined_text(a: Value, b: Value) -> str:
    """Both as text, one after the other.

    Raises:
        Misuse: it is too long.
    """
    joined = shown(a) + shown(b)
    if len(joined) > LONGEST_TEXT:
        raise Misuse(f"a text of {len(joined)} characters, allowed: {LONGEST_TEXT}")
    return joined


def safely_shown(value: Value) -> str:
    """The same, for pictures: what is too long is said to be."""
    try:
        return shown(value)
    except Misuse:
        return "(too long)"


def _parts(value: Value) -> Iterator[str]:
    kind_ = type(value)
    if kind_ is str:
        yield value
    elif kind_ is float:
        text = f"{value:.6f}".rstrip("0").rstrip(".") if abs(value) < 1e15 else f"{value:.6g}"
        yield "0" if text == "-0" else text
    elif kind_ is tuple or kind_ is PoseValue:
        yield "p[" if kind_ is PoseValue else "["
        for k, each in enumerate(value):
            if k:
                yield ", "
            yield from _parts(each)
        yield "]"
    elif kind_ is StructValue:
        yield "struct("
        for k, (name, each) in enumerate(value.members.items()):
            yield f"{', ' if k else ''}{name}="
            yield from _parts(each)
        yield ")"
    else:
        yield "(a handle)" if isinstance(value, RemoteHandle) else str(value)


SIMPLE = frozenset({float, int, bool})


def weight(value: Value) -> int:
    """How many numbers and characters a value holds; a number is 1."""
    kind_ = type(value)
    if kind_ is str:
        return len(value) // 8 + 1
    if kind_ is tuple:
        return len(value) + sum(weight(each) for each in value if type(each) not in SIMPLE)
    if kind_ is StructValue:
        return 1 + sum(weight(each) + 1 for each in value.members.values())
    return 6 if kind_ is PoseValue else 1


def made_list(items: list[Value]) -> tuple[Value, ...]:
    """A list of values.

    Raises:
        Misuse: it holds too much, or nothing that a list can hold.
    """
    kinds = set(map(type, items))
    if kinds <= SIMPLE:
        if len(items) > LONGEST_LIST:
            raise Misuse(f"a list of {len(items)} elements, allowed: {LONGEST_LIST}")
        return tuple(items)
    if None in items:
        raise Misuse("a list cannot hold None")
    made = tuple(items)
    if weight(made) > LONGEST_LIST:
        raise Misuse(f"a list of {weight(made)} elements, those of its lists counted, allowed: {LONGEST_LIST}")
    return made


def number_made(value: int) -> float | int:
    """A whole result, as a float where it is beyond 32 bits."""
    return value if LEAST <= value <= GREATEST else float(value)
