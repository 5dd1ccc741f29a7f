"""Haptic patterns: each ends where it began, within its bounds, at its moment, and is taken for nobody's hand (HF-1, HF-2)."""

import itertools
import math

import pytest

from pendant.events.event import Event, Kind
from pendant.haptics import (
    ABOUT_TO_END,
    CONTACTS,
    CYCLE,
    GAP,
    RHYTHMS,
    SETTLING,
    WANDER,
    Haptics,
    HapticUse,
    Moment,
    Pattern,
    length,
    offset,
)
from pendant.inputs import Command, Inputs
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK, Law, Mode, Phase
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench
from tests.pendant.program.test_contact_programs import GAINED, Told

ON = HapticUse(on=True)
REST = Moment(Mode.TEACH, Law.HOLD, Phase.OFF, [], False, -1, 250)
FREE = Moment(Mode.FREE_DRIVE, Law.FREE, Phase.PERIOD, [], False, -1, 250)


def event(kind: Kind) -> list[Event]:
    return [Event(kind, 0)]


def played(haptics: Haptics, moment: Moment, use: HapticUse = ON) -> Pattern | None:
    haptics.step(moment, use)
    return None if haptics.shake is None else haptics.shake.pattern


@pytest.mark.parametrize("pattern", Pattern)
def test_a_pattern_ends_where_it_began_and_stays_within_bounds(pattern: Pattern) -> None:
    whole = length(pattern)
    values = [offset(pattern, tick) for tick in range(-2, whole + 3)]
    assert values[:3] == [0.0] * 3
    assert abs(values[-3]) < 0.01
    assert values[-2:] == [0.0] * 2
    assert max(map(abs, values)) < 2.5
    speeds = [(after - before) / TICK for before, after in itertools.pairwise(values)]
    assert max(map(abs, speeds)) < 110.0  # of the amplitude: less than 1 rad/s at the largest
    assert max(map(abs, speeds)) > 50.0
    assert max(abs(speeds[0]), abs(speeds[-1])) < 10.0


@pytest.mark.parametrize("pattern", [pattern for pattern in Pattern if max(RHYTHMS[pattern]) > 3])
def test_a_long_one_does_not_turn_at_the_same_places(pattern: Pattern) -> None:
    """HF-2: the centre wanders out and back."""
    values = [offset(pattern, tick) for tick in range(length(pattern) + 1)]
    turns = [b for a, b, c in zip(values, values[1:], values[2:], strict=False) if (b - a) * (c - b) < 0.0]
    assert len(turns) >= 2 * sum(RHYTHMS[pattern]) - 1
    for same_side in (turns[::2], turns[1::2]):
        assert all(abs(a - b) > 0.04 for a, b in itertools.pairwise(same_side))


@pytest.mark.parametrize("pattern", Pattern)
def test_a_burst_swells_and_fades_about_the_centre_that_wanders(pattern: Pattern) -> None:
    """HF-2: each begins to the positive side, is at the centre after every half cycle, and the same backwards, turned over."""
    begin = 0.0
    assert offset(pattern, 0.5) > 0.0

    def beside(tick: float) -> float:
        return offset(pattern, tick) - WANDER * (1.0 - math.cos(2.0 * math.pi * tick / length(pattern))) / 2.0

    for cycles in RHYTHMS[pattern]:
        assert begin == 0.0 or beside(begin - GAP / 2.0) == pytest.approx(0.0)
        assert [beside(begin + half * CYCLE / 2.0) for half in range(2 * cycles + 1)] == pytest.approx([0.0] * (2 * cycles + 1))
        assert beside(begin + CYCLE / 4.0) == pytest.approx(math.sin(math.pi / (4.0 * cycles)) ** 2)
        middle = begin + cycles * CYCLE / 2.0
        peak = math.cos(math.pi / (4.0 * cycles)) ** 2
        assert abs(beside(middle + CYCLE / 4.0)) == pytest.approx(peak)
        for away in (0.1, 0.3, 0.45):
            assert beside(middle - away * cycles * CYCLE) == pytest.approx(-beside(middle + away * cycles * CYCLE))
        begin += cycles * CYCLE + GAP


def test_patterns_are_distinct() -> None:
    assert len(set(RHYTHMS.values())) == len(Pattern)
    assert set(RHYTHMS) == set(Pattern)


@pytest.mark.parametrize(
    ("pattern", "moment"),
    [
        (Pattern.ENTERED, FREE._replace(events=event(Kind.ENTERED))),
        (Pattern.CONFIRMATION, REST._replace(events=event(Kind.CONFIRM_ASKED), phase=Phase.FEEDBACK)),
        (Pattern.BORDER, FREE._replace(near=True)),
        (Pattern.ENDING, FREE._replace(left=ABOUT_TO_END)),
        *[(Pattern.CONTACT, REST._replace(events=event(kind))) for kind in sorted(CONTACTS)],
    ],
)
def test_each_is_felt_at_its_moment_for_its_length_and_can_be_switched_off(pattern: Pattern, moment: Moment) -> None:
    haptics = Haptics()
    played(haptics, moment._replace(events=[], near=False, left=-1))
    assert played(haptics, moment) is pattern
    after = moment._replace(events=[], left=-1)
    run = [(played(haptics, after), haptics.busy) for _ in range(length(pattern) + SETTLING)]
    assert run == [(pattern, True)] * length(pattern) + [(None, True)] * (SETTLING - 1) + [(None, False)]
    off = HapticUse(on=True, **{pattern.value: False})
    haptics = Haptics()
    played(haptics, moment._replace(events=[], near=False, left=-1))
    assert played(haptics, moment, off) is None


def test_leaving_is_felt_after_it() -> None:
    haptics = Haptics()
    assert played(haptics, FREE) is None
    left = REST._replace(law=Law.BRAKE, events=event(Kind.LEFT_PERIOD))
    assert played(haptics, left, HapticUse(on=True, left=False)) is None
    assert played(haptics, FREE) is None
    assert played(haptics, left) is Pattern.LEFT
    assert played(haptics, REST) is Pattern.LEFT
    assert haptics.busy


def test_before_the_first_tick_nothing_shakes_and_a_border_that_is_near_in_it_is_felt() -> None:
    haptics = Haptics()
    assert (haptics.busy, haptics.shake) == (False, None)
    assert played(haptics, FREE._replace(near=True)) is Pattern.BORDER


def test_what_plays_is_not_interrupted_by_another() -> None:
    haptics = Haptics()
    played(haptics, FREE)
    assert played(haptics, FREE._replace(near=True)) is Pattern.BORDER
    assert played(haptics, FREE._replace(near=True, left=ABOUT_TO_END)) is Pattern.BORDER


@pytest.mark.parametrize(
    "ends",
    [
        REST._replace(law=Law.HOLD, mode=Mode.FREE_DRIVE, phase=Phase.GUIDED),  # a wall holds the arm
        FREE._replace(phase=Phase.SEQUENCE, mode=Mode.TEACH),
        REST._replace(law=Law.FOLLOW, mode=Mode.RUN),
        REST._replace(law=Law.OFF, mode=Mode.STOP),
        REST._replace(law=Law.BRAKE, mode=Mode.STOP),
    ],
)
def test_another_law_ends_it(ends: Moment) -> None:
    haptics = Haptics()
    played(haptics, FREE)
    assert played(haptics, FREE._replace(near=True)) is Pattern.BORDER
    assert played(haptics, ends, HapticUse(on=True, left=False)) is None


@pytest.mark.parametrize(("law", "mode", "phase"), [(Law.FOLLOW, Mode.RUN, Phase.OFF), (Law.FREE, Mode.TEACH, Phase.SEQUENCE)])
def test_nothing_begins_where_it_would_disturb_the_law(law: Law, mode: Mode, phase: Phase) -> None:
    """HF-2, FD-9."""
    moment = Moment(mode, law, phase, event(Kind.CONTACT_GAINED), False, -1, 250)
    assert played(Haptics(), moment) is None
    assert played(Haptics(), moment._replace(law=Law.HOLD, mode=Mode.TEACH)) is Pattern.CONTACT


def test_switched_off_it_ends() -> None:
    haptics = Haptics()
    played(haptics, FREE)
    played(haptics, FREE._replace(near=True))
    assert played(haptics, FREE, HapticUse()) is None
    assert haptics.busy


@pytest.mark.parametrize(("feedback", "asked"), [(0.0, None), (0.46, None), (0.5, Pattern.CONFIRMATION)])
def test_who_is_asked_is_not_shaken_while_the_answer_counts(feedback: float, asked: Pattern | None) -> None:
    haptics = Haptics()
    moment = REST._replace(events=event(Kind.CONFIRM_ASKED), feedback=ticks(feedback))
    assert played(haptics, moment) is asked
    needed = length(Pattern.CONFIRMATION) + SETTLING
    assert played(Haptics(), moment._replace(feedback=needed)) is Pattern.CONFIRMATION
    assert played(Haptics(), moment._replace(feedback=needed - 1)) is None


def test_speed_and_acceleration_belong_to_the_angle() -> None:
    haptics = Haptics()
    shakes = []
    for tick in range(40):
        haptics.step(REST._replace(events=event(Kind.CONTACT_GAINED) if tick == 0 else []), ON)
        assert haptics.shake is not None
        shakes.append(haptics.shake)
    for before, now, after in zip(shakes, shakes[1:], shakes[2:], strict=False):
        assert now.speed == pytest.approx((after.angle - before.angle) / (2.0 * TICK))
        assert now.acceleration == pytest.approx((after.angle - 2.0 * now.angle + before.angle) / TICK**2)


def test_a_shaken_arm_is_moved_by_nobody() -> None:
    """FD-13, FD-19: what the patterns move is not counted; afterwards it is."""
    bench = Bench(haptics__on=True).in_period()
    assert bench.last.shake is not None
    fast = estimate(qd=0.2, speed=0.2)
    bench.run(length(Pattern.ENTERED), value=fast)
    assert bench.last.phase is Phase.PERIOD
    bench.run(SETTLING)
    assert bench.last.shake is None
    assert bench.events == []
    bench.step(value=fast)
    assert [each.kind for each in bench.events] == [Kind.MANIPULATION]


def test_who_leaves_feels_it_and_the_arm_is_held_in_the_end() -> None:
    bench = Bench(haptics__on=True, contact__on=True, signals__push__on=True, activation__period=0.02, let_go__on=False)
    bench.in_period()
    bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)))
    assert bench.last.shake is not None
    assert bench.last.shake.pattern is Pattern.LEFT
    bench.run(1000)
    assert bench.last.shake is None
    assert bench.last.law is Law.HOLD


def test_walls_and_endings_are_felt() -> None:
    bench = Bench(haptics__on=True, free_drive__period=2.0, free_drive__remainders=False).in_period()
    felt = set()
    for _ in range(1000):
        bench.step()
        if bench.last.shake is not None:
            felt.add((bench.last.shake.pattern, bench.last.mode))
    assert (Pattern.ENDING, Mode.FREE_DRIVE) in felt
    assert (Pattern.LEFT, Mode.TEACH) in felt


def test_off_nothing_is_felt() -> None:
    bench = Bench()
    bench.run(60)
    for inputs in [HOLD] * 600 + [LET_GO] * 10:
        assert bench.step(inputs).shake is None


def test_a_wall_that_comes_close_is_felt_once_and_only_in_free_drive() -> None:
    """HF-1: the tether's band begins 5 mm before its 30 mm."""
    bench = Bench(haptics__on=True, unexplained__motion=False)
    bench.run(60)
    assert bench.last.shake is None
    bench.in_period()
    bench.run(length(Pattern.ENTERED) + SETTLING)
    assert bench.last.shake is None
    decision = bench.step(value=estimate(position=0.027))
    assert decision.shake is not None
    assert decision.shake.pattern is Pattern.BORDER


def test_a_confirmation_that_is_asked_for_is_felt() -> None:
    """HF-1, FD-8."""
    bench = Bench(haptics__on=True, handshake__on=True)
    bench.run(60)
    bench.run(501, HOLD)
    assert Kind.CONFIRM_ASKED in [each.kind for each in bench.events]
    assert bench.last.shake is not None
    assert bench.last.shake.pattern is Pattern.CONFIRMATION


def test_the_sequence_is_not_disturbed() -> None:
    """FD-9, HF-2: in it a contact is told and not felt."""
    bench, told = Bench(haptics__on=True, sequence__on=True, activation__period=0.2), Told()
    bench.supervisor._monitor = told
    bench.run(60)
    bench.run(101, HOLD)
    assert bench.step(LET_GO).phase is Phase.SEQUENCE
    told.coming = iter((GAINED,))
    assert bench.step().contacts == (GAINED,)
    assert bench.last.shake is None
