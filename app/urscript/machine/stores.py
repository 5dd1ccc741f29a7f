"""What steps do that put values where they belong, and what they count."""

from typing import Any

from app.urscript.language import tree
from app.urscript.language.trouble import Misuse, ScriptTrouble, Spot
from app.urscript.machine.analysis import Routine, calls
from app.urscript.machine.expressions import Frame, Read
from app.urscript.machine.operators import with_element, with_member
from app.urscript.machine.values import Value


def put_own(slot: int, value: Read, following: int) -> Any:
    """Assign what needs no room to a function's variable."""

    def step(f: Frame) -> int:
        f[slot] = value(f)
        return following

    return step


def put_shared(values: list[Value], number: int, value: Read, following: int) -> Any:
    """The same to a variable that all functions see."""

    def step(f: Frame) -> int:
        values[number] = value(f)
        return following

    return step


def cost_within(node: tree.Node, routines: dict[str, Routine]) -> int:
    """Steps of the functions that run within an expression."""
    called = (routines.get(call.name) for call in calls(node))
    return sum(routine.cost for routine in called if routine is not None and not routine.by_steps)


def changed(read: Read, path: list[tuple[str, list[Read]]], value: Read, place: Spot) -> Read:
    """The variable's value with another part."""

    def put(of: Value, rest: list[tuple[str, list[Value]]], new: Value) -> Value:
        (name, numbers), *rest = rest
        if name:
            return with_member(of, name, put(of.members[name], rest, new) if rest else new)
        if not rest:
            return with_element(of, numbers, new)
        inner = of
        for number in numbers:
            inner = inner[int(number)]
        return with_element(of, numbers, put(inner, rest, new))

    def result(f: Frame) -> Value:
        new = value(f)
        if new is None:
            raise ScriptTrouble(place, "a part of a value cannot be None")
        of, way = read(f), [(name, [number(f) for number in numbers]) for name, numbers in path]
        try:
            return put(of, way, new)
        except (Misuse, TypeError, ValueError, IndexError, KeyError, AttributeError) as error:
            text = str(error) if isinstance(error, Misuse) else "there is no such part of the value"
            raise ScriptTrouble(place, text) from None

    return result
