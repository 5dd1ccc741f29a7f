"""The state of a part: nothing is forgotten, nothing changes afterwards, and equal states go on equally."""

import ast
from collections import deque
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path

import msgspec
import numpy as np
import pytest

from pendant.tick.modes import Mode
from pendant.tick.pose import dot
from pendant.tick.state import state_of


class Part:
    """One that is not in the pendant's folder, but says so."""

    __slots__ = ("_other", "value")
    __module__ = "pendant.somewhere"

    def __init__(self, value: object = None, other: object = None) -> None:
        self.value, self._other = value, other


class Longer(Part):
    __slots__ = ("more",)
    NOT_STATE = ("value",)
    __module__ = "pendant.somewhere"

    def __init__(self, value: object, more: object) -> None:
        super().__init__(value)
        self.more = more


class Open:
    """Without slots."""

    __module__ = "pendant.somewhere"

    def __init__(self, value: object) -> None:
        self.value = value


class Frozen(msgspec.Struct, frozen=True):
    number: int


class Loose(msgspec.Struct):
    number: int


def test_it_is_the_class_and_every_field() -> None:
    assert state_of(Part(1.5)) == ("Part", ("_other", None), ("value", 1.5))
    assert state_of(Open("word")) == ("Open", ("value", "word"))


def test_fields_of_the_base_belong_to_it_and_what_a_class_names_does_not() -> None:
    assert state_of(Longer(1, 2)) == ("Longer", ("_other", None), ("more", 2))


@pytest.mark.parametrize("value", [None, True, 3, 2.5, "word", b"\x00", Mode.RUN, frozenset({1}), Frozen(3), dot])
def test_values_are_as_they_are(value: object) -> None:
    assert state_of(Part(value))[2] == ("value", value)


CHANGES: list[tuple[object, Callable[..., object], object]] = [
    ([1, [2]], lambda held: held[1].append(3), (1, (2,))),
    (deque([1, 2], 3), lambda held: held.append(3), (1, 2)),
    ({"a": [1]}, lambda held: held["a"].append(2), (("a", (1,)),)),
    (np.array([1.0, 2.0]), lambda held: held.fill(3.0), ((2,), np.array([1.0, 2.0]).tobytes())),
    (Part([1]), lambda held: held.value.append(2), ("Part", ("_other", None), ("value", (1,)))),
    ((Part(1), 5), lambda held: setattr(held[0], "value", 2), (("Part", ("_other", None), ("value", 1)), 5)),
]


@pytest.mark.parametrize(("held", "change", "expected"), CHANGES)
def test_what_changes_later_does_not_change_it(held: object, change: Callable[..., object], expected: object) -> None:
    held = deepcopy(held)  # the list above is not this test's to change
    part = Part(held)
    before = state_of(part)
    assert before[2] == ("value", expected)
    change(held)
    assert before[2] == ("value", expected)
    assert state_of(part) != before


def test_parts_that_know_each_other_are_told_once() -> None:
    """By their numbers in the order in which they are met, so that other objects of the same history compare equal."""
    one, two = Part(1), Part(2)
    one._other, two._other = two, one
    assert state_of(one) == ("Part", ("_other", ("Part", ("_other", ("Part", 0)), ("value", 2))), ("value", 1))
    assert state_of(Part(one, one))[2] == ("value", ("Part", 1))
    assert state_of(Part(Part(), Part())) != state_of(Part(one, one))


@pytest.mark.parametrize("value", [object(), Loose(1), lambda: 1, {1}, Part().__init__])
def test_what_is_neither_a_value_nor_a_part_is_refused(value: object) -> None:
    """A field that the state cannot hold must not be forgotten."""
    with pytest.raises(TypeError, match="NOT_STATE"):
        state_of(Part(value))


def test_only_what_is_known_is_left_out() -> None:
    """Buffers of the contact detectors, and what is made of settings and of the arm's file alone."""
    found: dict[str, list[str]] = {}
    for path in Path("pendant").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            for line in node.body if isinstance(node, ast.ClassDef) else []:
                if isinstance(line, ast.Assign) and ast.unparse(line.targets[0]) == "NOT_STATE":
                    found[node.name] = list(ast.literal_eval(line.value))
    buffers = ["detectors", "links", "_poses", "_kept", "_limits", "_keys", "_sensor"]
    assert found == {
        "ContactMonitor": buffers,
        "OperatingSensitivity": ["_given"],
        "Equipping": ["_shape", "_room"],
        "Barrier": ["_shape"],
        "Containment": ["_triggers", "_workspace"],
        "Anchor": ["_decide"],
        "LimitWatch": ["_of", "_limits", "_normal"],
    }
