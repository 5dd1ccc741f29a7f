"""What starts free-drive: switches of the sources and of the confirmation, and the enabling device (FD-5, FD-8, FD-23)."""

from collections.abc import Callable
from typing import Any

import viser

from app.web.access.guard import Guard
from app.web.running import Running
from app.web.widgets.html import bring, enable
from pendant.all_settings import Settings, value_of
from pendant.inputs import Button
from pendant.signals.enabling_device import Grip
from pendant.tick.modes import Mode, Phase
from sim.exchange.snapshot import Snapshot

SWITCHES = {
    "signals.button": "The button",
    "signals.push.on": "A push",
    "signals.twist.on": "A twist",
    "signals.joints.on": "A push at a link",
    "signals.pattern.on": "Pushes in a row",
    "signals.presses.on": "Presses in a row",
    "signals.turn.on": "A turned joint",
    "signals.posture.on": "A posture by hand",
    "signals.force_step.on": "A force step",
    "signals.tap.on": "A tap",
    "signals.digital": "A digital input",
    "handshake.on": "Ask to confirm",
    "enabling.on": "Enabling device",
}
"""Settings that are switched here, with what is written beside them."""

BUTTONS = {Grip.MIDDLE: Button.ENABLING, Grip.PRESSED: Button.ENABLING_FULL}


class ActivationSwitches:
    """A folder of the pendant. Its controls run on viser's event loop; `show` runs in the painter.

    One pointer cannot hold the enabling device and use the pendant. So the page holds the device for a client, where that client
    left it, until its connection stalls or ends, or another client takes control: then it is released.
    """

    def __init__(self, gui: viser.GuiApi, guard: Guard, loop: Running) -> None:
        self._guard, self._loop = guard, loop
        self._settings: Settings = loop.settings
        self._holder: int | None = None  # the client for whom the enabling device is held
        self._held: Button | None = None
        with gui.add_folder("Free-drive starts by", expand_by_default=False):
            self.switches = {
                name: gui.add_checkbox(label, bool(value_of(loop.settings, name))) for name, label in SWITCHES.items()
            }
            self.grip: viser.GuiDropdownHandle[str] = gui.add_dropdown(
                "Grip", tuple(Grip), disabled=not loop.settings.enabling.on, hint="How the enabling device is held"
            )
        for name, control in self.switches.items():
            control.on_update(self._sets(name, control))

        @self.grip.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:  # a person, and not the page bringing itself up to date
                self._take(event.client_id, Grip(self.grip.value))

    def show(self, snapshot: Snapshot) -> bool:
        """Show what is switched on, and go on holding what is held; True if anything changed."""
        decision, settings = snapshot.decision, self._loop.settings
        holder = self._holder
        if holder is not None and (holder != self._guard.operator.holder or not settings.enabling.on):
            self.let_go(holder)
        if self._held is not None:
            self._loop.desk.hold(self._held)
        locked = decision.mode in (Mode.FREE_DRIVE, Mode.RUN) or decision.phase is Phase.SEQUENCE
        changed = [enable(control, not locked) for control in self.switches.values()]
        changed.append(enable(self.grip, settings.enabling.on))
        if settings is not self._settings:
            self._settings = settings
            for name, control in self.switches.items():
                changed.append(bring(control, bool(value_of(settings, name))))
        return any(changed)

    def let_go(self, client: int) -> None:
        """Release the enabling device, if it is held for `client`."""
        if client == self._holder:
            self._take(client, Grip.RELEASED)
            bring(self.grip, Grip.RELEASED.value)

    def _take(self, client: int, grip: Grip) -> None:
        wanted = BUTTONS.get(grip)
        if self._held is not None and wanted is not self._held:
            self._loop.desk.release(self._held)
        self._held, self._holder = wanted, client if wanted is not None else None
        if wanted is not None:
            self._loop.desk.hold(wanted)

    def _sets(self, name: str, control: viser.GuiCheckboxHandle) -> Callable[[viser.GuiEvent], Any]:
        async def update(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self._loop.desk.set({name: control.value})

        return update
