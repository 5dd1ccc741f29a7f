"""The robot, as the functions of one script see it."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.callers import Ask
from app.urscript.functions.pose_algebra import to_rpy
from app.urscript.functions.robot_side import ArmSide
from app.urscript.functions.script_sockets import ScriptSockets
from app.urscript.language.trouble import Misuse
from app.urscript.machine.limits import MOST_MESSAGES
from app.urscript.machine.machine import Machine
from app.urscript.running.told import Telling, Told, printable
from pendant.equipment.load import Load
from pendant.equipment.tools import Tool, tool_problem
from pendant.inputs import NOTHING, Command, Inputs
from pendant.tick.modes import TICK_RATE
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

TOOL_NAME = "script"
"""Of the tool that set_tcp() changes to."""


class ScriptRobot:
    """See `app.urscript.functions.robot_side.RobotSide`.

    Args:
        cabinet: the robot.
        arm: moves it.
        sockets: of this script.
        tell: takes what the script tells.
        seed: of random().
    """

    def __init__(
        self, cabinet: Cabinet, arm: ArmSide, sockets: ScriptSockets, tell: Callable[[Told], None], *, seed: int
    ) -> None:
        self._cabinet, self._tell = cabinet, tell
        self.arm, self.sockets, self.record, self.seed = arm, sockets, cabinet.record, seed
        self.watchdog: tuple[str, int, str] | None = None  # variable, ticks that it may be silent, action
        self.asks: list[Ask] = []  # for the tick that begins
        self.tool: Tool | None = None  # to be used from now on
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

    @property
    def popup_shown(self) -> bool:
        """A popup is there that nobody has closed."""
        return bool(self._cabinet.state.popup)

    def command(self, word: str, **values: Any) -> None:
        """Something of the robot other than its motion."""
        if word == "payload":
            self._payload(**values)
        elif word == "tcp":
            self._tcp(values["pose"])
        elif word == "protective_stop":
            self.asks.append(Ask((Command.PROTECTIVE_STOP,)))
        elif word == "power_off":
            self.asks.append(Ask((Command.POWER_OFF,)))
        elif word == "gravity":
            self._gravity(values["gravity"])
        elif word == "watchdog":
            self._watch(**values)
        elif word == "external_sensor" and values["enable"]:
            raise Misuse("an external force sensor is not simulated; the robot's own is used")

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
            inputs = joined(inputs, Inputs(tools=(*table, made), tool=made.name))
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
            return
        com = [(mass * c - tool.mass * t) / load for c, t in zip(cog, tool.com, strict=True)]
        moments = list(inertia) if inertia is not None and any(inertia) else None
        self.asks.append(Ask(load=Load(mass=load, com=com, inertia=moments)))

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
        if action not in ("pause", "stop", "ignore"):
            raise Misuse(f'action: {action!r}; expected "pause", "stop" or "ignore"')
        if not isinstance(name, str) or not name.startswith("input_"):
            raise Misuse(f"variable_name: {name!r} is no input of RTDE")
        silent = 0 if frequency == 0.0 else math.ceil(TICK_RATE / frequency)
        self.watchdog = None if action == "ignore" or not silent else (name, silent, action)


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
