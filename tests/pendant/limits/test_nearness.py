"""How near a singularity is, in words: where they change, and back (FD-4)."""

import math

import pytest

from pendant.limits.nearness import Nearness, SingularityWatch
from pendant.limits.settings import AxisSettings

OK, NEAR, TOO_NEAR = Nearness.OK, Nearness.NEAR, Nearness.TOO_NEAR


def test_the_words_change_at_their_values_and_back_a_fifth_later() -> None:
    watch, axes = SingularityWatch(), AxisSettings()
    heard = [
        (watch.step(value, axes), watch.status)
        for value in (math.inf, 0.04, 0.0399, 0.01, 0.0099, 0.0119, 0.012, 0.047, 0.048, 0.005, 0.1)
    ]
    assert heard == [
        (False, OK), (False, OK), (True, NEAR), (False, NEAR), (True, TOO_NEAR), (False, TOO_NEAR), (True, NEAR),
        (False, NEAR), (True, OK), (True, TOO_NEAR), (True, OK),
    ]  # fmt: skip
    assert watch.status is OK


@pytest.mark.parametrize(("value", "word"), [(0.0625, OK), (0.0624, NEAR), (0.03125, NEAR), (0.0312, TOO_NEAR), (0.0, TOO_NEAR)])
def test_from_ok_every_word_is_told_at_once_and_a_value_at_its_limit_is_the_better_one(value: float, word: Nearness) -> None:
    watch = SingularityWatch()
    assert watch.step(value, AxisSettings(near=0.0625, too_near=0.03125)) is (word is not OK)
    assert watch.status is word
