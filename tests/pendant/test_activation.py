"""The activation of free-drive: its period to the tick, and what refuses entry at its end."""

import pytest

from pendant.estimate import Estimate
from pendant.events import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.modes import Law, Mode, Phase
from pendant.program import Program, Wait
from tests.pendant.estimates import estimate
from tests.pendant.test_freedrive import HOLD, LET_GO, Bench, remaining


@pytest.mark.parametrize(("seconds", "count"), [(0.0, 0), (0.002, 1), (0.25, 125), (1.0, 500), (15.0, 7500)])
def test_activation_lasts_its_period_to_the_tick(seconds: float, count: int) -> None:
    """FD-7, FD-20."""
    bench = Bench(activation__period=seconds)
    bench.run(60)
    for left in range(count, 0, -1):
        bench.step(HOLD)
        assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.ACTIVATION, Law.HOLD)
        assert remaining(bench.last) == {"activation": (left, count)}
    bench.step(HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.FREE_DRIVE, Phase.HELD, Law.FREE)
    assert bench.last.periods == ()
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED, Kind.ENTERED]
    assert bench.events[0] == Event(Kind.ACTIVATION_STARTED, 60, {"period": pytest.approx(seconds)})
    assert bench.events[1] == Event(Kind.ENTERED, 60 + count, {"from": Mode.TEACH, "gain": 1.0})


@pytest.mark.parametrize("held", [1, 2, 250, 499, 500])
def test_letting_go_before_the_end_cancels_without_a_cool_down(held: int) -> None:
    """FD-8a."""
    bench = Bench()
    bench.run(60)
    bench.run(held, HOLD)
    bench.step(LET_GO)
    assert (bench.last.mode, bench.last.phase, bench.last.periods) == (Mode.TEACH, Phase.OFF, ())
    values = {"value": pytest.approx(held / 500), "limit": 1.0}
    assert bench.events[-1] == Event(Kind.ACTIVATION_CANCELLED, 60 + held, values)
    assert bench.step(HOLD).phase is Phase.ACTIVATION
    assert remaining(bench.last) == {"activation": (500, 500)}


def test_a_stutter_during_activation_does_not_cancel_it_and_silence_does() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(HOLD)
    bench.run(250)
    bench.step(HOLD)
    assert bench.last.phase is Phase.ACTIVATION
    bench.run(248)
    assert remaining(bench.last) == {"activation": (1, 500)}
    assert bench.step().phase is Phase.HELD
    bench = Bench(activation__period=2.0)
    bench.run(60)
    bench.step(HOLD)
    assert bench.run(250).phase is Phase.ACTIVATION
    bench.step()
    assert [event.kind for event in bench.last.events] == [Kind.HOLD_SILENT, Kind.ACTIVATION_CANCELLED]


@pytest.mark.parametrize(("ago", "entered"), [(0, False), (1, False), (49, False), (50, True), (51, True)])
def test_entry_is_refused_unless_the_arm_was_static(ago: int, entered: bool) -> None:
    """0.1 s are 50 ticks."""
    bench = Bench()
    bench.run(60)
    bench.run(500 - ago, HOLD)
    bench.step(HOLD, estimate(qd=[0.0, 0.0, -0.0123, 0.0, 0.0, 0.0]))
    bench.run(ago, HOLD)
    assert (bench.last.mode is Mode.FREE_DRIVE) == entered
    if not entered:
        values = {"joint": "elbow", "value": 0.0123, "limit": 0.01, "time": 0.1}
        assert bench.last.events == (Event(Kind.REFUSED_MOVING, bench.tick, values),)


@pytest.mark.parametrize("braking", [0, 1, 40])
@pytest.mark.parametrize(("rested", "there"), [(229, False), (230, True), (260, True)])
def test_an_arm_whose_program_is_stopped_on_its_way_is_compared_with_a_state_at_rest(
    braking: int, rested: int, there: bool
) -> None:
    """FD-9: the state must be 0.5 s old, 250 ticks, of which the button is held for 21; none of before or of braking counts."""
    bench = Bench(sequence__on=True, sequence__stored=True, sequence__age=0.5, activation__period=0.04)
    bench.run(300)
    bench.step(Inputs(program=Program(name="rest", steps=(Wait(duration=60.0),))))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.run(3, NOTHING, estimate(qd=0.3))
    bench.step(Inputs(commands=(Command.STOP_PROGRAM,)), estimate(qd=0.3))
    assert bench.last.mode is Mode.TEACH
    bench.run(braking, NOTHING, estimate(qd=0.3))
    bench.run(rested)
    bench.run(21, HOLD)
    assert (bench.last.phase is Phase.SEQUENCE) is there
    assert there or bench.last.events[-1].kind is Kind.REFUSED_NOT_STORED


@pytest.mark.parametrize("phase", [Phase.ACTIVATION, Phase.SEQUENCE])
def test_a_mode_that_free_drive_cannot_be_entered_from_ends_it_and_is_named(phase: Phase) -> None:
    """FD-1."""
    bench = Bench(sequence__on=True, activation__period=0.0 if phase is Phase.SEQUENCE else 1.0)
    bench.run(60)
    assert bench.step(HOLD).phase is phase
    bench.step(Inputs(held=HOLD.held, commands=(Command.NORMAL,)))
    assert bench.last.events[-1] == Event(Kind.REFUSED_MODE, bench.tick, {"mode": Mode.NORMAL, "allowed": "TEACH"})
    assert (bench.last.mode, bench.last.phase) == (Mode.NORMAL, Phase.OFF)


@pytest.mark.parametrize(
    ("broken", "sensor"),
    [
        (estimate(joints_valid=False), "joint encoders and motor currents"),
        (estimate(wrench_valid=False), "flange force sensor"),
    ],
)
def test_a_sensor_that_is_lost_in_the_sequence_refuses_entry_and_is_named(broken: Estimate, sensor: str) -> None:
    """FD-12."""
    bench = Bench(sequence__on=True, activation__period=0.0)
    bench.run(60)
    assert bench.step(HOLD).phase is Phase.SEQUENCE
    bench.step(HOLD, broken)
    assert (bench.last.mode, bench.last.phase) == (Mode.TEACH, Phase.OFF)
    assert bench.last.events == (Event(Kind.REFUSED_SENSORS, bench.tick, {"sensor": sensor}),)
