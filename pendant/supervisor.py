"""The supervisor: robot mode, safety mode, program and free-drive, one tick at a time (FD-1)."""

import math
from collections.abc import Mapping
from dataclasses import replace

from pendant.all_settings import Settings
from pendant.contact.contact_change import Contact, told
from pendant.contact.contact_monitor import ContactMonitor
from pendant.context import Surroundings
from pendant.decision import Decision
from pendant.equipment.tools import Equipment, Tool
from pendant.equipping import Equipping
from pendant.events.event import Event, Kind, Values
from pendant.events.happened import Transition
from pendant.freedrive.periods import RUNNING
from pendant.freedrive.state_machine import FreeDrive
from pendant.haptics import Haptics, Moment
from pendant.inputs import Button, Command, Inputs
from pendant.limits.joint_zones import JointZones
from pendant.limits.validity import WrenchMean
from pendant.program.sequencer import Sequencer
from pendant.program.steps import Program
from pendant.program_run import ProgramRun
from pendant.publisher import Publisher
from pendant.robot.joint_sensors import JointSensors
from pendant.robot.requests import Calls
from pendant.robot.robot_mode import Robot
from pendant.robot.safety_inputs import SafetyInputs
from pendant.safety.robot_limits import ArmRating
from pendant.sensor.sensor_spec import USUAL, SensorSpec
from pendant.settings.schema import ticks
from pendant.settings_lock import change, locked
from pendant.signals.enabling_device import EnablingDevice
from pendant.signals.keep_alive import KeepAlive
from pendant.signals.sources import PROGRAM
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, Law, Mode, Phase, way_out
from pendant.tick.motion_status import NO_MOTION, MotionStatus
from pendant.tick.pose import Pose, Wrench
from pendant.tick.state import State, state_of
from pendant.tooling.arm_shape import ArmShape
from pendant.tooling.tool_in_use import Fitting, Tooling
from pendant.walls.containment import Containment
from pendant.walls.definitions import AnyBorder
from pendant.zeroing import ForceReaders, TareRun

SWITCHABLE = {Command.NORMAL: Mode.NORMAL, Command.TEACH: Mode.TEACH, Command.REMOTE: Mode.REMOTE}
RESTING = frozenset(SWITCHABLE.values())

NOT_ENTERED = frozenset({Transition.CANCELLED, Transition.REFUSED})
"""Transitions with which an attempt to enter free-drive is over."""

ENDING = frozenset(RUNNING.values())
"""Periods that end free-drive."""


class Supervisor:
    """Decides every tick from the estimate and the inputs; all that it remembers is its `state`."""

    def __init__(
        self,
        settings: Settings,
        n_joints: int,
        *,
        joints: tuple[str, ...] | None = None,
        rated: tuple[float, ...] | None = None,
        borders: tuple[AnyBorder, ...] = (),
        frames: Mapping[str, Pose] | None = None,
        ranges: tuple[tuple[float, float], ...] | None = None,
        speeds: tuple[float, ...] | None = None,
        equipment: Equipment | None = None,
        sensor: SensorSpec = USUAL,
        shape: ArmShape | None = None,
    ) -> None:
        """
        Args:
            settings: to start with; `Inputs.settings` changes them.
            n_joints: number of joints of the arm, as in every estimate.
            joints: their names for texts, base to flange; None: "joint 1", "joint 2", ...
            rated: torque of each joint, of which some limits are shares [N·m]; None: 100 N·m each.
            borders: walls and areas; `pendant.walls.definitions.problem` has found nothing.
            frames: poses X_BR of what they lie in, apart from the base and the arm's own parts.
            ranges: smallest and largest angle of each joint [rad]; None: joints turn without end.
            speeds: that each joint is made for [rad/s]; None: any.
            equipment: what is at the flange, and the tools to choose from; None: nothing.
            sensor: what is known of the flange force/torque sensor.
            shape: of the arm; None: nothing is known of it, and the payload wizard turns no wrist by itself.
        """
        self.settings = settings
        self._joints = joints or tuple(f"joint {number}" for number in range(1, n_joints + 1))
        self._button = KeepAlive()
        self._enabling = EnablingDevice()
        self._haptics = Haptics()
        self._calls = Calls(n_joints)
        self._holding = False  # the arm was held in the last tick
        self._mean = WrenchMean()
        self._sensors = JointSensors()
        self._sequencer = Sequencer()
        self._contacts: tuple[Contact, ...] = ()  # of this tick
        rated = rated or (100.0,) * n_joints
        self.containment = Containment(borders, frames or {})
        ranges = ranges or ((-math.inf, math.inf),) * n_joints
        zones = JointZones(rated, ranges)
        self._monitor = ContactMonitor(sensor)
        self._free = FreeDrive(self._joints, rated, self.containment, zones, sensor=sensor)
        self._robot = Robot(self._free, self._sequencer)
        rating = ArmRating(self._joints, ranges, speeds or (math.inf,) * n_joints)
        self._safety = SafetyInputs(self._robot, rating)
        self._run = ProgramRun(self._robot, self._mean, n_joints, self.containment)
        self._tooling = Tooling(equipment or Equipment())
        self._equipping = Equipping(
            self._tooling, self._robot, self._mean, self._calls, containment=self.containment, shape=shape
        )
        robot, run, tooling, readers = self._robot, self._run, self._tooling, ForceReaders(self._calls, self._monitor, self._mean)
        self._tare = TareRun(sensor, robot, run, tooling, haptics=self._haptics, readers=readers)
        self._publisher = Publisher(robot, tooling, self._tare.taring, scripting=run.scripting, containment=self.containment)
        self._refresh()

    @property
    def program(self) -> Program | None:
        """The loaded program."""
        return self._sequencer.program

    @property
    def fitting(self) -> Fitting:
        """Tool and payload, as configured."""
        return self._tooling.fitting

    @property
    def zero(self) -> Wrench:
        """What is subtracted from the flange sensor's values, axes of F [N, N·m]; the same object until it changes."""
        return self._tare.taring.zero

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The table of tools as it is now."""
        return self._tooling.tools

    @property
    def state(self) -> State:
        """All that the next decision depends on, apart from its arguments and what `ContactMonitor` leaves out.

        Equal states decide equally. It is as of now: later steps do not change it.
        """
        return state_of(self)

    def step(self, estimate: Estimate, inputs: Inputs, status: MotionStatus = NO_MOTION) -> Decision:
        """One tick. The order of these lines is the precedence: what stands above acts first and forbids what stands below.

        Args:
            estimate: of this tick.
            inputs: of this tick.
            status: what the control law did in the last tick.
        """
        events: list[Event] = []
        wrench_ok = self._observe(estimate, inputs, events)
        looks = self._feel(estimate, events)
        if self._calls.commands:
            inputs = replace(inputs, commands=inputs.commands + self._calls.commands)
        commands = inputs.commands
        if commands:
            self._safety.step(estimate, commands, self.settings, events, held=self._button.held)
            self._obey(estimate, commands, events)
        asked, beyond = self._robot.move is not None and self._run.presses, self.containment.beyond(estimate, self.settings.walls)
        self._safety.watch(estimate, self.settings, events, asked=asked, beyond=beyond)
        changing = self._tooling.changing
        self._run.step(estimate, inputs, self.settings, events, status=status, monitor=self._monitor, changing=changing)
        self._free_drive(estimate, status, wrench_ok, events)
        mode = Mode.NORMAL if self._run.scripting.equips(inputs.script) else self._robot.mode
        self._equipping.step(estimate, inputs, self.settings, events, status=status, mode=mode)
        self._tare.step(estimate, commands, self.settings, events, wrench_ok=wrench_ok)
        trying = self._free.phase is not _OFF
        if inputs.borders is not None:
            where = "the payload wizard's motion" if self._tooling.busy else locked(self._robot.mode, trying)
            events += self.containment.change(inputs.borders, where, estimate.tick)
        wanted = inputs.settings
        if commands and Command.DETECTION in commands:
            wanted = {**wanted, "contact.on": not self.settings.contact.on}
        if wanted:
            self.settings, changed = change(self.settings, wanted, mode=self._robot.mode, trying=trying, tick=estimate.tick)
            events += changed
            self._refresh()
        return self._publish(events, looks)

    def _observe(self, estimate: Estimate, inputs: Inputs, events: list[Event]) -> bool:
        """What the tick brings, before anything is decided. Returns whether the user's wrench is valid."""
        robot, button = self._robot, _BUTTON
        if self._button.step(button in inputs.held, button in inputs.released, self._silence):
            values: Values = {"value": (self._silence + 1) * TICK, "limit": self._silence * TICK}
            events.append(Event(Kind.HOLD_SILENT, estimate.tick, values))
        events += self._sensors.step(estimate, self._joints)
        self._enabling.step(inputs, self._silence)
        self._grip()
        robot.still.step(estimate, self._slow)
        robot.static = robot.still.count >= self._static_ticks
        events += robot.stopping.step(estimate, robot.still.count, self._static_ticks)
        wrench = self._mean.step(estimate)
        calls, state, held = self._calls, self._sequencer.state, self._button.held
        events += calls.step(estimate, inputs, self.settings, wrench=wrench, holding=self._holding, state=state, button=held)
        asks = robot.mode is _RUN and not calls.signal.source and self._asks_for_a_hand
        self._free.sense(held, PROGRAM if asks else calls.signal)
        return wrench

    def _grip(self) -> None:
        """Of the enabling device, None where none is needed."""
        self._robot.grip = self._enabling.grip if self.settings.enabling.on else None

    @property
    def _asks_for_a_hand(self) -> bool:
        """A step of the running program wants free-drive, which is off, and the arm stands."""
        return self._sequencer.guiding and self._robot.static and self._free.phase is Phase.OFF

    def _feel(self, estimate: Estimate, events: list[Event]) -> bool:
        """Changes in contact (CD-1): told, and taken by a program step that waits for one. Returns whether any is looked for."""
        sequencer, robot, use = self._sequencer, self._robot, self.settings.contact
        looks = use.on or self._run.feels
        on = looks and not (self._tooling.changing or self._haptics.busy)
        if on:
            use = self._run.contact_use(use, estimate)
        self._contacts = self._monitor.step(estimate, use, robot.mode, on)
        for contact in self._contacts:
            until, action = sequencer.until, "none"
            if until is not None and robot.mode is Mode.RUN and sequencer.touch(contact, estimate.v_tcp):
                robot.braking, action = True, until.then
            events.append(told(contact, estimate.tick, action, estimate.v_tcp))
        return looks

    def _obey(self, estimate: Estimate, commands: tuple[Command, ...], events: list[Event]) -> None:
        """Commands for the mode and for free-drive."""
        robot, free = self._robot, self._free
        for command in commands:
            if command is Command.LEAVE_FREE_DRIVE:
                if free.phase is not Phase.OFF:
                    robot.happen(Event(Kind.DEACTIVATED, estimate.tick), self.settings, events)
            elif command is Command.RESTART_PERIOD:
                if not self.settings.free_drive.signal_renews:
                    robot.refuse(command, estimate, "periods are not started again here", events)
                elif not free.ask_anew():
                    robot.refuse(command, estimate, "no period of free-drive runs", events)
            elif command is Command.REGISTER_WAYPOINT:
                free.register()
                events.append(Event(Kind.WAYPOINT, estimate.tick))
            elif command in SWITCHABLE:
                to = SWITCHABLE[command]
                if robot.mode not in RESTING:
                    robot.refuse(command, estimate, way_out(robot.mode), events)
                elif to is not robot.mode:
                    events.append(Event(Kind.MODE_CHANGED, estimate.tick, {"from": robot.mode, "to": to}))
                    robot.mode = to

    def _free_drive(self, estimate: Estimate, status: MotionStatus, wrench_ok: bool, events: list[Event]) -> None:
        robot, calls, free, fitting = self._robot, self._calls, self._free, self._tooling.fitting
        changing = fitting.mass if self._tooling.changing else None
        felt = (calls.hand_off, calls.touched, calls.force, changing)
        others = (self._sequencer.guiding, self._haptics.busy, fitting.load.mass, self._tare.taring, status)
        around = Surroundings(estimate, robot.mode, wrench_ok, robot.still, self._mean, robot.grip, *felt, *others)
        happened = free.step(around, self.settings)
        for event in happened.events:
            robot.follow(event, events)
        if happened.transition in NOT_ENTERED and self._sequencer.guiding:
            self._run.fail("free-drive was not entered", estimate.tick, events)

    def _refresh(self) -> None:
        """What every tick needs of the settings."""
        self._grip()
        self._calls.refresh(self.settings)
        self._publisher.refresh(self.settings)
        self._silence = ticks(self.settings.hold.silence)
        self._slow = self.settings.static.speed
        self._static_ticks = ticks(self.settings.static.time)

    def _publish(self, events: list[Event], looks: bool) -> Decision:
        """What follows from all of it; `looks`: something asks for changes in contact."""
        law, haptics = self._robot.law(), self._haptics
        limits = self._safety.limits(self.settings)
        speeds = self._equipping.limits(None if limits is None else limits.speeds)
        joint_range = None if limits is None else limits.joint_range
        if self.settings.haptics.on or haptics.busy:
            self._shake(law, events)
        self._holding = law is _HOLD and not (self._free.caught or self._tooling.changing or haptics.busy)
        # A guided arm is not about to start a program, which would need the signals of the ticks before.
        looks = looks or law is not _FREE
        return self._publisher.step(
            law, events, contacts=self._contacts, looks=looks, speeds=speeds, joint_range=joint_range, shake=haptics.shake
        )

    def _shake(self, law: Law, events: list[Event]) -> None:
        """What is to be felt in this tick (HF-1)."""
        free, mode = self._free, self._robot.mode
        near = any(wall.near > 0.0 for wall in free.walls()) if mode is Mode.FREE_DRIVE else False
        left = next((period.ticks for period in free.periods() if period.name in ENDING), -1)
        moment = Moment(mode, law, free.phase, events, near, left, ticks(self.settings.handshake.feedback))
        self._haptics.step(moment, self.settings.haptics)


_BUTTON, _OFF, _RUN = Button.FREE_DRIVE, Phase.OFF, Mode.RUN  # looked up in every tick
_HOLD, _FREE = Law.HOLD, Law.FREE
