"""The constants of the modules that judge whose force moves the arm: how many they are, and that each says where it is from."""

import pytest

from tools.force_constants import constants, counts

AT_MOST, MODULES_AT_MOST = 24, 4
"""What there is; a number more is a rule more, and ought to be a model."""


def test_there_are_no_more_of_them() -> None:
    found = counts()
    assert sum(map(len, found.values())) <= AT_MOST
    assert sum(bool(some) for some in found.values()) <= MODULES_AT_MOST


def test_each_says_what_it_is() -> None:
    assert [(name, each.name) for name, some in counts().items() for each in some if not each.sourced] == []


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("FAR = 4.0  # [N]", ["FAR"]),
        ("FAR, FAR_TURN = 4.0, 1.0", ["FAR", "FAR_TURN"]),
        ("LEFT = 0.15\nREST = 1.0 - LEFT", ["LEFT"]),
        ("FOLLOW = TICK / 1.0", ["FOLLOW"]),
        ("NONE = 0.0\nNOTHING = (0, 0.0)\n_RATE = 3.0\nrate = 2.0", []),
        ("STEADY = ticks(5.0)", ["STEADY"]),
        ("HERE, THERE = range(2)", []),
        ("def f():\n    FAR = 4.0", []),
    ],
)
def test_a_constant_is_a_number_of_its_own(source: str, names: list[str]) -> None:
    assert [each.name for each in constants(source)] == names


def test_a_comment_or_a_docstring_is_its_source() -> None:
    found = constants('FAR = 4.0  # [N]\nNEAR = 1.0\n"""[N]"""\nBARE = 2.0\n')
    assert [each.sourced for each in found] == [True, True, False]
