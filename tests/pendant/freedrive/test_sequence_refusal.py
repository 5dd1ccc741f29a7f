"""What refuses the activation sequence, and what comes of it: payload or push, a stop, a paused program (FD-9 to FD-12)."""

import math

import numpy as np
import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import Program, ProgramState, Wait
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_sequence import tried
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench, remaining


@pytest.mark.parametrize(("mass", "way"), [(1.8, "down"), (-1.8, "up")])
def test_a_wrong_payload_is_refused_before_the_arm_is_freed_and_named_with_its_doubt(mass: float, way: str) -> None:
    bench = Bench(sequence__on=True)
    value = estimate(force=[0.0, 0.0, -9.81 * mass])
    bench.run(60, NOTHING, value)
    bench.run(501, HOLD, value)
    assert (bench.last.mode, bench.last.law) == (Mode.TEACH, Law.HOLD)
    assert [event.kind for event in bench.last.events] == [Kind.SEQUENCE_STARTED, Kind.ENTRY_PREVENTED, Kind.REFUSED_PAYLOAD]
    values = {"mass": pytest.approx(mass), "force": pytest.approx(17.658), "way": way, "zero": False}
    values |= {"parameter": "payload-like force"}
    assert bench.last.events[-1].values == values


@pytest.mark.parametrize("g", [[0.0, 0.0, -9.81], [9.81, 0.0, 0.0], [0.0, 0.0, 9.81], [0.0, -5.886, 7.848]])
def test_gravity_is_where_the_mounting_says(g: list[float]) -> None:
    def make(force: np.ndarray) -> Estimate:
        value = estimate(force=force.tolist())
        value.g_B = np.array(g)
        return value

    bench = Bench(sequence__on=True)
    bench.run(60, NOTHING, make(np.array(g)))
    bench.run(501, HOLD, make(np.array(g)))
    assert bench.last.events[-1].kind is Kind.REFUSED_PAYLOAD
    assert bench.last.events[-1].values["mass"] == pytest.approx(1.0)


def refused(mass: float = 1.8) -> Bench:
    bench = Bench(sequence__on=True)
    value = estimate(force=[0.0, 0.0, -9.81 * mass])
    bench.run(60, NOTHING, value)
    bench.run(501, HOLD, value)
    bench.events.clear()
    bench.step(LET_GO, value)
    return bench


def test_a_push_is_told_from_a_payload_when_the_hand_leaves() -> None:
    bench = refused()
    bench.run(100)
    assert [event.kind for event in bench.events] == [Kind.RESIDUAL_GONE]
    gone = bench.events[0]
    assert gone.values["force"] == pytest.approx(17.658)
    assert float(gone.values["left"]) < 8.829
    # half of the mean of 50 ticks is gone after 26 of them
    assert gone.tick == 561 + 26
    assert bench.run(1500).events == ()


def test_a_payload_that_stays_is_told_in_the_last_tick_of_the_cool_down() -> None:
    bench = refused()
    stays = estimate(force=[0.0, 0.0, -9.81 * 1.75])
    bench.run(997, NOTHING, stays)
    assert bench.events == []
    bench.step(NOTHING, stays)
    assert remaining(bench.last) == {"cool-down": (1, 1000)}
    assert [event.kind for event in bench.events] == [Kind.RESIDUAL_STAYED]


@pytest.mark.parametrize(("mass", "stays"), [(1.75, True), (1.6, False), (1.94, True), (2.0, False)])
def test_only_the_same_force_has_stayed(mass: float, stays: bool) -> None:
    bench = refused()
    bench.run(1200, NOTHING, estimate(force=[0.0, 0.0, -9.81 * mass]))
    assert [event.kind for event in bench.events] == [Kind.RESIDUAL_STAYED] * stays
    if stays:
        assert bench.events[0].values["mass"] == pytest.approx(mass)
        assert bench.events[0].tick == 560 + 999


def test_without_sensor_or_cool_down_there_is_no_verdict() -> None:
    bench = refused()
    bench.step(NOTHING, estimate(wrench_valid=False))
    assert bench.run(1200).events == ()
    assert bench.events == []
    bench = Bench(sequence__on=True, free_drive__cool_down=0.0)
    bench.run(501, HOLD, estimate(force=[0.0, 0.0, 30.0]))
    assert bench.last.events[-1].kind is Kind.REFUSED_PAYLOAD
    bench.events.clear()
    bench.step(LET_GO)
    bench.run(1200)
    assert bench.events == []


def test_the_option_is_a_protective_stop() -> None:
    """FD-10."""
    bench = tried(sequence__beyond_limit="protective_stop")
    bench.step(HOLD, estimate(position=0.003))
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.BRAKE)
    values = {"parameter": "flange displacement", "part": "flange", "value": 0.003, "limit": 0.002, "unit": "m"}
    assert bench.last.events[-1] == Event(Kind.SEQUENCE_STOPPED, bench.tick, values)


@pytest.mark.parametrize(
    ("broken", "sensor"),
    [
        (estimate(joints_valid=False), "joint encoders and motor currents"),
        (estimate(qd=math.nan), "joint encoders and motor currents"),
        (estimate(wrench_valid=False), "flange force sensor"),
        (estimate(force=math.nan), "flange force sensor"),
        (estimate(acceleration_valid=False), "flange accelerometer"),
    ],
)
def test_where_no_decision_is_possible_free_drive_is_not_entered(broken: Estimate, sensor: str) -> None:
    """FD-12."""
    bench = tried()
    bench.run(498, HOLD)
    bench.step(HOLD, broken)
    assert bench.last.mode is Mode.TEACH
    assert bench.last.events == (Event(Kind.REFUSED_SENSORS, bench.tick, {"sensor": sensor}),)


def test_an_acceleration_that_is_no_number_is_beyond() -> None:
    bench = tried()
    bench.step(HOLD, estimate(acceleration=math.nan))
    assert [event.kind for event in bench.last.events] == [Kind.ENTRY_PREVENTED, Kind.REFUSED_LIMIT]


def test_a_moving_arm_is_braked_when_it_is_refused() -> None:
    bench = tried()
    bench.run(10, HOLD, estimate(qd=0.049))
    bench.step(HOLD, estimate(qd=0.06))
    assert bench.last.law is Law.BRAKE
    assert bench.run(49).law is Law.BRAKE
    assert bench.step().law is Law.HOLD


def test_from_a_running_program_it_pauses_it_and_a_refusal_leaves_it_paused() -> None:
    """FD-1, FD-10."""
    bench = Bench(sequence__on=True, free_drive__allowed_from__run=True)
    bench.run(60)
    bench.step(Inputs(program=Program(name="rest", steps=(Wait(duration=60.0),))))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.run(501, HOLD)
    assert [event.kind for event in bench.last.events] == [Kind.SEQUENCE_STARTED, Kind.PROGRAM_PAUSED]
    bench.step(Inputs(held=frozenset({Button.FREE_DRIVE}), commands=(Command.RESUME_PROGRAM,)))
    assert bench.last.events[0].values["reason"] == "free-drive is being tried"
    bench.step(HOLD, estimate(position=1.0))
    assert (bench.last.mode, bench.last.program, bench.last.law) == (
        Mode.RUN,
        ProgramState.PAUSED,
        Law.BRAKE,
    ) or bench.last.law is Law.HOLD
    bench.run(1000)
    assert (bench.last.mode, bench.last.program) == (Mode.RUN, ProgramState.PAUSED)
