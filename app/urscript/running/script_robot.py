"""The robot, as the functions of one script see it."""

import math
from collections.abc import Callable, Generator
from dataclasses import replace
from typing import Any, NamedTuple

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.question import Question
from app.robot_interface.gripper.gripper_registers import GripperRegisters
from app.urscript.calculation.pose_algebra import to_rpy
from app.urscript.language.trouble import Misuse
from app.urscript.machine.limits import MOST_MESSAGES
from app.urscript.machine.machine import Machine
from app.urscript.outside.hosts import AllowedHosts
from app.urscript.outside.script_sockets import ScriptSockets
from app.urscript.robot.robot_memory import RobotMemory
from app.urscript.robot.robot_side import ArmSide
from app.urscript.running.told import Telling, Told, printable
from pendant.decision import Decision
from pendant.equipment.load import Load
from pendant.equipment.tools import Tool, tool_problem
from pendant.events.event import Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.tick.modes import TICK_RATE
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

TOOL_NAME = "script"
"""Of the tool that set_tcp() changes to."""


class ScriptRobot:
    """See `app.urscript.robot.robot_side.RobotSide`.

    Args:
        cabinet: the robot.
        arm: moves it.
        senders: addresses other than this machine's that this script may call.
        tell: takes what the script tells.
        memory: what the robot keeps from one program to the next.
        gripper: what its own gripper's port answers; None: it has no such port.
    """

    def __init__(
        self,
        cabinet: Cabinet,
        arm: ArmSide,
        senders: frozenset[str],
        tell: Callable[[Told], None],
        *,
        memory: RobotMemory,
        gripper: GripperRegisters | None = None,
    ) -> None:
        self._cabinet, self._tell, self.memory = cabinet, tell, memory
        self.arm, self.record, self.seed = arm, cabinet.record, cabinet.simulation.scenario.seed
        self.hosts = AllowedHosts(senders, self.say)
        self.sockets = ScriptSockets(self.hosts, gripper)
        self.watchdog: tuple[str, int, str] | None = None  # variable, ticks that it may be silent, action
        self.asks: list[Ask] = []  # for the tick that begins
        self.tool: Tool | None = None  # to be used from now on
        self._equips = False  # tool or payload are to change in the tick that runs
        self._transition = 0.0  # in which they do [s]
        self.refused = ""  # why they were not
        self._said, self._second = 0, -1

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        return self._cabinet.simulation

    @property
    def clock(self) -> float:
        """The controller's [s]."""
        return self._cabinet.clock

    def say(self, text: str) -> None:
        """To the log, and to clients; too many in a second are left out."""
        second = self._cabinet.ticks // TICK_RATE
        if second != self._second:
            self._said, self._second = 0, second
        self._said += 1
        if self._said <= MOST_MESSAGES:
            self._tell(Told(Telling.TEXT, printable(text)))
        elif self._said == MOST_MESSAGES + 1:
            self._tell(Told(Telling.TEXT, f"(more than {MOST_MESSAGES} messages in a second: the others are left out)"))

    def popup(self, text: str, title: str, level: str, blocking: bool) -> None:
        """Show a message."""
        self._cabinet.set(popup=printable(text))
        self._tell(Told(Telling.POPUP, printable(text), title=printable(title), level=level))

    def question(self, kind: str, text: str) -> Generator[None, None, Any]:
        """Ask people for a value, and wait for it."""
        asked = Question(kind, printable(text))
        self._cabinet.set(question=asked)
        self._tell(Told(Telling.QUESTION, asked.text, level=kind))
        try:
            while asked.answer is None:
                yield
            return asked.answer
        finally:
            if self._cabinet.state.question is asked:
                self._cabinet.set(question=None)

    @property
    def popup_shown(self) -> bool:
        """A popup is there that nobody has closed."""
        return bool(self._cabinet.state.popup)

    def command(self, word: str, **values: Any) -> None:
        """Something of the robot other than its motion."""
        if word == "protective_stop":
            self.asks.append(Ask((Command.PROTECTIVE_STOP,)))
        elif word == "power_off":
            self.asks.append(Ask((Command.POWER_OFF,)))
        elif word == "gravity":
            self._gravity(values["gravity"])
        elif word == "watchdog":
            self._watch(**values)
        elif word == "external_sensor" and values["enable"]:
            raise Misuse("an external force sensor is not simulated; the robot's own is used")

    def equip(self, word: str, **values: Any) -> Generator[None, None, None]:
        """Change the payload or the tool centre point; both are in effect after two ticks, where the robot takes them.

        The first tick decides; with the second, estimates and the kinematics of the script count with what was decided.
        """
        if word == "payload":
            self._payload(**values)
        else:
            self._tcp(values["pose"])
        yield
        if self.refused:
            reason, self.refused = self.refused, ""
            raise Misuse(reason)
        yield

    def see(self, decision: Decision) -> None:
        """Take in a tick in which tool or payload were to change."""
        if self._equips:
            reasons = [str(event.values["reason"]) for event in decision.events if event.kind is Kind.TOOL_REFUSED]
            self.refused, self._equips = "; ".join(dict.fromkeys(reasons)), False

    def taken(self) -> Inputs:
        """What the script asked of the robot other than motion, for the tick that begins."""
        if not self.asks and self.tool is None:
            return NOTHING
        inputs = NOTHING
        asks, self.asks = self.asks, []
        for ask in asks:
            inputs = joined(inputs, Inputs(commands=ask.commands, settings=ask.settings, load=ask.load))
        if self.tool is not None:
            made, self.tool = self.tool, None
            table = tuple(each for each in self.simulation.tools if each.name != made.name)
            kept = inputs.load or self.simulation.supervisor.fitting.load  # else the payload would go with the last tool
            inputs = joined(inputs, Inputs(tools=(*table, made), tool=made.name, load=kept))
        self._equips = inputs.load is not None
        if self._equips:
            inputs, self._transition = replace(inputs, load_time=self._transition), 0.0
        return inputs

    def _payload(self, mass: float, cog: Any, inertia: Any, transition: float) -> None:
        """What UR calls payload is the tool and what it carries; the tool in use keeps its part."""
        fitting = self.simulation.supervisor.fitting
        tool = fitting.tool
        load = mass - tool.mass
        if load < -1e-6:
            raise Misuse(f"m: the tool {tool.name} alone has {tool.mass:g} kg")
        if load < 1e-6:
            self.asks.append(Ask(load=Load(mass=0.0, com=[0.0, 0.0, 0.0])))
            self._transition = transition
            return
        com = [(mass * c - tool.mass * t) / load for c, t in zip(cog, tool.com, strict=True)]
        moments = list(inertia) if inertia is not None and any(inertia) else None
        self.asks.append(Ask(load=Load(mass=load, com=com, inertia=moments)))
        self._transition = transition

    def _tcp(self, pose: Any) -> None:
        """A tool like the one in use, with another tool centre point."""
        tool = self.simulation.supervisor.fitting.tool
        rpy = list(to_rpy(tuple(pose[3:])))
        made = Tool(name=TOOL_NAME, mass=tool.mass, com=tool.com, tcp=list(pose[:3]), rpy=rpy, inertia=tool.inertia)
        problem = tool_problem(made, self.simulation.arm.payload)
        if problem is not None:
            raise Misuse(f"pose: {problem.field} = {problem.value}, allowed: {problem.allowed}")
        self.tool = made

    def _gravity(self, gravity: Any) -> None:
        now = -self.simulation.estimate.g_B
        if math.dist(gravity, now.tolist()) > 0.5:
            x, y, z = now.tolist()
            raise Misuse(
                f"the simulated arm is mounted with gravity [{x:.3f}, {y:.3f}, {z:.3f}]; set it where the cell is set up"
            )

    def _watch(self, name: str, frequency: float, action: str) -> None:
        variable, done = name.lower(), action.lower()  # the maker's own example of RTDE writes "PAUSE"
        if done not in ("pause", "stop", "ignore"):
            raise Misuse(f'action: {action!r}; expected "pause", "stop" or "ignore"')
        if not variable.startswith("input_"):
            raise Misuse(f"variable_name: {name!r} is no input of RTDE")
        silent = 0 if frequency == 0.0 else math.ceil(TICK_RATE / frequency)
        self.watchdog = None if done == "ignore" or not silent else (variable, silent, done)


class OfferedScript(NamedTuple):
    """A script that can run."""

    machine: Machine
    robot: ScriptRobot
    text: str


def joined(a: Inputs, b: Inputs) -> Inputs:
    """Both of a tick."""
    if a is NOTHING or b is NOTHING:
        return b if a is NOTHING else a
    return Wishes(a, (), ()).joined(Wishes(b, (), ())).inputs
