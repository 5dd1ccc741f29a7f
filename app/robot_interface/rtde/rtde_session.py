"""One RTDE connection: version, recipes, start and pause, and its package of each tick."""

import struct
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.robot_words import VERSION
from app.robot_interface.controller.rtde_fields import OUTPUTS
from app.robot_interface.rtde.rtde_inputs import Recipe, RtdeInputs
from app.robot_interface.rtde.rtde_messages import (
    Level,
    Malformed,
    Package,
    Reader,
    heard_text,
    names,
    packed,
    text_message,
)
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from app.robot_interface.transport.tcp_port import Farewell
from pendant.event_table import TABLE, render
from pendant.events.event import Event
from pendant.events.event_row import Severity
from pendant.tick.modes import TICK_RATE

SLOWEST = 1.0
"""Packages a second, at least."""

OLD_RATE = 125.0
"""Packages a second in version 1, whose recipes name none."""

MOST_RECIPES = 255
"""Of inputs, for one connection."""

LEVELS = {Severity.NOTICE: Level.INFO, Severity.WARNING: Level.WARNING, Severity.STOP: Level.ERROR}
"""Of events that are told as text messages."""

LATE_TOLD = 500
"""Packages that may be skipped before a reader is told so again."""


class OutputRecipe(NamedTuple):
    """What a client wants of each tick: a value, for the loop sends by it while the network's thread takes the next one."""

    head: bytes  # of its packages
    places: NDArray[np.int64]  # in the record
    every: int  # ticks


class RtdeSession:
    """See `app.robot_interface.transport.tcp_port.Conversation` and `app.robot_interface.controller.cabinet.Listener`.

    Args:
        cabinet: the robot.
        inputs: of all connections.
        peers: who is connected.
        peer: of this connection.
        outbox: of it.
        writable: False on the read-only port.
    """

    def __init__(
        self, cabinet: Cabinet, inputs: RtdeInputs, peers: Peers, peer: Peer, *, outbox: Outbox, writable: bool = True
    ) -> None:
        self._cabinet, self._inputs, self._peers, self._peer, self._outbox = cabinet, inputs, peers, peer, outbox
        self._writable = writable
        self._reader = Reader()
        self._version = 1
        self._recipes: list[Recipe] = []
        self._output: OutputRecipe | None = None
        self._streams = False
        self._package = b""  # that was sent last
        self._told_late = 0

    async def hear(self, data: bytes) -> None:
        """Answer the packages that are whole."""
        try:
            for kind, payload in self._reader.feed(data):
                self._answer(kind, payload)
        except Malformed as error:
            raise Farewell(str(error)) from None

    def over(self) -> None:
        """The connection is over."""
        self._cabinet.forget(self)
        self._inputs.release(self._peer.number)

    def tick(self, number: int) -> None:
        """Send this tick's package, if it is due."""
        output = self._output
        if not self._streams or output is None or number % output.every:
            return
        if self._send(output):
            if self._told_late and not self._outbox.full:
                self._tell(f"reader too slow: {self._outbox.skipped} packages were skipped", Level.WARNING)
                self._told_late = 0
        else:
            if not self._told_late:
                self._peers.note(self._peer.interface, self._peer.number, "reads too slowly: packages are skipped")
            self._told_late = self._outbox.skipped

    def repeat(self) -> None:
        """Send a package all the same: while nothing is simulated, clients must not take the robot for dead."""
        output = self._output
        if self._streams and output is not None:
            self._send(output)

    def again(self) -> None:
        """Send the last package once more."""
        if self._streams and self._package:
            self._outbox.offer(self._package)

    def _send(self, output: OutputRecipe) -> bool:
        """False: the client does not read in time."""
        self._package = output.head + self._cabinet.record.taken(output.places)
        return self._outbox.offer(self._package)

    def told(self, event: Event) -> None:
        """Tell an event, if it is more than a note."""
        level = LEVELS.get(TABLE[event.kind].severity)
        if level is not None:
            self._tell(" ".join(render(event)).strip(), level)

    def _tell(self, text: str, level: Level) -> None:
        if self._streams:
            self._outbox.send(text_message(text, level, self._version))

    def _answer(self, kind: int, payload: bytes) -> None:
        with suppress(struct.error):  # a payload that is too short is no request
            if kind == Package.DATA_PACKAGE:
                self._take(payload)
            elif kind == Package.REQUEST_PROTOCOL_VERSION:
                (version,) = struct.unpack_from(">H", payload)
                accepted = version in (1, 2)
                self._version = version if accepted else self._version
                self._reply(kind, bytes([accepted]))
            elif kind == Package.GET_URCONTROL_VERSION:
                self._reply(kind, struct.pack(">4I", *VERSION))
            elif kind == Package.SETUP_OUTPUTS:
                self._choose(payload)
            elif kind == Package.SETUP_INPUTS:
                self._claim(payload)
            elif kind == Package.START:
                self._start()
            elif kind == Package.PAUSE:
                self._streams = False
                self._cabinet.forget(self)
                self._reply(kind, b"\1")
                self._peer.about = "paused"
            elif kind == Package.TEXT_MESSAGE:
                self._peers.note(self._peer.interface, self._peer.number, heard_text(payload, self._version))

    def _reply(self, kind: int, payload: bytes) -> None:
        self._outbox.send(packed(kind, payload))

    def _choose(self, payload: bytes) -> None:
        """An output recipe; it replaces the one before."""
        rate = OLD_RATE
        if self._version == 2:
            (rate,) = struct.unpack_from(">d", payload)
            payload = payload[8:]
        wanted = names(payload)
        kinds = [OUTPUTS.get(name, "NOT_FOUND") for name in wanted]
        good = "NOT_FOUND" not in kinds and bool(wanted) and SLOWEST <= rate <= TICK_RATE
        if good:
            places, every = self._cabinet.record.where(wanted), max(1, round(TICK_RATE / rate))
            ident = b"\1" if self._version == 2 else b""
            head = struct.pack(">HB", 3 + len(ident) + len(places), Package.DATA_PACKAGE) + ident
            self._output = OutputRecipe(head, places, every)
            self._peer.about = f"{len(wanted)} outputs at {TICK_RATE / every:g} Hz"
        else:
            self._output = None
        ident = bytes([good]) if self._version == 2 else b""
        self._reply(Package.SETUP_OUTPUTS, ident + ",".join(kinds).encode())

    def _claim(self, payload: bytes) -> None:
        """An input recipe."""
        wanted = names(payload)
        kinds = self._inputs.claim(wanted, self._peer.number) if self._writable else ["IN_USE"] * len(wanted)
        good = bool(wanted) and not {"NOT_FOUND", "IN_USE"} & set(kinds) and len(self._recipes) < MOST_RECIPES
        if good:
            self._recipes.append(Recipe(wanted))
        self._reply(Package.SETUP_INPUTS, bytes([len(self._recipes) if good else 0]) + ",".join(kinds).encode())

    def _start(self) -> None:
        """Stream; refused where there is no recipe, as a robot does."""
        good = self._output is not None
        self._reply(Package.START, bytes([good]))
        if good:
            self._cabinet.forget(self)
            self._cabinet.listen(self)
            self._streams = True

    def _take(self, payload: bytes) -> None:
        """A package of inputs."""
        number = payload[0] if payload else 0
        if not 1 <= number <= len(self._recipes):
            return
        self._inputs.write(self._recipes[number - 1].values(payload[1:]))
