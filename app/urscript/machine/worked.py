"""Calls: of the language's own functions and structs within an expression, and steps of those that take time."""

from collections.abc import Callable
from typing import Any

from app.urscript.language import tree
from app.urscript.language.trouble import Misuse, ScriptTrouble, Spot
from app.urscript.machine.analysis import Routine
from app.urscript.machine.expressions import Frame, Read
from app.urscript.machine.held import CALL, WAIT, Held, Step
from app.urscript.machine.limits import LONGEST_LIST
from app.urscript.machine.operators import member
from app.urscript.machine.values import RemoteHandle, StructValue, Value, kind, weight


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


def absent_called(name: str, why: str, given: list[Read], place: Spot) -> Read:
    """A function that this robot has not: the program ends here, when what it is given is known."""

    def ended(f: Frame) -> Value:
        for read in given:
            read(f)
        raise ScriptTrouble(place, f"{name}(): {why}")

    return ended


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


def called(held: Held, routine: Routine, made: Callable[[Frame], Frame], slot: int) -> Step:
    """A function of the script is run; its result is put into the frame at `slot`."""

    def step(f: Frame) -> int:
        held.called = (routine, made(f), slot)
        return CALL

    return step


def waited(
    held: Held, node: tree.Call, slot: int, work: Callable[..., Any], *, arguments: list[tuple[Read, Callable[[Value], Value]]]
) -> Step:
    """A function of the language takes time; each argument is checked."""
    name, place = node.name, node.place

    def step(f: Frame) -> int:
        try:
            held.waiting = (work(*[check(read(f)) for read, check in arguments]), slot, place, name)
        except Misuse as misuse:
            raise ScriptTrouble(place, f"{name}(): {misuse}") from None
        return WAIT

    return step


def remote_waited(held: Held, node: tree.RemoteCall, slot: int, of: Read, *, arguments: list[Read]) -> Step:
    """A function of a server is called: a name with dots is the server's, but for what leads to the handle in a struct."""
    place = node.place

    def step(f: Frame) -> int:
        handle, name = of(f), node.name
        try:
            while "." in name and isinstance(handle, StructValue):
                first, _, rest = name.partition(".")
                handle, name = member(handle, first), rest
            if not isinstance(handle, RemoteHandle):
                raise ScriptTrouble(place, f".{name}() of {kind(handle)}: expected a handle, as rpc_factory() gives it")
            held.waiting = (handle.call(name, [read(f) for read in arguments]), slot, place, name)
        except Misuse as misuse:
            raise ScriptTrouble(place, f"{name}(): {misuse}") from None
        return WAIT

    return step
