"""The levels of the safety inputs: each change is told once, and what is open keeps a reset off (FD-1)."""

import math

import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.robot.safety_inputs import SafetyInputs
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench

OPEN, CLOSED = Command.SAFEGUARD_OPEN, Command.SAFEGUARD_CLOSED
ON, OFF = Command.REDUCED_ON, Command.REDUCED_OFF
STOP, RESET = Command.EMERGENCY_STOP, Command.RESET
RELEASED, POWER_OFF = Command.EMERGENCY_STOP_RELEASED, Command.POWER_OFF


def told(bench: Bench, *commands: Command) -> list[Kind]:
    """What a tick with these commands tells."""
    return [event.kind for event in bench.step(Inputs(commands=commands)).events]


def resting() -> Bench:
    bench = Bench()
    bench.run(60)
    return bench


@pytest.mark.parametrize(
    ("ticks", "kinds"),
    [
        ([(CLOSED,)], []),
        ([(OPEN,), (OPEN,)], [Kind.SAFEGUARD_STOP]),
        ([(OPEN,), (CLOSED,), (CLOSED,)], [Kind.SAFEGUARD_STOP, Kind.SAFEGUARD_CLOSED]),
        ([(OPEN,), (CLOSED,), (OPEN,)], [Kind.SAFEGUARD_STOP, Kind.SAFEGUARD_CLOSED, Kind.SAFEGUARD_STOP]),
        ([(OPEN,), (CLOSED, OPEN)], [Kind.SAFEGUARD_STOP]),
        ([(OPEN,), (CLOSED, RESET)], [Kind.SAFEGUARD_STOP, Kind.SAFEGUARD_CLOSED, Kind.RESET]),
        ([(OPEN,), (RESET,)], [Kind.SAFEGUARD_STOP, Kind.RESET_REFUSED_SAFEGUARD]),
        ([(STOP, OPEN), (CLOSED,), (RESET,)], [Kind.SAFEGUARD_STOP, Kind.EMERGENCY_STOP, Kind.SAFEGUARD_CLOSED, Kind.RESET]),
        ([(OFF,), (ON,), (ON,), (OFF, ON), (OFF,), (OFF,)], [Kind.REDUCED_ON, Kind.REDUCED_OFF]),
    ],
)
def test_each_change_of_a_level_is_told_once(ticks: list[tuple[Command, ...]], kinds: list[Kind]) -> None:
    bench = resting()
    assert [kind for commands in ticks for kind in told(bench, *commands)] == kinds


def levels(safety: SafetyInputs) -> tuple[object, ...]:
    """What it remembers besides the robot."""
    return (state_of(safety._limits), safety._safeguard)


def test_a_safeguard_that_is_closed_is_as_before_it_was_opened() -> None:
    bench = resting()
    safety = bench.supervisor._safety
    before = levels(safety)
    told(bench, OPEN)
    assert levels(safety) != before
    bench.step(Inputs(commands=(CLOSED,)))
    assert bench.last.events == (Event(Kind.SAFEGUARD_CLOSED, bench.tick, {}),)
    assert levels(safety) == before
    assert (bench.last.mode, bench.last.safety) == (Mode.STOP, Safety.SAFEGUARD_STOP), "no reset by itself"


def test_no_reset_while_the_button_is_held_or_the_arm_moves() -> None:
    """FD-1: a released button is asked for, however the robot was stopped, and then an arm at rest."""
    held = frozenset({Button.FREE_DRIVE})
    for stop in (OPEN, STOP):
        bench = resting()
        told(bench, stop)
        told(bench, CLOSED)
        bench.step(Inputs(held=held, commands=(RESET,)))
        assert Event(Kind.RESET_REFUSED_SIGNAL, bench.tick, {}) in bench.last.events
        assert bench.last.mode is Mode.STOP
        bench.step(LET_GO, estimate(qd=0.4))
        bench.step(Inputs(commands=(RESET,)))
        values = {"joint": "base", "value": 0.4, "limit": 0.01, "time": 0.1}
        assert bench.last.events == (Event(Kind.RESET_REFUSED_MOVING, bench.tick, values),)
        bench.run(60)
        assert told(bench, RESET) == [Kind.RESET]


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize(("command", "kind"), [(OPEN, Kind.SAFEGUARD_STOP), (STOP, Kind.EMERGENCY_STOP)])
def test_a_stop_ends_free_drive(command: Command, kind: Kind, held: bool) -> None:
    bench = Bench(activation__period=0.0)
    bench.run(60)
    bench.step(HOLD)
    if not held:
        bench.step(LET_GO)
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.step(Inputs(commands=(command,)))
    assert bench.last.events[0] == Event(kind, bench.tick, {"mode": Mode.FREE_DRIVE})
    assert (bench.last.mode, bench.last.phase) == (Mode.STOP, Phase.OFF)


@pytest.mark.parametrize(("levels", "safety"), [((), Safety.NORMAL), ((ON,), Safety.REDUCED), ((ON, OFF), Safety.NORMAL)])
def test_a_reset_leads_to_the_safety_mode_that_the_inputs_ask_for(levels: tuple[Command, ...], safety: Safety) -> None:
    bench = resting()
    told(bench, STOP)
    for level in levels:
        told(bench, level)
        assert bench.last.safety is Safety.EMERGENCY_STOP
    assert told(bench, RESET) == [Kind.RESET]
    assert (bench.last.mode, bench.last.safety) == (Mode.TEACH, safety)


def test_what_is_too_fast_for_reduced_is_stopped_once() -> None:
    """FD-1: 0.5 s of grace are 250 ticks; what goes on in STOP is the stop's to brake."""
    bench, fast = resting(), estimate(v_tcp=0.9)
    bench.step(Inputs(commands=(ON,)))
    assert bench.last.speed_limits == SpeedLimits(0.75, 0.75, (6.4832,) * 6, 10.0, 0.3, 0.3)
    bench.events.clear()
    assert bench.run(249, NOTHING, fast).mode is Mode.TEACH
    bench.run(20, NOTHING, fast)
    values = {
        "parameter": "tool speed",
        "part": "tool",
        "value": 0.9,
        "limit": 0.75,
        "unit": "m/s",
        "mode": "REDUCED",
        "position": False,
    }
    assert bench.events == [Event(Kind.LIMIT_EXCEEDED, 310, values)]
    assert (bench.last.mode, bench.last.safety) == (Mode.STOP, Safety.PROTECTIVE_STOP)


@pytest.mark.parametrize("value", [estimate(joints_valid=False, v_tcp=math.nan), estimate(qd=math.nan)])
def test_where_no_joint_can_be_told_nothing_is_too_fast(value: Estimate) -> None:
    """FD-12: what is lost is told by others."""
    bench = resting()
    told(bench, ON)
    bench.run(300)
    bench.step(NOTHING, value)
    assert Kind.LIMIT_EXCEEDED not in [event.kind for event in bench.last.events]
    assert bench.last.mode is Mode.TEACH


def test_a_released_emergency_stop_leaves_the_drives_off_until_a_reset() -> None:
    bench = resting()
    assert told(bench, STOP) == [Kind.EMERGENCY_STOP]
    assert told(bench, RELEASED) == [Kind.EMERGENCY_STOP_RELEASED]
    decision = bench.step(NOTHING)
    assert (decision.mode, decision.safety, decision.law) == (Mode.STOP, Safety.NORMAL, Law.OFF)
    assert told(bench, RESET) == [Kind.RESET]
    assert bench.step(NOTHING).law is Law.HOLD


def test_an_emergency_stop_that_is_pressed_is_not_released_in_the_same_tick() -> None:
    bench = resting()
    assert told(bench, STOP, RELEASED) == [Kind.EMERGENCY_STOP]
    assert told(bench, RELEASED, STOP) == []
    assert bench.step(NOTHING).safety is Safety.EMERGENCY_STOP


def test_what_was_not_pressed_cannot_be_released() -> None:
    bench = resting()
    assert told(bench, RELEASED) == []
    assert told(bench, OPEN, RELEASED) == [Kind.SAFEGUARD_STOP]


@pytest.mark.parametrize(("level", "safety"), [(OPEN, Safety.SAFEGUARD_STOP), (ON, Safety.REDUCED), (CLOSED, Safety.NORMAL)])
def test_a_released_emergency_stop_leaves_what_else_holds(level: Command, safety: Safety) -> None:
    bench = resting()
    told(bench, level)
    told(bench, STOP)
    told(bench, RELEASED)
    assert bench.step(NOTHING).safety is safety


def test_power_off_is_told_once_and_leaves_the_safety_mode() -> None:
    bench = resting()
    assert told(bench, POWER_OFF) == [Kind.POWERED_OFF]
    decision = bench.step(NOTHING)
    assert (decision.mode, decision.safety, decision.law) == (Mode.STOP, Safety.NORMAL, Law.OFF)
    assert told(bench, POWER_OFF) == []
    assert told(bench, RESET) == [Kind.RESET]


def test_power_off_brakes_a_moving_arm_first() -> None:
    bench = resting()
    laws = [bench.step(Inputs(commands=(POWER_OFF,)), estimate(qd=0.3)).law]
    laws += [bench.step(NOTHING, estimate(qd=0.3)).law for _ in range(3)]
    assert laws == [Law.BRAKE] * 4
    assert bench.run(100).law is Law.OFF


def blind(joint: int = 2, sensor: str = "motor_encoder") -> Estimate:
    """A tick in which a joint has lost a sensor."""
    seen = estimate()
    seen.degraded, seen.lost = True, ((sensor, joint),)
    return seen


def stops_of(bench: Bench) -> list[Event]:
    return [event for event in bench.events if event.kind is Kind.MOTOR_ANGLE_LOST]


def test_a_motor_angle_that_is_out_for_a_tenth_of_a_second_is_a_stop_on_the_brakes() -> None:
    """Nothing else can hold such a joint; a shorter gap is one of the bus."""
    bench = resting()
    bench.run(49, NOTHING, blind())
    assert (bench.last.mode, stops_of(bench)) == (Mode.TEACH, [])
    bench.step(NOTHING, blind())
    assert stops_of(bench) == [Event(Kind.MOTOR_ANGLE_LOST, bench.tick, {"joint": "elbow"})]
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.OFF)
    bench.run(200, NOTHING, blind())
    assert len(stops_of(bench)) == 1, "told once"


def test_a_motor_angle_that_an_arm_loses_while_it_moves_is_a_stop_after_ten_ticks() -> None:
    """What pushes turns a joint that nothing controls."""
    bench = resting()
    bench.step(NOTHING, estimate(qd=0.3))
    bench.run(9, NOTHING, blind())
    assert stops_of(bench) == []
    bench.step(NOTHING, blind())
    assert len(stops_of(bench)) == 1
    assert (bench.last.safety, bench.last.law) == (Safety.PROTECTIVE_STOP, Law.OFF)


def test_gaps_of_a_motor_angle_do_not_add_up() -> None:
    bench = resting()
    for _ in range(5):
        bench.run(49, NOTHING, blind())
        bench.step()
    assert (bench.last.mode, stops_of(bench)) == (Mode.TEACH, [])


@pytest.mark.parametrize("sensor", ["output_encoder", "current"])
def test_other_joint_sensors_do_not_stop_an_arm_at_rest(sensor: str) -> None:
    bench = resting()
    bench.run(200, NOTHING, blind(sensor=sensor))
    assert (bench.last.mode, stops_of(bench)) == (Mode.TEACH, [])
