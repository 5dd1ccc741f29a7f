"""The controller cabinet: the one robot as its network interfaces see it, and the way of their wishes into its ticks."""

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Any

import msgspec

from app.robot_interface.controller.callers import Act, Ask, Between, Listener, at_once
from app.robot_interface.controller.controller_state import ControllerState
from app.robot_interface.controller.field_record import BEGIN, FieldRecord
from app.robot_interface.controller.measured_fields import MeasuredFields
from app.robot_interface.controller.program_folder import ProgramFolder
from app.robot_interface.controller.scripts_side import Scripts
from app.robot_interface.controller.status_fields import ALL_OUTPUTS, StatusFields, set_outputs
from app.session.actions import Action
from app.session.timeline import Timeline
from pendant.decision import Decision
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect
from pendant.inputs import Command, Inputs
from pendant.program.steps import is_script
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.exchange.desk import Wishes
from sim.exchange.snapshot import Snapshot
from sim.gripping.finger_drive import GripperState
from sim.plant.changes import DriveGripper
from sim.simulation import Simulation

AT_MOST = ticks(1.5)
"""Ticks that a wish waits for the arm to stand still; then the robot says itself that it moves."""

MOST_DRIVES = 100
"""Orders to the gripper that wait for the next tick: so many, the last ones, are kept while nothing is simulated."""


class Cabinet:
    """Acts in the loop beside whoever else does, and stays through resets (sim.run.loop.Script).

    Args:
        simulation: gives what runs now.
        joints: names of the arm's joints, base to flange.
        programs: that can be loaded.
        high: gives the digital inputs that whoever is at the desk keeps high.
        between: has work done between two ticks, on the thread that does them.
        remote: it begins in remote control.

    Attributes:
        between: as given.
        state: the controller as of the last tick, replaced whole; the loop's thread writes it.
        ticks: done so far, through resets too.
        gripper: as it was after the last tick, None without one; the loop's thread writes it.
        free_drive_until: tick up to which the remote controller asks for free-drive: its signal, kept alive.
        free_drive_by_input: the same of digital inputs that ask for it; the loop's thread writes it.
        writes: how often each input of RTDE was written; by the network's thread.
    """

    def __init__(
        self,
        simulation: Callable[[], Simulation],
        joints: list[str],
        programs: ProgramFolder,
        high: Callable[[], frozenset[int]] = frozenset,
        *,
        between: Between = at_once,
        remote: bool = True,
    ) -> None:
        self._simulation, self.joints, self._high, self.between = simulation, joints, high, between
        self.programs = programs
        self.state = ControllerState(remote=remote)
        self.record = FieldRecord()
        self._switched = self.record.field("actual_digital_output_bits")
        self._measured, self._status = MeasuredFields(self.record), StatusFields(self.record)
        self._lock = threading.Lock()
        self._asks: list[Ask] = []
        self._asked: list[Ask] = []  # of the tick that runs
        self._listeners: tuple[Listener, ...] = ()
        self._acts: list[Act] = []  # to begin with the next tick
        self._drives: deque[DriveGripper] = deque(maxlen=MOST_DRIVES)  # for the next tick
        self.gripper: GripperState | None = None
        self._timeline = Timeline([], joints)
        self._static = False  # the arm stood still in the last tick
        self._seen: Decision | None = None  # of the last tick
        self.ticks = 0
        self._settled = False  # the robot has been brought into remote control
        self.free_drive_until = self.free_drive_by_input = 0
        self._wanted = False  # in the last tick
        self.script: Scripts | None = None  # runs scripts
        self.writes: dict[str, int] = {}

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

        Actions are checked already. While nothing is simulated, there is no result yet; where the simulation starts over before
        their first tick, they are not played, and the result is cancelled.
        """
        act = Act(actions, Future())
        with self._lock:
            self._acts.append(act)
        return act.begun

    def drive(self, change: DriveGripper) -> None:
        """Have the gripper do something in the next tick; without one it is for nothing."""
        with self._lock:
            self._drives.append(change)

    def listen(self, listener: Listener) -> None:
        """Tell somebody of every tick."""
        with self._lock:
            self._listeners = (*self._listeners, listener)

    def forget(self, listener: Listener) -> None:
        """Tell somebody no more."""
        with self._lock:
            self._listeners = tuple(each for each in self._listeners if each is not listener)

    def change(self, **values: Any) -> "Future[None]":
        """Have fields of `state` changed that no tick decides, such as `popup`; it is so when the result is there."""
        return self.between(lambda: self.set(**values))

    def set(self, **values: Any) -> None:
        """The same at once, on the loop's thread."""
        self.state = msgspec.structs.replace(self.state, **values)

    def turn_conveyor(self, encoder: int, rate: float) -> "Future[None]":
        """Have a conveyor turn an encoder of the robot, 0 or 1, from now on [ticks/s]."""

        def turn() -> None:
            rates = list(self.state.conveyors)
            rates[encoder] = rate
            self.set(conveyors=tuple(rates))

        return self.between(turn)

    def look(self, *names: str) -> "Future[tuple[float | list[float], ...]]":
        """The values of output fields of RTDE after the tick done last, worked out now."""
        return self.between(lambda: self._worked_out(names))

    def _worked_out(self, names: tuple[str, ...]) -> tuple[float | list[float], ...]:
        self.refresh()
        return tuple(self.record.get(name) for name in names)

    def note(self, event: Event) -> None:
        """Take in what no tick decided, and tell everybody; on the loop's thread."""
        if event.kind is Kind.BROKEN_DOWN:
            self.set(failure=str(event.values["reason"]))
            self._status.tell(self.state, ending=False)
        for listener in self._listeners:
            listener.told(event)

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
            drives = tuple(self._drives)
            self._drives.clear()
        for act in acts:
            if act.begun.set_running_or_notify_cancel():
                self._timeline.add(act.actions, tick - 1)
                act.begun.set_result(tick - 1)
        commands = [command for ask in self._asked for command in ask.commands]
        if self.state.remote and not self._settled:
            commands.append(Command.REMOTE)
        self._settled = True
        scripted = None if self.script is None else self.script.wishes(tick)
        wanted = self.ticks < max(self.free_drive_until, self.free_drive_by_input)
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
        outputs = None
        if self._simulation().gripper is not None:
            outputs = int(self._switched.item())
        else:
            drives = ()
        wishes = Wishes(inputs, (), drives, outputs).joined(self._timeline.wishes(tick, snapshot))
        return wishes if scripted is None else scripted.joined(wishes)

    def see(self, tick: int, decision: Decision) -> None:
        """Take in what the robot decided, and tell everybody."""
        self.ticks += 1
        self._static = decision.static
        gripper = self._simulation().gripper
        self.gripper = None if gripper is None else gripper.state
        listeners = self._listeners
        self._timeline.see(tick, decision)
        if self.script is not None:
            self.script.see(decision)
        self._understand(tick, decision)
        self._status.follow(decision)
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
            gripper = self._simulation().gripper
            detected = None if gripper is None else gripper.detected_input
            high = self._high() | self._timeline.high
            self._status.fill(self.state, self._seen, high if detected is None else high | {detected})

    def repeat(self) -> None:
        """Nothing has been simulated for a while: have everybody say that the robot is still there; on the loop's thread."""
        self._status.tell(self.state, ending=False)
        for listener in self._listeners:
            listener.repeat()

    def again(self) -> None:
        """The same while the loop is busy, for example with another simulation that is built; from any thread."""
        for listener in self._listeners:
            listener.again()

    def _begin(self) -> None:
        """A simulation starts: faults of the one before are over, outputs are low, and who had control has it again."""
        with self._lock:
            acts, self._acts = self._acts, []
            self._drives.clear()
        for act in acts:
            act.begun.cancel()
        self._timeline = Timeline([], self.joints)
        self.state = ControllerState(remote=self.state.remote, operational=self.state.operational)
        self._settled = self._static = False
        self._seen = None
        self.free_drive_until = self.free_drive_by_input = 0
        self._wanted = False
        if self.script is not None:
            self.script.begin()
        set_outputs(self.record, ALL_OUTPUTS, 0)  # after the script, whose end may switch some

    def _understand(self, tick: int, decision: Decision) -> None:
        idle = None
        for ask in self._asked:
            idle = idle if ask.idle is None else ask.idle
        before, script = self.state, self.script
        self.state = before.after(tick, decision, None if script is None else script.state, idle)
        for event in decision.events:
            if event.kind is Kind.RESET and before.remote:  # a reset leads to TEACH; it takes nobody's control
                self._settled = False
                self.set(remote=True)
            elif event.kind is Kind.PROGRAM_LOADED:
                program = self._simulation().supervisor.program
                if program is not None and not is_script(program):  # what a client sends as a script is never loaded
                    self.set(loaded=program, ready=True)
                else:
                    self.set(ready=False)
            elif event.kind is Kind.POWERED_OFF:
                self.set(popup="")
            elif TABLE[event.kind].effect is Effect.NO_ENTRY:
                self.set(refusal=" ".join(render(event)[:2]))
            elif event.kind is Kind.ENTERED:
                self.set(refusal="")
