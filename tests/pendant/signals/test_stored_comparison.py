"""How short the activation sequence may be, and its comparison with a stored state (FD-9)."""

import math
from collections.abc import Callable

import pytest

from pendant.decision import Decision
from pendant.event_table import render
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import Program, Wait
from pendant.signals.stored_baseline import Stored
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase
from pendant.tick.state import state_of
from pendant.tooling.tool_in_use import Load
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_sequence import PARAMETERS
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench, remaining
from tests.pendant.tooling.test_tool_in_use import Robot

SHORT: dict[str, float | bool] = {
    "sequence__on": True,
    "sequence__stored": True,
    "sequence__age": 0.5,
    "activation__period": 0.04,
    "free_drive__cool_down": 0.2,
}


def bench(untouched: int = 300, value: Estimate | None = None, **changes: float | bool) -> Bench:
    """Untouched for so many ticks, then the button is held for the activation period of 20: the sequence begins next."""
    made = Bench(**{**SHORT, **changes})
    value = value or estimate()
    made.run(untouched, NOTHING, value)
    made.run(20, HOLD, value)
    assert made.last.phase is Phase.ACTIVATION
    return made


BELOW = (0.0, 0.002, 0.1, 0.248, 0.2499, math.nextafter(0.25, 0.0))
"""Periods that need more than rest [s]."""


@pytest.mark.parametrize("period", [*BELOW, 0.25, math.nextafter(0.25, 1.0), 0.2501, 0.252, 1.0])
def test_a_short_sequence_needs_the_handshake_or_a_stored_state(period: float) -> None:
    bare = bench(sequence__stored=False, sequence__period=period)
    bare.step(HOLD)
    if period not in BELOW:
        assert bare.last.phase is Phase.SEQUENCE
        return
    assert bare.last.events == (Event(Kind.REFUSED_SHORT, bare.tick, {"value": period, "limit": 0.25}),)
    assert (bare.last.mode, bare.last.law, bare.last.phase) == (Mode.TEACH, Law.HOLD, Phase.OFF)
    assert remaining(bare.last) == {"cool-down": (100, 100)}


def test_its_refusal_says_what_is_allowed() -> None:
    bare = bench(sequence__stored=False, sequence__period=0.1)
    headline, guidance = render(bare.step(HOLD).events[0])
    assert headline == "Free-drive refused: the check is too short"
    assert guidance == "0.100 s; below 0.25 s only with the handshake or a stored state."


def ends(made: Bench, period: float) -> None:
    """The sequence starts in the next tick, lasts its period to the tick and ends in free-drive."""
    count = round(period * 500)
    decision = made.step(HOLD)
    kinds = [event.kind for event in decision.events]
    if count == 0:
        assert kinds == [Kind.SEQUENCE_STARTED, Kind.ENTERED]
    else:
        assert kinds == [Kind.SEQUENCE_STARTED]
        assert (decision.phase, remaining(decision)) == (Phase.SEQUENCE, {"sequence": (count, count)})
        made.run(count - 1, HOLD)
        assert made.last.phase is Phase.SEQUENCE
        made.step(HOLD)
        assert [event.kind for event in made.last.events] == [Kind.ENTERED]
    assert (made.last.mode, made.last.law) == (Mode.FREE_DRIVE, Law.FREE)


@pytest.mark.parametrize("period", [*BELOW, 0.25, 0.5, 5.0])
def test_with_a_stored_state_it_lasts_its_period_to_the_tick(period: float) -> None:
    ends(bench(sequence__period=period), period)


@pytest.mark.parametrize("period", BELOW)
def test_with_the_handshake_it_lasts_its_period_to_the_tick(period: float) -> None:
    made = Bench(sequence__on=True, sequence__period=period, handshake__on=True, activation__period=0.04)
    made.run(60)
    made.run(21, HOLD)
    assert made.last.events[-1].kind is Kind.CONFIRM_ASKED
    made.step(LET_GO)
    made.run(260)
    made.run(100, HOLD)
    assert made.last.phase is Phase.CONFIRM
    ends(made, period)


def test_a_handshake_switched_on_too_late_is_none() -> None:
    """An attempt that began without it ends without it: limits are locked from the signal on."""
    made = Bench(**{**SHORT, "sequence__stored": False, "sequence__period": 0.1})
    made.run(60)
    made.run(19, HOLD)
    made.step(Inputs(held=HOLD.held, settings={"handshake.on": True}))
    assert [event.kind for event in made.last.events] == [Kind.SETTING_REFUSED]
    made.step(HOLD)
    assert not made.supervisor.settings.handshake.on
    assert made.last.events[-1].kind is Kind.REFUSED_SHORT


@pytest.mark.parametrize(
    ("untouched", "age", "there"),
    [
        (229, 0.5, False),
        (230, 0.5, True),
        (230, 0.502, False),
        (231, 0.502, True),
        (300, 0.64, True),
        (300, 0.642, False),
        (979, 2.0, False),
        (980, 2.0, True),
        (7479, 15.0, False),
        (7480, 15.0, True),
    ],
)
def test_a_state_must_have_been_stored_for_so_long(untouched: int, age: float, there: bool) -> None:
    """The first is stored in tick 0, the sequence begins in tick `untouched` + 20."""
    made = bench(untouched, sequence__age=age)
    made.step(HOLD)
    if there:
        assert made.last.phase is Phase.SEQUENCE
    else:
        assert made.last.events == (Event(Kind.REFUSED_NOT_STORED, made.tick, {"age": age}),)
        assert (made.last.mode, made.last.law) == (Mode.TEACH, Law.HOLD)


COMPARED = {name: PARAMETERS[name] for name in PARAMETERS if name not in ("flange speed", "flange acceleration", "joint speed")}
OFFSET: dict[str, Callable[[float], Estimate]] = {
    "flange displacement": lambda value: estimate(position=[value, 0.0, 0.0]),
    "joint external torque": lambda value: estimate(tau_ext=[0.0, 0.0, value, 0.0, 0.0, 0.0]),
    "payload-like force": lambda value: estimate(force=[0.0, 0.0, value]),
    "payload-like torque": lambda value: estimate(torque=[0.0, value, 0.0]),
    "user force": lambda value: estimate(force=[0.0, -value, 0.0]),
    "user torque": lambda value: estimate(torque=[0.0, 0.0, -value]),
}
DENSE = (0.9, 1 - 1e-9, 1 + 1e-9, 1.1)
"""Shares of a limit."""


@pytest.mark.parametrize("share", DENSE)
@pytest.mark.parametrize("name", COMPARED)
def test_a_change_since_it_was_stored_is_a_parameter_with_the_same_limit(name: str, share: float) -> None:
    """Half of the change one way when it was stored, half the other way now: neither is beyond a limit by itself."""
    part, limit, unit, _ = COMPARED[name]
    make, half = OFFSET[name], share * limit / 2
    made = Bench(**SHORT, let_go__on=False)
    made.run(300, NOTHING, make(-half))
    made.run(80, NOTHING, make(half))
    made.run(21, HOLD, make(half))
    if share < 1:
        assert made.last.phase is Phase.SEQUENCE
        return
    told, refused = made.last.events[-2:]
    values = {"parameter": f"{name}, against stored", "part": part, "value": pytest.approx(share * limit), "unit": unit}
    assert refused == Event(Kind.REFUSED_LIMIT, made.tick, {**values, "limit": limit})
    assert told == Event(Kind.ENTRY_PREVENTED, made.tick, {**values, "limit": limit, "time": 0.0})


@pytest.mark.parametrize("share", DENSE)
def test_a_joint_that_has_moved_since_is_told_where_it_is_checked(share: float) -> None:
    made = Bench(**SHORT, limits__activation__joint_displacement__on=True)
    made.run(300, NOTHING, estimate(q=[0.0, 0.0, 0.5, 0.0, 0.0, 0.0]))
    made.run(21, HOLD, estimate(q=[0.0, 0.0, 0.5 - 0.01 * share, 0.0, 0.0, 0.0]))
    if share < 1:
        assert made.last.phase is Phase.SEQUENCE
    else:
        assert made.last.events[-1].values["parameter"] == "joint displacement, against stored"
        assert made.last.events[-1].values["part"] == "elbow"


def test_what_was_wrong_before_is_still_found() -> None:
    """A payload that is 1.8 kg off all the time has not changed, and is refused for what it is."""
    value = estimate(force=[0.0, 0.0, -17.658])
    made = bench(value=value, sequence__period=0.0)
    made.step(HOLD, value)
    assert [event.kind for event in made.last.events] == [Kind.SEQUENCE_STARTED, Kind.ENTRY_PREVENTED, Kind.REFUSED_PAYLOAD]
    assert made.last.law is Law.HOLD


def test_a_change_in_any_tick_of_it_refuses() -> None:
    made = bench(value=estimate(tau_ext=-2.0), sequence__period=0.1)
    made.run(50, HOLD, estimate(tau_ext=1.9))
    assert made.last.phase is Phase.SEQUENCE
    made.step(HOLD, estimate(tau_ext=2.1))
    assert made.last.events[-1].values["parameter"] == "joint external torque, against stored"
    assert made.last.law is Law.HOLD


def test_values_are_published_and_states_compared_while_it_runs() -> None:
    one, other = bench(), bench()
    names = [item.name for item in one.step(HOLD).monitored]
    other.step(HOLD)
    assert names == [*PARAMETERS, *[f"{name}, against stored" for name in COMPARED]]
    one.step(HOLD, estimate(position=0.001))
    assert one.supervisor.state != other.supervisor.state
    other.step(HOLD, estimate(position=0.001))
    assert one.supervisor.state == other.supervisor.state


def test_without_a_flange_sensor_the_joints_are_compared() -> None:
    """FD-3a."""
    blind = estimate(wrench_valid=False, acceleration_valid=False)
    made = bench(value=blind)
    made.step(HOLD, blind)
    names = [item.name for item in made.last.monitored if "stored" in item.name]
    assert names == ["flange displacement, against stored", "joint external torque, against stored"]


def test_a_sensor_that_came_since_leaves_nothing_to_compare_with() -> None:
    """FD-12."""
    made = bench(value=estimate(wrench_valid=False))
    made.step(HOLD)
    assert made.last.events[-1].kind is Kind.REFUSED_NOT_STORED


def test_joints_that_were_out_make_it_begin_anew() -> None:
    made = Bench(**SHORT)
    made.run(300)
    made.run(25, NOTHING, estimate(joints_valid=False))
    made.run(229)
    made.run(21, HOLD)
    assert made.last.events[-1].kind is Kind.REFUSED_NOT_STORED
    made.step(LET_GO)
    made.run(100)
    assert made.run(21, HOLD).phase is Phase.SEQUENCE


def test_free_drive_makes_it_begin_anew() -> None:
    """The arm is elsewhere then."""
    made = bench(sequence__period=0.0)
    assert made.step(HOLD).mode is Mode.FREE_DRIVE
    made.step(LET_GO)
    made.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)))
    made.run(200)
    made.run(21, HOLD)
    assert made.last.events[-1].kind is Kind.REFUSED_NOT_STORED
    made.step(LET_GO)
    made.run(130)
    assert made.run(21, HOLD).mode is Mode.FREE_DRIVE


@pytest.mark.parametrize(("speed", "there"), [(0.0, True), (0.009, True), (0.01, False), (0.3, False)])
def test_a_program_that_moves_the_arm_makes_it_begin_anew(speed: float, there: bool) -> None:
    made = Bench(**SHORT, free_drive__allowed_from__run=True)
    made.run(300)
    made.step(Inputs(program=Program(name="rest", steps=(Wait(duration=60.0),))))
    made.step(Inputs(commands=(Command.START_PROGRAM,)))
    made.run(3, NOTHING, estimate(qd=speed))
    made.run(60)
    made.run(21, HOLD)
    assert (made.last.phase is Phase.SEQUENCE) is there
    assert there or made.last.events[-1].kind is Kind.REFUSED_NOT_STORED


def test_another_payload_makes_it_begin_anew() -> None:
    robot = Robot(**SHORT)
    robot.run(300)
    robot.step(Inputs(load=Load(mass=1.0)))
    robot.run(200)
    robot.run(21, HOLD)
    assert Kind.REFUSED_NOT_STORED in robot.kinds()


def test_switched_off_nothing_is_stored() -> None:
    made = Bench(sequence__on=True)
    made.run(30)
    assert state_of(made.supervisor._free._activation._stored) == state_of(Stored())


def test_a_decision_of_a_sequence_without_length_is_that_of_free_drive() -> None:
    decision: Decision = bench(sequence__period=0.0).step(HOLD)
    assert (decision.phase, decision.gain, decision.monitored) == (Phase.HELD, 1.0, ())
