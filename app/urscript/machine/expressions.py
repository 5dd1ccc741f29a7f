"""Compiles expressions to functions of a frame."""

from collections.abc import Callable
from typing import Any

from app.urscript.language import tree
from app.urscript.language.trouble import Misuse, ScriptTrouble, Spot
from app.urscript.machine.operators import (
    NUMBERS,
    SINGLE,
    compare,
    compute,
    element,
    member,
    negative,
    truth,
)
from app.urscript.machine.values import GREATEST, LEAST, UNSET, PoseValue, Value, kind, made_list

Frame = list[Any]
Read = Callable[[Frame], Value]


def constant(value: Value) -> Read:
    """Always the same."""
    return lambda _: value


def local(slot: int, name: str, place: Spot) -> Read:
    """A variable of a function."""

    def read(f: Frame) -> Value:
        value = f[slot]
        if value is UNSET:
            raise ScriptTrouble(place, f"variable {name} has no value yet")
        return value

    return read


def shared(values: list[Value], number: int, name: str, place: Spot) -> Read:
    """A variable that all functions see."""

    def read(_: Frame) -> Value:
        value = values[number]
        if value is UNSET:
            raise ScriptTrouble(place, f"variable {name} has no value yet")
        return value

    return read


def arithmetic(operator: str, x: Read, y: Read, place: Spot) -> Read:
    """+ - * / %."""
    work, whole = SINGLE[operator], operator in "+-*"

    def both(a: Value, b: Value) -> Value:
        try:
            return compute(operator, a, b)
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    if not whole:
        return lambda f: both(x(f), y(f))

    def result(f: Frame) -> Value:
        a, b = x(f), y(f)
        if type(a) is float and type(b) is float:
            return work(a, b)
        if type(a) is int and type(b) is int:
            found = work(a, b)
            if LEAST <= found <= GREATEST:
                return found
        return both(a, b)

    return result


def comparison(operator: str, x: Read, y: Read, place: Spot) -> Read:
    """== != < > <= >=."""
    if operator == "==":
        return lambda f: x(f) == y(f)
    if operator == "!=":
        return lambda f: x(f) != y(f)

    def result(f: Frame) -> bool:
        try:
            return compare(operator, x(f), y(f))
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    return result


def same(x: Read, value: Value) -> Read:
    """== of something that never changes."""
    return lambda f: x(f) == value


def one_of(x: Read, values: list[Value]) -> Read:
    """Whether it equals one of several numbers: `a == 1 or a == 2`."""
    found = frozenset(values)

    def result(f: Frame) -> bool:
        value = x(f)
        return type(value) in NUMBERS and value in found

    return result


def same_local(slot: int, value: Value, missing: Read) -> Read:
    """== of a function's variable and what never changes; `missing` says that it has no value."""

    def result(f: Frame) -> bool:
        found = f[slot]
        return (missing(f) if found is UNSET else found) == value

    return result


def same_shared(values: list[Value], number: int, value: Value, missing: Read) -> Read:
    """== of a variable that all functions see and what never changes."""

    def result(f: Frame) -> bool:
        found = values[number]
        return (missing(f) if found is UNSET else found) == value

    return result


def condition(x: Read, node: tree.Node) -> Read:
    """Whether a condition holds."""
    if is_bool(node):
        return x
    place = node.place

    def result(f: Frame) -> bool:
        value = x(f)
        if value is True or value is False:
            return value
        try:
            return truth(value)
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    return result


def is_bool(node: tree.Node) -> bool:
    """The value is a bool whatever happens."""
    if isinstance(node, tree.Binary):
        return node.operator in ("==", "!=", "<", ">", "<=", ">=", "and", "or", "xor")
    if isinstance(node, tree.Unary):
        return node.operator == "not"
    return isinstance(node, tree.Literal) and isinstance(node.value, bool)


def either(parts: list[Read]) -> Read:
    """`or` of several conditions."""
    if len(parts) == 2:
        x, y = parts
        return lambda f: x(f) or y(f)

    def result(f: Frame) -> bool:
        return any(part(f) for part in parts)

    return result


def both(x: Read, y: Read) -> Read:
    """`and`."""
    return lambda f: x(f) and y(f)


def unequal(x: Read, y: Read) -> Read:
    """`xor`."""
    return lambda f: x(f) is not y(f)


def opposite(x: Read) -> Read:
    """`not`."""
    return lambda f: not x(f)


def signed(x: Read, place: Spot) -> Read:
    """A sign before a value."""

    def result(f: Frame) -> Value:
        try:
            return negative(x(f))
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    return result


def listed(parts: list[Read], place: Spot, pose: bool) -> Read:
    """A list or a pose."""

    def posed(f: Frame) -> Value:
        values = [part(f) for part in parts]
        for value in values:
            if type(value) not in NUMBERS:
                raise ScriptTrouble(place, f"a pose has 6 numbers, one of these is {kind(value)}")
        return PoseValue(values)

    def result(f: Frame) -> Value:
        try:
            return made_list([part(f) for part in parts])
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    return posed if pose else result


def indexed(of: Read, parts: list[Read], place: Spot) -> Read:
    """An element of a list, a pose, a matrix."""
    first = parts[0]

    def one(f: Frame) -> Value:
        value, number = of(f), first(f)
        if (type(value) is tuple or type(value) is PoseValue) and type(number) is int and 0 <= number < len(value):
            return value[number]
        try:
            return element(value, [number])
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    def several(f: Frame) -> Value:
        try:
            return element(of(f), [part(f) for part in parts])
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    return one if len(parts) == 1 else several


def selected(of: Read, name: str, place: Spot) -> Read:
    """A member of a struct."""

    def result(f: Frame) -> Value:
        try:
            return member(of(f), name)
        except Misuse as misuse:
            raise ScriptTrouble(place, str(misuse)) from None

    return result
