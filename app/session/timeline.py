"""A session's hand on the desk: turns its actions, tick by tick, into the wishes that the simulation reads."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from app.session.actions import (
    Action,
    Axes,
    ChangeSettings,
    DigitalInput,
    Hold,
    HoldJog,
    Laboratory,
    LoadProgram,
    OfClient,
    Press,
    Release,
    SelectTool,
    SetPayload,
    SetWalls,
    Tap,
    UseGripper,
    Wrench,
    triple,
)
from app.session.triggers import NEVER, Trigger
from pendant.decision import Decision
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.jog_move import Jogged
from pendant.program.steps import Program as Steps
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import Load
from sim.exchange.desk import Wishes
from sim.exchange.scoring import point_of
from sim.exchange.snapshot import Snapshot
from sim.plant.changes import AnyChange
from sim.plant.touch import Pull, Touch, Triple

BUTTONS = frozenset(button.value for button in Button)

COMMAND_OF_PROGRAM = {
    "start": Command.START_PROGRAM,
    "pause": Command.PAUSE_PROGRAM,
    "resume": Command.RESUME_PROGRAM,
    "stop": Command.STOP_PROGRAM,
}


@dataclass(slots=True)
class Entry:
    """One action and where it stands."""

    action: Action
    trigger: Trigger
    offset: int = 0  # the tick from which times are counted
    start: int | None = None  # the tick in which it began
    done: bool = False
    grabbed: Triple | None = None  # where a hold took hold, in W [m]

    def due(self) -> int | None:
        """The first tick in which the action acts, None while that is not known."""
        if self.action.at is not None:
            # A hand can take hold of an arm whose place is known, that is after one tick.
            return self.offset + max(ticks(self.action.at), 2 if isinstance(self.action, Hold) and not self.offset else 1)
        if self.trigger.happened is None:
            return None
        # What the robot did in a tick is seen after it, so the next tick is the first that can answer.
        return self.trigger.happened + max(1, ticks(self.action.delay))


@dataclass(slots=True)
class _Tick:
    """What one tick's actions add up to."""

    released: set[Button] = field(default_factory=set)
    commands: list[Command] = field(default_factory=list)
    settings: dict[str, float | bool | str] = field(default_factory=dict)
    changes: list[AnyChange] = field(default_factory=list)
    tool: str = ""
    load: Load | None = None
    borders: tuple[AnyBorder, ...] | None = None
    touches: list[Touch] = field(default_factory=list)
    jog: Jogged | None = None
    jog_released: bool = False


class Timeline:
    """Plays a list of actions. Call `wishes` before each tick and `see` after it, with ticks counted from 1, as in events.

    Args:
        actions: checked by app.session.prepare.prepare.
        joints: the arm's joint names, base to flange.
        program: loaded in the first tick.
    """

    def __init__(self, actions: Sequence[Action], joints: list[str], program: Steps | None = None) -> None:
        self._entries = [Entry(action, Trigger(action.after, action.nth)) for action in actions]
        self._joints = joints
        self._program = program
        self.of_clients: list[tuple[int, OfClient]] = []  # what clients do in this tick, with its place in the time line
        self._held: set[Button] = set()
        self._high: set[int] = set()  # digital inputs
        self._waiting = [entry for entry in self._entries if entry.trigger.happened is None]
        self._next = 0  # the next tick in which an action begins, goes on or ends
        self._quiet = Wishes(NOTHING, (), ())  # the wishes until then

    def add(self, actions: Sequence[Action], offset: int) -> None:
        """Play more actions, with times counted from the tick `offset`, which is done; what is over is forgotten."""
        new = [Entry(action, Trigger(action.after, action.nth), offset) for action in actions]
        self._entries = [entry for entry in self._entries if not entry.done] + new
        self._waiting += [entry for entry in new if entry.trigger.happened is None]
        self._next = 0

    def wishes(self, tick: int, snapshot: Callable[[], Snapshot]) -> Wishes:
        """The wishes for `tick`; `snapshot` copies the tick before, and is called only where a hand grabs the arm."""
        self.of_clients = []
        if tick < self._next:
            return self._quiet
        now = _Tick()
        self._next = NEVER
        for entry in self._entries:
            if entry.done:
                continue
            due = entry.due()
            if due is not None and tick >= due:
                if entry.start is None:
                    entry.start = tick
                self._act(entry, tick - entry.start, now, snapshot)
                due = NEVER if entry.done else tick + 1
            if due is not None:
                self._next = min(self._next, due)
        program, self._program = self._program, None
        released, commands = frozenset(now.released), tuple(now.commands)
        held, high = frozenset(self._held), frozenset(self._high)
        self._quiet = Wishes(Inputs(held=held, high=high), (), ())
        inputs = Inputs(
            held,
            released,
            commands,
            now.settings,
            program,
            high,
            now.tool,
            now.load,
            jog=now.jog,
            jog_released=now.jog_released,
            borders=now.borders,
        )
        return Wishes(inputs, tuple(now.touches), tuple(now.changes))

    def see(self, tick: int, decision: Decision) -> None:
        """Take in what the robot decided in `tick`."""
        for entry in self._waiting:
            entry.trigger.see(tick, decision)
            if entry.trigger.happened is not None:
                self._next = 0
        if self._next == 0:
            self._waiting = [entry for entry in self._waiting if entry.trigger.happened is None]

    @property
    def high(self) -> frozenset[int]:
        """Digital inputs that it keeps high."""
        return frozenset(self._high)

    def unstarted(self) -> list[tuple[int, Action]]:
        """Actions that never began, with their place in the time line: what they wait for did not happen in time."""
        return [(i, entry.action) for i, entry in enumerate(self._entries) if entry.start is None]

    def _act(self, entry: Entry, age: int, now: _Tick, snapshot: Callable[[], Snapshot]) -> None:
        """Do what `entry` does `age` ticks after its start."""
        action = entry.action
        if isinstance(action, Wrench | Hold):
            entry.done = age >= ticks(action.length)
            if not entry.done:
                now.touches.append(self._touch(entry, action, age * TICK, snapshot))
            return
        if isinstance(action, Tap) and action.control in BUTTONS:
            button = Button(action.control)
            entry.done = age >= ticks(action.length)
            if entry.done:
                self._let_go(button, now)
            else:
                self._held.add(button)
            return
        if isinstance(action, HoldJog):
            entry.done = now.jog_released = age >= ticks(action.length)
            now.jog = None if entry.done else action.move
            return
        entry.done = True
        if isinstance(action, OfClient):
            self.of_clients.append((self._entries.index(entry), action))
        else:
            self._at_once(action, now)

    def _at_once(self, action: Action, now: _Tick) -> None:
        """Do what takes no time."""
        match action:
            case DigitalInput():
                (self._high.add if action.high else self._high.discard)(action.input)
            case Press():
                self._held.add(Button(action.control))
            case Release():
                self._let_go(Button(action.control), now)
            case Tap():
                now.commands.append(Command(action.control))
            case LoadProgram():
                now.commands.append(COMMAND_OF_PROGRAM[action.command])
            case ChangeSettings() | Axes():
                now.settings.update(action.set)
            case SelectTool():
                now.tool = action.tool
            case SetPayload():
                now.load = action.load
            case SetWalls():
                now.borders = tuple(action.walls)
            case Laboratory() | UseGripper():
                now.changes.append(action.change)
            case _:
                raise AssertionError(f"{type(action).__name__} has no case here")

    def _let_go(self, button: Button, now: _Tick) -> None:
        self._held.discard(button)
        now.released.add(button)

    def _touch(self, entry: Entry, action: Wrench | Hold, t: float, snapshot: Callable[[], Snapshot]) -> Touch:
        if isinstance(action, Wrench):
            return action.push(t)
        if entry.grabbed is None:
            entry.grabbed = point_of(snapshot(), self._joints, action.part, action.point)
        share = min(1.0, t / action.length)
        x, y, z = (start + share * way for start, way in zip(entry.grabbed, action.carry, strict=True))
        return Pull(action.part, triple(action.point), (x, y, z), action.cap)
