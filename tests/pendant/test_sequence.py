"""The activation sequence with the shipped settings (FD-9 to FD-12)."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from msgspec.structs import astuple

from pendant.estimate import Estimate
from pendant.events import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.modes import Law, Mode, Phase, Safety
from pendant.program import Program, ProgramState, Wait
from tests.pendant.estimates import estimate
from tests.pendant.test_freedrive import HOLD, LET_GO, Bench, remaining

PARAMETERS: dict[str, tuple[str, float, str, Callable[[float], Estimate]]] = {
    "flange displacement": ("flange", 0.002, "m", lambda value: estimate(position=value)),
    "flange speed": ("flange", 0.02, "m/s", lambda value: estimate(speed=-value)),
    "flange acceleration": ("flange", 1.5, "m/s²", lambda value: estimate(acceleration=value)),
    "joint speed": ("shoulder", 0.05, "rad/s", lambda value: estimate(qd=[0.0, -value, 0.0, 0.0, 0.0, 0.0])),
    "joint external torque": ("elbow", 4.0, "N·m", lambda value: estimate(tau_ext=[0.0, 0.0, value, 0.0, 0.0, 0.0])),
    "payload-like force": ("flange", 5.8, "N", lambda value: estimate(force=[0.0, 0.0, value])),
    "payload-like torque": ("flange", 1.5, "N·m", lambda value: estimate(torque=[0.0, value, 0.0])),
    "user force": ("flange", 12.0, "N", lambda value: estimate(force=[0.0, -value, 0.0])),
    "user torque": ("flange", 1.5, "N·m", lambda value: estimate(torque=[0.0, 0.0, -value])),
}
"""Part, limit, unit; rated torques are 100 N·m."""
AVERAGED = {name for name in PARAMETERS if "payload" in name or "user" in name}


def tried(**changes: float | bool) -> Bench:
    """In the first tick of the sequence, tick 560."""
    bench = Bench(**{"sequence__on": True, **changes})
    bench.run(60)
    bench.run(501, HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.SEQUENCE, Law.FREE)
    return bench


@pytest.mark.parametrize(("seconds", "count"), [(0.25, 125), (1.0, 500), (5.0, 2500)])
def test_it_lasts_its_period_to_the_tick_and_ends_in_free_drive(seconds: float, count: int) -> None:
    """FD-9, FD-12."""
    bench = tried(sequence__period=seconds)
    assert remaining(bench.last) == {"sequence": (count, count)}
    for left in range(count - 1, 0, -1):
        bench.step(HOLD)
        assert (bench.last.mode, bench.last.phase, bench.last.law, bench.last.gain) == (Mode.TEACH, Phase.SEQUENCE, Law.FREE, 0.0)
        assert remaining(bench.last) == {"sequence": (left, count)}
    bench.step(HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law, bench.last.gain) == (Mode.FREE_DRIVE, Phase.HELD, Law.FREE, 1.0)
    assert bench.last.monitored == ()
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED, Kind.SEQUENCE_STARTED, Kind.ENTERED]
    assert bench.events[1] == Event(Kind.SEQUENCE_STARTED, 560, {"period": seconds})


@pytest.mark.parametrize("tick", [1, 2, 250, 499])
def test_the_button_let_go_in_it_does_not_abort(tick: int) -> None:
    """FD-8a: and nobody holds it at entry, so that the period runs from there."""
    bench = tried()
    bench.run(tick - 1, HOLD)
    bench.step(LET_GO)
    assert bench.run(499 - tick).phase is Phase.SEQUENCE
    bench.step()
    assert (bench.last.mode, bench.last.phase) == (Mode.FREE_DRIVE, Phase.PERIOD)
    assert remaining(bench.last) == {"free-drive": (1500, 1500)}


def test_pressed_again_in_it_the_button_is_held_at_entry() -> None:
    bench = tried()
    bench.step(LET_GO)
    bench.run(300)
    assert bench.run(199, HOLD).phase is Phase.HELD
    assert bench.step(LET_GO).phase is Phase.PERIOD


@pytest.mark.parametrize("tick", [1, 250, 499, 500])
@pytest.mark.parametrize("name", PARAMETERS)
def test_beyond_a_limit_in_any_tick_refuses_at_once_and_at_it_does_not(name: str, tick: int) -> None:
    """FD-10, FD-11."""
    part, limit, unit, make = PARAMETERS[name]
    value = limit * (1 + 1e-9)
    bench = tried()
    at_limit, beyond = make(limit * (1 - 1e-12)), make(value)
    if name in AVERAGED:
        bench = Bench(sequence__on=True)
        bench.run(60)
        bench.run(500 + tick, HOLD, at_limit)
        bench.supervisor._mean._ring[:] = beyond.F_user
    else:
        bench.run(tick - 1, HOLD, at_limit)
    assert bench.last.phase is Phase.SEQUENCE
    bench.events.clear()
    bench.step(HOLD, beyond)
    assert (bench.last.mode, bench.last.safety, bench.last.phase) == (Mode.TEACH, Safety.NORMAL, Phase.OFF)
    assert bench.last.law is (Law.BRAKE if name == "joint speed" else Law.HOLD)
    assert remaining(bench.last) == {"cool-down": (1000, 1000)}
    told, refused = bench.events
    assert told.kind is Kind.ENTRY_PREVENTED
    assert told.values == {
        "parameter": name,
        "part": part,
        "value": pytest.approx(value),
        "limit": pytest.approx(limit),
        "unit": unit,
        "time": pytest.approx(tick / 500),
    }
    assert refused.kind is (Kind.REFUSED_PAYLOAD if name.startswith("payload") else Kind.REFUSED_LIMIT)
    assert bench.run(1100, HOLD).mode is Mode.TEACH


@pytest.mark.parametrize("name", PARAMETERS)
def test_a_limit_that_is_off_is_not_checked(name: str) -> None:
    _, limit, _, make = PARAMETERS[name]
    key = {"joint external torque": "joint_torque", "payload-like force": "payload_force"}.get(name, name)
    key = {"payload-like torque": "payload_torque"}.get(name, key).replace(" ", "_")
    bench = tried(**{f"limits__activation__{key}__on": False})
    assert name not in [item.name for item in bench.last.monitored]
    assert bench.run(500, HOLD, make(1.5 * limit)).mode is Mode.FREE_DRIVE


def test_every_parameter_that_prevented_entry_is_told() -> None:
    bench = tried()
    bench.step(HOLD, estimate(position=0.003, speed=0.1, qd=0.4, tau_ext=-30.0, acceleration=2.0))
    kinds = [event.kind for event in bench.last.events]
    assert kinds == [Kind.ENTRY_PREVENTED] * 5 + [Kind.REFUSED_LIMIT]
    names = [event.values["parameter"] for event in bench.last.events]
    assert names == [*list(PARAMETERS)[:5], "flange displacement"]


def test_values_and_limits_are_published_while_they_are_checked() -> None:
    bench = tried()
    assert [item.name for item in bench.last.monitored] == list(PARAMETERS)
    bench.step(HOLD, estimate(position=0.001, tau_ext=3.0))
    shown = {item.name: item for item in bench.last.monitored}
    assert astuple(shown["flange displacement"])[1:] == ("flange", pytest.approx(0.001), -math.inf, 0.002, "m")
    assert astuple(shown["joint external torque"])[1:] == ("base", 3.0, -math.inf, 4.0, "N·m")
    assert Bench().run(3).monitored == ()


@pytest.mark.parametrize(("mass", "way"), [(1.8, "down"), (-1.8, "up")])
def test_a_wrong_payload_is_refused_before_the_arm_is_freed_and_named_with_its_doubt(mass: float, way: str) -> None:
    bench = Bench(sequence__on=True)
    value = estimate(force=[0.0, 0.0, -9.81 * mass])
    bench.run(60, NOTHING, value)
    bench.run(501, HOLD, value)
    assert (bench.last.mode, bench.last.law) == (Mode.TEACH, Law.HOLD)
    assert [event.kind for event in bench.last.events] == [Kind.SEQUENCE_STARTED, Kind.ENTRY_PREVENTED, Kind.REFUSED_PAYLOAD]
    values = {"mass": pytest.approx(mass), "force": pytest.approx(17.658), "way": way, "parameter": "payload-like force"}
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
    bench = tried(sequence__protective_stop=True)
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


def test_an_arm_without_flange_sensors_is_judged_by_its_joints() -> None:
    """FD-3a."""
    blind = estimate(wrench_valid=False, acceleration_valid=False)
    bench = Bench(sequence__on=True)
    bench.run(60, NOTHING, blind)
    bench.run(501, HOLD, blind)
    names = [item.name for item in bench.last.monitored]
    assert names == ["flange displacement", "flange speed", "joint speed", "joint external torque"]
    assert bench.run(500, HOLD, blind).mode is Mode.FREE_DRIVE
    assert bench.last.gain == 0.0


@pytest.mark.parametrize(("amplified", "gain"), [(False, 0.0), (True, 1.5)])
def test_the_users_force_is_not_amplified_in_it_unless_asked_for(amplified: bool, gain: float) -> None:
    bench = tried(sequence__amplified=amplified, free_drive__gain=1.5)
    assert bench.last.gain == gain
    assert bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,))).gain == 0.0


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


def test_limits_are_locked_in_it() -> None:
    bench = tried()
    bench.step(Inputs(settings={"limits.activation.user_force.max": 50.0, "free_drive.period": 5.0}))
    assert [event.kind for event in bench.last.events] == [Kind.SETTING_REFUSED, Kind.SETTING_CHANGED]
    assert bench.last.events[0].values["reason"] == "no change of a limit in the activation sequence"


def test_equal_states_decide_equally_in_it() -> None:
    one, other = tried(), tried()
    one.step(HOLD, estimate(position=0.001))
    assert one.supervisor.state != other.supervisor.state
    other.step(HOLD, estimate(position=0.001))
    assert one.supervisor.state == other.supervisor.state
