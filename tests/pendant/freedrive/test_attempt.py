"""One attempt to start free-drive: what confirms it and when, to the tick (FD-7, FD-8)."""

from itertools import product

import pytest

from pendant.all_settings import Settings, apply
from pendant.freedrive.attempt import CONFIRMING, Attempt, Outcome, reserved
from pendant.signals.settings import ConfirmedBy
from pendant.signals.sources import NONE, Presence
from pendant.tick.modes import Phase
from tests.items import each_of

BUTTON = Presence("button")
PUSH = Presence("push", by_hand=True)
ABSENT, HOLD, WINDOW = 100, 100, 1500
"""0.2 s of absence make a signal a new one, 0.2 s of it confirm, 3 s there is time to [ticks]."""


def outcomes(feedback: float, *course: tuple[int, Presence]) -> tuple[Attempt, list[Outcome]]:
    """What follows an activation that has just been completed, of signals for so many ticks each."""
    settings = apply(Settings(), {"handshake.on": True, "handshake.feedback": feedback, "activation.period": 0.02})
    attempt = Attempt(BUTTON, settings)
    attempt.first()
    assert [attempt.step(BUTTON, False, False) for _ in range(10)] == [Outcome.GOES_ON] * 9 + [Outcome.CONFIRM]
    return attempt, [attempt.step(signal, False, False) for count, signal in course for _ in range(count)]


@pytest.mark.parametrize(("feedback", "held"), [(0.2, 0), (0.0, 0), (0.1, 50), (0.2, 1), (0.0, 700)])
@pytest.mark.parametrize(("absent", "new"), [(ABSENT, True), (ABSENT - 1, False), (ABSENT + 30, True)])
def test_a_confirmation_is_new_after_an_absence(feedback: float, held: int, absent: int, new: bool) -> None:
    """FD-8: counted from the first signal on, whether that goes on into the feedback or beyond it."""
    absent = max(absent, round(feedback * 500) - held)
    _, said = outcomes(feedback, (held, BUTTON), (absent, NONE), (HOLD, BUTTON), (1, BUTTON))
    assert set(said[:-1]) == {Outcome.GOES_ON}
    assert said[-1] is (Outcome.READY if new or absent >= ABSENT else Outcome.GOES_ON)


@pytest.mark.parametrize("feedback", [0.0, 0.2, 0.4])
@pytest.mark.parametrize(("off", "new"), [(ABSENT, True), (ABSENT - 1, False)])
def test_a_hand_confirms_after_it_was_off(feedback: float, off: int, new: bool) -> None:
    """FD-8: to the tick; it counts from the feedback on, as the signal's own absence does, and may end with it."""
    settings = apply(Settings(), {"handshake.on": True, "handshake.feedback": feedback, "activation.period": 0.02})
    attempt = Attempt(PUSH, settings)
    attempt.first()
    assert [attempt.step(PUSH, True, False) for _ in range(10)][-1] is Outcome.CONFIRM
    course = [(200 - off, NONE, True), (off, NONE, False), (HOLD, PUSH, True), (1, PUSH, True)]
    said = [attempt.step(signal, touched, False) for count, signal, touched in course for _ in range(count)]
    assert set(said[:-1]) == {Outcome.GOES_ON}
    assert said[-1] is (Outcome.LET_GO if new else Outcome.GOES_ON)


@pytest.mark.parametrize("signal", [BUTTON, PUSH])
@pytest.mark.parametrize("short", [1, 2, HOLD])
def test_one_that_was_too_short_leaves_the_next_to_be_new_too(short: int, signal: Presence) -> None:
    """FD-8."""
    attempt, said = outcomes(0.2, (100, NONE), (short, signal), (1, NONE), (3 * HOLD, signal))
    assert set(said) == {Outcome.GOES_ON}
    assert attempt.phase is Phase.CONFIRM


def test_the_time_to_confirm_ends_to_its_tick() -> None:
    """FD-8."""
    _, said = outcomes(0.2, (100, NONE), (WINDOW, NONE))
    assert said == [Outcome.GOES_ON] * (100 + WINDOW - 1) + [Outcome.UNCONFIRMED]


@pytest.mark.parametrize("within", [100, 101, 1000])
def test_the_time_to_let_go_ends_to_its_tick(within: int) -> None:
    """FD-8a: a hand that is off in the last tick, or before, is in time."""
    settings = apply(Settings(), {"activation.period": 0.0, "let_go.within": within / 500})
    for on in (0, 1, within - 2, within - 1, within):
        attempt = Attempt(PUSH, settings)
        assert (attempt.first(), attempt.phase, attempt.left, attempt.total) == (Outcome.LET_GO, Phase.LET_GO, within, within)
        said = [attempt.step(NONE, True, tick == on) for tick in range(min(on + 1, within))]
        assert said == [Outcome.GOES_ON] * (len(said) - 1) + [Outcome.READY if on < within else Outcome.STILL_HELD]


@pytest.mark.parametrize("course", [(PUSH, BUTTON), (BUTTON, PUSH), (PUSH, PUSH), (BUTTON, BUTTON)])
def test_a_hand_that_gave_any_of_the_signal_must_let_go(course: tuple[Presence, Presence]) -> None:
    """FD-8a."""
    attempt = Attempt(course[0], apply(Settings(), {"activation.period": 0.02}))
    assert attempt.first() is Outcome.GOES_ON
    said = [attempt.step(course[1], False, False) for _ in range(10)]
    assert said == [Outcome.GOES_ON] * 9 + [Outcome.LET_GO if PUSH in course else Outcome.READY]


@pytest.mark.parametrize("summed", [True, False])
def test_presences_are_summed_over_gaps_of_a_second(summed: bool) -> None:
    """FD-7: 1 s are 500 ticks, of each gap for itself."""
    settings = apply(Settings(), {"activation.period": 0.02, "activation.sum_presences": summed})
    gap = 500 if summed else 0
    attempt = Attempt(BUTTON, settings)
    assert attempt.first() is Outcome.GOES_ON
    for _ in range(3):
        assert [attempt.step(NONE, False, False) for _ in range(gap)] == [Outcome.GOES_ON] * gap
        assert [attempt.step(BUTTON, False, False) for _ in range(3)] == [Outcome.GOES_ON] * 3
        assert attempt.left == 7 or summed
        if not summed:
            break
    said = [attempt.step(NONE, False, False) for _ in range(gap + 1)]
    assert said == [Outcome.GOES_ON] * gap + [Outcome.CANCELLED]


@pytest.mark.parametrize("signal", [BUTTON, PUSH])
@pytest.mark.parametrize(("feedback", "new"), [(88, False), (89, False), (90, True), (91, True)])
def test_a_tap_is_over_with_its_tick(feedback: int, new: bool, signal: Presence) -> None:
    """FD-8: its absence counts through the activation period of 10 ticks, and is complete after 100."""
    names = {"handshake.on": True, "handshake.feedback": feedback / 500, "activation.period": 0.02, "let_go.on": False}
    attempt = Attempt(Presence("tap", by_hand=True, whole=True), apply(Settings(), names))
    attempt.first()
    course = [attempt.step(NONE, False, False) for _ in range(10 + feedback)]
    assert [outcome for outcome in course if outcome is not Outcome.GOES_ON] == [Outcome.CONFIRM]
    assert attempt.phase is Phase.CONFIRM
    said = [attempt.step(signal, False, False) for _ in range(HOLD + 1)]
    assert said == [Outcome.GOES_ON] * HOLD + [Outcome.READY if new else Outcome.GOES_ON]


ALL = sorted(set().union(*CONFIRMING.values()))


@each_of(product(ConfirmedBy, ["button", "push", "force step"], [*ALL, "digital input", "tap"]))
def test_what_is_chosen_confirms(by: ConfirmedBy, first: str, second: str) -> None:
    """FD-8: any that can, another than the first, or one kind; a confirmation by hand is let go of."""
    chosen = {
        "any": set(ALL),
        "other": set(ALL) - {first},
        "button": {"button", "presses in a row"},
        "push": {"push"},
        "twist": {"twist"},
        "joints": {"push felt by joints"},
        "pattern": {"pushes in a row"},
        "turn": {"turned joint"},
        "posture": {"posture", "series of postures"},
    }[by]
    settings = apply(Settings(), {"handshake.on": True, "activation.period": 0.0, "handshake.by": by.value})
    attempt = Attempt(Presence(first), settings)
    assert attempt.first() is Outcome.CONFIRM
    course = [(250, NONE), (HOLD, Presence(second)), (1, Presence(second))]
    said = [attempt.step(signal, False, False) for count, signal in course for _ in range(count)]
    assert said[:-1] == [Outcome.GOES_ON] * (250 + HOLD)
    assert (said[-1] is Outcome.READY) is (second in chosen)


@pytest.mark.parametrize("by", ConfirmedBy)
@pytest.mark.parametrize("on", [True, False])
def test_what_is_chosen_to_confirm_does_not_begin(by: ConfirmedBy, on: bool) -> None:
    """FD-8."""
    settings = apply(Settings(), {"handshake.on": on, "handshake.by": by.value})
    kept = {source for source in [*ALL, "digital input"] if reserved(Presence(source), settings)}
    assert kept == (CONFIRMING[by] if on and by in CONFIRMING else set())


@pytest.mark.parametrize(("delay", "count"), [(0.0, 0), (0.002, 1), (0.5, 250), (5.0, 2500)])
def test_the_robot_asks_after_a_delay(delay: float, count: int) -> None:
    """FD-8: what comes meanwhile does not count, to the tick; then the feedback of 0.5 s begins."""
    names = {"handshake.on": True, "handshake.delay": delay, "activation.period": 0.02}
    attempt = Attempt(BUTTON, apply(Settings(), names))
    attempt.first()
    said = [attempt.step(BUTTON, False, False) for _ in range(10)]
    assert said == [Outcome.GOES_ON] * 9 + [Outcome.GOES_ON if count else Outcome.CONFIRM]
    assert attempt.phase is (Phase.DELAY if count else Phase.FEEDBACK)
    assert (attempt.left, attempt.total) == ((count, count) if count else (250, 250))
    said = [attempt.step(BUTTON, False, False) for _ in range(count)]
    assert said == [Outcome.GOES_ON] * (count - 1) + [Outcome.CONFIRM] * (count > 0)
    assert (attempt.phase, attempt.left, attempt.total) == (Phase.FEEDBACK, 250, 250)
