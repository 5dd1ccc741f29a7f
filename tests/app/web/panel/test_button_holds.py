"""A hold that fell silent counts again after a real pointer-up, and not before (FD-23)."""

import pytest

from app.web.panel.button_holds import ButtonHolds
from pendant.events.event import Event, Kind
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


def silent(loop: FakeLoop, holds: ButtonHolds, *besides: Kind) -> list[Event]:
    """A hold, and the events of the tick in which it counts as released."""
    holds.hold(1)
    loop.advance(0.502)
    holds.silence()
    return [Event(Kind.HOLD_SILENT, loop.tick, {"value": 0.502, "limit": 0.5}), *(Event(kind, loop.tick) for kind in besides)]


@pytest.mark.parametrize("first", [True, False])
def test_a_pointer_up_after_the_last_word_makes_a_silence_a_release(loop: FakeLoop, holds: ButtonHolds, first: bool) -> None:
    """Whether the pointer-up is heard of before the silence is seen on the page, or after."""
    fresh = silent(loop, holds)
    if not first:
        assert holds.excused(fresh, loop.tick) is None
        loop.advance(1.5)
    holds.lift(1)
    assert holds.excused(fresh if first else [], loop.tick) == fresh[0]
    assert holds.excused([], loop.tick) is None


@pytest.mark.parametrize("kind", [Kind.ACTIVATION_CANCELLED, Kind.LEFT_RELEASE])
def test_a_silence_that_ends_something_stays(loop: FakeLoop, holds: ButtonHolds, kind: Kind) -> None:
    fresh = silent(loop, holds, kind)
    holds.lift(1)
    assert holds.excused(fresh, loop.tick) is None


def test_a_silence_that_lasts_stays(loop: FakeLoop, holds: ButtonHolds) -> None:
    fresh = silent(loop, holds)
    loop.advance(2.1)
    assert holds.excused(fresh, loop.tick) is None
    holds.lift(1)
    assert holds.excused([], loop.tick) is None


def test_a_pointer_up_of_before_excuses_nothing(loop: FakeLoop, holds: ButtonHolds) -> None:
    holds.lift(1)
    loop.advance(0.1)
    assert holds.excused(silent(loop, holds), loop.tick) is None
