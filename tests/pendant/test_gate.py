"""The gate before free-drive: cool-down, and a signal that has to be a new one, to the tick."""

from dataclasses import replace

import pytest

from pendant.events import Event, Kind
from pendant.gate import Gate
from pendant.inputs import Command
from pendant.modes import Mode, Phase
from pendant.sources import BUTTON, DIGITAL, NONE, Presence
from tests.pendant.test_freedrive import HOLD, LET_GO, Bench, remaining


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
    assert gate.memory == Gate().memory
