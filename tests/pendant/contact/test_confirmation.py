"""A rule is believed after so many sightings, in a row or all but some of the last ticks (CD-9)."""

import pytest

from pendant.contact.confirmation import Confirmation


@pytest.mark.parametrize(
    ("seen", "count", "misses", "confirmed"),
    [
        ("110111", 2, 0, "010011"),
        ("111111", 4, 0, "000111"),
        ("101101", 3, 1, "000101"),  # three of four, and only where this tick saw it
        ("100111", 3, 3, "000011"),
        ("1", 1, 0, "1"),
        ("0000", 2, 2, "0000"),
    ],
)
def test_confirmed_after_so_many(seen: str, count: int, misses: int, confirmed: str) -> None:
    confirmation = Confirmation()
    assert "".join(str(int(confirmation.step(int(tick), count, misses))) for tick in seen) == confirmed


def test_one_tick_may_count_for_several() -> None:
    confirmation = Confirmation()
    assert [confirmation.step(sightings, 6, 0) for sightings in (2, 3, 1)] == [False, False, True]
    assert [confirmation.step(sightings, 6, 0) for sightings in (0, 5, 5)] == [False, False, True]
    assert [confirmation.step(sightings, 6, 1) for sightings in (0, 5)] == [False, True]  # one miss among seven


def test_cleared_it_counts_anew() -> None:
    confirmation = Confirmation()
    confirmation.step(1, 2, 0)
    confirmation.clear()
    assert not confirmation.step(1, 2, 0)
    assert confirmation.step(1, 2, 0)
