"""A hold that fell silent counts again after a real pointer-up, and not before (FD-23)."""

import pytest

from app.web.panel.button_holds import ButtonHolds
from pendant.inputs import Button
from tests.app.web.fake_loop import FakeLoop


@pytest.fixture
def holds(loop: FakeLoop) -> ButtonHolds:
    return ButtonHolds(loop)


def held(loop: FakeLoop) -> bool:
    """Whether the desk has heard of a held button since the last tick."""
    loop.advance()
    return Button.FREE_DRIVE in loop.wishes[-1].inputs.held


def test_a_silent_hold_does_not_count_until_the_pointer_is_lifted(loop: FakeLoop, holds: ButtonHolds) -> None:
    holds.hold(1)
    assert held(loop)
    loop.advance(loop.settings.hold.silence + 0.1)
    holds.hold(1)
    assert not held(loop)
    holds.lift(1)
    loop.advance()
    assert Button.FREE_DRIVE not in loop.wishes[-1].inputs.released  # the pendant has released it long ago
    holds.hold(1)
    assert held(loop)


def test_a_hold_without_silence_goes_on(loop: FakeLoop, holds: ButtonHolds) -> None:
    for _ in range(5):
        holds.hold(1)
        assert held(loop)
        loop.advance(0.5 * loop.settings.hold.silence)


def test_the_pendants_word_of_silence_ends_every_hold(loop: FakeLoop, holds: ButtonHolds) -> None:
    holds.hold(1)
    holds.silence()
    loop.advance()
    holds.hold(1)
    assert not held(loop)


def test_who_has_let_go_by_a_stall_has_to_lift_too(loop: FakeLoop, holds: ButtonHolds) -> None:
    holds.hold(1)
    loop.advance()
    holds.let_go(1)
    loop.advance()
    assert Button.FREE_DRIVE in loop.wishes[-1].inputs.released
    holds.hold(1)
    assert not held(loop)
    holds.forget(1)
    holds.hold(1)
    assert held(loop)
