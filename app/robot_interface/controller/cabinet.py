"""The controller cabinet: the one robot as its network interfaces see it, and the way of their wishes into its ticks."""

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from app.robot_interface.controller.controller_state import ControllerState
from app.robot_interface.controller.field_record import BEGIN, FieldRecord
from app.robot_interface.controller.measured_fields import MeasuredFields
from app.robot_interface.controller.program_folder import ProgramFolder
from app.robot_interface.controller.scripts_side import Scripts
from app.robot_interface.controller.status_fields import StatusFields
from app.session.actions import Action
from app.session.timeline import Timeline
from pendant.decision import Decision
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect
from pendant.inputs import Command, Inputs
from pendant.program.steps import Program, is_script
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.arm.scenario import Load
from sim.exchange.desk import Wishes
from sim.exchange.snapshot import Snapshot
from sim.simulation import Simulation


class Listener(Protocol):
    """Who is told of every tick, on the loop's thread."""

    def tick(self, number: int) -> None:
        """A tick is done; `number` counts all of them, through resets too."""
        ...

    def told(self, event: Event) -> None:
        """Something happened in it."""
        ...

    def repeat(self) -> None:
        """No tick has been done for a while: say again what was said last, on the network's thread."""
        ...


AT_MOST = ticks(1.5)
"""Ticks that a wish waits for the arm to stand still; then the robot says itself that it moves."""


@dataclass(slots=True)
class Ask:
    """What a client asks the robot for, for one tick: the next, or the first in which the arm stands still."""

    commands: tuple[Command, ...] = ()
    settings: dict[str, float | bool | str] = field(default_factory=dict)
    program: Program | None = None
    load: Load | None = None
    standing: bool = False  # a robot takes it only where the arm stands
    waited: int = 0  # ticks for that
    done: "Future[tuple[Event, ...]]" = field(default_factory=Future)  # the events of that tick


class Act(NamedTuple):
    """Actions that wait for the next tick."""

    actions: Sequence[Action]
    begun: "Future[int]"  # the tick from which their times count


class Cabinet:
    """Acts in the loop beside whoever else does, and stays through resets (sim.run.loop.Script).

    Args:
        simulation: gives what runs now.
        joints: names of the arm's joints, base to flange.
        programs: that can be loaded.
        high: gives the digital inputs that whoever is at the desk keeps high.
    """

    def __init__(
        self,
        simulation: Callable[[], Simulation],
        joints: list[str],
        programs: ProgramFolder,
        high: Callable[[], frozenset[int]] = frozenset,
    ) -> None:
        self._simulation, self._joints, self._high = simulation, joints, high
        self.programs = programs
        self.state = ControllerState()
        self.record = FieldRecord()
        self._measured, self._status = MeasuredFields(self.record), StatusFields(self.record)
        self._lock = threading.Lock()
        self._asks: list[Ask] = []
        self._asked: list[Ask] = []  # of the tick that runs
        self._listeners: tuple[Listener, ...] = ()
        self._acts: list[Act] = []  # to begin with the next tick
        self._timeline = Timeline([], joints)
        self._static = False  # the arm stood still in the last tick
        self._seen: Decision | None = None  # of the last tick
        self.ticks = 0  # done so far, through resets too
        self.events: list[Event] = []  # of the running simulation
        self._settled = False  # the robot has been brought into remote control
        self.free_drive_until = 0  # tick up to which the remote controller asks for free-drive: its signal, kept alive
        self._wanted = False  # in the last tick
        self.script: Scripts | None = None  # runs scripts
        self.writes: dict[str, int] = {}  # how often each input of RTDE was written

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        return self._simulation()

    @property
    def clock(self) -> float:
        """What the controller's clock shows [s]; it never goes back."""
        return BEGIN + self.ticks * TICK

    def ask(self, ask: Ask) -> "Future[tuple[Event, ...]]":
        """Hand over a wish for the next tick; the result is what happened in it."""
        with self._lock:
            self._asks.append(ask)
        return ask.done

    def act(self, actions: Sequence[Action]) -> "Future[int]":
        """Play actions from the next tick on; the result is the tick before it, from which their times count.

        Actions are checked already. While nothing is simulated, there is no result yet.
        """
        act = Act(actions, Future())
        with self._lock:
            self._acts.append(act)
        return act.begun

    def listen(self, listener: Listener) -> None:
        """Tell somebody of every tick."""
        with self._lock:
            self._listeners = (*self._listeners, listener)

    def forget(self, listener: Listener) -> None:
        """Tell somebody no more."""
        with self._lock:
            self._listeners = tuple(each for each in self._listeners if each is not listener)

    def fresh(self, name: str) -> float | list[float]:
        """The value of an RTDE field in the tick done last."""
        return self.record.get(name)

    def wishes(self, tick: int, snapshot: Callable[[], Snapshot]) -> Wishes:
        """What the clients, and the faults on command, want of the next tick."""
        if tick == 1:
            self._begin()
        with self._lock:
            ready = [ask for ask in self._asks if self._static or not ask.standing or ask.waited >= AT_MOST]
            self._asks = [ask for ask in self._asks if not any(ask is each for each in ready)]
            for ask in self._asks:
                ask.waited += 1
            self._asked = [ask for ask in ready if ask.done.set_running_or_notify_cancel()]
            acts, self._acts = self._acts, []
        for act in acts:
            self._timeline.add(act.actions, tick - 1)
            act.begun.set_result(tick - 1)
        commands = [command for ask in self._asked for command in ask.commands]
        if self.state.remote and not self._settled:
            commands.append(Command.REMOTE)
        self._settled = True
        scripted = None if self.script is None else self.script.wishes(tick)
        wanted = self.ticks < self.free_drive_until
        if self._wanted and not wanted:
            commands.append(Command.LEAVE_FREE_DRIVE)
        self._wanted = wanted
        inputs = Inputs(commands=tuple(commands), remote_signal=self._wanted)
        for ask in self._asked:
            inputs = Inputs(
                commands=inputs.commands,
                settings=inputs.settings | ask.settings,
                program=ask.program or inputs.program,
                load=ask.load or inputs.load,
                remote_signal=inputs.remote_signal,
            )
        wishes = Wishes(inputs, (), ()).joined(self._timeline.wishes(tick, snapshot))
        return wishes if scripted is None else scripted.joined(wishes)

    def see(self, tick: int, decision: Decision) -> None:
        """Take in what the robot decided, and tell everybody."""
        self.ticks += 1
        self._static = decision.static
        listeners = self._listeners
        self._timeline.see(tick, decision)
        if self.script is not None:
            self.script.see(decision)
            self.state.script = self.script.state
        self._understand(tick, decision)
        self.record.put("timestamp", self.clock)
        self.record.put("control_step", self.ticks)
        self._seen = decision
        if listeners or (self.script is not None and self.script.reads):
            self.refresh()
        for listener in listeners:
            for event in decision.events:
                listener.told(event)
            listener.tick(self.ticks)
        for ask in self._asked:
            ask.done.set_result(decision.events)
        self._asked = []

    def refresh(self) -> None:
        """Have the record say how the last tick was: it is kept up only while somebody listens, or a script reads it."""
        if self._seen is not None:
            self._measured.fill(self._simulation(), self._seen)
            self._status.fill(self.state, self._seen, self._high() | self._timeline.high)

    def repeat(self) -> None:
        """Nothing has been simulated for a while; the network's thread has everybody say that the robot is still there."""
        self._status.tell(self.state, ending=False)
        for listener in self._listeners:
            listener.repeat()

    def _begin(self) -> None:
        """A simulation starts: faults of the one before are over, and who had control has it again."""
        with self._lock:
            self._acts = []
        self._timeline = Timeline([], self._joints)
        self.state = ControllerState(remote=self.state.remote, operational=self.state.operational)
        self.events = []
        self._settled = self._static = False
        self._seen = None
        self.free_drive_until, self._wanted = 0, False
        if self.script is not None:
            self.script.begin()

    def _understand(self, tick: int, decision: Decision) -> None:
        state = self.state
        remote = state.remote
        state.see(tick, decision)
        self.events += decision.events
        for event in decision.events:
            if event.kind is Kind.RESET and remote:  # a reset leads to TEACH; it takes nobody's control
                self._settled, state.remote = False, True
            elif event.kind is Kind.PROGRAM_LOADED:
                program = self._simulation().supervisor.program
                if program is not None and not is_script(program):  # what a client sends as a script is never loaded
                    state.loaded = program
            elif TABLE[event.kind].effect is Effect.NO_ENTRY:
                state.refusal = " ".join(render(event)[:2])
            elif event.kind is Kind.ENTERED:
                state.refusal = ""
