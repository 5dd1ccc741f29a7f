"""Inputs of the robot, switched on the page, and its outputs, shown there."""

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from app.web.server import Served
from pendant.all_settings import Settings, apply
from pendant.inputs import Command
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def test_a_digital_input_keeps_its_level(served: Served, join: Join, loop: FakeLoop) -> None:
    client, wires = join(), served.lab.wires
    client.set(wires.digital[3]._impl.uuid, value=True)
    until(lambda: loop.desk.high == {3}, "high")
    for _ in range(3):
        loop.advance()
    assert [wish.inputs.high for wish in loop.wishes[-3:]] == [{3}] * 3
    client.set(wires.digital[3]._impl.uuid, value=False)
    until(lambda: loop.desk.high == frozenset(), "low")


@pytest.mark.parametrize(
    ("label", "on", "off"),
    [
        ("Safeguard open", Command.SAFEGUARD_OPEN, Command.SAFEGUARD_CLOSED),
        ("Reduced mode", Command.REDUCED_ON, Command.REDUCED_OFF),
    ],
)
def test_a_safety_input_commands_its_level(
    served: Served, join: Join, loop: FakeLoop, label: str, on: Command, off: Command
) -> None:
    client, control = join(), served.lab.wires.safety[label]
    for value, command in ((True, on), (False, off)):
        client.set(control._impl.uuid, value=value)
        until(lambda command=command: loop.advance() is None and loop.wishes[-1].inputs.commands == (command,), command)


def test_what_an_input_does_stands_beside_it(loop: FakeLoop, still: Served) -> None:
    wires = still.lab.wires
    assert [control.label for control in wires.digital] == [f"Input {number}" for number in range(8)]
    for changes, label in (
        ({"signals.digital": True, "signals.digital_input": 2.0}, "Input 2: enter"),
        ({"signals.digital_input": 2.0, "signals.leaving": True, "signals.leaving_input": 2.0}, "Input 2: leave"),
        ({"signals.digital": True, "signals.leaving": True, "signals.leaving_input": 0.0}, "Input 0: both"),
    ):
        loop.settings = apply(Settings(), changes)
        still.docks.show(loop.latest())
        assert [control.label for control in wires.digital if ":" in control.label] == [label]


def test_when_the_simulation_begins_again_nothing_is_wired(loop: FakeLoop, still: Served) -> None:
    wires = still.lab.wires
    loop.advance(1.0)
    loop.desk.wire(5, True)
    wires.safety["Reduced mode"].value = True
    still.docks.show(loop.latest())
    assert wires.digital[5].value
    assert wires.safety["Reduced mode"].value
    loop.tick = 0
    loop.desk.clear()
    still.docks.show(loop.latest())
    assert not wires.digital[5].value
    assert not wires.safety["Reduced mode"].value
    loop.advance()
    assert loop.wishes[-1].inputs.commands == ()


def test_a_watcher_switches_nothing(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.lab.wires.digital[1]._impl.uuid, value=True)
    until(lambda: loop.desk.high == {1}, "somebody has control")
    for control in (served.lab.wires.digital[0], *served.lab.wires.safety.values()):
        watcher.set(control._impl.uuid, value=True)
    until(lambda: served.guard.refused["not the operator"] == 3, "refused")
    loop.advance()
    assert loop.wishes[-1].inputs.high == {1}
    assert loop.wishes[-1].inputs.commands == ()


def test_outputs_are_shown(loop: FakeLoop, still: Served) -> None:
    wires = still.lab.wires
    still.docks.show(loop.latest())
    assert "<dd>none</dd>" in wires.outputs.shown
    loop.outputs = frozenset({7, 0, 2})
    still.docks.show(loop.latest())
    assert "<dd>0, 2, 7</dd>" in wires.outputs.shown


def test_outputs_that_clients_set_are_shown_from_the_image_that_they_share(loop: FakeLoop, still: Served) -> None:
    """Beyond the eighth bit are those of other plugs."""
    wires = still.lab.wires
    record = SimpleNamespace(get={"actual_digital_output_bits": 0x1_8182}.get)
    wires._interfaces = SimpleNamespace(cabinet=SimpleNamespace(record=record))  # type: ignore[assignment]
    still.docks.show(loop.latest())
    assert "<dd>1, 7</dd>" in wires.outputs.shown
