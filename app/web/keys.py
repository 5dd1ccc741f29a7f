"""Keys of the page. Letters that viser's camera (WASDQE, arrows) and its palette (Ctrl+K, which lists these) do not use; while
somebody types into a field, none of them counts."""

import time
from collections.abc import Callable, Coroutine
from typing import Any, Literal, NamedTuple

import viser

from app.web.access.guard import Guard
from app.web.docks import Docks
from app.web.panel.preferences import Preferences
from app.web.running import Running
from pendant.inputs import Command

AGAIN = 0.6
"""A key that is held down repeats; what comes sooner than this after the last is such a repetition [s]."""


class Key(NamedTuple):
    """One key and what it does for the client that presses it."""

    letter: Literal["X", "L", "M", "P", "N", "T", "B"]
    label: str
    act: Callable[[int], None]
    anyone: bool = False  # the operator alone otherwise
    repeats: bool = False  # each repetition of a held key counts


class Keys:
    """All of them. Lives on viser's event loop."""

    def __init__(self, server: viser.ViserServer, guard: Guard, loop: Running, *, docks: Docks, preferences: Preferences) -> None:
        self._loop, self._docks = loop, docks
        self._last: dict[tuple[int, str], float] = {}
        self.commands: dict[str, viser.CommandHandle] = {}
        for key in (
            Key("X", "Emergency stop", lambda _: loop.desk.command(Command.EMERGENCY_STOP), anyone=True, repeats=True),
            Key("L", "Leave free-drive", lambda _: self._leave()),
            Key("M", "Register a waypoint", lambda _: self._mark()),
            Key("P", "Pause the simulation, or let it go on", lambda _: self._pause()),
            Key("N", "One tick, while paused", lambda _: loop.step_once(), repeats=True),
            Key("T", "Dark or light page", preferences.flip_dark, anyone=True),
            Key("B", "Sound on or off", preferences.flip_sound, anyone=True),
        ):
            command = server.gui.add_command(key.label, hotkey=key.letter)
            command.on_trigger(self._pressed(key))
            self.commands[key.letter] = command
            if key.anyone:
                guard.for_anyone(command)

    def _pressed(self, key: Key) -> Callable[[viser.CommandEvent], Coroutine[Any, Any, None]]:
        async def pressed(event: viser.CommandEvent) -> None:
            if event.client_id is None:
                return
            now = time.monotonic()
            before = self._last.get((event.client_id, key.letter), -AGAIN)
            self._last[event.client_id, key.letter] = now
            if key.repeats or now - before >= AGAIN:
                key.act(event.client_id)

        return pressed

    def forget(self, client: int) -> None:
        """A client has gone."""
        self._last = {pressed: when for pressed, when in self._last.items() if pressed[0] != client}

    def _leave(self) -> None:
        if not self._docks.panel.leave.disabled:
            self._loop.desk.command(Command.LEAVE_FREE_DRIVE)

    def _mark(self) -> None:
        if not self._docks.teach.register.disabled:
            self._docks.teach.mark()

    def _pause(self) -> None:
        self._loop.paused = not self._loop.paused
        self._docks.lab.clock.value = "Freeze" if self._loop.paused else "Go on"
