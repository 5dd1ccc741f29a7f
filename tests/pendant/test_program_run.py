"""A program in its modes: which commands are refused and why, what stops or pauses it, what it switches (FD-1, FD-12, CD-15)."""

import pytest

from pendant.equipment.load import Load
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import Program, ProgramState, SwitchTool, Wait
from pendant.signals.enabling_device import Grip
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, Bench

START, PAUSE = Command.START_PROGRAM, Command.PAUSE_PROGRAM
RESUME, STOP = Command.RESUME_PROGRAM, Command.STOP_PROGRAM
LOADED = Inputs(program=Program(name="rest", steps=(Wait(duration=60.0),)))


def resting(inputs: Inputs = NOTHING, *commands: Command) -> Bench:
    """After inputs, and commands that are possible."""
    bench = Bench(sequence__on=True, activation__period=0.0, free_drive__allowed_from__run=True)
    bench.run(60)
    bench.step(inputs)
    for command in commands:
        bench.step(Inputs(commands=(command,)))
        bench.run(60)
    bench.events.clear()
    return bench


@pytest.mark.parametrize(
    ("inputs", "before", "command", "value", "reason"),
    [
        (NOTHING, (), START, estimate(), "no program is loaded"),
        (LOADED, (), PAUSE, estimate(), "no program is running"),
        (LOADED, (), RESUME, estimate(), "no program is running"),
        (LOADED, (START, STOP), STOP, estimate(), "no program is running"),
        (LOADED, (START,), RESUME, estimate(), "it is running already"),
        (LOADED, (START, PAUSE), PAUSE, estimate(), "it is paused already"),
        (LOADED, (), START, estimate(qd=0.2), "the arm still moves"),
        (LOADED, (START, PAUSE), RESUME, estimate(qd=0.2), "the arm still moves"),
    ],
)
def test_in_this_state_it_is_refused(
    inputs: Inputs, before: tuple[Command, ...], command: Command, value: Estimate, reason: str
) -> None:
    bench = resting(inputs, *before)
    mode = bench.last.mode
    bench.step(Inputs(commands=(command,)), value)
    values = {"command": command, "mode": mode, "reason": reason}
    assert bench.events == [Event(Kind.COMMAND_REFUSED, bench.tick, values)]


@pytest.mark.parametrize(("before", "command", "mode"), [((), START, Mode.TEACH), ((START,), RESUME, Mode.RUN)])
def test_while_free_drive_is_tried_no_program_moves_the_arm(before: tuple[Command, ...], command: Command, mode: Mode) -> None:
    bench = resting(LOADED, *before)
    assert bench.step(HOLD).phase is Phase.SEQUENCE
    bench.events.clear()
    assert bench.step(Inputs(commands=(command,))).phase is Phase.SEQUENCE
    values = {"command": command, "mode": mode, "reason": "free-drive is being tried"}
    assert bench.events == [Event(Kind.COMMAND_REFUSED, bench.tick, values)]


def test_while_the_payload_is_changed_no_program_begins() -> None:
    """The arm would be moved with a load that is none yet."""
    bench = resting(LOADED)
    bench.step(Inputs(load=Load(mass=2.0)))
    bench.events.clear()
    bench.step(Inputs(commands=(START,)))
    values = {"command": START, "mode": Mode.TEACH, "reason": "the payload is being changed"}
    assert bench.events == [Event(Kind.COMMAND_REFUSED, bench.tick, values)]


@pytest.mark.parametrize("phase", [Phase.OFF, Phase.ACTIVATION])
def test_without_joint_values_it_stops_and_what_free_drive_has_begun_ends(phase: Phase) -> None:
    """FD-12."""
    bench = Bench(free_drive__allowed_from__run=True)
    bench.run(60)
    bench.step(LOADED)
    bench.step(Inputs(commands=(START,)))
    held = NOTHING if phase is Phase.OFF else HOLD
    assert bench.run(10, held).phase is phase
    bench.step(held, estimate(joints_valid=False))
    assert (bench.last.mode, bench.last.phase, bench.last.program) == (Mode.STOP, Phase.OFF, ProgramState.STOPPED)
    assert bench.last.events == (Event(Kind.RUN_SENSORS_LOST, bench.tick, {"sensor": "joint encoders and motor currents"}),)


def test_it_pauses_when_the_enabling_device_is_let_go_or_pressed_through_and_says_which() -> None:
    middle = Inputs(held=frozenset({Button.ENABLING}))
    for lost, grip in (
        (Inputs(released=frozenset({Button.ENABLING})), Grip.RELEASED),
        (Inputs(held=frozenset({Button.ENABLING_FULL})), Grip.PRESSED),
    ):
        bench = Bench(enabling__on=True)
        bench.run(60)
        bench.step(LOADED)
        bench.step(Inputs(held=middle.held, commands=(START,)))
        assert bench.run(5, middle).program is ProgramState.RUNNING
        bench.step(lost)
        told = Event(Kind.RUN_ENABLING, bench.tick, {"grip": grip})
        assert bench.last.events == (told, Event(Kind.PROGRAM_PAUSED, bench.tick, {"name": "rest", "step": 1}))
        assert (bench.last.mode, bench.last.program, bench.last.grip) == (Mode.RUN, ProgramState.PAUSED, grip)


def test_what_the_program_switches_is_told_once() -> None:
    """CD-15: only where it changes."""
    bench = Bench()
    bench.run(60)
    steps = (SwitchTool(on=True), SwitchTool(on=True), SwitchTool(on=False), Wait(duration=60.0))
    bench.step(Inputs(program=Program(name="tool", steps=steps)))
    bench.step(Inputs(commands=(START,)))
    first, on = bench.tick, [bench.last.tool_on]
    for _ in range(8):
        on.append(bench.step().tool_on)
    told = [event for event in bench.events if event.kind is Kind.TOOL_SWITCHED]
    changes = [first + k for k in range(1, 9) if on[k] is not on[k - 1]]
    assert told == [Event(Kind.TOOL_SWITCHED, tick, {"state": state}) for tick, state in zip(changes, ("on", "off"), strict=True)]
