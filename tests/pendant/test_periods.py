"""The periods of free-drive: anew (FD-16), switched off (FD-24), not told (FD-20), and the way back (FD-22)."""

import pytest

from pendant.events import Event, Kind, posture_of
from pendant.inputs import NOTHING, Command, Inputs
from pendant.modes import Law, Mode, Phase
from tests.pendant.estimates import estimate
from tests.pendant.test_freedrive import LET_GO, Bench, remaining

ANEW = Inputs(commands=(Command.RESTART_PERIOD,))
MOVING = estimate(qd=0.5)


@pytest.mark.parametrize("after", [0, 1, 700, 1498])
def test_the_free_drive_period_begins_anew(after: int) -> None:
    bench = Bench().in_period()
    bench.run(after)
    bench.step(ANEW)
    assert bench.last.events == (Event(Kind.PERIOD_ANEW, bench.tick, {"period": 3.0}),)
    assert remaining(bench.last) == {"free-drive": (1500, 1500)}
    assert bench.run(1499).phase is Phase.PERIOD
    assert bench.step().mode is Mode.TEACH


def test_the_restart_period_begins_anew_with_its_own_length() -> None:
    bench = Bench(free_drive__restart_period=1.0).in_period()
    bench.run(10, NOTHING, MOVING)
    bench.run(300)
    bench.step(ANEW)
    assert (bench.last.phase, remaining(bench.last)) == (Phase.RESTART, {"restart": (500, 500)})


def test_a_hand_that_was_there_counts_from_the_new_begin() -> None:
    """FD-13: forces are changes since the period began."""
    bench = Bench().in_period()
    bench.step(ANEW, estimate(force=20.0))
    assert bench.step(NOTHING, estimate(force=20.0)).phase is Phase.PERIOD
    assert bench.step(NOTHING, estimate(force=11.9)).phase is Phase.GUIDED


def test_where_no_period_runs_none_begins() -> None:
    bench = Bench().entered()
    refused = {"command": Command.RESTART_PERIOD, "mode": Mode.FREE_DRIVE, "reason": "no period of free-drive runs"}
    assert bench.step(ANEW).events == (Event(Kind.COMMAND_REFUSED, bench.tick, refused),)
    bench.step(LET_GO)
    assert bench.run(1499).phase is Phase.PERIOD  # and it is not kept for later
    assert bench.step().mode is Mode.TEACH
    assert bench.step(ANEW).events[0].kind is Kind.COMMAND_REFUSED


def test_none_begins_anew_where_that_is_switched_off() -> None:
    bench = Bench(free_drive__anew=False).in_period()
    bench.run(1498)
    refused = {"command": Command.RESTART_PERIOD, "mode": Mode.FREE_DRIVE, "reason": "periods are not begun anew here"}
    assert bench.step(ANEW).events == (Event(Kind.COMMAND_REFUSED, bench.tick, refused),)
    assert bench.step().mode is Mode.TEACH


@pytest.mark.parametrize(("longest", "period", "restart"), [(30.0, 5.0, 4.0), (4.5, 4.5, 4.0), (0.5, 0.5, 0.5)])
def test_no_period_is_longer_than_the_longest(longest: float, period: float, restart: float) -> None:
    names = {"free_drive__longest": longest, "free_drive__period": 5.0, "free_drive__restart_period": 4.0}
    bench = Bench(**names).in_period()
    assert remaining(bench.last) == {"free-drive": (period * 500, period * 500)}
    bench.run(10, NOTHING, MOVING)
    bench.run(50)
    assert remaining(bench.last) == {"restart": (restart * 500, restart * 500)}


def test_without_periods_free_drive_lasts() -> None:
    bench = Bench(free_drive__maintained=False).entered()
    bench.events.clear()
    assert bench.step(LET_GO).phase is Phase.GUIDED
    bench.run(10, NOTHING, MOVING)
    assert bench.run(4000).phase is Phase.GUIDED
    assert (bench.last.law, bench.last.periods, bench.events) == (Law.FREE, (), [])
    assert bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,))).mode is Mode.TEACH


def test_remainders_are_not_told_where_they_are_switched_off() -> None:
    bench = Bench(free_drive__remainders=False).in_period()
    assert (bench.last.phase, bench.last.periods) == (Phase.PERIOD, ())
    assert bench.run(1499).periods == ()
    assert bench.step().mode is Mode.TEACH
    assert bench.last.periods == ()


@pytest.mark.parametrize("told", [True, False])
def test_the_way_back_is_told_where_it_is_switched_on(told: bool) -> None:
    bench = Bench(free_drive__way_back=told).in_period()
    bench.run(1500, NOTHING, estimate(q=[0.1, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert [event.kind for event in bench.events] == [Kind.LEFT_PERIOD, Kind.WAY_BACK][: 1 + told]
    if told:
        assert posture_of(bench.events[-1].values) == (0.0,) * 6  # as it was at activation
