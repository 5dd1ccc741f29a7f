"""Two thousand random motions of every kind: each ends where it says or tells a reason, without a step on its way.

A hundred thousand, stepped to their ends: `python -m benchmarks.motions --full`.
"""

import pytest

from benchmarks.motion.play import play

LONGEST = 0.3
"""Of a motion that is stepped to its end; of longer ones the plan is looked at [s]."""


@pytest.mark.parametrize("chunk", range(20))
def test_whatever_is_asked_for_is_done_or_refused_with_a_reason(chunk: int) -> None:
    found = [play(0, number, LONGEST) for number in range(100 * chunk, 100 * chunk + 100)]
    assert [each for each in found if each.failure] == []
    assert sum(bool(each.reason) for each in found) < 60, "most can be done"
    assert max(each.off for each in found) > 0.0, "some are measured"
