"""The supervisor: numbers in its events, settings at run time, programs, one decision a tick."""

import pickle
from collections.abc import Callable

import pytest

from pendant.all_settings import Settings, apply, describe, value_of
from pendant.events.event import Event, Kind, Values
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import JointMove, Program, ProgramState, Wait
from pendant.settings.schema import SettingRow, Value
from pendant.supervisor import Supervisor
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.motion_status import MotionStatus
from pendant.walls.definitions import Start, Wall
from pendant.walls.shapes import Sphere
from tests.items import each_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, JOINTS, LET_GO, Bench
from tests.pendant.oracle import PROGRAM, WRONG
from tests.pendant.test_all_settings import other

START = Bench().supervisor.settings
LOCKED = [row for row in describe() if row.locked]
UNLOCKED = [row for row in describe() if not row.locked]


def command(*commands: Command) -> Inputs:
    return Inputs(commands=commands)


def another(row: SettingRow) -> Value:
    """A value that is allowed and not the present one."""
    if row.choices:
        return next(choice for choice in row.choices if choice != value_of(START, row.name))
    return not value_of(START, row.name) if row.low is None else other(row)


def change(row: SettingRow) -> Inputs:
    return Inputs(settings={row.name: another(row)})


def running(program: Program = PROGRAM, **changes: float | bool) -> Bench:
    bench = Bench(**changes)
    bench.run(60)
    bench.step(Inputs(program=program))
    bench.step(command(Command.START_PROGRAM))
    assert (bench.last.mode, bench.last.law, bench.last.program) == (Mode.RUN, Law.FOLLOW, ProgramState.RUNNING)
    return bench


def test_it_starts_in_teach_holding() -> None:
    decision = Supervisor(Settings(), 6).step(estimate(), NOTHING)
    assert (decision.mode, decision.safety, decision.law) == (Mode.TEACH, Safety.NORMAL, Law.HOLD)
    assert (decision.move, decision.gain, decision.baseline) == (None, 0.0, (0.0,) * 6)
    assert (decision.periods, decision.events, decision.program, decision.step) == ((), (), ProgramState.NONE, 0)


def test_an_idle_tick_gives_the_same_decision_again() -> None:
    bench = Bench()
    first = bench.run(60)
    assert bench.step() == first
    assert bench.step(command(Command.NORMAL)).events
    quiet = bench.step()
    assert quiet != first
    assert quiet.events == ()
    assert bench.step() == quiet


def test_decisions_do_not_change() -> None:
    decision = Bench().step()
    with pytest.raises(AttributeError, match="immutable"):
        decision.mode = Mode.RUN  # type: ignore[misc]
    event = Event(Kind.RESET, 0)
    with pytest.raises(AttributeError):
        event.tick = 3  # type: ignore[misc]


def test_emergency_stop_and_reset() -> None:
    bench = Bench().entered()
    bench.step(command(Command.EMERGENCY_STOP), estimate(qd=0.4))
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.EMERGENCY_STOP, Law.BRAKE)
    assert bench.last.events == (Event(Kind.EMERGENCY_STOP, bench.tick, {"mode": Mode.FREE_DRIVE}),)
    assert bench.step(command(Command.EMERGENCY_STOP)).events == ()
    assert bench.step(command(Command.RESET)).events == (Event(Kind.RESET_REFUSED_SIGNAL, bench.tick, {}),)
    bench.step(LET_GO)
    bench.step(command(Command.RESET))
    values = {"joint": "base", "value": 0.4, "limit": 0.01, "time": 0.1}
    assert bench.last.events == (Event(Kind.RESET_REFUSED_MOVING, bench.tick, values),)
    bench.run(60)
    bench.step(command(Command.RESET), estimate(joints_valid=False))
    assert bench.last.events == (Event(Kind.RESET_REFUSED_SENSORS, bench.tick, {"sensor": "joint encoders and motor currents"}),)
    bench.run(60)
    assert bench.last.law is Law.OFF
    bench.step(command(Command.RESET))
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.TEACH, Safety.NORMAL, Law.HOLD)
    assert bench.last.events == (Event(Kind.RESET, bench.tick, {}),)


def test_free_drive_from_a_paused_program_returns_to_it_paused() -> None:
    """FD-1."""
    bench = running(free_drive__allowed_from__run=True)
    bench.run(3)
    bench.step(command(Command.PAUSE_PROGRAM))
    bench.run(501, HOLD)
    assert bench.last.mode is Mode.FREE_DRIVE
    assert bench.last.program is ProgramState.PAUSED
    bench.step(LET_GO)
    bench.run(1500)
    assert (bench.last.mode, bench.last.program, bench.last.law, bench.last.step) == (Mode.RUN, ProgramState.PAUSED, Law.HOLD, 1)
    bench.run(2000)
    assert bench.last.program is ProgramState.PAUSED
    bench.step(command(Command.RESUME_PROGRAM))
    assert (bench.last.law, bench.last.program) == (Law.FOLLOW, ProgramState.RUNNING)
    assert bench.last.move is not None
    assert bench.last.move.id == 2
    assert bench.last.events == (Event(Kind.PROGRAM_RESUMED, bench.tick, {"name": "two moves", "step": 1}),)


def test_free_drive_from_a_running_program_pauses_it() -> None:
    bench = running(Program(name="rest", steps=(Wait(duration=60.0),)), free_drive__allowed_from__run=True)
    bench.run(501, HOLD)
    kinds = [event.kind for event in bench.last.events]
    assert kinds == [Kind.ENTERED, Kind.PROGRAM_PAUSED]
    assert (bench.last.mode, bench.last.program, bench.last.move) == (Mode.FREE_DRIVE, ProgramState.PAUSED, None)


def test_a_program_runs_to_its_end_and_returns_to_where_it_was_started() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(command(Command.NORMAL))
    bench.step(Inputs(program=PROGRAM))
    assert bench.last.events == (Event(Kind.PROGRAM_LOADED, bench.tick, {"name": "two moves", "steps": 2}),)
    assert bench.supervisor.program is PROGRAM
    bench.step(command(Command.START_PROGRAM))
    assert bench.last.events == (Event(Kind.PROGRAM_STARTED, bench.tick, {"name": "two moves"}),)
    for number in (1, 2):
        assert isinstance(bench.last.move, JointMove)
        assert (bench.last.move.id, bench.last.step) == (number, number)
        bench.run(5, status=MotionStatus(number - 1))
        bench.step(status=MotionStatus(number))
    assert (bench.last.mode, bench.last.law, bench.last.move, bench.last.step) == (Mode.NORMAL, Law.HOLD, None, 0)
    assert bench.last.events == (Event(Kind.PROGRAM_FINISHED, bench.tick, {"name": "two moves"}),)


def test_a_wait_begins_with_the_tick_after_its_start() -> None:
    bench = running(Program(steps=(Wait(duration=0.02),)))
    for _ in range(10):
        assert bench.last.mode is Mode.RUN
        bench.step()
    assert bench.last.mode is not Mode.RUN


def test_a_motion_that_is_paused_or_stopped_is_braked_until_static() -> None:
    for stop, mode in ((Command.PAUSE_PROGRAM, Mode.RUN), (Command.STOP_PROGRAM, Mode.TEACH)):
        bench = running()
        moving = estimate(qd=0.7)
        bench.run(5, NOTHING, moving)
        bench.step(command(stop), moving)
        assert (bench.last.mode, bench.last.law, bench.last.move) == (mode, Law.BRAKE, None)
        assert bench.last.events[0].values == {"name": "two moves", "step": 1}
        bench.step(command(Command.RESUME_PROGRAM if mode is Mode.RUN else Command.START_PROGRAM), moving)
        assert bench.last.events[0].values["reason"] == "the arm still moves"
        assert bench.run(49).law is Law.BRAKE
        assert bench.step().law is Law.HOLD


def test_a_move_that_is_not_possible_ends_the_program_and_says_why() -> None:
    bench = running()
    bench.step(status=MotionStatus(1))
    bench.step(NOTHING, estimate(qd=0.2), MotionStatus(1, "beyond the reach"))
    assert (bench.last.mode, bench.last.law, bench.last.program) == (Mode.TEACH, Law.BRAKE, ProgramState.STOPPED)
    values = {"name": "two moves", "step": 2, "reason": "beyond the reach"}
    assert bench.last.events == (Event(Kind.PROGRAM_FAILED, bench.tick, values),)


def test_sensors_lost_in_run_are_a_protective_stop_that_ends_the_program() -> None:
    bench = running()
    bench.step(NOTHING, estimate(joints_valid=False))
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.OFF)
    assert (bench.last.program, bench.last.move) == (ProgramState.STOPPED, None)
    bench.run(60)
    bench.step(command(Command.RESET))
    assert (bench.last.mode, bench.last.safety) == (Mode.TEACH, Safety.NORMAL)


def test_an_emergency_stop_in_a_protective_stop_is_the_greater_one() -> None:
    bench = running()
    bench.step(NOTHING, estimate(joints_valid=False))
    assert bench.step(command(Command.EMERGENCY_STOP)).safety is Safety.EMERGENCY_STOP


@pytest.mark.parametrize(
    ("build", "refused", "reason"),
    [
        (Bench, Command.START_PROGRAM, "no program is loaded"),
        (Bench, Command.PAUSE_PROGRAM, "no program is running"),
        (Bench, Command.RESUME_PROGRAM, "no program is running"),
        (Bench, Command.STOP_PROGRAM, "no program is running"),
        (Bench, Command.RESET, "nothing to reset"),
        (Bench, Command.RESTART_PERIOD, "no period of free-drive runs"),
        (lambda: Bench(free_drive__signal_renews=False), Command.RESTART_PERIOD, "periods are not started again here"),
        (running, Command.START_PROGRAM, "stop the program first"),
        (running, Command.RESUME_PROGRAM, "it is running already"),
        (running, Command.NORMAL, "stop the program first"),
        (lambda: Bench().entered(), Command.TEACH, "leave free-drive first"),
        (lambda: Bench().entered(), Command.START_PROGRAM, "leave free-drive first"),
    ],
)
def test_a_command_that_is_not_possible_says_why(build: Callable[[], Bench], refused: Command, reason: str) -> None:
    bench = build()
    mode = bench.step(HOLD if bench.tick > 500 else NOTHING).mode
    bench.step(command(refused))
    assert bench.last.mode is mode
    assert bench.last.events == (Event(Kind.COMMAND_REFUSED, bench.tick, {"command": refused, "mode": mode, "reason": reason}),)


def test_more_commands_that_are_not_possible() -> None:
    bench = running()
    bench.step(command(Command.PAUSE_PROGRAM))
    bench.step(command(Command.PAUSE_PROGRAM))
    assert bench.last.events[0].values["reason"] == "it is paused already"
    bench.step(command(Command.RESUME_PROGRAM), estimate(joints_valid=False))
    assert bench.last.events[0].values["reason"] == "check joint encoders and motor currents"
    bench.step(command(Command.STOP_PROGRAM))
    bench.step(command(Command.REMOTE))
    bench.step(command(Command.START_PROGRAM))
    assert bench.last.events[0].values["reason"] == "switch to NORMAL or TEACH first"
    bench.step(command(Command.EMERGENCY_STOP))
    bench.step(command(Command.START_PROGRAM, Command.NORMAL))
    assert [event.values["reason"] for event in bench.last.events] == ["reset first", "reset first"]
    bench.run(60)
    bench.step(command(Command.RESET, Command.EMERGENCY_STOP))
    reason = "the emergency stop was pressed at the same time"
    assert bench.last.events[0].values == {"command": Command.RESET, "mode": Mode.STOP, "reason": reason}
    assert bench.last.mode is Mode.STOP


def test_switching_modes() -> None:
    bench = Bench()
    for name, before in (("NORMAL", "TEACH"), ("REMOTE", "NORMAL"), ("TEACH", "REMOTE")):
        bench.step(command(Command(name.lower())))
        assert bench.last.mode.value == name
        assert bench.last.events == (Event(Kind.MODE_CHANGED, bench.tick, {"from": before, "to": name}),)
        assert bench.step(command(Command(name.lower()))).events == ()


def test_programs_that_cannot_be_loaded() -> None:
    bench = Bench()
    bench.step(Inputs(program=WRONG))
    values: Values = {"name": "five joints", "reason": "step 1 has 5 joint angles, the arm has 6 joints"}
    assert bench.last.events == (Event(Kind.PROGRAM_REFUSED, bench.tick, values),)
    assert bench.supervisor.program is None
    bench = running()
    bench.step(Inputs(program=PROGRAM))
    assert bench.last.events[0].values == {"name": "two moves", "reason": "stop the program first"}


def activating() -> Bench:
    bench = Bench(activation__period=5.0, hold__silence=1.0)
    bench.run(60)
    bench.run(10, HOLD)
    return bench


@pytest.mark.parametrize(
    ("make", "mode", "where"),
    [
        (lambda: Bench().in_period(), Mode.FREE_DRIVE, Mode.FREE_DRIVE),
        (running, Mode.RUN, Mode.RUN),
        (activating, Mode.TEACH, "the activation of free-drive"),
    ],
)
def test_limits_are_locked_in_free_drive_and_run_and_from_the_signal_on(
    make: Callable[[], Bench], mode: Mode, where: str
) -> None:
    """A hand that is on the arm would be forgotten where its source is switched off under it (FD-8a)."""
    bench = make()
    before = bench.supervisor.settings
    for row in LOCKED:
        value = another(row)
        bench.step(change(row))
        values: Values = {"name": row.name, "value": value, "reason": f"no change of a limit in {where}"}
        assert (bench.last.mode, bench.last.events) == (mode, (Event(Kind.SETTING_REFUSED, bench.tick, values),))
        assert bench.supervisor.settings == before


@each_of(UNLOCKED, lambda row: row.name)
def test_what_is_no_limit_changes_in_free_drive_and_run(row: SettingRow) -> None:
    for bench, mode in ((Bench().entered(), Mode.FREE_DRIVE), (running(), Mode.RUN)):
        before = bench.supervisor.settings
        bench.step(change(row))
        assert (bench.last.mode, bench.last.events[0].kind) == (mode, Kind.SETTING_CHANGED)
        assert bench.supervisor.settings == apply(before, {row.name: another(row)})


@each_of([*LOCKED, *UNLOCKED], lambda row: row.name)
def test_each_setting_changes_while_the_arm_is_held(row: SettingRow) -> None:
    bench, value = Bench(), another(row)
    bench.step(change(row))
    values: Values = {"name": row.name, "old": value_of(START, row.name), "new": value}
    assert bench.last.events == (Event(Kind.SETTING_CHANGED, bench.tick, values),)
    assert bench.supervisor.settings == apply(START, {row.name: value})
    assert bench.step(change(row)).events == ()


def test_where_nothing_is_free_there_is_nothing_to_leave() -> None:
    bench = Bench()
    assert bench.step(command(Command.LEAVE_FREE_DRIVE)).events == ()
    assert (bench.last.mode, bench.last.phase) == (Mode.TEACH, Phase.OFF)


def test_changed_settings_act_from_the_next_tick() -> None:
    bench = Bench()
    bench.step(Inputs(settings={"hold.silence": 0.1, "static.time": 0.5, "static.speed": 0.05}))
    bench.run(249, NOTHING, estimate(qd=0.04))
    bench.step(HOLD, estimate(qd=0.04))
    bench.run(50, NOTHING, estimate(qd=0.04))
    assert bench.last.phase.value == "ACTIVATION"
    bench.step(NOTHING, estimate(qd=0.04))
    assert bench.last.events[0].values == {"value": pytest.approx(0.102), "limit": pytest.approx(0.1)}
    bench.step(Inputs(program=PROGRAM), estimate(qd=0.04))
    assert bench.step(command(Command.START_PROGRAM), estimate(qd=0.04)).mode is Mode.RUN


def test_bad_settings_are_refused_one_by_one() -> None:
    bench, sections = Bench(), dict.fromkeys(row.name.split(".")[0] for row in describe())
    bench.step(Inputs(settings={"free_drive.period": 99.0, "fence.on": True, "free_drive.gain": 2}))
    assert [event.kind for event in bench.last.events] == [Kind.SETTING_REFUSED, Kind.SETTING_REFUSED, Kind.SETTING_CHANGED]
    assert bench.last.events[0].values["reason"] == "a number from 0.5 to 30 s"
    assert bench.last.events[1].values["reason"] == f"no such section; there are {', '.join(sections)}"
    assert bench.supervisor.settings == apply(START, {"free_drive.gain": 2.0})


def test_a_running_period_keeps_its_length_and_the_next_one_is_the_new() -> None:
    bench = Bench().in_period()
    bench.step(Inputs(settings={"free_drive.period": 10.0}))
    assert bench.run(1498).mode is Mode.FREE_DRIVE
    assert bench.step().mode is Mode.TEACH


def test_a_wall_that_holds_before_free_drive_is_not_felt() -> None:
    """HF-1, VW-6: one that is anchored as the button is pressed, while the arm is still held."""
    bench = Bench(haptics__on=True)
    early = Wall(name="early", shape=Sphere(radius=0.1), anchored_at=Start.ACTIVATION, activation_size=0.3, band=0.01)
    bench.supervisor = Supervisor(bench.supervisor.settings, 6, joints=JOINTS, borders=(early,))
    bench.step(HOLD)
    decision = bench.step(HOLD, estimate(position=0.029))
    assert (decision.phase, decision.law, decision.walls[0].near > 0.0) == (Phase.ACTIVATION, Law.HOLD, True)
    assert decision.shake is None


@pytest.mark.parametrize("pauses", [True, False])
def test_a_push_that_is_told_pauses_the_program_and_other_commands_of_its_tick_count(pauses: bool) -> None:
    """FD-6a: told in the tick in which it pauses, before what follows from it, with everything else of that tick."""
    bench = running(
        Program(name="rest", steps=(Wait(duration=60.0),)), signals__push__reported=True, signals__push__pauses=pauses
    )
    bench.run(120)
    bench.events.clear()
    inputs = Inputs(commands=(Command.NORMAL,), settings={"free_drive.cool_down": 3.0})
    while not any(event.kind is Kind.PUSHED for event in bench.events):
        bench.events.clear()
        bench.step(inputs, estimate(force=40.0))
        assert bench.tick < 400
    kinds = [event.kind for event in bench.last.events]
    paused = [Kind.PROGRAM_PAUSED] if pauses else []
    assert kinds == [Kind.PUSHED, Kind.COMMAND_REFUSED, *paused, Kind.SETTING_REFUSED]
    assert bench.last.program is (ProgramState.PAUSED if pauses else ProgramState.RUNNING)


def test_joints_without_names_are_counted_from_the_base() -> None:
    supervisor = Supervisor(Settings(), 6)
    supervisor.step(estimate(), NOTHING)
    (event,) = supervisor.step(estimate(1, qd=[0.0] * 5 + [7.0]), NOTHING).events
    assert (event.kind, event.values["part"]) == (Kind.LIMIT_EXCEEDED, "joint 6")


def test_equal_states_decide_equally() -> None:
    one, other = Bench(), Bench()
    for bench in (one, other):
        bench.run(60)
        bench.run(300, HOLD, estimate(force=2.0))
    assert one.supervisor.state == other.supervisor.state
    copy = pickle.loads(pickle.dumps(one.supervisor.state))
    one.step(HOLD)
    assert one.supervisor.state != other.supervisor.state
    assert other.supervisor.state == copy
    other.step(HOLD)
    assert one.supervisor.state == other.supervisor.state
