"""Held controls (FD-23)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.signals.keep_alive import KeepAlive

SILENCE = 250


def test_it_is_not_held_before_its_first_refresh() -> None:
    keep = KeepAlive()
    assert [keep.step(False, False, SILENCE) for _ in range(600)] == [False] * 600
    assert not keep.held


@pytest.mark.parametrize("gap", [0, 1, 2, 148, 150, SILENCE - 1, SILENCE])
def test_a_stutter_does_not_drop_it(gap: int) -> None:
    keep = KeepAlive()
    for _ in range(5):
        assert not keep.step(True, False, SILENCE)
        for _ in range(gap):
            assert not keep.step(False, False, SILENCE)
            assert keep.held


def test_a_longer_silence_drops_it_once() -> None:
    keep = KeepAlive()
    keep.step(True, False, SILENCE)
    dropped = []
    for tick in range(1, 800):
        ended = keep.step(False, False, SILENCE)
        assert keep.held == (tick <= SILENCE)
        dropped += [tick] if ended else []
    assert dropped == [SILENCE + 1]


def test_letting_go_acts_at_once_and_wins() -> None:
    keep = KeepAlive()
    keep.step(True, False, SILENCE)
    assert not keep.step(True, True, SILENCE)
    assert not keep.held
    assert not keep.step(False, True, SILENCE)
    assert not keep.held
    keep.step(True, False, SILENCE)
    assert keep.held


@given(
    stream=st.lists(st.tuples(st.booleans(), st.booleans()), max_size=200),
    silence=st.integers(0, 20),
)
def test_held_means_refreshed_lately_and_not_let_go_since(stream: list[tuple[bool, bool]], silence: int) -> None:
    keep = KeepAlive()
    for tick, (refreshed, released) in enumerate(stream):
        keep.step(refreshed, released, silence)
        past = stream[max(0, tick - silence) : tick + 1]
        expected = any(past[at][0] and not any(later[1] for later in past[at:]) for at in range(len(past)))
        assert keep.held == expected
