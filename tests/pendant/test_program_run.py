"""A command of a program that is not possible says why (FD-1, CD-15)."""

import pytest

from pendant.estimate import Estimate
from pendant.events import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.modes import Mode, Phase
from pendant.program import Program, Wait
from tests.pendant.estimates import estimate
from tests.pendant.test_freedrive import HOLD, Bench

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
