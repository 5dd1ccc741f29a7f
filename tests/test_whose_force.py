"""The modules that estimate or decide whose force moves the arm: how many lines they have."""

import pytest

from tools.whose_force import count, counts

MODULES_AT_MOST, LINES_AT_MOST = 26, 4541
"""What there is; the aim is 18 modules and 2,600 lines."""


def test_there_are_no_more_of_them() -> None:
    found = counts()
    assert len(found) <= MODULES_AT_MOST
    assert sum(found.values()) <= LINES_AT_MOST


@pytest.mark.parametrize(("source", "lines"), [("", 0), ("a\n\nb\n", 3), (100 * "a", 1), (101 * "a", 2), (201 * "a", 3)])
def test_a_line_counts_for_each_hundred_characters(source: str, lines: int) -> None:
    assert count(source) == lines
