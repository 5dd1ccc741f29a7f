"""Zeroing the flange sensor in the running robot: by command and by a program's step, unnoticed by all that feels forces."""

from typing import NamedTuple

from pendant.all_settings import Settings
from pendant.contact.contact_monitor import ContactMonitor
from pendant.events.event import Event, Kind
from pendant.haptics import Haptics
from pendant.inputs import Command
from pendant.limits.validity import WrenchMean
from pendant.program.steps import ProgramState, Wait, ZeroSensor
from pendant.program_run import ProgramRun
from pendant.robot.requests import Calls
from pendant.robot.robot_mode import Robot
from pendant.sensor.sensor_spec import SensorSpec
from pendant.sensor.taring import Taring
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase
from pendant.tick.pose import Wrench, flat, turned
from pendant.tooling.tool_in_use import Tooling

STANDING = (Wait, ZeroSensor)
"""Steps of a program in which the arm stands and nobody is to touch it."""


class ForceReaders(NamedTuple):
    """What reads the sensor in every tick, other than the robot's parts: a new zero is no hand and no contact to any of it."""

    calls: Calls  # which feel the user's hand
    monitor: ContactMonitor
    mean: WrenchMean  # of F_user


class TareRun:
    """Steers `Taring` by what the robot does."""

    __slots__ = ("_calls", "_gone", "_haptics", "_mean", "_monitor", "_robot", "_run", "_tooling", "taring")

    def __init__(
        self,
        sensor: SensorSpec,
        robot: Robot,
        run: ProgramRun,
        tooling: Tooling,
        *,
        haptics: Haptics,
        readers: ForceReaders,
    ) -> None:
        """
        Args:
            sensor: what is known of it.
            robot: whose sensor it is.
            run: of its program.
            tooling: of tool and payload.
            haptics: that may shake the arm.
            readers: of forces.
        """
        self.taring = Taring(sensor)
        self._gone: Wrench | None = None  # by how much F_user is less from this tick on, axes of F [N, N·m]
        self._robot, self._run, self._tooling, self._haptics = robot, run, tooling, haptics
        self._calls, self._monitor, self._mean = readers

    def step(
        self, estimate: Estimate, commands: tuple[Command, ...], settings: Settings, events: list[Event], *, wrench_ok: bool
    ) -> None:
        """One tick, after everything else that was decided in it.

        Args:
            estimate: of this tick.
            commands: of this tick.
            settings: as they are now.
            events: of this tick; more are added.
            wrench_ok: the user's wrench is valid and finite.
        """
        robot, taring = self._robot, self.taring
        if self._gone is not None:
            taring.shift_reading(self._gone)
            self._gone = None
        move = robot.sequencer.move
        if self._tooling.changing or not wrench_ok:
            taring.restart(lost=not wrench_ok)
        else:
            freed = robot.mode is _FREE_DRIVE or robot.free.phase is _SEQUENCE or self._haptics.busy
            stands = robot.static and not freed and (move is None or isinstance(move, STANDING) or self._scripted)
            events += taring.step(estimate, self._mean, stands, settings.limits.activation)
        if commands and Command.ZERO_READING in commands:
            self._zero_reading(estimate, events, wrench_ok=wrench_ok)
        if commands and Command.ZERO_SENSOR in commands:
            running = robot.sequencer.state is ProgramState.RUNNING and not self._scripted
            why_not = "a program runs: pause or stop it first" if running else self._why_not(estimate, wrench_ok)
            if why_not:
                events.append(Event(Kind.ZERO_REFUSED, estimate.tick, {"reason": why_not}))
            else:
                self._tare(estimate, events)
        elif isinstance(move, ZeroSensor):
            why_not = self._why_not(estimate, wrench_ok)
            if not why_not:
                self._tare(estimate, events)
                self._run.zeroed(estimate.tick, events)
            elif robot.sequencer.impatient():
                self._run.fail(f"force sensor not zeroed, {why_not}", estimate.tick, events)

    def _zero_reading(self, estimate: Estimate, events: list[Event], *, wrench_ok: bool) -> None:
        """As a robot's script does it: at once, in every state; a hand on the arm is told, and not waited for."""
        if not wrench_ok:
            events.append(Event(Kind.ZERO_REFUSED, estimate.tick, {"reason": "the flange force sensor is not valid"}))
            return
        wrench = tuple(estimate.F_user.tolist()) if self._tooling.changing else self._mean.mean()
        events.append(self.taring.zero_reading(estimate, wrench))

    @property
    def _scripted(self) -> bool:
        """A script moves the arm as it likes; it is known to push at nothing."""
        return self._robot.sequencer.scripted and self._run.scripting.force is None

    def _why_not(self, estimate: Estimate, wrench_ok: bool) -> str:
        """Why the sensor cannot be zeroed in this tick, or ""."""
        robot, tooling = self._robot, self._tooling
        if robot.free.phase is not Phase.OFF:
            return "free-drive is on" if robot.mode is _FREE_DRIVE else "free-drive is being tried"
        if tooling.changing:
            return "the payload is being changed"
        if tooling.busy or tooling.wizard.left:
            return "the payload is being measured"
        if not wrench_ok:
            return "the flange force sensor is not valid"
        if self._haptics.busy:
            return "haptic feedback shakes the arm"
        return self.taring.why_not(estimate, self._mean) if robot.static else "the arm moves"

    def _tare(self, estimate: Estimate, events: list[Event]) -> None:
        """Zero the sensor. The change of all forces in the next tick is no push."""
        gone, event = self.taring.tare(estimate)
        self._gone = gone
        events.append(event)
        x, y, z, a, b, c = gone
        R_BF = flat(estimate.R_BF)
        force = turned(R_BF, (x, y, z))
        self._mean.shift((*force, *turned(R_BF, (a, b, c))))
        self._robot.sequencer.shift(force)
        self._robot.free.forget()
        self._calls.relearn()
        self._monitor.restart()
        self._tooling.wizard.shift(gone)


_FREE_DRIVE, _SEQUENCE = Mode.FREE_DRIVE, Phase.SEQUENCE  # looked up in every tick
