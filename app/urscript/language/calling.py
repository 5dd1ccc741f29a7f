"""Which argument of a call is for which parameter."""

from typing import Any, NamedTuple

from app.urscript.language import tree
from app.urscript.language.trouble import ScriptTrouble


class Given(NamedTuple):
    """What a parameter gets: an argument, or its default."""

    node: tree.Node | None
    default: Any = None


def bound(call: tree.Call, names: list[str], defaults: dict[str, Given]) -> list[Given]:
    """For each parameter, in its order, what the call gives it.

    Raises:
        ScriptTrouble: too many arguments, too few, or one that does not exist.
    """
    if len(call.arguments) > len(names):
        raise ScriptTrouble(call.place, f"{call.name}() takes {_count(len(names))}, {len(call.arguments)} are given")
    found = {name: Given(node) for name, node in zip(names, call.arguments, strict=False)}
    for name, node in call.named:
        if name not in names:
            known = f"; it has {', '.join(names)}" if names else ""
            raise ScriptTrouble(call.place, f"{call.name}() has no parameter {name}{known}")
        if name in found:
            raise ScriptTrouble(call.place, f"{call.name}(): {name} is given twice")
        found[name] = Given(node)
    for name in names:
        if name not in found and name not in defaults:
            raise ScriptTrouble(call.place, f"{call.name}() needs {name}")
    return [found.get(name) or defaults[name] for name in names]


def _count(number: int) -> str:
    return "no arguments" if number == 0 else "1 argument" if number == 1 else f"{number} arguments at most"
