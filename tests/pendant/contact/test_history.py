"""Buffers of signals: means and variances from running sums equal those of the samples themselves (CD-4, CD-6, CD-8)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.contact.history import MASK, SIZE, SUMMED, History
from pendant.tick.source_signal import Signal

numbers = st.floats(-100.0, 100.0, allow_nan=False)


def filled(rows: list[list[float]]) -> History:
    history = History()
    for row in rows:
        history.push(Signal(*row))
    return history


@given(st.lists(st.lists(numbers, min_size=6, max_size=6), min_size=12, max_size=40), st.data())
def test_a_mean_and_a_variance_are_those_of_the_samples(rows: list[list[float]], data: st.DataObject) -> None:
    history = filled(rows)
    age = data.draw(st.integers(0, len(rows) - 2))
    length = data.draw(st.integers(1, len(rows) - age - 1))
    samples = np.array(rows[::-1][age : age + length])
    mean = history.mean(age, length)
    assert mean == pytest.approx(samples.mean(axis=0), abs=1e-9)
    assert history.median(age, length) == pytest.approx(np.median(samples, axis=0))
    force, acceleration = history.variances(age, length, mean)
    assert force == pytest.approx(samples[:, :3].var(axis=0).mean(), abs=1e-7)
    assert acceleration == pytest.approx(samples[:, 3:].var(axis=0).mean(), abs=1e-7)


def test_it_keeps_the_last_second_and_counts_no_further() -> None:
    history = filled([[float(k), 0.0, 0.0, 0.0, 0.0, 0.0] for k in range(SIZE + 90)])
    assert history.count == MASK
    assert [history.sample(age).fx for age in (0, 1, MASK - 1)] == [SIZE + 89.0, SIZE + 88.0, 91.0]
    assert history.mean(0, 4)[0] == SIZE + 87.5


def test_a_day_of_samples_leaves_no_error_that_counts() -> None:
    rng = np.random.default_rng(3)
    noise = rng.normal(0.0, 0.15, (4 * SIZE, 6))
    rows = noise + np.array([30.0, -40.0, 20.0, 1.0, 2.0, 9.0])
    fresh, old = filled(rows.tolist()), History()
    old._sums[0] = tuple(4.3e7 * value for value in (30.0, -40.0, 20.0, 1.0, 2.0, 9.0))
    old._squares[0] = (4.3e7 * 2900.0, 4.3e7 * 86.0)
    for row in rows.tolist():
        old.push(Signal(*row))
        old.mean(0, 1)
    assert old.mean(8, 30) == pytest.approx(fresh.mean(8, 30), abs=1e-6)
    mean = fresh.mean(8, 30)
    assert old.variances(8, 30, mean) == pytest.approx(fresh.variances(8, 30, mean), abs=1e-4)


def test_what_lies_before_a_gap_counts_no_more() -> None:
    history = filled([[5.0] * 6] * 20)
    history.gap()
    assert history.count == 0
    history.push(Signal(*[1.0] * 6))
    assert history.count == 1
    assert history.mean(0, 1) == (1.0,) * 6


@pytest.mark.parametrize("unasked", [1, 2, SUMMED - 1, SUMMED, SUMMED + 1, MASK, SIZE, 3 * SIZE + 5])
def test_sums_that_were_not_asked_for_are_made_up_for(unasked: int) -> None:
    rng = np.random.default_rng(unasked)
    rows = rng.normal(0.0, 5.0, (60 + unasked, 6))
    history = filled(rows[:60].tolist())
    history.mean(0, 5)
    for row in rows[60:].tolist():
        history.push(Signal(*row))
    assert history.mean(30, 25) == pytest.approx(rows[::-1][30:55].mean(axis=0), abs=1e-9)
    assert history.count == (60 + unasked if unasked <= SUMMED else SUMMED)
    history.push(Signal(*[7.0] * 6))
    assert history.mean(0, 1) == pytest.approx([7.0] * 6)
    mean = history.mean(1, 20)
    assert mean == pytest.approx(rows[::-1][:20].mean(axis=0), abs=1e-9)
    assert history.variances(1, 20, mean)[0] == pytest.approx(rows[::-1][:20, :3].var(axis=0).mean(), abs=1e-7)


def test_samples_since_a_saturated_one_are_counted_apart() -> None:
    assert (History().count, History().clean) == (0, 0)
    history = filled([[5.0] * 6] * 20)
    assert history.clean == 20
    history.push(Signal(*[100.0] * 6, saturated=1.0))
    assert (history.count, history.clean) == (21, 0)
    for _ in range(5):
        history.push(Signal(*[5.0] * 6))
    assert (history.count, history.clean) == (26, 5)
    history.shorten(10)
    assert (history.count, history.clean) == (10, 5)
    history.shorten(3)
    assert (history.count, history.clean) == (3, 3)


def test_a_mean_over_all_that_is_kept() -> None:
    rows = np.random.default_rng(5).normal(0.0, 5.0, (SIZE + 90, 6))
    history = History()
    for row in rows.tolist():
        history.push(Signal(*row))
        history.mean(0, 1)
    assert history.mean(0, MASK) == pytest.approx(rows[-MASK:].mean(axis=0), abs=1e-9)


def test_sums_that_begin_anew_owe_nothing_to_what_was_before() -> None:
    """Beside a sum of 5e20, values of 1 and 3 would not count at all."""
    history = History()
    for _ in range(SIZE):
        history.push(Signal(*[1e18] * 6))
        history.mean(0, 1)
    for k in range(SUMMED + 1):
        history.push(Signal(*[1.0 + k % 2 * 2.0] * 6))
    mean = history.mean(0, 4)
    assert mean == (2.0,) * 6
    assert history.variances(0, 4, mean) == (1.0, 1.0)


def test_what_was_before_the_samples_that_still_count_is_in_no_sum() -> None:
    """Asked late: only the newest hundred count: sums begin with them, beside them 5e20 would hide 1 and 3."""
    history = History()
    for _ in range(SIZE):
        history.push(Signal(*[1e18] * 6))
        history.mean(0, 1)
    for k in range(SUMMED + 1):
        history.push(Signal(*[1.0 + k % 2 * 2.0] * 6))
    history.shorten(100)
    mean = history.mean(0, 100)
    assert mean == (2.0,) * 6
    assert history.variances(0, 100, mean) == (1.0, 1.0)
