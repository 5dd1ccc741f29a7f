"""The tree of a script."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from app.urscript.language.trouble import Spot

Plain = float | int | bool | str | None


@dataclass(slots=True)
class Node:
    """Base of all."""

    place: Spot
    size: int = field(default=0, init=False, repr=False, compare=False)  # nodes of an expression, once they have been counted


@dataclass(slots=True)
class Literal(Node):
    """A number, a text, True, False or None."""

    value: Plain


@dataclass(slots=True)
class Name(Node):
    """A variable's."""

    name: str


@dataclass(slots=True)
class Unary(Node):
    """`not` or a sign."""

    operator: str
    operand: Node


@dataclass(slots=True)
class Binary(Node):
    """An operator between two values; `and` and `or` look at the second only if it counts."""

    operator: str
    left: Node
    right: Node


@dataclass(slots=True)
class Items(Node):
    """A list, or a pose."""

    items: list[Node]
    pose: bool = False


@dataclass(slots=True)
class Index(Node):
    """An element of a list or a pose; two numbers for one of a matrix."""

    of: Node
    numbers: list[Node]


@dataclass(slots=True)
class Member(Node):
    """A member of a struct."""

    of: Node
    name: str


@dataclass(slots=True)
class Call(Node):
    """Of a function, with arguments by place and by name."""

    name: str
    arguments: list[Node]
    named: list[tuple[str, Node]]


@dataclass(slots=True)
class RemoteCall(Node):
    """Of a function of the server behind a handle: `handle.function(arguments)`."""

    of: Node  # a handle, or a struct that has one
    name: str  # all that stands behind it: `function`, `part.function`, or of a struct `member.function`
    arguments: list[Node]


@dataclass(slots=True)
class Run(Node):
    """Starts a thread; its number is the value."""

    call: Call


@dataclass(slots=True)
class Assign(Node):
    """To a variable, or to a part of one."""

    target: Node
    value: Node
    scope: str = ""  # "local", "global" or none


@dataclass(slots=True)
class Evaluate(Node):
    """A call for its own sake."""

    value: Node


@dataclass(slots=True)
class If(Node):
    """With all of its branches; the last condition may be missing."""

    branches: list[tuple[Node | None, list[Node]]]


@dataclass(slots=True)
class While(Node):
    """A loop."""

    condition: Node
    body: list[Node]


@dataclass(slots=True)
class Jump(Node):
    """break, continue, halt, enter_critical or exit_critical."""

    word: str


@dataclass(slots=True)
class Return(Node):
    """Of a function."""

    value: Node | None


@dataclass(slots=True)
class OnThread(Node):
    """join or kill of a thread."""

    word: str
    thread: Node


@dataclass(slots=True)
class FunctionParameter(Node):
    """Of a function; with a default it can be left out."""

    name: str
    default: Node | None


@dataclass(slots=True)
class Function(Node):
    """def, thread or sec, with its body."""

    kind: str
    name: str
    parameters: list[FunctionParameter]
    body: list[Node] = field(default_factory=list)


def levels(body: list[Node]) -> Iterator[list[Node]]:
    """All nodes of a tree: those on top, then those that these consist of, and so on."""
    level = list(body)
    while level:
        yield level
        level = [part for node in level for part in _parts(node)]


def _parts(node: Node) -> Iterator[Node]:
    for name in type(node).__slots__:
        yield from _nodes(getattr(node, name))


def _nodes(value: Any) -> Iterator[Node]:
    if isinstance(value, Node):
        yield value
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _nodes(each)


def let_go(body: list[Node]) -> None:
    """Give a tree's memory back one node after the other: all at once it would hold up every other thread."""
    kept = list(levels(body))
    body.clear()
    for level in kept:
        while level:
            level.pop()
