"""Wiring of the robot: safety and digital inputs as switches of the laboratory, and the digital outputs."""

from collections.abc import Callable, Mapping
from typing import Any

import viser

from app.robot_interface.interfaces import RobotInterfaces
from app.web.running import Running
from app.web.widgets import svg
from app.web.widgets.html import Html
from pendant.all_settings import Settings
from pendant.inputs import Command
from pendant.program.steps import LINES
from sim.exchange.snapshot import Snapshot

COUNT = 8
"""Digital inputs, numbered from 0: as many as `signals.digital_input` may name."""

LEVELS = {
    "Safeguard open": (Command.SAFEGUARD_OPEN, Command.SAFEGUARD_CLOSED),
    "Reduced mode": (Command.REDUCED_ON, Command.REDUCED_OFF),
}
"""Safety inputs, with their commands when switched on and off."""

HINT = "Settings, signals: which input enters free-drive, which leaves it"


class Wires:
    """A folder of switches that keep their level, and of outputs. Its controls run on viser's event loop; `show` runs in the
    painter.

    Args:
        gui: of the page.
        loop: the running simulation.
        interfaces: the robot's network interfaces; their clients can write inputs and outputs, too. None: only programs switch
            outputs.
    """

    def __init__(self, gui: viser.GuiApi, loop: Running, interfaces: RobotInterfaces | None) -> None:
        self._loop, self._interfaces = loop, interfaces
        self.names: Callable[[], Mapping[str, str]] = dict  # of inputs and outputs
        self._tick = 0
        with gui.add_folder("Inputs and outputs", expand_by_default=False):
            self.outputs = Html(gui)
            self.safety = {label: gui.add_checkbox(label, False) for label in LEVELS}
            self.digital = [gui.add_checkbox(_label(number, loop.settings, {}), False, hint=HINT) for number in range(COUNT)]
        for label, control in self.safety.items():
            _by_hand(control, self._commands(label))
        for number, control in enumerate(self.digital):
            _by_hand(control, self._wires(number))

    def show(self, snapshot: Snapshot) -> bool:
        """Show the levels and their use; True if anything changed."""
        high, settings, names = self._loop.desk.high, self._loop.settings, self.names()
        changed = [_bring(control, "value", number in high) for number, control in enumerate(self.digital)]
        changed += [_bring(control, "label", _label(number, settings, names)) for number, control in enumerate(self.digital)]
        if snapshot.tick < self._tick:  # the simulation began again, with everything closed and off
            changed += [_bring(control, "value", False) for control in self.safety.values()]
        self._tick = snapshot.tick
        on = ", ".join(names.get(f"output {number}", str(number)) for number in sorted(self._on(snapshot))) or "none"
        changed.append(self.outputs.show(svg.facts([("Outputs that are on", on)])))
        return any(changed)

    def _on(self, snapshot: Snapshot) -> frozenset[int]:
        """The outputs that are on."""
        if self._interfaces is None:
            return snapshot.decision.outputs
        bits = self._interfaces.cabinet.record.get("actual_digital_output_bits")
        assert isinstance(bits, int)
        return frozenset(number for number in range(LINES) if bits >> number & 1)

    def _commands(self, label: str) -> Callable[[], None]:
        on, off = LEVELS[label]
        return lambda: self._loop.desk.command(on if self.safety[label].value else off)

    def _wires(self, number: int) -> Callable[[], None]:
        return lambda: self._loop.desk.wire(number, self.digital[number].value)


def _label(number: int, settings: Settings, names: Mapping[str, str]) -> str:
    """The input's name, and what it does with free-drive."""
    use = settings.signals
    enters = use.digital and use.digital_input == number
    leaves = use.leaving and use.leaving_input == number
    does = ": both" if enters and leaves else ": enter" if enters else ": leave" if leaves else ""
    return f"{names.get(f'input {number}', f'Input {number}')}{does}"


def _by_hand(control: Any, act: Callable[[], None]) -> None:
    @control.on_update
    async def _(event: viser.GuiEvent) -> None:
        if event.client_id is not None:  # a person, not an update by the page itself
            act()


def _bring(control: Any, name: str, value: bool | str) -> bool:
    """Let an attribute of a control be `value`; True if that changed anything."""
    if getattr(control, name) == value:
        return False
    setattr(control, name, value)
    return True
