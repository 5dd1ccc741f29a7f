"""What the pendant remembers in a few situations, as text: a golden table. `python -m tests.pendant.states` writes it.

Look at the difference before it is committed: what a part begins with decides what it does when nobody has told it anything yet.
"""

import hashlib
import json
from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path

import msgspec

from pendant.all_settings import Settings, apply
from pendant.contact.contact_monitor import ContactMonitor
from pendant.contact.history import History
from pendant.inputs import Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.supervisor import Supervisor
from pendant.tick.state import State
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench

FILE = Path(__file__).parent / "states.json"

PROGRAM = Program(name="p", steps=(JointMove(q=(0.1,) * 6),))
SIGNALS = {
    f"signals__{name}": True
    for name in ("push__on", "twist__on", "joints__on", "pattern__on", "turn__on", "force_step__on", "tap__on")
}


def lines(state: object, place: str = "") -> Iterator[str]:
    """A line for each value of a state."""
    if isinstance(state, tuple) and state and isinstance(state[0], str) and all(_named(each) for each in state[1:]):
        for name, value in state[1:]:  # type: ignore[misc]
            if name not in ("settings", "_settings", "_checksum"):
                yield from lines(value, f"{place}{state[0]}.{name} ")
    elif isinstance(state, tuple) and len(state) == 2 and isinstance(state[0], str) and type(state[1]) is int:
        return  # a part that stands elsewhere
    elif isinstance(state, tuple):
        for number, value in enumerate(state):
            yield from lines(value, f"{place}[{number}] ")
        if not state:
            yield f"{place}()"
    else:
        yield place + _text(state)


def _named(value: object) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and isinstance(value[0], str)


def _text(value: object) -> str:
    if isinstance(value, Enum):
        return f"{type(value).__name__}.{value.name}"
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, msgspec.Struct):
        return type(value).__name__
    return value.__qualname__ if callable(value) else repr(value)  # type: ignore[attr-defined]


def running() -> Bench:
    """A program has just been started."""
    bench = Bench()
    bench.run(60)
    bench.step(Inputs(program=PROGRAM))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    return bench


def stepped(bench: Bench, *inputs: Inputs) -> Bench:
    """After more ticks."""
    for each in inputs:
        bench.step(each)
    return bench


SITUATIONS: dict[str, Callable[[], State]] = {
    "fresh": lambda: Supervisor(Settings(), 6).state,
    "fresh, signals on": lambda: Bench(**SIGNALS).supervisor.state,
    "activation begins": lambda: stepped(Bench(sequence__on=True), HOLD).supervisor.state,
    "sequence begins": lambda: _sequence(60).supervisor.state,
    "compensation begins": lambda: _balanced().supervisor.state,
    "free-drive entered": lambda: Bench().entered().supervisor.state,
    "period begins": lambda: Bench().in_period().supervisor.state,
    "guided": lambda: _guided().supervisor.state,
    "program begins": lambda: running().supervisor.state,
    "emergency stop": lambda: stepped(Bench(), Inputs(commands=(Command.EMERGENCY_STOP,))).supervisor.state,
    "payload measured": lambda: stepped(_rested(), Inputs(commands=(Command.WIZARD_MEASURE,))).supervisor.state,
    "contact detection": lambda: stepped(Bench(contact__on=True), Inputs(), Inputs()).supervisor.state,
    "history": lambda: _own(History()),
    "detector": lambda: _own(ContactMonitor().detectors[0]),
    "monitor": lambda: _own(ContactMonitor()),
}


def _own(part: object) -> State:
    """Fields of a part, without the parts that it holds."""
    fields = getattr(type(part), "__slots__", None) or vars(part)
    values = {name: getattr(part, name) for name in fields}
    return tuple((name, str(value)) for name, value in values.items() if " object at " not in str(value))


def _rested() -> Bench:
    bench = Bench()
    bench.run(100)
    return bench


def _sequence(before: int) -> Bench:
    bench = Bench(sequence__on=True)
    bench.run(before)
    bench.run(501, HOLD)
    return bench


def _balanced() -> Bench:
    bench = _sequence(60)
    bench.supervisor.settings = apply(bench.supervisor.settings, {"sequence.beyond_limit": "balance"})
    bench.step(HOLD, estimate(force=40.0))
    return bench


def _guided() -> Bench:
    bench = Bench().in_period()
    bench.step(LET_GO)
    bench.run(5, Inputs(), estimate(force=15.0, qd=0.2, speed=0.1))
    return bench


LONGEST = 100
"""Of a line; what is longer stands as its beginning and a hash of all."""


def short(line: str) -> str:
    """A line that can be read."""
    if len(line) <= LONGEST:
        return line
    return f"{line[:LONGEST]} {hashlib.sha256(line.encode()).hexdigest()[:12]}"


def found() -> dict[str, list[str]]:
    """The table as it is now: of the fresh state everything, of the others what is not as in that."""
    whole = {name: [short(line) for line in lines(state())] for name, state in SITUATIONS.items()}
    fresh = set(whole["fresh"])
    return {name: rows if name == "fresh" else [row for row in rows if row not in fresh] for name, rows in whole.items()}


if __name__ == "__main__":
    FILE.write_text(json.dumps(found(), indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
