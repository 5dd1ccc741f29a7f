"""A program that has the arm guided by hand, and one that pushes (CD-15)."""

import msgspec
import pytest

from pendant.events.event import Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.reaction import Until
from pendant.program.steps import AnyStep, ApplyForce, HandGuide, JointMove, LinearMove, Program, ProgramState, SwitchTool
from pendant.tick.modes import Law, Mode, Phase
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench
from tests.pendant.program.test_contact_programs import DOWN, GAINED, NEXT, POSE, done, running

GUIDE, PUSH = HandGuide(), ApplyForce(force=(0.0, 0.0, -10.0))
PERIOD = {"free_drive__period": 0.5}


def guided(*steps: AnyStep, **changes: float | bool) -> Bench:
    """The first step of a program has begun; the arm stands."""
    bench = Bench(**{"activation__period": 0.1, **PERIOD, **changes})
    bench.run(60)
    bench.step(Inputs(program=Program(steps=steps)))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    return bench


def kinds(bench: Bench) -> list[Kind]:
    return [event.kind for event in bench.events]


def test_the_arm_is_given_to_the_hand_and_the_program_goes_on() -> None:
    bench = guided(GUIDE, NEXT)
    bench.run(52)
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.FREE_DRIVE, Phase.PERIOD, Law.FREE)
    assert (bench.last.program, bench.last.step) == (ProgramState.RUNNING, 1)
    bench.run(250)
    assert (bench.last.mode, bench.last.law, bench.last.step) == (Mode.RUN, Law.FOLLOW, 2)
    assert kinds(bench)[-3:] == [Kind.SIGNAL_SEEN, Kind.ENTERED, Kind.LEFT_PERIOD]
    done(bench)
    assert kinds(bench)[-1] is Kind.PROGRAM_FINISHED


def test_it_does_not_go_on_before_the_arm_stands() -> None:
    bench = guided(GUIDE, NEXT, free_drive__period=5.0)
    bench.run(80)
    moving = estimate(qd=0.3)
    bench.step(Inputs(held=frozenset({Button.FREE_DRIVE})), moving)
    bench.step(Inputs(released=frozenset({Button.FREE_DRIVE})), moving)
    assert (bench.last.mode, bench.last.law) == (Mode.RUN, Law.BRAKE)
    bench.run(100, value=moving)
    assert (bench.last.law, bench.last.step) == (Law.BRAKE, 1)
    bench.run(60)
    assert bench.last.step == 2


def test_it_is_not_asked_for_while_the_arm_moves() -> None:
    bench = guided(GUIDE, activation__period=0.0)
    assert bench.last.mode is Mode.RUN  # the law has to come to rest first
    moving = guided(GUIDE)
    moving.run(100, value=estimate(qd=0.3))
    assert Kind.SIGNAL_SEEN not in kinds(moving)[2:]


def test_the_check_is_that_of_free_drive() -> None:
    bench = guided(GUIDE, NEXT, sequence__on=True)
    bench.run(60)
    assert (bench.last.mode, bench.last.phase) == (Mode.RUN, Phase.SEQUENCE)
    bench.run(20, value=estimate(force=60.0))
    assert kinds(bench)[-1] is Kind.PROGRAM_FAILED
    assert bench.events[-1].values["reason"] == "free-drive was not entered"
    assert (bench.last.mode, bench.last.phase, bench.last.program) == (Mode.TEACH, Phase.OFF, ProgramState.STOPPED)


def test_refused_at_once_it_fails_at_once() -> None:
    """FD-9: so short a sequence needs the handshake, so that signal and refusal fall into one tick."""
    bench = guided(GUIDE, activation__period=0.0, sequence__on=True, sequence__period=0.2)
    bench.step()
    assert kinds(bench)[-3:] == [Kind.SIGNAL_SEEN, Kind.REFUSED_SHORT, Kind.PROGRAM_FAILED]
    assert (bench.last.mode, bench.last.program) == (Mode.TEACH, ProgramState.STOPPED)


def test_what_ends_or_forbids_the_program_itself_is_no_refusal() -> None:
    bench = guided(GUIDE, activation__period=0.0)
    bench.events.clear()
    bench.step(value=estimate(joints_valid=False))
    assert Kind.PROGRAM_FAILED not in kinds(bench)
    bench = guided(GUIDE, activation__period=0.0, enabling__on=True)
    assert bench.last.mode is Mode.TEACH  # not started without the device


def test_a_cool_down_is_waited_for() -> None:
    bench = guided(GUIDE, GUIDE, free_drive__cool_down=0.5)
    bench.run(302)
    assert kinds(bench)[-1] is Kind.LEFT_PERIOD
    bench.run(60)
    assert (bench.last.step, bench.last.phase) == (2, Phase.OFF)
    assert kinds(bench)[-1] is Kind.NOT_YET
    bench.run(300)
    assert kinds(bench)[-1] is Kind.ENTERED
    assert bench.last.mode is Mode.FREE_DRIVE


def test_a_short_press_ends_it_and_the_program_goes_on() -> None:
    bench = guided(GUIDE, NEXT, free_drive__period=5.0)
    bench.run(80)
    bench.step(Inputs(held=frozenset({Button.FREE_DRIVE})))
    bench.step(Inputs(released=frozenset({Button.FREE_DRIVE})))
    assert kinds(bench)[-1] is Kind.LEFT_PRESS
    bench.run(60)
    assert (bench.last.mode, bench.last.step) == (Mode.RUN, 2)


def test_after_any_other_ending_somebody_must_look() -> None:
    bench = guided(GUIDE, NEXT, free_drive__period=5.0, limits__operation__tcp_speed__max=0.2)
    bench.run(80)
    bench.run(60, value=estimate(v_tcp=1.4, force=5.0))
    assert Kind.LEFT_LIMIT in kinds(bench)
    assert (bench.last.mode, bench.last.program) == (Mode.RUN, ProgramState.PAUSED)
    bench.run(60)
    bench.step(Inputs(commands=(Command.RESUME_PROGRAM,)))
    bench.run(4000)
    assert kinds(bench)[-1] is Kind.ENTERED or bench.last.step == 2


def test_a_stop_ends_program_and_guiding() -> None:
    bench = guided(GUIDE, NEXT)
    bench.run(60)
    bench.step(Inputs(commands=(Command.EMERGENCY_STOP,)))
    assert (bench.last.mode, bench.last.phase, bench.last.program) == (Mode.STOP, Phase.OFF, ProgramState.STOPPED)


def test_a_pause_in_the_check_refuses_free_drive() -> None:
    bench = guided(GUIDE, NEXT, sequence__on=True)
    bench.run(60)
    assert bench.last.phase is Phase.SEQUENCE
    bench.step(Inputs(commands=(Command.PAUSE_PROGRAM,)))
    assert (bench.last.phase, bench.last.program) == (Phase.OFF, ProgramState.PAUSED)
    assert Kind.PROGRAM_FAILED not in kinds(bench)


def test_a_force_knows_what_was_felt_before_the_touch() -> None:
    until = msgspec.structs.replace(DOWN, until=Until(change="gained"))
    bench, told = running(until, PUSH, SwitchTool(on=True))
    bench.run(60, value=estimate(force=[1.0, 2.0, 3.0]))
    bench.step(NOTHING, estimate(force=[1.0, 2.0, 3.0], qd=0.3))
    told.coming = iter((GAINED,))
    bench.run(60, value=estimate(force=[1.0, 2.0, 43.0]))
    move = bench.last.move
    assert isinstance(move, ApplyForce)
    assert (bench.last.law, move.force) == (Law.FOLLOW, PUSH.force)
    assert move.untouched == pytest.approx((0.0, 0.0, 0.0))  # the mean when the line began: nothing was felt then
    done(bench)
    assert bench.last.tool_on is False
    bench.step()
    assert bench.last.tool_on is True


@pytest.mark.parametrize("force", [0.0, 25.0])
def test_a_force_at_the_start_counts_from_what_is_felt_there(force: float) -> None:
    bench = Bench()
    bench.run(60, value=estimate(force=[0.0, force, 0.0]))
    bench.step(Inputs(program=Program(steps=(PUSH,))), estimate(force=[0.0, force, 0.0]))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)), estimate(force=[0.0, force, 0.0]))
    move = bench.last.move
    assert isinstance(move, ApplyForce)
    assert move.untouched == pytest.approx((0.0, force, 0.0))


def test_a_line_that_begins_later_counts_from_what_is_felt_then() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(Inputs(program=Program(steps=(JointMove(q=POSE.q), LinearMove(**msgspec.structs.asdict(DOWN)), PUSH))))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.run(60, value=estimate(force=4.0))
    done(bench)
    bench.step(value=estimate(force=4.0))
    done(bench)
    move = bench.last.move
    assert isinstance(move, ApplyForce)
    assert move.untouched[0] == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize(("force", "size"), [((0.0, 0.5, 0.0), "0.5"), ((80.0, 80.0, 0.0), "113.1")])
def test_a_force_too_small_or_too_large_is_refused(force: tuple[float, float, float], size: str) -> None:
    with pytest.raises(msgspec.ValidationError, match=rf"force: its size is {size}, allowed: 1 \.\. 90 N"):
        msgspec.convert({"kind": "force", "force": force}, AnyStep)
