"""The tool in use, the table it is from, and the configured payload: chosen, refused, changed as one, led over without a jump."""

import math
from typing import NamedTuple

from msgspec.structs import replace

from pendant.equipment.load import NOTHING, Load, problem
from pendant.equipment.tools import Equipment, Tool, first_problem
from pendant.events.event import Event, Kind, Values
from pendant.inputs import Command, Inputs
from pendant.limits.validity import WINDOW, wrench_ok
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase, way_out
from pendant.tick.words import difference
from pendant.tooling.payload_wizard import PayloadWizard
from pendant.tooling.settings import ToolUse

WIZARD = frozenset({Command.WIZARD_MEASURE, Command.WIZARD_APPLY, Command.WIZARD_CLEAR})


class Fitting(NamedTuple):
    """What the controller takes to be at the flange, from the tick after the decision on."""

    number: int  # of the change, from 1; 0 is what the robot started with
    tool: Tool
    load: Load  # beyond the tool, once the change is complete
    share: float = 1.0  # of the way from the load before to this one; the tool centre point is this tool's all the time
    mass: float = 0.0  # beyond the tool, now [kg]


class Tooling:
    """One tick at a time. The estimates' reaction to a change is no push: `changing` says how long it lasts."""

    __slots__ = ("_age", "_from", "_most", "_plate", "_ramp", "busy", "changing", "fitting", "tools", "wizard")

    def __init__(self, equipment: Equipment) -> None:
        self.tools = equipment.tools  # the table
        self.fitting = Fitting(0, equipment.tool, equipment.load, 1.0, equipment.load.mass)
        self.wizard = PayloadWizard()
        self.changing = False
        self.busy = False  # the wizard turns the wrist by itself: nothing is changed meanwhile
        self._most = equipment.most
        self._plate = equipment.fixed
        self._ramp = 0  # ticks of the change
        self._age = 0  # ticks of it that are over
        self._from = 0.0  # mass beyond the tool, before [kg]

    def step(self, estimate: Estimate, inputs: Inputs, use: ToolUse, *, mode: Mode, phase: Phase, still: bool) -> list[Event]:
        """One tick.

        Args:
            estimate: of this tick.
            inputs: of this tick.
            use: settings.
            mode: of the robot. Nothing is changed while it moves by hand or by program.
            phase: of free-drive. Nothing is changed or measured while it is tried, either.
            still: the arm stands still.
        """
        steered = not WIZARD.isdisjoint(inputs.commands)
        if not (inputs.tool or inputs.load or inputs.tools or steered or self.changing or self.wizard.left):
            return []
        events: list[Event] = []
        if inputs.load_time is not None:
            use = replace(use, ramp=inputs.load_time)
        why_not = "" if phase is Phase.OFF else "free-drive is being tried"
        if mode in (Mode.RUN, Mode.FREE_DRIVE):
            why_not = way_out(mode)
        elif self.busy:
            why_not = "the wizard measures the payload: stop it first"
        if inputs.tools:
            events += self._tabulate(inputs.tools, why_not, estimate.tick, use)
        if inputs.tool:
            events += self._choose(inputs.tool, why_not, estimate.tick, use)
        if inputs.load is not None:
            events += self._configure(inputs.load, why_not, estimate.tick, use)
        if steered:
            obstacle = _obstacle(estimate, phase, still)
            events += self._steer(estimate, inputs.commands, use, why_not=why_not, obstacle=obstacle)
        elif self.wizard.left:
            events += self.wizard.step(estimate, _obstacle(estimate, phase, still), self._known)
        if self.changing:
            events += self._go_on(estimate.tick)
        return events

    @property
    def _known(self) -> tuple[Load, Load]:
        tool = self.fitting.tool
        return (self._plate, Load(mass=tool.mass, com=tool.com))

    def _steer(
        self, estimate: Estimate, commands: tuple[Command, ...], use: ToolUse, *, why_not: str, obstacle: str
    ) -> list[Event]:
        """The wizard's controls; clearing wins."""
        if Command.WIZARD_CLEAR in commands:
            self.wizard.clear()
            return []
        if Command.WIZARD_MEASURE in commands:
            return self.wizard.begin(estimate, ticks(use.measure), "the wizard measures by itself" if self.busy else obstacle)
        found = self.wizard.progress.finding
        if found is None:
            return [_refused("payload of the wizard", "there is none yet", estimate.tick)]
        events = self._configure(found.load, why_not, estimate.tick, use)
        if not events:
            self.wizard.clear()
        return events

    def _tabulate(self, tools: tuple[Tool, ...], why_not: str, tick: int, use: ToolUse) -> list[Event]:
        """Another table. The tool in use stays in it; what is changed of it is led over, and it keeps what it holds."""
        if tools == self.tools:
            return []
        used = next((tool for tool in tools if tool.name == self.fitting.tool.name), None)
        why_not = why_not or self._objection(tools, used)
        if used is None or why_not:
            return [_refused("table of tools", why_not, tick)]
        change, self.tools = difference(self.tools, tools), tools
        if used != self.fitting.tool:
            self._lead(used, self.fitting.load, use)
            self.wizard.clear()
        return [Event(Kind.TOOLS_CHANGED, tick, {"change": change, "count": len(tools)})]

    def _objection(self, tools: tuple[Tool, ...], used: Tool | None) -> str:
        """Why a table cannot be taken, or "". What was in the last one as it is may be heavier than what can be used."""
        if used is None:
            return f"{self.fitting.tool.name} is in use, and keeps its name"
        fresh = [tool for tool in tools if tool not in self.tools]
        for entries, most in ((fresh, self._most), (tools, math.inf)):
            wrong = first_problem(entries, most)
            if wrong is not None:
                place, (field, value, allowed) = wrong
                return f"{entries[place].name or 'no name'}: {field} {value}, allowed: {allowed}"
        together, beyond = used.mass + self.fitting.load.mass, self.fitting.load.mass
        if used != self.fitting.tool and together > self._most:
            return f"{used.name}: mass {used.mass:g}, allowed: 0 .. {self._most - beyond:g} kg with this payload"
        return ""

    def _choose(self, name: str, why_not: str, tick: int, use: ToolUse) -> list[Event]:
        what = f"tool {name}"
        tool = next((tool for tool in self.tools if tool.name == name), None)
        if tool is None:
            why_not = f"there is {', '.join(tool.name for tool in self.tools)}"
        elif not why_not and tool.mass > self._most:
            why_not = f"{tool.mass:.2f} kg, at most {self._most:g} kg"
        if tool is None or why_not:
            return [_refused(what, why_not, tick)]
        before = self.fitting.tool
        # What the last tool held, this one does not: with its tool centre point and mass goes the payload, too.
        self._lead(tool, NOTHING, use)
        self.wizard.clear()
        x, y, z = tool.tcp
        values: Values = {"name": tool.name, "old": before.name, "mass": tool.mass}
        values |= {"x": 1000.0 * x, "y": 1000.0 * y, "z": 1000.0 * z}
        return [Event(Kind.TOOL_CHANGED, tick, values)]

    def _configure(self, load: Load, why_not: str, tick: int, use: ToolUse) -> list[Event]:
        if not why_not:
            wrong = problem(load, self._most - self.fitting.tool.mass)
            why_not = "" if wrong is None else f"{wrong.field} {wrong.value}, allowed {wrong.allowed} with this tool"
        if why_not:
            return [_refused(f"payload {load.mass:.2f} kg", why_not, tick)]
        self._lead(self.fitting.tool, load, use)
        return []

    def _lead(self, tool: Tool, load: Load, use: ToolUse) -> None:
        now = self.fitting
        self._from = now.mass
        self._ramp, self._age = ticks(use.ramp), -1
        self.changing = True
        self.fitting = now._replace(number=now.number + 1, tool=tool, load=load)  # `_go_on` begins the way in the same tick

    def _go_on(self, tick: int) -> list[Event]:
        """Lead on; then wait until the means of the estimates hold the new load alone."""
        self._age += 1
        if self._age > self._ramp:
            self.changing = self._age < self._ramp + WINDOW
            return []
        now = self.fitting
        share = self._age / self._ramp if self._ramp else 1.0
        mass = now.load.mass if share == 1.0 else self._from + share * (now.load.mass - self._from)
        self.fitting = now._replace(share=share, mass=mass)
        if share < 1.0:
            return []
        x, y, z = (1000.0 * way for way in now.load.com)
        values: Values = {"mass": now.load.mass, "x": x, "y": y, "z": z, "tool": now.tool.name}
        return [Event(Kind.PAYLOAD_CHANGED, tick, {**values, "total": now.load.mass + now.tool.mass})]


def _obstacle(estimate: Estimate, phase: Phase, still: bool) -> str:
    """Why the flange sensor says nothing about the load now, or ""."""
    if phase is not Phase.OFF:
        return "free-drive is on"
    if not wrench_ok(estimate):
        return "the flange force sensor is not valid"
    return "" if still else "the arm moves"


def _refused(what: str, reason: str, tick: int) -> Event:
    return Event(Kind.TOOL_REFUSED, tick, {"what": what, "reason": reason})
