"""Replay of a recording on the page: as a ghost of the arm beside the arm that runs, with a time line."""

import asyncio
import time
from collections.abc import Callable

import viser

from app.files.checked import BadInput
from app.log.layout import WORDS as CODED
from app.web.panel.state_words import WORDS
from app.web.recordings.event_marks import EventMarks
from app.web.recordings.shelf import Shelf
from app.web.scene.moving_ghost import MovingGhost
from app.web.widgets import svg
from app.web.widgets.html import Html, enable, reveal
from app.web.widgets.svg import Colour
from pendant.tick.modes import TICK, Mode
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot

VIOLET = (132, 94, 247)
NOTHING: str = "none yet"
SPEEDS = ("0.1 ×", "0.5 ×", "1 ×", "2 ×")
LOOK = 1.0
"""Between two looks into the folder [s]."""


class ReplayControls:
    """Part of the tab Record. Its controls run on viser's event loop; `show` runs in the painter.

    Args:
        server: of the page.
        arm: that is shown.
        shelf: of the recordings.
        busy: tells the name of the file that is being recorded, "" for none.
        now: the clock [s].
    """

    def __init__(
        self,
        server: viser.ViserServer,
        arm: Arm,
        shelf: Shelf,
        *,
        busy: Callable[[], str],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._shelf, self._busy, self._now = shelf, busy, now
        self._before = self._looked = now()
        self._names: tuple[str, ...] = ()
        self._set = 0.0  # where we have put the slider ourselves
        self._opened: object = None
        self.ghost = MovingGhost(server, arm, "/ghost/replay", VIOLET)
        gui = server.gui
        names: tuple[str, ...] = (NOTHING,)
        self.choice: viser.GuiDropdownHandle[str] = gui.add_dropdown("Replay of", names)
        self.play = gui.add_button("Replay", icon=viser.Icon.PLAYER_PLAY, disabled=True)
        self.line = gui.add_slider("Time [s]", min=0.0, max=1.0, step=0.01, initial_value=0.0, visible=False)
        self.marks = EventMarks(gui, self.line, self._jump)
        self.speed = gui.add_button_group("Speed", SPEEDS, visible=False)
        self.speed.value = "1 ×"
        self.said = Html(gui)
        self.leave = gui.add_button("End the replay", color="gray", visible=False)
        self.download = gui.add_button("Download", color="gray", disabled=True)
        self._connect()
        self._look()

    def show(self, snapshot: Snapshot) -> bool:
        """Let the replay go on; True if anything changed."""
        now = self._now()
        passed, self._before = now - self._before, now
        if now - self._looked > LOOK:
            self._looked = now
            self._look()
        player = self._shelf.player
        chosen = self.choice.value != NOTHING and self.choice.value != self._busy()
        changed = [
            enable(self.play, chosen and not self._shelf.opening),
            enable(self.download, chosen),
            *(reveal(control, player is not None) for control in (self.line, self.speed, self.leave)),
        ]
        if player is not self._opened:
            self._opened = player
            if player is not None:
                self.line.max = max(round(player.end, 2), 0.01)
            self.marks.show(() if player is None else player.log.events, 0.0 if player is None else player.end)
        label = "Replay"
        posture = None
        if player is not None:
            player.advance(passed)
            label = "Pause" if player.playing else "Go on" if player.time < player.end else "Replay"
            posture = player.log.state.row(player.row)["q"].tolist()
            at = round(player.time, 2)
            if self.line.value != at:
                self._set = at
                self.line.value = at
        if self.play.label != label:
            self.play.label = label
            self.play.icon = viser.Icon.PLAYER_PAUSE if label == "Pause" else viser.Icon.PLAYER_PLAY
        changed += [self.ghost.show(posture, snapshot), self.said.show(self._words())]
        return any(changed)

    def look_at(self, tick: int | None) -> None:
        """Show the moment of an event there and pause, if the recording that is open has it; None: nothing to show."""
        player = self._shelf.player
        if tick is not None and player is not None and any(event.tick == tick for event in player.log.events):
            player.playing = False
            player.jump(tick * TICK)

    def look(self) -> None:
        """A recording has begun or ended: look into the folder at once, and offer the newest."""
        self._looked = self._now()
        self._look()
        if self._names and self._shelf.player is None and self.choice.value != self._names[0]:
            self.choice.value = self._names[0]

    def _jump(self, time: float) -> None:
        if self._shelf.player is not None:
            self._shelf.player.jump(time)

    def _look(self) -> None:
        names = self._shelf.names()
        if names != self._names:
            newest = not self._names or self.choice.value == self._names[0]
            self._names = names
            wanted = self.choice.value
            offered = names or (NOTHING,)
            self.choice.options = offered
            if newest or wanted not in names:
                wanted = offered[0]
            if self.choice.value != wanted:
                self.choice.value = wanted

    def _words(self) -> str:
        shelf = self._shelf
        if shelf.failure:
            return svg.note("Not opened", shelf.failure, Colour.RED)
        if shelf.opening:
            return svg.note("Opening", shelf.opening, Colour.GREY)
        player = shelf.player
        if player is None:
            return ""
        log, row = player.log, player.row
        mode, _ = WORDS[Mode(CODED["mode"][log.state.row(row)["mode"]])]
        told = next((event.headline for event in reversed(log.events) if event.t <= player.time), "")
        return svg.note("Replay: the violet arm", f"{mode}. {told}", Colour.BLUE)

    def _connect(self) -> None:
        shelf = self._shelf

        @self.play.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._toggle()

        @self.choice.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                shelf.close()

        @self.line.on_update
        async def _(_: viser.GuiEvent) -> None:
            if self.line.value != self._set:
                self._jump(float(self.line.value))

        @self.speed.on_click
        async def _(_: viser.GuiEvent) -> None:
            if shelf.player is not None:
                shelf.player.speed = float(self.speed.value.split()[0])

        @self.leave.on_click
        async def _(_: viser.GuiEvent) -> None:
            shelf.close()

        @self.download.on_click
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None:
                await self._send(event.client, self.choice.value)

    def _toggle(self) -> None:
        """Open the chosen recording; play it, or pause."""
        player = self._shelf.player
        if player is None:
            self._shelf.open(self.choice.value)
            return
        if not player.playing and player.time >= player.end:
            player.jump(0.0)
        player.playing = not player.playing

    async def _send(self, client: viser.ClientHandle, name: str) -> None:
        """Give the file to a browser; it is read beside the page's event loop."""
        try:
            content = await asyncio.to_thread(self._shelf.content, name)
        except BadInput as error:
            self._shelf.failure = str(error)
            return
        client.send_file_download(name, content, save_immediately=True)
