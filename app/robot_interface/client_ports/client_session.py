"""One connection to the primary, secondary or real-time interface."""

from typing import NamedTuple

from app.robot_interface.client_ports.bare_commands import LONGEST, TextCommands
from app.robot_interface.client_ports.primary_messages import (
    OURS,
    Code,
    error_message,
    exception_message,
    key_message,
    popup_message,
    question_message,
    safety_message,
    text_of,
    version_message,
)
from app.robot_interface.client_ports.primary_packages import RobotState
from app.robot_interface.client_ports.realtime_package import RealtimePackage
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.robot_words import SafetyMode
from app.robot_interface.dashboard.dashboard_commands import DashboardCommands
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peer, Peers
from app.robot_interface.transport.tcp_port import Farewell
from app.urscript.language.trouble import NOWHERE, Spot
from app.urscript.running.script_runner import ScriptRunner
from app.urscript.running.told import Telling, Told
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Severity
from pendant.tick.modes import TICK_RATE

EVERY = TICK_RATE // 10
"""Ticks between two robot states."""

KEYS = {
    Kind.PROGRAM_STARTED: "PROGRAM_XXX_STARTED",
    Kind.PROGRAM_FINISHED: "PROGRAM_XXX_STOPPED",
    Kind.PROGRAM_STOPPED: "PROGRAM_XXX_STOPPED",
    Kind.PROGRAM_FAILED: "PROGRAM_XXX_STOPPED",
}

SECONDARY_EXCEPTION = "SECONDARY_PROGRAM_EXCEPTION_XXX"
"""What ends a secondary program, which the one beside goes on after."""

CODES = {Kind.COLLISION: 157, Kind.PATH_LEFT: 153}
"""Codes of a UR's protective stops, whose argument is the joint: a collision, and a position that deviates from the path."""

LEVELS = {Severity.NOTICE: 1, Severity.WARNING: 2, Severity.STOP: 3}


class Talking(NamedTuple):
    """What the connections of one robot share."""

    cabinet: Cabinet
    commands: DashboardCommands
    peers: Peers
    scripts: ScriptRunner


class StreamSession:
    """What primary, secondary and real-time have in common: text in, packages out.

    See `app.robot_interface.transport.tcp_port.Conversation` and `app.robot_interface.controller.cabinet.Listener`.
    """

    def __init__(self, robot: Talking, peer: Peer, *, outbox: Outbox, writable: bool) -> None:
        self.cabinet, self.outbox = robot.cabinet, outbox
        outbox.patient = writable  # a client may only send programs, and ur-rtde does
        self._peers, self._peer, self._writable, self._scripts = robot.peers, peer, writable, robot.scripts
        hosts = frozenset({peer.address.rpartition(":")[0]})
        self._text = TextCommands(robot.commands, self._complain, self._note, scripts=robot.scripts, hosts=hosts)
        self._package = b""  # that was sent last
        self.cabinet.listen(self)
        self._scripts.listen(self.script)

    async def hear(self, data: bytes) -> None:
        """Do what the text says; on the read-only port nothing."""
        if not self._writable:
            self._complain("C210: this port is read-only")
        elif not await self._text.hear(data, lambda: self.cabinet.state.remote):
            raise Farewell(f"a line of more than {LONGEST} bytes")

    def over(self) -> None:
        """The connection is over."""
        self._text.over()
        self._scripts.forget(self.script)
        self.cabinet.forget(self)

    def tick(self, number: int) -> None:
        """A tick is done."""

    def told(self, event: Event) -> None:
        """Something happened in it."""

    def repeat(self) -> None:
        """No tick has been done for a while."""

    def again(self) -> None:
        """Send the last package once more; from any thread."""
        if self._package:
            self.outbox.offer(self._package)

    def send(self, package: bytes) -> None:
        """Send a package, and keep it."""
        self._package = package
        self.outbox.offer(package)

    def script(self, told: Told) -> None:
        """A script tells something."""

    def complain(self, place: Spot, text: str, words: str = "") -> None:
        """Tell the client what cannot be done; `words`: as a robot says it, "" for the text."""

    def _complain(self, text: str) -> None:
        self._note(text)
        self.complain(NOWHERE, text)

    def _note(self, text: str) -> None:
        self._peers.note(self._peer.interface, self._peer.number, f"text refused: {text}")


class PrimarySession(StreamSession):
    """Robot state ten times a second, and messages; `messages` False is the secondary interface."""

    def __init__(self, robot: Talking, peer: Peer, *, outbox: Outbox, writable: bool, state: RobotState, messages: bool) -> None:
        self._state, self._messages = state, messages
        self._safety: SafetyMode | None = None
        self._told = False  # the state, once
        outbox.send(version_message(robot.cabinet.clock))  # before all that ticks tell
        super().__init__(robot, peer, outbox=outbox, writable=writable)

    def tick(self, number: int) -> None:
        """At once and then every tenth of a second the state; the safety mode as soon as it changes."""
        if number % EVERY == 0 or not self._told:
            self._told = True
            self._tell_state()
        safety = self.cabinet.state.safety_mode
        if self._messages and safety is not self._safety:
            self._safety = safety
            self.outbox.send(safety_message(self.cabinet.clock, safety))

    def told(self, event: Event) -> None:
        """Messages: keys of programs, texts and errors of everything else that is more than a note."""
        if not self._messages:
            return
        if event.kind in KEYS and self._scripts.state is None and not self._scripts.arm.at_work:
            self.outbox.send(key_message(self.cabinet.clock, KEYS[event.kind], str(event.values["name"])))
        level = LEVELS.get(TABLE[event.kind].severity)
        if level is not None:
            self.outbox.send(error_message(self.cabinet.clock, level, " ".join(render(event)).strip(), self._code(event)))

    def _code(self, event: Event) -> Code:
        """By which a UR's clients know what stopped it."""
        number = CODES.get(event.kind)
        return OURS if number is None else Code(number, self.cabinet.joints.index(str(event.values["joint"])))

    def script(self, told: Told) -> None:
        """Messages of scripts: keys, texts, popups, and what went wrong with line and column."""
        if not self._messages:
            return
        clock = self.cabinet.clock
        if told.kind is Telling.STARTED:
            self.outbox.send(key_message(clock, "PROGRAM_XXX_STARTED", told.name))
        elif told.kind is Telling.ENDED:
            self.outbox.send(key_message(clock, "PROGRAM_XXX_STOPPED", told.name))
        elif told.kind is Telling.TEXT:
            self.outbox.send(text_of(clock, told.text))
        elif told.kind is Telling.POPUP:
            self.outbox.send(popup_message(clock, told.title, told.text, told.level))
        elif told.kind is Telling.QUESTION:
            self.outbox.send(question_message(clock, told.text, told.level))
        elif told.kind is Telling.ASIDE:
            self.outbox.send(key_message(clock, SECONDARY_EXCEPTION, told.words or told.text))
            self.outbox.send(text_of(clock, f"{told.name}, line {told.place.line}: {told.text}"))
        else:
            self.complain(told.place, told.text, told.words)

    def complain(self, place: Spot, text: str, words: str = "") -> None:
        """A runtime exception, and the text of it."""
        self.outbox.send(exception_message(self.cabinet.clock, place.line, place.column, words or text))
        self.outbox.send(text_of(self.cabinet.clock, text))

    def repeat(self) -> None:
        """Send the state again, while nothing is simulated."""
        self._tell_state()

    def _tell_state(self) -> None:
        self.send(self._state.primary() if self._messages else self._state.secondary())


class RealtimeSession(StreamSession):
    """A package every tick."""

    def __init__(self, robot: Talking, peer: Peer, *, outbox: Outbox, writable: bool) -> None:
        self._made = RealtimePackage(robot.cabinet)
        super().__init__(robot, peer, outbox=outbox, writable=writable)

    def tick(self, number: int) -> None:
        """Send the tick's package."""
        self.send(self._made.bytes())

    def repeat(self) -> None:
        """Send it again, while nothing is simulated."""
        self.tick(0)
