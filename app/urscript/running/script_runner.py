"""Runs scripts in the robot's ticks: one program, and secondary programs beside it."""

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError
from contextlib import suppress

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.robot_words import RobotMode, RuntimeState
from app.robot_interface.gripper.gripper_registers import GripperRegisters
from app.urscript.functions.library_of_functions import builtins_of
from app.urscript.functions.sensing_values import HISTORY
from app.urscript.language import tree
from app.urscript.language.reading import read_script
from app.urscript.language.trouble import NOWHERE, ScriptTrouble, Spot
from app.urscript.machine.machine import Machine
from app.urscript.robot.robot_memory import RobotMemory
from app.urscript.running.garbage import uncollected
from app.urscript.running.input_watchdog import InputWatchdog
from app.urscript.running.orders import NOTHING_ORDERED, Orders
from app.urscript.running.script_arm import ScriptArm
from app.urscript.running.script_robot import OfferedScript, ScriptRobot, joined
from app.urscript.running.secondary_programs import SecondaryPrograms
from app.urscript.running.told import Telling, Told, printable
from pendant.decision import Decision
from pendant.inputs import NOTHING
from pendant.tick.modes import Mode
from sim.exchange.desk import Wishes

KEPT = 200
"""Messages that are remembered."""

PARTING = 1.0
"""Time in which a tick must have ended, so that all that scripts have begun can end [s]."""

BREATHLESS = (
    "warning: line {}: the program computes without end; a sync() or sleep() in such a loop lets the robot do other things"
)
"""A robot goes on, too (URScript manual, "Thread scheduling"); controllers of the CB series end the program."""


class ScriptRunner:
    """Beside the cabinet, in its ticks. `offer`, `stop`, `pause` and `resume` may be called from any thread.

    What the loop's thread runs is its own; others read values that it replaces whole (docs/explanation/threads.md).

    Args:
        cabinet: the robot.

    Attributes:
        told: the last messages.
        line: of the script that runs, 0: none does.
        text: of the script that ran last.
        trouble: of the one that ran last.
        gripper: the registers of the robot's gripper, for scripts and for its port.
    """

    def __init__(self, cabinet: Cabinet) -> None:
        self.cabinet = cabinet
        self.gripper = GripperRegisters(cabinet)
        self._lock = threading.Lock()  # of what is told, and to whom
        self._orders = Orders()
        self._beside = SecondaryPrograms(self._close)
        self._running: OfferedScript | None = None
        self._listeners: tuple[Callable[[Told], None], ...] = ()
        self._history: deque[tuple[float, ...]] = deque(maxlen=HISTORY + 1)
        self._watchdog = InputWatchdog(cabinet)
        self._warned = False  # that the script that runs computes without end
        self.told: tuple[Told, ...] = ()
        self.paused = False
        self.line = 0
        self.text = ""
        self.trouble: ScriptTrouble | None = None
        self.arm = ScriptArm()
        self.memory = RobotMemory(cabinet)
        cabinet.script = self

    # from any thread

    def listen(self, listener: Callable[[Told], None]) -> None:
        """Tell somebody what scripts tell, on the thread where it happens."""
        with self._lock:
            self._listeners = (*self._listeners, listener)

    def forget(self, listener: Callable[[Told], None]) -> None:
        """Tell somebody no more."""
        with self._lock:
            self._listeners = tuple(each for each in self._listeners if each != listener)

    def offer(self, text: str, hosts: frozenset[str] = frozenset()) -> str:
        """Run a script from the next tick on, in place of the one that runs; a secondary one beside it.

        Args:
            text: of the script.
            hosts: addresses other than this machine that its sockets may connect to.

        Returns:
            Its name.

        Raises:
            ScriptTrouble: it cannot be read, or the robot cannot run it now.
        """
        try:
            script = self._made(text, hosts)
            self._take(script)
        except ScriptTrouble as trouble:
            self.tell(Told(Telling.TROUBLE, trouble.text, place=trouble.place, words=trouble.words))
            raise
        return script.machine.script.name

    def _take(self, script: OfferedScript) -> None:
        if script.machine.script.secondary:
            self._orders.run_beside(script, len(self._beside))
        else:
            self._orders.run(script)

    def stop(self) -> None:
        """End the script that runs, and the one that waits."""
        self._orders.stop()

    def pause(self) -> None:
        """Let it wait; the arm comes to rest."""
        self._orders.halt(True)

    def resume(self) -> None:
        """Let it go on, as soon as the arm stands."""
        self._orders.halt(False)

    def close(self) -> None:
        """The robot is there no more: programs, connections and threads of its end, as soon as a tick that runs is done."""
        with suppress(CancelledError, TimeoutError):  # the loop has ended, or does it later
            self.cabinet.between(self._end_all).result(PARTING)

    def tell(self, told: Told) -> None:
        """Tell everybody."""
        with self._lock:
            self.told = (*self.told[1 - KEPT :], told)
        for listener in self._listeners:
            listener(told)

    @property
    def state(self) -> RuntimeState | None:
        """Of the script; None: there is none, and the robot's own programs count."""
        if self._running is None:
            return None
        return RuntimeState.PAUSED if self.paused or self.arm.halted else RuntimeState.PLAYING

    @property
    def name(self) -> str:
        """Of the script that runs."""
        running = self._running
        return "" if running is None else running.machine.script.name

    @property
    def reads(self) -> bool:
        """A script runs, which may read the robot's record."""
        return self._running is not None or bool(self._beside)

    def variables(self) -> dict[str, str]:
        """Of the script that runs."""
        running = self._running
        return {} if running is None else running.machine.variables()

    def _made(self, text: str, hosts: frozenset[str]) -> OfferedScript:
        state = self.cabinet.state
        if state.robot_mode is not RobotMode.RUNNING or state.mode is Mode.STOP:
            raise ScriptTrouble(NOWHERE, "the robot does not run: power on and release the brakes, or reset it, first")
        robot = ScriptRobot(self.cabinet, self.arm, hosts, self.tell, memory=self.memory, gripper=self.gripper)
        self._orders.let_go()
        with uncollected(len(text)):
            body = read_script(text)
            secondary = len(body) == 1 and getattr(body[0], "kind", "") == "sec"
            try:
                machine = Machine(body, builtins_of(robot, self._history, secondary))
            finally:
                tree.let_go(body)
        return OfferedScript(machine, robot, text)

    # on the loop's thread

    def wishes(self, tick: int) -> Wishes | None:
        """What the script wants of the tick that begins; None: nothing."""
        self._change()
        inputs = NOTHING
        running = self._running
        if running is not None and not (self.paused or self.arm.halted):
            over = running.machine.tick()
            self.line = running.machine.line
            inputs = running.robot.taken()
            if over:
                self._end(running.machine.trouble, whole=running.machine.trouble is None)
            elif running.robot.watchdog is not None:
                self._watch(running.robot)
            if running.machine.breathless is not None and not self._warned:
                self._warned = True
                self.tell(Told(Telling.TEXT, BREATHLESS.format(running.machine.breathless.line), running.machine.script.name))
        found = self.memory.step()
        if found:
            self._note(found)
        if self._beside:
            inputs = self._beside.step(inputs)
        equips = inputs is not NOTHING and bool(inputs.load or inputs.tool or inputs.tools)
        inputs = joined(inputs, self.arm.inputs(equips))
        return None if inputs is NOTHING else Wishes(inputs, (), ())

    def see(self, decision: Decision) -> None:
        """Take in what the robot decided."""
        refusal = self.arm.refusal
        self.arm.see(decision)
        self._beside.see(decision)
        if self._running is None:
            return
        self._running.robot.see(decision)
        self._history.appendleft(tuple(self.cabinet.simulation.estimate.q.tolist()))
        if decision.mode is Mode.STOP or self.arm.gone:
            self._end(self._unable(refusal or self.arm.refusal))
        elif refusal and refusal == self.arm.refusal:  # nobody waits for what was refused
            self._end(self._unable(refusal))

    def _note(self, text: str) -> None:
        """Tell people something; while a program runs, it counts as one of its messages."""
        if self._running is not None:
            self._running.robot.say(text)
        else:
            self.tell(Told(Telling.TEXT, printable(text)))

    def _unable(self, reason: str) -> ScriptTrouble | None:
        """Why the arm could not do what the script asked for, at the line that it has come to."""
        return ScriptTrouble(Spot(max(self.line, 1), 1), reason) if reason else None

    def begin(self) -> None:
        """The simulation starts over: no script runs."""
        self._end_all()
        self.memory = RobotMemory(self.cabinet)
        self.gripper.begin()
        self.arm.begin()  # the same one: a script that is being read has it already

    def _end_all(self) -> None:
        """No script runs, and nothing is left that one has begun."""
        self._end(None)
        self._beside.end()
        self.memory.end()

    def _change(self) -> None:
        """Do what others asked for since the last tick."""
        ordered = self._orders.take()
        if ordered is NOTHING_ORDERED:
            return
        script, beside = ordered.script, [each for each in ordered.beside if not self._outdated(each)]
        if script is not None and self._outdated(script):
            script = None
        if script is not None or beside:
            self.cabinet.refresh()
        if script is not None or ordered.stop:
            self._end(None)
        if script is not None:
            self._running, self.text, self.trouble, self.paused = script, script.text, None, False
            self._history.clear()
            self._watchdog, self._warned = InputWatchdog(self.cabinet), False
            self.memory.begin_program()
            self.tell(Told(Telling.STARTED, "", script.machine.script.name))
        if ordered.halt is not None:
            self._halted(ordered.halt)
        self._beside.add(beside)

    def _outdated(self, script: OfferedScript) -> bool:
        """Whether a script was read for the robot before a restart, which is no more; it is told and closed then."""
        if script.robot.memory is self.memory:
            return False
        self._close(script, ScriptTrouble(NOWHERE, "the simulation has started over"))
        return True

    def _halted(self, wait: bool) -> None:
        """Have the script wait, or go on."""
        if not wait:
            self.paused = False
            self.arm.resume()
        elif self._running is not None and not self.paused:
            self.paused = True
            self.arm.pause()

    def _watch(self, robot: ScriptRobot) -> None:
        """End or pause a script whose client is silent for longer than it said."""
        assert robot.watchdog is not None
        late = self._watchdog.late(*robot.watchdog)
        if late:
            self.tell(Told(Telling.TEXT, late))
            if robot.watchdog[2] == "stop":
                self._end(None)
            else:
                self._halted(True)

    def _end(self, trouble: ScriptTrouble | None, *, whole: bool = False) -> None:
        running = self._running
        if running is None:
            return
        self._running, self.trouble, self.line = None, trouble, 0
        running.machine.stop()
        self.arm.end(whole=whole)
        self.memory.end_program()
        self._close(running, trouble)
        self.tell(Told(Telling.ENDED, "", running.machine.script.name))

    def _close(self, script: OfferedScript, trouble: ScriptTrouble | None) -> None:
        script.machine.stop()
        script.robot.sockets.end()
        self._orders.used_up(script)
        if trouble is not None:
            outline = script.machine.script
            kind = Telling.ASIDE if outline.secondary else Telling.TROUBLE
            self.tell(Told(kind, printable(trouble.text), outline.name, trouble.place, words=trouble.words))
