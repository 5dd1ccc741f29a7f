"""What moves the arm by itself: a program, with its commands and its tick in mode RUN, and jogging."""

import math

from pendant.all_settings import Settings
from pendant.contact.contact_monitor import ContactMonitor
from pendant.contact.operating import OperatingSensitivity, Operation, follows
from pendant.contact.settings import ContactUse
from pendant.events.event import Event, Kind, Values
from pendant.inputs import Command, Inputs
from pendant.limits.validity import JOINTS_SENSED, WrenchMean, joints_ok, motion_ok
from pendant.motion.scripting import Scripting
from pendant.program.steps import ApplyForce, LinearMove, Program, ProgramState, is_script, misfit
from pendant.robot.jogging import Jogging
from pendant.robot.robot_mode import Robot
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase, way_out
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import Vector
from pendant.walls.containment import Containment

STARTS_FROM = {
    Command.START_PROGRAM: frozenset({Mode.NORMAL, Mode.TEACH}),
    Command.START_REMOTELY: frozenset({Mode.REMOTE}),
}
"""The modes from which a command starts the program: who has control."""

LOCAL = STARTS_FROM[Command.START_PROGRAM]

PROGRAM_COMMANDS = STARTS_FROM.keys() | {Command.PAUSE_PROGRAM, Command.RESUME_PROGRAM, Command.STOP_PROGRAM}


class ProgramRun:
    """Steers the robot's sequencer, and jogs."""

    __slots__ = ("_containment", "_jogging", "_mean", "_n", "_origin", "_robot", "_sensitivity", "scripting")

    def __init__(self, robot: Robot, mean: WrenchMean, n_joints: int, containment: Containment) -> None:
        """
        Args:
            robot: that it steers.
            mean: of F_user.
            n_joints: of the arm.
            containment: knows the walls.
        """
        self._robot, self._mean, self._n, self._containment = robot, mean, n_joints, containment
        self._jogging = Jogging(robot, n_joints)
        self.scripting = Scripting(robot.sequencer)
        self._sensitivity = OperatingSensitivity()
        self._origin = Mode.TEACH  # where the program was started from

    @property
    def feels(self) -> bool:
        """The running program waits for a change in contact, or looks for it."""
        return self._robot.sequencer.until is not None or self.scripting.feeling

    @property
    def presses(self) -> bool:
        """The running program asked for contact: it moves until one, or with a force."""
        return self.feels or isinstance(self._robot.sequencer.move, ApplyForce) or self.scripting.force is not None

    def contact_use(self, use: ContactUse, estimate: Estimate) -> ContactUse:
        """The settings of contact detection in this tick: their thresholds follow what the robot does (CD-11)."""
        if not follows(use):
            return use
        move = self._robot.sequencer.move
        acceleration = move.acceleration if isinstance(move, LinearMove) else 0.0
        force = math.hypot(*move.force) if isinstance(move, ApplyForce) else 0.0
        torque, current = float(abs(estimate.tau_J).max()), float(abs(estimate.current).max())
        running = self._robot.mode is Mode.RUN
        return self._sensitivity.step(use, Operation(acceleration, force, torque, current, running))

    def step(
        self,
        estimate: Estimate,
        inputs: Inputs,
        settings: Settings,
        events: list[Event],
        *,
        status: MotionStatus,
        monitor: ContactMonitor,
        changing: bool,
    ) -> None:
        """One tick.

        Args:
            estimate: of this tick.
            inputs: of this tick.
            settings: as they are now.
            events: of this tick; more are added.
            status: what the control law did in the last tick.
            monitor: knows where the arm is.
            changing: the configured payload is being changed.
        """
        robot = self._robot
        sequencer = robot.sequencer
        sequencer.high = inputs.high
        if status.wall and robot.move is not None:
            events += self._containment.reached(estimate, status.wall, settings.walls)
        if inputs.program is not None:
            self._load(inputs.program, estimate.tick, events)
        move = sequencer.move
        for command in inputs.commands:
            if command in PROGRAM_COMMANDS:
                why_not = self._why_not(command, estimate, changing)
                if why_not:
                    robot.refuse(command, estimate, why_not, events)
                else:
                    self._steer(command, estimate.tick, events)
        self._jogging.step(estimate, inputs, settings, events, status=status, changing=changing)
        if robot.mode is not _FREE_DRIVE and (sequencer.braked or (move is not None and sequencer.move is move)):
            before, tool_on, outputs = len(events), sequencer.tool_on, sequencer.outputs
            self._go_on(estimate, monitor, settings, events, status=status)
            events[before:before] = self._did(estimate.tick, tool_on, outputs)  # the last step comes before the end
        if move is not None and sequencer.scripted:
            self._follow_script(estimate, inputs, settings, events, done=status.done)

    def _did(self, tick: int, tool_on: bool, outputs: frozenset[int]) -> list[Event]:
        """What the step of this tick has switched, from what was on before, and what it tells."""
        sequencer = self._robot.sequencer
        events: list[Event] = []
        if sequencer.tool_on is not tool_on:
            events.append(Event(Kind.TOOL_SWITCHED, tick, {"state": "on" if sequencer.tool_on else "off"}))
        if sequencer.telling is not None:
            says: Values = {"name": self._robot.program_name, "text": sequencer.telling.text, "tone": sequencer.telling.tone}
            events.append(Event(Kind.PROGRAM_TELLS, tick, says))
            sequencer.telling = None
        for number in sorted(outputs ^ sequencer.outputs):
            state = "on" if number in sequencer.outputs else "off"
            events.append(Event(Kind.OUTPUT_SWITCHED, tick, {"number": number, "state": state}))
        return events

    def _follow_script(self, estimate: Estimate, inputs: Inputs, settings: Settings, events: list[Event], *, done: int) -> None:
        """One tick of a step that is a script; without its word the arm comes to rest, also a guided one."""
        robot, wish = self._robot, inputs.script
        reason = self.scripting.step(done, wish, ticks(settings.hold.silence))
        over = wish is not None and wish.over
        if (reason or over) and robot.free.phase is not Phase.OFF:
            robot.happen(Event(Kind.DEACTIVATED, estimate.tick), settings, events)
        if reason:
            self.fail(reason, estimate.tick, events)
        elif over:
            self._end()
            events.append(Event(Kind.PROGRAM_FINISHED, estimate.tick, {"name": robot.program_name}))

    def _go_on(
        self, estimate: Estimate, monitor: ContactMonitor, settings: Settings, events: list[Event], *, status: MotionStatus
    ) -> None:
        """One tick of a step, in the order of precedence."""
        robot, sequencer = self._robot, self._robot.sequencer
        if not motion_ok(estimate):
            event = Event(Kind.RUN_SENSORS_LOST, estimate.tick, {"sensor": JOINTS_SENSED})
            robot.happen(event, settings, events)
        elif sequencer.braked:
            if robot.static and sequencer.rest(monitor.now()):
                self._finish(estimate.tick, events)
        elif not robot.enabled:
            events.append(Event(Kind.RUN_ENABLING, estimate.tick, {"grip": robot.grip or ""}))
            robot.begin_stop(Kind.RUN_ENABLING)
            robot.pause_program(estimate.tick, events)
        elif status.refused:
            self.fail(status.refused, estimate.tick, events)
        elif missed := sequencer.missed(status.done):
            self.fail(missed, estimate.tick, events)
        elif sequencer.step(status.done, monitor.now, self._felt):
            self._finish(estimate.tick, events)

    def fail(self, reason: str, tick: int, events: list[Event]) -> None:
        """The program cannot go on."""
        robot = self._robot
        values: Values = {"name": robot.program_name, "step": robot.sequencer.index + 1, "reason": reason}
        events.append(Event(Kind.PROGRAM_FAILED, tick, values))
        self._end()

    def zeroed(self, tick: int, events: list[Event]) -> None:
        """The sensor is zeroed, for which the present step was there."""
        if self._robot.sequencer.zeroed():
            self._finish(tick, events)

    def _felt(self) -> Vector:
        """Mean force of F_user [N]."""
        x, y, z = self._mean.mean()[:3]
        return x, y, z

    def _finish(self, tick: int, events: list[Event]) -> None:
        self._robot.mode = self._origin
        events.append(Event(Kind.PROGRAM_FINISHED, tick, {"name": self._robot.program_name}))

    def _end(self) -> None:
        robot = self._robot
        robot.sequencer.stop()
        robot.mode = self._origin
        robot.braking = True

    def _load(self, program: Program, tick: int, events: list[Event]) -> None:
        reason, mode = misfit(program, self._n), self._robot.mode
        if mode in (Mode.RUN, Mode.FREE_DRIVE):
            reason = way_out(mode)
        if reason is not None:
            events.append(Event(Kind.PROGRAM_REFUSED, tick, {"name": program.name, "reason": reason}))
            return
        self._robot.sequencer.load(program)
        events.append(Event(Kind.PROGRAM_LOADED, tick, {"name": program.name, "steps": len(program.steps)}))

    def _why_not(self, command: Command, estimate: Estimate, changing: bool) -> str | None:
        """Why a program command is not possible now, or None."""
        robot = self._robot
        state = robot.sequencer.state
        if command in STARTS_FROM:
            if robot.mode not in STARTS_FROM[command]:
                return "the robot is in local control" if robot.mode in LOCAL else way_out(robot.mode)
            if state is ProgramState.NONE:
                return "no program is loaded"
        elif robot.mode is not Mode.RUN:
            return "no program is running"
        if command is Command.PAUSE_PROGRAM:
            return "it is paused already" if state is ProgramState.PAUSED else None
        if command is Command.STOP_PROGRAM:
            return None
        if command is Command.RESUME_PROGRAM and state is ProgramState.RUNNING:
            return "it is running already"
        if robot.free.phase is Phase.SEQUENCE:
            return "free-drive is being tried"
        if not robot.enabled:
            return f"enabling device {robot.grip}: hold it in its middle position"
        if not joints_ok(estimate):
            return f"check {JOINTS_SENSED}"
        program = robot.sequencer.program
        if changing and not (program is not None and is_script(program)):  # a script changes it while it moves
            return "the payload is being changed"
        return None if robot.static else "the arm still moves"

    def _steer(self, command: Command, tick: int, events: list[Event]) -> None:
        """Carry out a program command that is possible."""
        robot = self._robot
        sequencer = robot.sequencer
        values: Values = {"name": robot.program_name, "step": sequencer.index + 1}
        if command in STARTS_FROM:
            self._origin = robot.mode
            robot.mode = Mode.RUN
            self.scripting.begin()
            sequencer.start(self._felt())
            events.append(Event(Kind.PROGRAM_STARTED, tick, {"name": robot.program_name}))
        elif command is Command.PAUSE_PROGRAM:
            robot.pause_program(tick, events)
        elif command is Command.RESUME_PROGRAM:
            self.scripting.begin()
            sequencer.resume()
            events.append(Event(Kind.PROGRAM_RESUMED, tick, values))
        else:
            self._end()
            events.append(Event(Kind.PROGRAM_STOPPED, tick, values))


_FREE_DRIVE = Mode.FREE_DRIVE  # looked up in every tick
