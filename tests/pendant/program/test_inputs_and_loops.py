"""Programs that repeat, wait for inputs, switch outputs, and leave steps out."""

import msgspec
import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import Command, Inputs
from pendant.program.sequencer import Sequencer
from pendant.program.steps import (
    INSTANT,
    LINES,
    MOST_RUNS,
    SHORTEST_ROUND,
    AnyStep,
    InputLevel,
    JointMove,
    Program,
    ProgramState,
    SetOutput,
    SwitchTool,
    Tell,
    Wait,
    WaitForInput,
    misfit,
)
from tests.pendant.freedrive.test_state_machine import Bench

HOME = JointMove(q=(0.0,) * 6)
REST = Wait(duration=0.1)


def started(*steps: AnyStep, repeat: int = 1) -> Sequencer:
    sequencer = Sequencer()
    sequencer.load(Program(steps=steps, repeat=repeat))
    sequencer.start()
    return sequencer


@pytest.mark.parametrize("repeat", [1, 2, 5])
def test_a_program_runs_as_often_as_it_says(repeat: int) -> None:
    sequencer = started(Wait(duration=0.004), Wait(duration=0.002), repeat=repeat)
    ends = [sequencer.step(0) for _ in range(3 * repeat)]
    assert ends == [False] * (3 * repeat - 1) + [True]
    assert (sequencer.state, sequencer.index) == (ProgramState.STOPPED, 0)
    sequencer.start()
    assert [sequencer.step(0) for _ in range(3 * repeat)] == ends


def test_a_program_that_repeats_without_end_goes_on_until_it_is_stopped() -> None:
    sequencer = started(Wait(duration=0.004), Wait(duration=0.002), repeat=0)
    assert not any(sequencer.step(0) for _ in range(3001))
    assert (sequencer.state, sequencer.index) == (ProgramState.RUNNING, 0)
    sequencer.stop()
    assert sequencer.state is ProgramState.STOPPED


@pytest.mark.parametrize("high", [True, False])
def test_it_waits_for_a_level_of_an_input(high: bool) -> None:
    sequencer = started(WaitForInput(level=InputLevel(input=3, high=high)), HOME)
    sequencer.high = frozenset({0, 7} if high else {0, 3, 7})
    for _ in range(50):
        assert not sequencer.step(0)
    assert sequencer.index == 0
    sequencer.high = frozenset({0, 3, 7} if high else {0, 7})
    sequencer.step(0)
    assert (sequencer.index, isinstance(sequencer.move, JointMove)) == (1, True)


def test_outputs_stay_as_they_were_switched() -> None:
    sequencer = started(SetOutput(output=0, on=True), SetOutput(output=7, on=True), SetOutput(output=0, on=False), REST)
    seen = [(sequencer.step(0), sequencer.outputs)[1] for _ in range(4)]
    assert seen == [{0}, {0, 7}, {7}, {7}]
    sequencer.stop()
    assert sequencer.outputs == {7}


@pytest.mark.parametrize("high", [True, False])
@pytest.mark.parametrize("level", [True, False])
def test_a_step_whose_condition_does_not_hold_as_it_begins_is_left_out(high: bool, level: bool) -> None:
    step = JointMove(q=(0.5,) * 6, when=InputLevel(input=2, high=level))
    sequencer = started(Wait(duration=0.002), step, HOME)
    sequencer.high = frozenset({2} if high else {1})
    sequencer.step(0)
    if high is level:
        assert isinstance(sequencer.move, JointMove)
        sequencer.high = frozenset({2}) - sequencer.high
        for _ in range(5):
            sequencer.step(0)  # it has begun: what changes now changes nothing
        assert sequencer.index == 1
    else:
        assert isinstance(sequencer.move, Wait)
        sequencer.step(0)
        assert sequencer.move == JointMove(id=sequencer.move.id, q=(0.0,) * 6)
        assert sequencer.index == 2


def test_a_wait_that_is_left_out_after_a_pause_lasts_a_tick() -> None:
    sequencer = started(Wait(duration=0.1, when=InputLevel(input=0, high=False)), HOME)
    sequencer.step(0)
    sequencer.pause()
    sequencer.high = frozenset({0})
    sequencer.resume()
    sequencer.step(0)
    assert sequencer.index == 1


@pytest.mark.parametrize("repeat", [0, 2])
@pytest.mark.parametrize(
    ("step", "lasts"),
    [
        (HOME, True),
        (REST, True),
        (Wait(duration=0.99 * SHORTEST_ROUND), False),
        (JointMove(q=(0.0,) * 6, when=InputLevel(input=0)), False),
        (SetOutput(output=1, on=True), False),
        (SwitchTool(on=True), False),
        (Tell(text="t"), False),
        (WaitForInput(level=InputLevel(input=0)), False),
    ],
)
def test_a_program_that_repeats_takes_time(step: AnyStep, lasts: bool, repeat: int) -> None:
    """Or it would switch 500 times a second; of the steps that may last a tick, each is here."""
    reason = misfit(Program(steps=(SetOutput(output=0, on=True), step), repeat=repeat), 6)
    assert (reason is None) is lasts
    assert misfit(Program(steps=(step,)), 6) is None
    assert set(INSTANT) == {SwitchTool, SetOutput, Tell, WaitForInput}


@pytest.mark.parametrize(
    ("raw", "fits"),
    [
        ({"kind": "output", "output": LINES - 1, "on": True}, True),
        ({"kind": "output", "output": LINES, "on": True}, False),
        ({"kind": "output", "output": -1, "on": True}, False),
        ({"kind": "wait_for_input", "level": {"input": 0}}, True),
        ({"kind": "wait_for_input", "level": {"input": LINES}}, False),
        ({"kind": "wait", "duration": 1.0, "when": {"input": 7, "high": False}}, True),
        ({"kind": "wait", "duration": 1.0, "when": {"input": -1}}, False),
    ],
)
def test_inputs_and_outputs_have_numbers_from_0_to_7(raw: dict[str, object], fits: bool) -> None:
    if fits:
        msgspec.convert({"steps": [raw]}, Program)
    else:
        with pytest.raises(msgspec.ValidationError, match="Expected `int`"):
            msgspec.convert({"steps": [raw]}, Program)


@pytest.mark.parametrize(("repeat", "fits"), [(0, True), (MOST_RUNS, True), (-1, False), (MOST_RUNS + 1, False)])
def test_a_program_repeats_to_the_ends_of_the_range(repeat: int, fits: bool) -> None:
    raw = {"steps": [{"kind": "wait", "duration": 1.0}], "repeat": repeat}
    if fits:
        assert msgspec.convert(raw, Program).repeat == repeat
    else:
        with pytest.raises(msgspec.ValidationError, match="repeat"):
            msgspec.convert(raw, Program)


def test_the_supervisor_reads_its_inputs_and_tells_each_output_once() -> None:
    bench = Bench()
    bench.run(60)
    steps = (
        WaitForInput(level=InputLevel(input=4)),
        SetOutput(output=2, on=True),
        SetOutput(output=2, on=True),
        SetOutput(output=5, on=True),
        SetOutput(output=2, on=False),
    )
    bench.step(Inputs(program=Program(name="lines", steps=steps)))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.run(100)
    assert (bench.last.step, bench.last.outputs) == (1, frozenset())
    bench.events.clear()
    bench.step(Inputs(high=frozenset({4})))
    first = bench.tick
    bench.run(4, Inputs(high=frozenset({4})))
    told = [event for event in bench.events if event.kind is Kind.OUTPUT_SWITCHED]
    assert told == [
        Event(Kind.OUTPUT_SWITCHED, first + after, {"number": number, "state": state})
        for after, number, state in ((1, 2, "on"), (3, 5, "on"), (4, 2, "off"))
    ]
    assert bench.last.outputs == {5}
    assert bench.last.program is ProgramState.STOPPED
