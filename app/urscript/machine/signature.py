"""A function that comes with the language: its name, its parameters, what it does."""

import math
from collections.abc import Callable
from typing import NamedTuple

from app.urscript.language.trouble import Misuse
from app.urscript.machine.operators import effort
from app.urscript.machine.values import PoseValue, Value, kind

Check = Callable[[Value], Value]


class NeededArgument:
    """Stands for the default of a parameter that has none."""


NEEDED = NeededArgument()


class Taken(NamedTuple):
    """A parameter of it."""

    name: str
    check: Check
    default: Value = NEEDED


class Builtin(NamedTuple):
    """A function of the language.

    `work` gets checked values in the order of `parameters`, and returns the result; of one that takes time it is a generator that
    is asked once a tick until it returns. It raises Misuse where it cannot be done.
    """

    name: str
    parameters: tuple[Taken, ...]
    work: Callable[..., Value]
    takes_time: bool = False
    physical: bool = False  # the time that it takes is the arm's: it moves, or waits on purpose
    barred: str = ""  # why a program of this kind may not name it
    absent: str = ""  # why this robot has it not, which ends a program that calls it


def builtin(
    name: str,
    work: Callable[..., Value],
    *parameters: Taken,
    takes_time: bool = False,
    physical: bool = False,
    cost: int = 0,
) -> Builtin:
    """A function of the language; `cost`: what a call takes beyond that of a short function, in steps of the evaluator."""
    return Builtin(name, parameters, _counted(work, cost) if cost else work, takes_time or physical, physical)


def barred(name: str, why: str) -> Builtin:
    """A function that the language has, and this kind of program has not: who names it is refused."""
    return Builtin(name, (), _never, barred=why)


def absent(name: str, why: str) -> Builtin:
    """A function that the language has, and this robot has not: a program may name it, and ends where it calls it."""
    return Builtin(name, (), _never, absent=why)


def _never(*_: Value) -> Value:
    raise AssertionError("the compiler takes care of it")


def _counted(work: Callable[..., Value], cost: int) -> Callable[..., Value]:
    def counted(*given: Value) -> Value:
        effort[0] += cost
        return work(*given)

    return counted


def anything(value: Value) -> Value:
    """Every value but None."""
    if value is None:
        raise Misuse("there is no value, it is None")
    return value


def any_value(value: Value) -> Value:
    """Every value."""
    return value


def number(value: Value) -> float:
    """A finite number."""
    if type(value) is float and math.isfinite(value):
        return value
    if type(value) is int:
        return float(value)
    if type(value) is float:
        raise Misuse(f"expected a finite number, this is {'no number (NaN)' if math.isnan(value) else 'infinite'}")
    raise Misuse(f"expected a number, this is {kind(value)}")


def integer(value: Value) -> int:
    """A whole number."""
    if type(value) is int:
        return value
    if type(value) is float and value.is_integer() and abs(value) < 1e15:
        return int(value)
    raise Misuse(f"expected an integer, this is {value if type(value) is float else kind(value)}")


def boolean(value: Value) -> bool:
    """True or False; numbers too, as on the robot."""
    if type(value) is bool:
        return value
    if type(value) in (int, float):
        return value != 0
    raise Misuse(f"expected a bool, this is {kind(value)}")


def text(value: Value) -> str:
    """A string."""
    if type(value) is str:
        return value
    raise Misuse(f"expected a string, this is {kind(value)}")


def pose(value: Value) -> PoseValue:
    """A pose; a list of six numbers is taken as one."""
    if type(value) is PoseValue:
        return PoseValue(map(number, value))
    if type(value) is tuple and len(value) == 6:
        return PoseValue(map(number, value))
    raise Misuse(f"expected a pose, this is {described(value)}")


def described(value: Value) -> str:
    """Kind and length."""
    return f"{kind(value)} of {len(value)}" if type(value) in (tuple, PoseValue) else kind(value)


def numbers(length: int) -> Check:
    """A list of so many finite numbers; poses too."""

    def check(value: Value) -> tuple[float, ...]:
        if type(value) not in (tuple, PoseValue) or len(value) != length:
            raise Misuse(f"expected a list of {length} numbers, this is {described(value)}")
        return tuple(map(number, value))

    return check


def vector(value: Value) -> tuple[float, ...]:
    """A list of finite numbers, of any length."""
    if type(value) not in (tuple, PoseValue):
        raise Misuse(f"expected a list of numbers, this is {kind(value)}")
    return tuple(map(number, value))


def items(value: Value) -> tuple[Value, ...]:
    """A list."""
    if type(value) is not tuple:
        raise Misuse(f"expected a list, this is {kind(value)}")
    return value


def within(check: Check, least: float, most: float) -> Check:
    """A number in a range."""

    def checked(value: Value) -> Value:
        found = check(value)
        if not least <= found <= most:
            raise Misuse(f"{found:g} is out of range, allowed: {least:g} to {most:g}")
        return found

    return checked


def optional(check: Check) -> Check:
    """None, or what `check` takes."""
    return lambda value: None if value is None else check(value)
