from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.session.expectation_watch import Verdict, Watch
from app.session.expectations import (
    AnyExpectation,
    ContactDelay,
    Displacement,
    Happens,
    Heard,
    Never,
    NumberRange,
    Period,
    Reaches,
    State,
    Value,
)
from app.session.measures import watch
from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.freedrive.periods import Remaining
from pendant.tick.modes import Mode, Phase, Safety
from sim.exchange.snapshot import Snapshot
from tests.app.fakes import JOINTS, decision, happened, snapshot

SECOND = 500


def follow(
    expectation: AnyExpectation,
    ticks: int,
    decide: Callable[[int], Decision] = lambda tick: decision(),
    picture: Callable[[int], Snapshot] = snapshot,
) -> Verdict:
    watched = watch(expectation, JOINTS)
    for tick in range(1, ticks + 1):
        watched.see(tick, decide(tick), lambda tick=tick: picture(tick))
    return watched.verdict()


def enters_at(entry: int) -> Callable[[int], Decision]:
    return lambda tick: decision(Mode.FREE_DRIVE if tick >= entry else Mode.TEACH, Phase.HELD if tick >= entry else Phase.OFF)


@pytest.mark.parametrize(("entry", "passed"), [(SECOND, True), (SECOND + 1, False)])
def test_a_deadline_is_met_to_the_tick(entry: int, passed: bool) -> None:
    verdict = follow(State(mode=Mode.FREE_DRIVE, by=1.0), 2 * SECOND, enters_at(entry))
    assert verdict.passed == passed
    assert verdict.expected == "mode FREE_DRIVE by 1 s"
    assert verdict.seen == ("reached at 1.000 s" if passed else "mode TEACH, phase OFF, safety NORMAL at 1.000 s")


@pytest.mark.parametrize(("entry", "passed"), [(SECOND, True), (SECOND + 1, False)])
def test_a_state_at_a_time_is_that_of_its_tick(entry: int, passed: bool) -> None:
    assert follow(State(phase=Phase.HELD, at=1.0), 2 * SECOND, enters_at(entry)).passed == passed


def test_a_state_at_the_start_is_that_of_the_first_tick() -> None:
    assert follow(State(mode=Mode.TEACH, at=0.0), 5).passed
    assert not follow(State(mode=Mode.NORMAL, at=0.0), 5).passed


def test_a_state_all_the_time_tells_the_first_break() -> None:
    verdict = follow(State(mode=Mode.TEACH, begin=0.5, end=1.5), 2 * SECOND, enters_at(600))
    assert not verdict.passed
    assert verdict.seen == "mode FREE_DRIVE, phase HELD, safety NORMAL at 1.200 s"


def test_the_safety_mode_counts_too() -> None:
    stopped = decision(Mode.STOP, safety=Safety.EMERGENCY_STOP)
    assert follow(State(mode=Mode.STOP, safety="EMERGENCY_STOP", at=0.01), 9, lambda tick: stopped).passed
    assert not follow(State(mode=Mode.STOP, safety="PROTECTIVE_STOP", at=0.01), 9, lambda tick: stopped).passed


@pytest.mark.parametrize(("reset", "passed"), [(100, True), (101, False)])
def test_times_count_from_the_trigger(reset: int, passed: bool) -> None:
    def decide(tick: int) -> Decision:
        return happened(Kind.RESET, tick) if tick == reset else decision(Mode.TEACH if tick == 150 else Mode.STOP)

    assert follow(State(mode=Mode.TEACH, after="event reset", at=0.1), 200, decide).passed == passed


def test_a_trigger_that_never_comes_fails_even_what_forbids() -> None:
    verdict = follow(Never(kind=Kind.RESET, after="mode RUN"), 10)
    assert not verdict.passed
    assert verdict.seen == '"mode RUN" never came (time 1)'


def test_the_nth_time_is_told_from_the_first() -> None:
    decide = lambda tick: decision(Mode.RUN if tick in (10, 20, 21, 30) else Mode.TEACH)
    assert follow(State(mode=Mode.RUN, after="mode RUN", nth=2, begin=0.0, end=0.002), 40, decide).passed
    assert not follow(State(mode=Mode.RUN, after="mode RUN", nth=3, begin=0.0, end=0.002), 40, decide).passed


def test_a_session_that_ends_too_soon_fails() -> None:
    verdict = follow(Value(of="user_force", begin=0.0, end=1.0, max=1.0), 499)
    assert not verdict.passed
    assert verdict.seen == "the session ended at 0.998 s, before the interval did"
    assert not verdict.looked


@pytest.mark.parametrize(("at", "passed"), [(499, False), (500, True), (1000, True), (1001, False)])
def test_an_event_must_be_in_its_interval(at: int, passed: bool) -> None:
    decide = lambda tick: happened(Kind.ENTERED, tick) if tick == at else decision()
    assert follow(Happens(kind=Kind.ENTERED, begin=1.0, end=2.0), 1500, decide).passed == passed
    assert follow(Never(kind=Kind.ENTERED, begin=1.0, end=2.0), 1500, decide).passed == (not passed)
    assert not follow(Happens(kind=Kind.RESET, begin=1.0, end=2.0), 1500, decide).passed


def test_events_are_told_apart_by_their_words() -> None:
    decide = lambda tick: happened(Kind.SIGNAL_SEEN, tick, source="push", period=1.0) if tick == 3 else decision()
    assert follow(Happens(kind=Kind.SIGNAL_SEEN, values={"source": "push"}), 10, decide).passed
    assert follow(Never(kind=Kind.SIGNAL_SEEN, values={"source": "twist"}), 10, decide).passed
    verdict = follow(Happens(kind=Kind.SIGNAL_SEEN, values={"source": "twist"}), 10, decide)
    assert not verdict.passed
    assert verdict.expected.startswith("event signal_seen (source twist) from")


def test_a_tone_is_heard_at_the_change_that_has_it() -> None:
    def decide(tick: int) -> Decision:
        return decision(periods=(Remaining("restart", 1600 - tick, 2000),) if tick < 1600 else ())

    verdict = follow(Heard(tone="COUNT", times=3), 1700, decide)
    assert verdict.passed
    assert verdict.expected == "tone COUNT 3 times from 0.000 s to the end"
    assert verdict.seen == "3, at 0.200 s, 1.200 s, 2.200 s"
    assert not follow(Heard(tone="COUNT", times=4), 1700, decide).passed
    exactly = follow(Heard(tone="COUNT", times=3, exactly=True), 1700, decide)
    assert exactly.passed
    assert exactly.expected == "tone COUNT exactly 3 times from 0.000 s to the end"
    assert not follow(Heard(tone="COUNT", times=2, exactly=True), 1700, decide).passed
    assert follow(Heard(tone="COUNT", begin=2.0, end=2.4), 1700, decide).passed
    assert not follow(Heard(tone="COUNT", begin=2.3, end=2.4), 1700, decide).passed
    assert follow(Heard(tone="FREE"), 10, enters_at(5)).seen == "1, at 0.010 s"
    assert follow(Heard(tone="HELD"), 10, enters_at(5)).seen == "none"


def test_events_are_counted() -> None:
    decide = lambda tick: happened(Kind.NOT_YET, tick) if tick in (3, 7) else decision()
    assert follow(Happens(kind=Kind.NOT_YET, times=2), 10, decide).passed
    verdict = follow(Happens(kind=Kind.NOT_YET, times=3), 10, decide)
    assert (verdict.passed, verdict.seen) == (False, "2, at 0.006 s, 0.014 s")


def moving(tick: int) -> Snapshot:
    """The flange goes 1 mm a tick along x from tick 100 to tick 200, and half of it back until tick 250."""
    x = min(max(0, tick - 100), 100) - min(max(0, tick - 200), 50)
    return snapshot(tick, (0.001 * x, 0.0, 0.0))


def test_displacement_is_the_largest_from_the_place_at_the_begin() -> None:
    verdict = follow(Displacement(begin=0.1, end=0.6, max=0.05), 400, picture=moving)
    assert (verdict.passed, verdict.seen) == (False, "0.1 m at 0.400 s")
    assert follow(Displacement(begin=0.1, end=0.6, min=0.0999, max=0.1001), 400, picture=moving).passed
    assert not follow(Displacement(begin=0.1, end=0.6, min=0.11), 400, picture=moving).passed
    assert follow(Displacement(begin=0.4, end=0.6, max=0.0501), 400, picture=moving).passed


def test_displacement_may_be_what_is_left() -> None:
    assert follow(Displacement(begin=0.1, end=0.6, measure="final", min=0.0499, max=0.0501), 400, picture=moving).passed
    assert not follow(Displacement(begin=0.1, end=0.4, measure="final", max=0.0501), 400, picture=moving).passed


def test_displacement_along_a_direction_has_a_sign() -> None:
    assert follow(Displacement(end=0.4, along=[2.0, 0.0, 0.0], min=0.0999), 200, picture=moving).passed
    assert not follow(Displacement(end=0.4, along=[-1.0, 0.0, 0.0], min=0.0999), 200, picture=moving).passed
    assert not follow(Displacement(end=0.4, along=[0.0, 1.0, 0.0], min=0.0999), 200, picture=moving).passed


def test_the_flange_speed_is_that_of_its_place() -> None:
    assert follow(Value(of="flange_speed", begin=0.25, end=0.35, min=0.4999, max=0.5001), 400, picture=moving).passed
    verdict = follow(Value(of="flange_speed", max=0.4), 400, picture=moving)
    assert not verdict.passed
    assert verdict.seen.startswith("0.5 m/s at 0.")


def test_a_value_that_is_no_number_is_out_of_bounds() -> None:
    broken = lambda tick: snapshot(tick, F_user=np.full(6, np.nan if tick == 5 else 1.0))
    assert not follow(Value(of="user_force", max=10.0), 10, picture=broken).passed
    assert not follow(Value(of="user_force", min=0.0), 10, picture=broken).passed


def picture_at(speed: float) -> Callable[[int], Snapshot]:
    return lambda tick: snapshot(tick, v_tcp=speed * tick)


@pytest.mark.parametrize(
    ("bounds", "passed", "seen"),
    [
        ({"min": 0.3}, True, "reached at 0.006 s"),
        ({"max": 0.2}, True, "reached at 0.002 s"),
        ({"min": 0.2, "max": 0.2}, True, "reached at 0.004 s"),
        ({"min": 0.35, "max": 0.38}, False, "0.1 to 0.5 m/s"),
        ({"min": 0.6}, False, "0.1 to 0.5 m/s"),
    ],
)
def test_a_value_is_reached_once(bounds: dict[str, float], passed: bool, seen: str) -> None:
    verdict = follow(Reaches(of="tcp_speed", **bounds), 5, picture=picture_at(0.1))
    assert (verdict.passed, verdict.seen) == (passed, seen)
    assert verdict.expected.startswith("tcp speed at some time at ")


@pytest.mark.parametrize(
    ("value", "number"),
    [
        (Value(of="user_force", max=0.0), 5.0),
        (Value(of="user_torque", max=0.0), 13.0),
        (Value(of="joint_angle", joint="elbow", max=0.0), 0.3),
        (Value(of="joint_speed", joint="wrist_3", max=0.0), 0.6),
        (Value(of="tcp_speed", max=0.0), 0.7),
        (Value(of="elbow_speed", max=0.0), 0.8),
        (Value(of="payload_true", max=0.0), 2.5),
    ],
)
def test_each_quantity_is_read_where_it_stands(value: Value, number: float) -> None:
    row = np.arange(1, 7) / 10
    wrench = np.array([3.0, 0.0, -4.0, 0.0, 5.0, 12.0])
    seen = follow(value, 3, picture=lambda tick: snapshot(tick, q=row, qd=row, F_user=wrench, v_tcp=0.7, v_elbow=0.8)).seen
    assert float(seen.split()[0]) == pytest.approx(number)


def counting(first: int, total: int, again: int = 0) -> Callable[[int], Decision]:
    """A period that runs from `first` for `total` ticks; begun afresh at `again`."""

    def decide(tick: int) -> Decision:
        start = again if again and tick >= again else first
        left = start + total - tick
        return decision(periods=(Remaining("restart", left, total),) if tick >= start and left > 0 else ())

    return decide


def test_a_period_is_measured() -> None:
    assert follow(Period(name="restart", length=1.0, tolerance=0.0), 700, counting(100, 500)).passed
    verdict = follow(Period(name="restart", length=1.1, tolerance=0.05), 700, counting(100, 500))
    assert (verdict.passed, verdict.seen) == (False, "1.000 s, from 0.200 s")
    assert not follow(Period(name="free-drive", length=1.0), 700, counting(100, 500)).passed
    assert follow(Period(name="restart", length=1.0), 550, counting(100, 500)).seen == "0 ended runs"


def test_a_period_begun_afresh_is_another_run() -> None:
    decide = counting(100, 500, again=300)
    assert follow(Period(name="restart", length=0.4, tolerance=0.0, run=1), 900, decide).passed
    assert follow(Period(name="restart", length=1.0, tolerance=0.0, run=2), 900, decide).passed


@pytest.mark.parametrize("end", [0.2, None])
def test_a_final_displacement_looks_at_two_ticks_alone(end: float | None) -> None:
    looked: list[int] = []

    def picture(tick: int) -> Snapshot:
        looked.append(tick)
        return snapshot(tick, (0.001 * tick, 0.0, 0.0))

    watched = watch(Displacement(begin=0.1, end=end, part="flange", measure="final", max=1.0), JOINTS)
    for tick in range(1, 151):
        if watched.needs(tick, quiet=True) or tick == 150:
            watched.see(tick, decision(), lambda tick=tick: picture(tick))
    assert looked == [50, 100 if end else 150]
    assert watched.verdict().seen == f"{0.001 * (looked[1] - 50):.6g} m at {0.002 * looked[1]:.3f} s"


def shown(watched: Watch, quiet: bool) -> list[int]:
    """The ticks that it needs to see, of forty; mode RUN from the third on."""
    needed: list[int] = []
    for tick in range(1, 40):
        if watched.needs(tick, quiet):
            needed.append(tick)
            watched.see(tick, decision(Mode.RUN if tick >= 3 else Mode.TEACH), lambda: snapshot(1))
    return needed


def test_a_watch_says_which_ticks_it_needs() -> None:
    assert shown(watch(State(mode=Mode.RUN, after="mode RUN", begin=0.02, end=0.04), JOINTS), quiet=True) == [
        1, 2, 3, *range(13, 24)
    ]  # fmt: skip


@pytest.mark.parametrize(("quiet", "needed"), [(True, [1, 2, 3]), (False, [1, 2, 3, *range(13, 24)])])
def test_what_waits_for_an_event_needs_no_tick_without_one(quiet: bool, needed: list[int]) -> None:
    assert shown(watch(Never(kind=Kind.RESET, after="mode RUN", begin=0.02, end=0.04), JOINTS), quiet) == needed


def far_at_the_end(tick: int) -> Snapshot:
    """The flange goes 1 mm a tick along x until tick 51; the tool's speed rises by 0.1 m/s a tick until tick 30."""
    return snapshot(tick, (0.001 * min(tick - 1, 50), 0.0, 0.0), v_tcp=0.1 * min(tick, 30))


def touched(tick: int) -> Decision:
    return happened(Kind.CONTACT_GAINED, tick, ratio=-0.6) if tick == 3 else decision()


@pytest.mark.parametrize(
    ("expectation", "decide", "margin"),
    [
        (Displacement(max=0.05, end=0.11), None, 0.0),
        (Displacement(max=0.1, end=0.11), None, 0.5),
        (Displacement(min=0.04, max=0.2, end=0.11), None, 0.25),
        (Displacement(max=0.04, end=0.11), None, -0.25),
        (Displacement(min=0.0, end=0.11), None, None),  # of zero there is no share
        (Displacement(min=0.05, max=0.05, end=0.11), None, None),  # an exact number is met, or not
        (Reaches(of="tcp_speed", min=3.0, max=3.0, end=0.11), None, None),
        (Value(of="tcp_speed", max=4.0, end=0.11), None, 0.25),
        (Reaches(of="tcp_speed", min=2.0, end=0.11), None, 0.5),
        (State(mode=Mode.FREE_DRIVE, by=0.2), enters_at(50), 0.5),
        (State(mode=Mode.FREE_DRIVE, by=0.08), enters_at(50), None),
        (State(mode=Mode.TEACH, at=0.02), None, None),
        (Happens(kind=Kind.CONTACT_GAINED, numbers={"ratio": NumberRange(max=-0.5)}), touched, 0.2),
        (Never(kind=Kind.CONTACT_GAINED, numbers={"ratio": NumberRange(min=0.0)}, end=0.11), touched, None),
    ],
)
def test_a_verdict_says_how_far_it_is_from_its_bound(
    expectation: AnyExpectation, decide: Callable[[int], Decision] | None, margin: float | None
) -> None:
    verdict = follow(expectation, 60, decide or (lambda tick: decision()), far_at_the_end)
    assert verdict.margin == (None if margin is None else pytest.approx(margin, abs=1e-9))


def test_a_delay_is_that_of_the_first_event_whatever_touches_later() -> None:
    decide = lambda tick: happened(Kind.CONTACT_GAINED, tick) if tick in (12, 43) else decision()
    picture = lambda tick: replace(snapshot(tick), truth_touched=10 <= tick < 20 or tick >= 40)
    verdict = follow(ContactDelay(max=0.01), 60, decide, picture)
    assert (verdict.passed, verdict.seen) == (True, "0.004 s after 0.020 s")
    assert verdict.margin == pytest.approx(0.6)
