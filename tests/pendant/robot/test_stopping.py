"""Stops: their categories, and the time and way that are measured."""

import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.robot.stopping import LONGEST, Stopping
from pendant.tick.modes import Law, Mode, Safety
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import LET_GO, Bench

MOVING = estimate(qd=0.5, v_tcp=0.25)


def command(*commands: Command) -> Inputs:
    return Inputs(commands=commands)


def test_an_emergency_stop_removes_the_power_when_the_arm_stands() -> None:
    """Category 1."""
    bench = Bench().entered()
    bench.step(command(Command.EMERGENCY_STOP), MOVING)
    bench.run(40, NOTHING, MOVING)
    assert bench.last.law is Law.BRAKE
    bench.run(49)
    assert bench.last.law is Law.BRAKE
    bench.step()
    assert bench.last.law is Law.OFF
    # 40 ticks at 0.25 m/s
    values = {"time": pytest.approx(0.08), "distance": pytest.approx(0.02), "category": 1, "cause": "emergency_stop"}
    assert bench.last.events == (Event(Kind.STOPPED, bench.tick, values),)
    bench.step(LET_GO)
    bench.step(command(Command.RESET))
    assert (bench.last.mode, bench.last.law) == (Mode.TEACH, Law.HOLD)


def test_at_rest_it_removes_the_power_at_once_and_measures_nothing() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(command(Command.EMERGENCY_STOP))
    assert bench.last.law is Law.OFF
    bench.run(200)
    assert [event.kind for event in bench.events] == [Kind.EMERGENCY_STOP]


def test_the_power_goes_after_a_second_at_the_latest() -> None:
    bench = Bench().entered()
    bench.step(command(Command.EMERGENCY_STOP), MOVING)
    bench.run(LONGEST - 1, NOTHING, MOVING)
    assert bench.last.law is Law.BRAKE
    bench.step(NOTHING, MOVING)
    assert bench.last.law is Law.OFF


def test_without_sensors_nothing_is_measured() -> None:
    bench = Bench().entered()
    bench.step(command(Command.EMERGENCY_STOP), MOVING)
    bench.step(NOTHING, estimate(joints_valid=False))
    bench.run(600)
    assert Kind.STOPPED not in [event.kind for event in bench.events]
    assert bench.last.law is Law.OFF


def test_a_safeguard_stop_keeps_the_power_and_needs_a_closed_safeguard() -> None:
    """Category 2; no automatic reset."""
    bench = Bench().in_period()
    bench.step(command(Command.SAFEGUARD_OPEN), MOVING)
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.SAFEGUARD_STOP, Law.BRAKE)
    assert bench.last.events == (Event(Kind.SAFEGUARD_STOP, bench.tick, {"mode": Mode.FREE_DRIVE}),)
    assert bench.step(command(Command.SAFEGUARD_OPEN), MOVING).events == ()
    bench.run(60)
    assert bench.events[-1].values["category"] == 2
    assert bench.last.law is Law.BRAKE
    assert bench.step(command(Command.RESET)).events == (Event(Kind.RESET_REFUSED_SAFEGUARD, bench.tick, {}),)
    bench.step(command(Command.SAFEGUARD_CLOSED))
    bench.run(500)
    assert (bench.last.mode, bench.last.safety) == (Mode.STOP, Safety.SAFEGUARD_STOP)
    bench.step(command(Command.RESET))
    assert (bench.last.mode, bench.last.safety) == (Mode.TEACH, Safety.NORMAL)


def test_open_wins_over_closed_in_one_tick() -> None:
    bench = Bench()
    bench.step(command(Command.SAFEGUARD_CLOSED, Command.SAFEGUARD_OPEN))
    assert [event.kind for event in bench.events] == [Kind.SAFEGUARD_STOP]
    bench.run(60)
    assert bench.step(command(Command.RESET)).events[0].kind is Kind.RESET_REFUSED_SAFEGUARD


def test_a_harder_stop_on_top_counts_as_one_stop_of_the_first_cause() -> None:
    stopping = Stopping()
    stopping.begin(Kind.SAFEGUARD_STOP, 2, False)
    stopping.step(MOVING, 0, 50)
    stopping.begin(Kind.EMERGENCY_STOP, 1, False)
    assert not stopping.off
    stopping.begin(Kind.MOTOR_ANGLE_LOST, 0, False)
    assert stopping.off
    (event,) = stopping.step(estimate(), 50, 50)
    assert event.values == {"time": 0.0, "distance": pytest.approx(0.0005), "category": 0, "cause": "safeguard_stop"}
    stopping.end()
    assert not stopping.off
    assert stopping.step(estimate(), 50, 50) == []


def test_a_stop_that_kept_the_power_is_forgotten_once_measured() -> None:
    stopping = Stopping()
    stopping.begin(Kind.SAFEGUARD_STOP, 2, False)
    assert stopping.step(estimate(), 50, 50)
    stopping.begin(Kind.EMERGENCY_STOP, 1, False)
    (event,) = stopping.step(estimate(), 50, 50)
    assert (event.values["cause"], event.values["category"]) == ("emergency_stop", 1)
    assert stopping.off


def test_each_stop_is_measured_anew() -> None:
    """After a reset, and after one that found the arm at rest."""
    stopping = Stopping()
    for _ in range(2):
        stopping.begin(Kind.EMERGENCY_STOP, 1, False)
        assert stopping.step(MOVING, 0, 50) == []
        (event,) = stopping.step(estimate(), 50, 50)
        assert (event.kind, stopping.off) == (Kind.STOPPED, True)
        stopping.end()
        assert stopping.off is False
    stopping.begin(Kind.STOPPED_LIMIT, 2, True)
    assert stopping.step(estimate(), 50, 50) == []
    stopping.begin(Kind.STOPPED_MOTION, 2, False)
    assert stopping.step(MOVING, 0, 50) == []
    (event,) = stopping.step(estimate(), 50, 50)
    assert (event.values["category"], event.values["cause"]) == (2, "stopped_motion")


def test_a_stop_that_is_measured_is_as_one_that_had_nothing_to_measure() -> None:
    moving, standing = Stopping(), Stopping()
    moving.begin(Kind.EMERGENCY_STOP, 1, False)
    standing.begin(Kind.EMERGENCY_STOP, 1, True)
    assert state_of(moving) != state_of(standing)
    assert len(moving.step(estimate(), 50, 50)) - len(standing.step(estimate(), 50, 50)) == 1
    assert state_of(moving) == state_of(standing)


def test_a_reset_without_a_stop_leaves_no_trace() -> None:
    stopping = Stopping()
    stopping.end()
    assert state_of(stopping) == state_of(Stopping())
