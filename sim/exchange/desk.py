"""The slot between the outside and the loop: whoever acts writes the latest wish, the loop reads it once a tick."""

import threading
from dataclasses import dataclass, field

import msgspec

from pendant.equipment.tools import Tool
from pendant.inputs import Button, Command, Inputs
from pendant.program.jog_move import Jogged
from pendant.program.steps import Program
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import Load
from sim.plant.changes import AnyChange
from sim.plant.touch import Touch


class Wishes(msgspec.Struct, frozen=True, gc=False):
    """What the loop takes from the desk for one tick."""

    inputs: Inputs
    touches: tuple[Touch, ...]
    changes: tuple[AnyChange, ...]
    outputs: int | None = None  # the robot's digital outputs as bits; None: those of its program alone

    def joined(self, other: "Wishes") -> "Wishes":
        """The wishes of two for the same tick; where only one can have its way, it is `other`."""
        ours, theirs = self.inputs, other.inputs
        inputs = Inputs(
            ours.held | theirs.held,
            ours.released | theirs.released,
            ours.commands + theirs.commands,
            ours.settings | theirs.settings,
            theirs.program or ours.program,
            ours.high | theirs.high,
            theirs.tool or ours.tool,
            theirs.load or ours.load,
            theirs.tools or ours.tools,
            ours.remote_signal or theirs.remote_signal,
            theirs.jog or ours.jog,
            ours.jog_released or theirs.jog_released,
            theirs.script or ours.script,
            ours.borders if theirs.borders is None else theirs.borders,
            ours.load_time if theirs.load_time is None else theirs.load_time,
        )
        outputs = self.outputs if other.outputs is None else other.outputs
        return Wishes(inputs, self.touches + other.touches, self.changes + other.changes, outputs)


@dataclass(slots=True)
class Desk:
    """Latest values of touches and inputs, queues for what must not be lost. Every method may be called from any thread."""

    _lock: threading.Lock = field(default_factory=threading.Lock)
    _held: set[Button] = field(default_factory=set)
    _released: set[Button] = field(default_factory=set)
    _commands: list[Command] = field(default_factory=list)
    _settings: dict[str, float | bool | str] = field(default_factory=dict)
    _program: Program | None = None
    _changes: list[AnyChange] = field(default_factory=list)
    _touches: dict[str, Touch] = field(default_factory=dict)
    _high: frozenset[int] = frozenset()
    _tool: str = ""
    _load: Load | None = None
    _tools: tuple[Tool, ...] = ()
    _borders: tuple[AnyBorder, ...] | None = None
    _jog: Jogged | None = None
    _jog_released: bool = False

    def hold(self, button: Button) -> None:
        """Say that `button` is held now: a keep-alive (FD-23), good until the next tick."""
        with self._lock:
            self._held.add(button)
            self._released.discard(button)

    def release(self, button: Button) -> None:
        """Say that `button` was let go."""
        with self._lock:
            self._held.discard(button)
            self._released.add(button)

    def jog(self, move: Jogged) -> None:
        """Say that the button of this motion is held now: a keep-alive, good until the next tick."""
        with self._lock:
            self._jog, self._jog_released = move, False

    def stop_jogging(self) -> None:
        """Say that the button was let go."""
        with self._lock:
            self._jog, self._jog_released = None, True

    def command(self, command: Command) -> None:
        """Queue a one-shot command."""
        with self._lock:
            self._commands.append(command)

    def set(self, settings: dict[str, float | bool | str]) -> None:
        """Queue validated settings changes."""
        with self._lock:
            self._settings.update(settings)

    def load(self, program: Program) -> None:
        """Hand over a program; a later one before the next tick replaces it."""
        with self._lock:
            self._program = program

    def change(self, change: AnyChange) -> None:
        """Queue a laboratory change."""
        with self._lock:
            self._changes.append(change)

    @property
    def high(self) -> frozenset[int]:
        """Digital inputs that are high; they stay so until they are set low."""
        return self._high

    def wire(self, number: int, high: bool) -> None:
        """Give a digital input a level; it lasts."""
        with self._lock:
            self._high = self._high | {number} if high else self._high - {number}

    def choose(self, tool: str) -> None:
        """Say which tool of the table the controller is to use."""
        with self._lock:
            self._tool = tool

    def tabulate(self, tools: tuple[Tool, ...]) -> None:
        """Say what the table of tools is to be, all of it."""
        with self._lock:
            self._tools = tools

    def fence(self, borders: tuple[AnyBorder, ...]) -> None:
        """Say what walls and areas there are to be, all of them."""
        with self._lock:
            self._borders = borders

    def configure(self, load: Load) -> None:
        """Say what payload the controller is to believe in, beyond the tool."""
        with self._lock:
            self._load = load

    def touch(self, who: str, touch: Touch) -> None:
        """Set or move the touch of `who`; it lasts until `let_go`."""
        with self._lock:
            self._touches[who] = touch

    def let_go(self, who: str) -> None:
        """End the touch of `who`, if there is one."""
        with self._lock:
            self._touches.pop(who, None)

    def take(self) -> Wishes:
        """Read all wishes and empty the queues; touches and digital inputs stay as they are."""
        with self._lock:
            inputs = Inputs(
                frozenset(self._held),
                frozenset(self._released),
                tuple(self._commands),
                self._settings,
                self._program,
                self._high,
                tool=self._tool,
                load=self._load,
                tools=self._tools,
                jog=self._jog,
                jog_released=self._jog_released,
                borders=self._borders,
            )
            wishes = Wishes(inputs, tuple(self._touches.values()), tuple(self._changes))
            self._held = set()
            self._released = set()
            self._commands = []
            self._settings = {}
            self._program = None
            self._changes = []
            self._tool, self._load, self._tools, self._borders = "", None, (), None
            self._jog, self._jog_released = None, False
            return wishes

    def clear(self) -> None:
        """Forget every wish, touches and digital inputs too: after a reset nobody holds anything."""
        with self._lock:
            self._held, self._released = set(), set()
            self._commands, self._settings, self._changes = [], {}, []
            self._program = self._load = self._borders = None
            self._tool, self._tools, self._high = "", (), frozenset()
            self._jog, self._jog_released = None, False
            self._touches.clear()
