"""Calls of the language's own functions, and structs, within an expression."""

from collections.abc import Callable

from app.urscript.language.trouble import Misuse, ScriptTrouble, Spot
from app.urscript.machine.expressions import Frame, Read
from app.urscript.machine.limits import LONGEST_LIST
from app.urscript.machine.values import StructValue, Value, weight


def worked(name: str, work: Callable[..., Value], arguments: list[tuple[Read, Callable[[Value], Value]]], place: Spot) -> Read:
    """A function of the language that takes no time; each argument is checked."""

    def failed(misuse: Exception) -> ScriptTrouble:
        return ScriptTrouble(place, f"{name}(): {misuse}")

    if not arguments:

        def nothing(_: Frame) -> Value:
            try:
                return work()
            except Misuse as misuse:
                raise failed(misuse) from None

        return nothing
    if len(arguments) == 1:
        ((x, check),) = arguments

        def one(f: Frame) -> Value:
            value = x(f)
            try:
                return work(check(value))
            except Misuse as misuse:
                raise failed(misuse) from None

        return one

    if len(arguments) == 2:
        (first, check_first), (second, check_second) = arguments

        def two(f: Frame) -> Value:
            a, b = first(f), second(f)
            try:
                return work(check_first(a), check_second(b))
            except Misuse as misuse:
                raise failed(misuse) from None

        return two

    def several(f: Frame) -> Value:
        values = [x(f) for x, _ in arguments]
        try:
            return work(*[check(value) for value, (_, check) in zip(values, arguments, strict=True)])
        except Misuse as misuse:
            raise failed(misuse) from None

    return several


def structured(parts: list[tuple[str, Read]], place: Spot) -> Read:
    """A struct of these members."""

    def made(f: Frame) -> Value:
        found = StructValue({name: part(f) for name, part in parts})
        if weight(found) > LONGEST_LIST:
            raise ScriptTrouble(place, f"a struct of {weight(found)} values, allowed: {LONGEST_LIST}")
        return found

    return made


def kept(slot: int) -> Read:
    """What a statement has put into the frame for a moment."""
    return lambda f: f[slot]


def as_it_is(value: Value) -> Value:
    """A default needs no check."""
    return value


def named_check(check: Callable[[Value], Value], name: str) -> Callable[[Value], Value]:
    """The same check, whose error says which argument is wrong."""

    def checked(value: Value) -> Value:
        try:
            return check(value)
        except Misuse as misuse:
            raise Misuse(f"{name}: {misuse}") from None

    return checked
