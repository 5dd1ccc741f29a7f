"""Loads that can be, and those that cannot."""

import math

import pytest

from pendant.equipment.load import FARTHEST, NOTHING, Load, Problem, misplaced, problem, strange


@pytest.mark.parametrize(
    "load",
    [
        NOTHING,
        Load(mass=5.0),
        Load(mass=2.0, com=[FARTHEST, -FARTHEST, 0.0]),
        Load(mass=2.0, inertia=[0.01, 0.01, 0.01, 0.0, 0.0, 0.0]),
        Load(mass=2.0, inertia=[0.01, 0.01, 0.02, 0.0, 0.0, 0.0]),  # a disc: the largest moment is the sum of the others
    ],
)
def test_a_load_that_can_be_has_no_problem(load: Load) -> None:
    assert problem(load, 5.0) is None


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        (Load(mass=5.1), Problem("mass", 5.1, "0 .. 5 kg")),
        (Load(mass=-0.1), Problem("mass", -0.1, "0 .. 5 kg")),
        (Load(mass=1.0, com=[0.0, 1.1, 0.0]), Problem("com[1]", 1.1, "-1 .. 1 m")),
        (Load(mass=1.0, com=[0.0, 0.0, -1.1]), Problem("com[2]", -1.1, "-1 .. 1 m")),
    ],
)
def test_what_is_wrong_is_said_with_its_value_and_what_is_allowed(load: Load, expected: Problem) -> None:
    assert problem(load, 5.0) == expected


def test_what_is_not_a_number_is_refused() -> None:
    assert problem(Load(mass=math.nan), 5.0) is not None
    assert misplaced([0.0, math.nan, 0.0], "tcp") is not None
    assert strange([math.nan] * 6, 1.0) is not None


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        ([0.01, 0.01], "six numbers"),
        ([0.01, 0.01, 0.021, 0.0, 0.0, 0.0], "principal moments"),  # thinner than a disc
        ([0.0, 0.01, 0.01, 0.0, 0.0, 0.0], "principal moments"),
        ([0.01, 0.01, 0.01, 0.02, 0.0, 0.0], "principal moments"),  # one of them below 0
        ([1.01, 1.01, 1.01, 0.0, 0.0, 0.0], "principal moments from 1e-08 to 1 kg·m² for 1 kg"),  # a kilogram more than 1 m away
        ([0.9e-8, 0.9e-8, 0.9e-8, 0.0, 0.0, 0.0], "principal moments from 1e-08 to 1 kg·m² for 1 kg"),  # denser than anything
    ],
)
def test_an_inertia_that_no_body_has_is_refused(inertia: list[float], words: str) -> None:
    found = problem(Load(mass=1.0, inertia=inertia), 5.0)
    assert found is not None
    assert (found.field, found.value) == ("inertia", inertia)
    assert found.allowed.startswith(words)
