"""The three-position enabling device: by itself, and what the supervisor makes of it."""

import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import Program, ProgramState, Wait
from pendant.signals.enabling_device import EnablingDevice, Grip
from pendant.tick.modes import Law, Mode, Phase
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

FREE, MIDDLE, FULL = Button.FREE_DRIVE, Button.ENABLING, Button.ENABLING_FULL


def holding(*buttons: Button) -> Inputs:
    return Inputs(held=frozenset(buttons))


def letting_go(*buttons: Button, still: tuple[Button, ...] = ()) -> Inputs:
    return Inputs(held=frozenset(still), released=frozenset(buttons))


def test_only_the_middle_enables() -> None:
    device = EnablingDevice()
    assert device.grip is Grip.RELEASED
    for inputs, grip in (
        (holding(MIDDLE), Grip.MIDDLE),
        (holding(MIDDLE, FULL), Grip.PRESSED),
        (letting_go(FULL, still=(MIDDLE,)), Grip.PRESSED),  # on the way back the middle does not enable
        (holding(MIDDLE), Grip.PRESSED),
        (letting_go(MIDDLE), Grip.RELEASED),
        (holding(MIDDLE), Grip.MIDDLE),
        (holding(FULL), Grip.PRESSED),
    ):
        device.step(inputs, 50)
        assert device.grip is grip


def test_silence_is_a_release() -> None:
    """FD-23."""
    device = EnablingDevice()
    device.step(holding(MIDDLE), 3)
    for _ in range(3):
        device.step(NOTHING, 3)
        assert device.grip is Grip.MIDDLE
    device.step(NOTHING, 3)
    assert device.grip is Grip.RELEASED


def test_equal_memories_go_on_equally() -> None:
    one, two = EnablingDevice(), EnablingDevice()
    one.step(holding(MIDDLE), 3)
    assert state_of(one) != state_of(two)
    two.step(holding(MIDDLE), 3)
    assert state_of(one) == state_of(two)
    one.step(holding(FULL), 3)
    assert state_of(one) != state_of(two)


def device_bench(**changes: float | bool) -> Bench:
    bench = Bench(enabling__on=True, **changes)
    bench.run(60)
    return bench


def test_without_the_device_nothing_is_asked_of_it() -> None:
    bench = Bench().entered()
    assert bench.last.grip is None


def test_free_drive_needs_it() -> None:
    bench = device_bench()
    bench.step(holding(FREE))
    assert bench.last.events == (Event(Kind.REFUSED_ENABLING, bench.tick, {"grip": "released"}),)
    assert bench.last.grip is Grip.RELEASED


def test_in_its_middle_free_drive_begins() -> None:
    bench = device_bench()
    bench.run(501, holding(FREE, MIDDLE))
    assert (bench.last.mode, bench.last.grip) == (Mode.FREE_DRIVE, Grip.MIDDLE)


@pytest.mark.parametrize(
    ("inputs", "grip"), [(letting_go(MIDDLE, still=(FREE,)), "released"), (holding(FREE, MIDDLE, FULL), "fully pressed")]
)
def test_letting_go_and_clenching_both_end_free_drive_in_the_same_tick(inputs: Inputs, grip: str) -> None:
    bench = device_bench()
    bench.run(510, holding(FREE, MIDDLE))
    bench.step(inputs, estimate(qd=0.3, v_tcp=0.2))
    assert (bench.last.mode, bench.last.law, bench.last.phase) == (Mode.TEACH, Law.BRAKE, Phase.OFF)
    assert bench.last.events == (Event(Kind.LEFT_ENABLING, bench.tick, {"grip": grip}),)
    bench.run(10, NOTHING, estimate(qd=0.3, v_tcp=0.2))
    bench.run(50)
    stopped = bench.last.events[0]
    assert stopped.kind is Kind.STOPPED
    # 1 tick of the stop itself is not in it: the way is counted from the tick after the decision on
    assert stopped.values == {"time": 0.02, "distance": pytest.approx(0.004), "category": 2, "cause": "left_enabling"}
    # and the middle again does not free it again: the button is still held
    bench.run(3000, holding(FREE, MIDDLE))
    assert bench.last.mode is Mode.TEACH


def test_a_sequence_ends_with_it() -> None:
    bench = device_bench(sequence__on=True)
    bench.run(520, holding(FREE, MIDDLE))
    assert bench.last.phase is Phase.SEQUENCE
    bench.step(letting_go(MIDDLE))
    assert bench.last.events == (Event(Kind.REFUSED_ENABLING, bench.tick, {"grip": "released"}),)
    assert bench.last.phase is Phase.OFF


def test_a_program_pauses_and_goes_on_only_when_told() -> None:
    bench = device_bench()
    bench.step(Inputs(program=Program(steps=(Wait(duration=60.0),))))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    assert bench.last.events[0].values["reason"] == "enabling device released: hold it in its middle position"
    bench.step(holding(MIDDLE))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    assert bench.last.program is ProgramState.RUNNING
    bench.run(3, holding(MIDDLE), estimate(qd=0.3))
    bench.step(letting_go(MIDDLE), estimate(qd=0.3))
    assert [event.kind for event in bench.last.events] == [Kind.RUN_ENABLING, Kind.PROGRAM_PAUSED]
    assert (bench.last.mode, bench.last.law) == (Mode.RUN, Law.BRAKE)
    bench.run(60)
    assert bench.events[-1].kind is Kind.STOPPED
    bench.step(Inputs(commands=(Command.RESUME_PROGRAM,)))
    assert bench.last.events[0].kind is Kind.COMMAND_REFUSED
    bench.run(60, holding(MIDDLE))
    assert bench.last.program is ProgramState.PAUSED
    bench.step(Inputs(held=frozenset({MIDDLE}), commands=(Command.RESUME_PROGRAM,)))
    assert bench.last.program is ProgramState.RUNNING
