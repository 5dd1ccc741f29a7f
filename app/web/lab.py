"""The laboratory: the clock of the simulation, the hand, and what is done to the true arm and its sensors."""

import viser

from app.web import svg
from app.web.hand import FORCE, Hand
from app.web.html import Html
from app.web.running import Running
from pendant.modes import TICK_RATE
from sim.snapshot import Snapshot


class Lab:
    """The laboratory's tab."""

    def __init__(self, gui: viser.GuiApi, loop: Running, hand: Hand) -> None:
        self._loop = loop
        self._hand = hand
        self.clock = gui.add_button_group("Clock", ("Run", "Pause", "Step"))
        self.speed = gui.add_slider("Speed", min=0.1, max=1.0, step=0.1, initial_value=1.0)
        self.restart = gui.add_button("Start over", color="gray")
        self.rates = Html(gui)
        self.force = gui.add_slider("Hand [N]", min=FORCE[0], max=FORCE[2], step=5.0, initial_value=FORCE[1])
        self._connect()

    def show(self, snapshot: Snapshot) -> bool:
        """Show a snapshot; True if anything changed."""
        state = "paused" if self._loop.paused else f"{self._loop.actual_rate:.2f} ×"
        pairs = [
            ("Time", f"{snapshot.tick / TICK_RATE:.1f} s"),
            ("Rate asked, real", f"{self._loop.speed:.1f} ×, {state}"),
            ("Seed", f"{self._loop.seed}"),
        ]
        return self.rates.show(svg.facts(pairs))

    def _connect(self) -> None:
        @self.force.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._hand.cap = float(self.force.value)

        @self.clock.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self.clock.value == "Step":
                self._loop.paused = True
                self._loop.step_once()
            else:
                self._loop.paused = self.clock.value == "Pause"

        @self.speed.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._loop.speed = float(self.speed.value)

        @self.restart.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._loop.reset()
