"""The comparison of sessions with what they did before."""

import pytest

from app.session.session_file import bundled
from tests.golden import GRACE, Deed, differences, known

BEFORE: list[Deed] = [(1.0, "entered"), (4.0, "left_period")]


@pytest.mark.parametrize(
    ("now", "count"),
    [
        (BEFORE, 0),
        ([(1.0 + GRACE, "entered"), (4.0 - GRACE, "left_period")], 0),
        ([(1.0 + GRACE + 0.002, "entered"), (4.0, "left_period")], 1),
        ([(1.0, "entered"), (4.0, "left_wall")], 1),
        ([(1.0, "entered")], 1),
        ([*BEFORE, (5.0, "entered")], 1),
    ],
)
def test_another_kind_time_or_number_is_a_difference(now: list[Deed], count: int) -> None:
    assert len(differences(BEFORE, now)) == count


def test_every_bundled_session_is_known() -> None:
    assert set(known()) == set(bundled("sessions"))
    assert sum(map(len, known().values())) > 100
