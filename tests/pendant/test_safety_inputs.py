"""The levels of the safety inputs: each change is told once, and what is open keeps a reset off (FD-1)."""

import pytest

from pendant.events import Event, Kind
from pendant.inputs import Command, Inputs
from pendant.modes import Mode, Phase, Safety
from tests.pendant.test_freedrive import HOLD, LET_GO, Bench

OPEN, CLOSED = Command.SAFEGUARD_OPEN, Command.SAFEGUARD_CLOSED
ON, OFF = Command.REDUCED_ON, Command.REDUCED_OFF
STOP, RESET = Command.EMERGENCY_STOP, Command.RESET


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


def test_a_safeguard_that_is_closed_is_as_before_it_was_opened() -> None:
    bench = resting()
    before = bench.supervisor._safety.memory
    told(bench, OPEN)
    assert bench.supervisor._safety.memory != before
    bench.step(Inputs(commands=(CLOSED,)))
    assert bench.last.events == (Event(Kind.SAFEGUARD_CLOSED, bench.tick, {}),)
    assert bench.supervisor._safety.memory == before
    assert (bench.last.mode, bench.last.safety) == (Mode.STOP, Safety.SAFEGUARD_STOP), "no reset by itself"


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
