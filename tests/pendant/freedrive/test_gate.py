"""The gate before free-drive: cool-down, and a signal that has to be a new one, to the tick."""

from dataclasses import replace

import pytest

from pendant.events.event import Event, Kind
from pendant.freedrive.gate import Gate
from pendant.inputs import Command
from pendant.signals.sources import BUTTON, DIGITAL, NONE, Presence
from pendant.tick.modes import Mode, Phase
from pendant.tick.state import state_of
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench, remaining

PUSH = Presence("push", by_hand=True)


@pytest.mark.parametrize(("seconds", "count"), [(0.0, 0), (0.1, 50), (2.0, 1000), (30.0, 15000)])
def test_the_cool_down_lasts_to_its_tick(seconds: float, count: int) -> None:
    """FD-12c: a new press counts when the cool-down has ended."""
    bench = Bench(free_drive__cool_down=seconds).in_period()
    bench.step(HOLD)
    bench.step(LET_GO)
    left = bench.tick
    assert bench.events[-1].kind is Kind.LEFT_PRESS
    bench.events.clear()
    while bench.step(HOLD).phase is Phase.OFF:
        assert remaining(bench.last) == {"cool-down": (count - (bench.tick - left), count)}
    assert bench.tick == left + max(count, 1)
    expected = [] if count < 2 else [Event(Kind.NOT_YET, left + 1, {"remaining": pytest.approx((count - 1) / 500)})]
    assert bench.events == [*expected, Event(Kind.ACTIVATION_STARTED, bench.tick, {"period": 1.0})]


@pytest.mark.parametrize(("absent", "counts"), [(1, False), (98, False), (99, False), (100, True), (101, True)])
def test_a_signal_present_at_a_leaving_counts_after_an_absence(absent: int, counts: bool) -> None:
    """FD-7: 0.2 s are 100 ticks. FD-17 starts no cool-down."""
    bench = Bench().entered()
    bench.step(replace(HOLD, commands=(Command.LEAVE_FREE_DRIVE,)))
    assert (bench.last.mode, bench.last.periods) == (Mode.TEACH, ())
    assert bench.last.events == (Event(Kind.DEACTIVATED, bench.tick, {}),)
    bench.run(1200, HOLD)
    assert bench.last.phase is Phase.OFF
    bench.step(LET_GO)
    bench.run(absent - 1)
    bench.events.clear()
    bench.step(HOLD)
    assert bench.last.phase is (Phase.ACTIVATION if counts else Phase.OFF)
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED if counts else Kind.NOT_YET]


@pytest.mark.parametrize(("held", "signal"), [(True, BUTTON), (True, NONE), (False, DIGITAL), (False, NONE)])
def test_a_button_or_a_signal_that_is_there_at_a_leaving_shuts_the_gate_without_a_cool_down(held: bool, signal: Presence) -> None:
    """FD-7."""
    gate = Gate()
    gate.sense(held, signal)
    gate.close(0)
    assert gate.shut is (held or signal is not NONE)


def test_a_leaving_with_neither_and_no_cool_down_leaves_the_gate_as_it_was() -> None:
    gate = Gate()
    gate.close(0)
    assert state_of(gate) == state_of(Gate())


def told(gate: Gate) -> tuple[bool, bool, bool, bool, bool, int]:
    """All that others read."""
    return (gate.held, gate.began, gate.ended, gate.appeared, gate.shut, gate.left)


def test_a_new_gate_is_open() -> None:
    assert told(Gate()) == (False, False, False, False, False, 0)
    assert (Gate().signal, Gate().total) == (NONE, 0)


@pytest.mark.parametrize("before", [0, 1, 3])
@pytest.mark.parametrize("signal", [BUTTON, PUSH])
def test_the_button_and_the_signal_each_appear_for_one_tick(before: int, signal: Presence) -> None:
    """FD-7: also where nothing has changed for a while; one changes alone, or both at once. Without a cool-down nothing shuts."""
    course = [(False, NONE)] * before
    course += [(True, NONE)] * 3 + [(True, signal)] * 3 + [(False, signal)] * 3 + [(False, NONE)] * 3
    course += [(True, signal)] * 3 + [(False, NONE)] * 3
    gate = Gate()
    was_held, was_there = False, False
    for held, now in course:
        gate.sense(held, now)
        there = now is not NONE
        assert told(gate) == (held, held and not was_held, was_held and not held, there and not was_there, False, 0)
        was_held, was_there = held, there


@pytest.mark.parametrize(("held", "signal"), [(True, NONE), (False, DIGITAL), (True, BUTTON)])
def test_it_stays_shut_as_long_as_either_is_there(held: bool, signal: Presence) -> None:
    """FD-7: it opens after 100 ticks without both."""
    gate = Gate()
    gate.sense(held, signal)
    gate.close(0)
    for _ in range(150):
        gate.sense(held, signal)
        assert gate.shut
    for tick in range(1, 103):
        gate.sense(False, NONE)
        assert gate.shut is (tick < 100)


@pytest.mark.parametrize("cool_down", [2, 3, 50])
def test_a_hand_felt_in_the_cool_down_must_leave_the_arm(cool_down: int) -> None:
    """FD-12c, FD-7: in its last tick but one, too; what appears in its last tick is a new signal."""
    for quiet in (0, cool_down - 2, cool_down - 1, cool_down):
        gate = Gate()
        gate.sense(True, BUTTON)
        gate.sense(False, NONE)
        gate.close(cool_down)
        for left in reversed(range(cool_down - quiet, cool_down)):
            gate.sense(False, NONE)
            assert (gate.left, gate.total, gate.shut) == (left, cool_down, left > 0)
        for _ in range(cool_down - quiet + 3):
            gate.sense(False, PUSH)
        assert (gate.left, gate.shut) == (0, quiet < cool_down - 1)
