"""What operators do with values; the compiler has shorter ways for plain numbers."""

import math
from collections.abc import Callable

from app.urscript.language.trouble import Misuse
from app.urscript.machine.values import PoseValue, StructValue, Value, joined_text, kind, number_made

NUMBERS = frozenset({int, float})
LISTS = frozenset({tuple, PoseValue})

effort = [0]
"""Elements that operators have gone through since the machine looked: steps that no count of nodes knows."""

Work = Callable[[Value, Value], Value]


def divided(a: Value, b: Value) -> Value:
    """a / b of numbers; a float also of two integers, as clients' programs expect."""
    if b == 0:
        raise Misuse("division by zero")
    return a / b


def remainder(a: Value, b: Value) -> Value:
    """a % b of numbers, with the sign of a, as in C."""
    if b == 0:
        raise Misuse("division by zero")
    found = math.fmod(a, b)
    return int(found) if type(a) is int and type(b) is int else found


SINGLE: dict[str, Work] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": divided,
    "%": remainder,
}


def compute(operator: str, a: Value, b: Value) -> Value:
    """`a operator b`: of numbers; of lists, poses and numbers element by element; of matrices; + joins strings.

    Source: URScript manual, "Matrix and array expressions". Lists of one length take all five operators, and so do a list or a
    matrix and a number, in either order. A matrix times a matrix or a list is the product of linear algebra.

    Raises:
        Misuse: it cannot be done with these.
    """
    work, left, right = SINGLE[operator], type(a), type(b)
    if left in NUMBERS and right in NUMBERS:
        try:
            found = work(a, b)
        except OverflowError:
            raise Misuse(f"{operator}: the result is too great") from None
        return number_made(found) if type(found) is int else found
    if left is str and right is str and operator == "+":
        return joined_text(a, b)
    if left in LISTS or right in LISTS:
        return _by_elements(operator, a, b)
    hint = "; str_cat() joins strings" if str in (left, right) and operator == "+" else ""
    raise Misuse(f"{operator} of {kind(a)} and {kind(b)}{hint}")


def _by_elements(operator: str, a: Value, b: Value) -> Value:
    """`a operator b` where one of them is a list or a pose, or both are."""
    left, right = type(a), type(b)
    effort[0] += (len(a) if left in LISTS else 0) + (len(b) if right in LISTS else 0)
    if left in LISTS and right in LISTS:
        if operator == "*" and left is tuple and right is tuple and _matrix(a):
            return _product(a, b)
        if _matrix(a) is not _matrix(b):
            raise Misuse(f"{operator} of {_described(a)} and {_described(b)}: only a matrix times a list is known")
        if len(a) != len(b):
            raise Misuse(f"{operator} of lists of {len(a)} and {len(b)} elements")
        pose = a if left is PoseValue else b
        if operator in "+-*" and set(map(type, a)) | set(map(type, b)) == {float}:
            return _like(pose, list(map(SINGLE[operator], a, b)))
        return _like(pose, [compute(operator, x, y) for x, y in zip(a, b, strict=True)])
    if right in NUMBERS:
        return _like(a, [compute(operator, x, b) for x in a])
    if left in NUMBERS:
        return _like(b, [compute(operator, a, x) for x in b])
    raise Misuse(f"{operator} of {kind(a)} and {kind(b)}")


def compare(operator: str, a: Value, b: Value) -> bool:
    """`a < b` and the like, of numbers."""
    if type(a) not in NUMBERS or type(b) not in NUMBERS:
        raise Misuse(f"{operator} of {kind(a)} and {kind(b)}: expected numbers")
    return a < b if operator == "<" else a > b if operator == ">" else a <= b if operator == "<=" else a >= b


def negative(a: Value) -> Value:
    """-a."""
    if type(a) in NUMBERS:
        return number_made(-a) if type(a) is int else -a
    if type(a) in (tuple, PoseValue):
        return _like(a, [negative(x) for x in a])
    raise Misuse(f"- of {kind(a)}")


def truth(value: Value) -> bool:
    """Whether a condition holds: bools, and numbers other than 0."""
    if value is True or value is False:
        return value
    if type(value) in NUMBERS:
        return value != 0
    raise Misuse(f"a condition is {kind(value)}: expected a bool")


def element(of: Value, numbers: list[Value]) -> Value:
    """of[i], or of[i, j] of a matrix."""
    for number in numbers:
        of = of[place_in(of, number)]
    return of


def place_in(of: Value, number: Value) -> int:
    """An index, checked."""
    if type(of) not in (tuple, PoseValue, str):
        raise Misuse(f"[] of {kind(of)}: expected a list or a pose")
    if type(number) is float and number.is_integer():
        number = int(number)
    if type(number) is not int:
        raise Misuse(f"the index is {kind(number)}: expected an integer")
    if not 0 <= number < len(of):
        raise Misuse(f"index {number} out of range: there are {len(of)} elements, counted from 0")
    return number


def with_element(of: Value, numbers: list[Value], value: Value) -> Value:
    """A list like `of` with another element."""
    if type(of) is str:
        raise Misuse("a string cannot be changed at one place")
    at = place_in(of, numbers[0])
    if len(numbers) > 1:
        value = with_element(of[at], numbers[1:], value)
    elif (type(of) is PoseValue or type(of[at]) in NUMBERS) and type(value) not in NUMBERS:
        raise Misuse(f"an element that is a number cannot become {kind(value)}")
    return _like(of, [*of[:at], value, *of[at + 1 :]])


def member(of: Value, name: str) -> Value:
    """of.name of a struct."""
    if type(of) is not StructValue:
        raise Misuse(f".{name} of {kind(of)}: expected a struct")
    if name not in of.members:
        raise Misuse(f"the struct has no member {name}; it has {', '.join(of.members)}")
    return of.members[name]


def with_member(of: Value, name: str, value: Value) -> StructValue:
    """A struct like `of` with another value of a member that it has."""
    member(of, name)
    return StructValue({**of.members, name: value})


def _like(of: Value, items: list[Value]) -> Value:
    return PoseValue(items) if type(of) is PoseValue else tuple(items)


def _matrix(a: Value) -> bool:
    return bool(a) and type(a[0]) is tuple


def _described(a: Value) -> str:
    return "a matrix" if _matrix(a) else kind(a)


def _product(a: Value, b: Value) -> Value:
    """A matrix times a matrix or a vector."""
    if _matrix(b) and any(type(row) is not tuple or len(row) != len(b[0]) for row in b):
        raise Misuse("* of matrices: the rows of the second are not all of one length")
    columns = list(zip(*b, strict=True)) if _matrix(b) else [b]
    for row in a:
        if type(row) is not tuple or any(len(row) != len(column) for column in columns):
            raise Misuse(f"* of matrices: rows of {len(row)}, columns of {len(b)}")
    rows = [[_dot(row, column) for column in columns] for row in a]
    return tuple(map(tuple, rows)) if _matrix(b) else tuple(row[0] for row in rows)


def _dot(row: Value, column: Value) -> Value:
    total: Value = 0
    for x, y in zip(row, column, strict=True):
        total = compute("+", total, compute("*", x, y))
    return total
