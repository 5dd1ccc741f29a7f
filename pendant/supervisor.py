"""The supervisor: robot mode, safety mode, program and free-drive, one tick at a time (FD-1)."""

import math
from collections.abc import Mapping
from dataclasses import replace

from pendant.axis_locks import axis_locks
from pendant.barrier import Place
from pendant.calls import Calls
from pendant.contact import Change, Contact
from pendant.contact_monitor import ContactMonitor
from pendant.containment import Containment
from pendant.decision import Decision
from pendant.enabling import EnablingDevice, Grip
from pendant.estimate import Estimate
from pendant.events import Event, Kind, Values, posture_text
from pendant.freedrive import ASKED_FOR, FreeDrive
from pendant.haptics import Haptics, Moment
from pendant.inputs import Button, Command, Inputs
from pendant.joint_zones import JointZones
from pendant.keepalive import KeepAlive
from pendant.lock import change
from pendant.modes import TICK, Law, Mode, Phase, Safety, way_out
from pendant.pose import Pose, Vector, from_rpy
from pendant.program import Program, ProgramState, Sequencer, misfit
from pendant.reduced import Reduced
from pendant.sensing import JointSensors
from pendant.sequence import JOINTS_SENSED
from pendant.settings import Settings, limits_checksum, ticks
from pendant.sources import PROGRAM
from pendant.stopping import Stopping
from pendant.surroundings import Surroundings
from pendant.table import TABLE, Effect
from pendant.tooling import Fitting, Tooling
from pendant.tools import Equipment, Tool
from pendant.walls import AnyBorder
from pendant.watch import Stillness, WrenchMean, joints_ok, motion_ok

SWITCHABLE = {Command.NORMAL: Mode.NORMAL, Command.TEACH: Mode.TEACH, Command.REMOTE: Mode.REMOTE}
RESTING = frozenset(SWITCHABLE.values())
PROGRAM_COMMANDS = frozenset({Command.START_PROGRAM, Command.PAUSE_PROGRAM, Command.RESUME_PROGRAM, Command.STOP_PROGRAM})
STOPPING = {
    Effect.LEAVE_TO_STOP: Safety.NORMAL,
    Effect.SAFEGUARD_STOP: Safety.SAFEGUARD_STOP,
    Effect.PROTECTIVE_STOP: Safety.PROTECTIVE_STOP,
    Effect.EMERGENCY_STOP: Safety.EMERGENCY_STOP,
}


DONE_GUIDING = ASKED_FOR | {Kind.LEFT_PERIOD, Kind.LEFT_RESTART}
"""Endings of free-drive with which a program goes on; after any other one somebody must look first."""

STILL_OFF = frozenset({Kind.NOT_YET, Kind.RESIDUAL_GONE, Kind.RESIDUAL_STAYED})
"""What is told while free-drive has not been begun."""

ENDING = ("free-drive", "restart")
"""Periods that end free-drive."""

TOLD = {
    Change.GAINED: Kind.CONTACT_GAINED,
    Change.LOST: Kind.CONTACT_LOST,
    Change.RESISTANCE: Kind.CONTACT_RESISTANCE,
    Change.CLAMPING: Kind.CONTACT_CLAMPING,
}


def told(contact: Contact, action: str) -> Values:
    """The values of a contact's event (CD-16)."""
    (fx, fy, fz), (ax, ay, az), (x, y, z) = contact.force, contact.acceleration, contact.pose.p_BT
    return {
        "part": contact.part,
        "source": contact.source,
        "rule": contact.rule,
        "force": math.hypot(fx, fy, fz),
        "fx": fx,
        "fy": fy,
        "fz": fz,
        "acceleration": math.hypot(ax, ay, az),
        "ax": ax,
        "ay": ay,
        "az": az,
        "ratio": contact.ratio,
        "steps": contact.steps,
        "x": x,
        "y": y,
        "z": z,
        "posture": posture_text(contact.pose.q),
        "action": action,
    }


class Supervisor:
    """Decides every tick from the estimate and the inputs; keeps all of its memory in `state`."""

    def __init__(
        self,
        settings: Settings,
        n_joints: int,
        joints: tuple[str, ...] | None = None,
        rated: tuple[float, ...] | None = None,
        borders: tuple[AnyBorder, ...] = (),
        frames: Mapping[str, Pose] | None = None,
        ranges: tuple[float, ...] | None = None,
        equipment: Equipment | None = None,
    ) -> None:
        """
        Args:
            settings: to start with; `Inputs.settings` changes them.
            n_joints: number of joints of the arm, as in every estimate.
            joints: their names for texts, base to flange; None: "joint 1", "joint 2", ...
            rated: torque of each joint, of which some limits are shares [N·m]; None: 100 N·m each.
            borders: walls and areas; `pendant.walls.problem` has found nothing.
            frames: poses X_BR of what they lie in, besides the base and the arm's own parts.
            ranges: largest angle of each joint either way [rad]; None: joints turn without end.
            equipment: what is at the flange, and the tools to choose from; None: nothing.
        """
        self.settings = settings
        self._n = n_joints
        self._joints = joints or tuple(f"joint {number}" for number in range(1, n_joints + 1))
        self._mode = Mode.TEACH
        self._safety = Safety.NORMAL
        self._remembered = Mode.TEACH  # where free-drive was entered from
        self._origin = Mode.TEACH  # where the program was started from
        self._braking = False  # since free-drive or a motion was ended, until static
        self._freed = False  # the law was FREE in the last tick
        self._static = False
        self._button = KeepAlive()
        self._enabling = EnablingDevice()
        self._reduced = Reduced()
        self._safeguard = False  # the safety input is open
        self._stopping = Stopping()
        self._haptics = Haptics()
        self._calls = Calls(n_joints)
        self._holding = False  # the arm was held in the last tick
        self._still = Stillness()
        self._mean = WrenchMean()
        self._sensors = JointSensors()
        self._sequencer = Sequencer()
        self._monitor = ContactMonitor()
        self._contacts: tuple[Contact, ...] = ()  # of this tick
        rated = rated or (100.0,) * n_joints
        zones = JointZones(rated, ranges or (math.inf,) * n_joints)
        self._containment = Containment(borders, frames or {})
        self._free = FreeDrive(self._joints, rated, self._containment, zones)
        self._tooling = Tooling(equipment or Equipment())
        self._turn_tool()
        self._refresh()
        self._key: tuple[object, ...] = ()
        self._decision: Decision | None = None  # the last one, if the next may be the same

    @property
    def program(self) -> Program | None:
        """The loaded program."""
        return self._sequencer.program

    @property
    def fitting(self) -> Fitting:
        """Tool and payload, as configured."""
        return self._tooling.fitting

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The table of tools as it is now."""
        return self._tooling.tools

    @property
    def places(self) -> tuple[tuple[AnyBorder, Place], ...]:
        """Every wall and area that holds, and every area that will in free-drive, with where its shape lies in B."""
        return self._containment.every_place(self.settings.walls)

    @property
    def state(self) -> tuple[object, ...]:
        """All that the next decision depends on, besides its arguments and the buffers of the contact detectors.

        Equal states decide equally.
        """
        button = (self._button.held, self._button.silent)
        still = (self._still.count, self._still.joint, self._still.speed)
        devices = (self._enabling.memory, self._reduced.memory, self._safeguard, self._stopping.memory)
        own = (self._mode, self._safety, self._remembered, self._origin, self._braking, self._freed, button, still)
        own += (self._calls.memory, self._holding, self._tooling.memory, self._haptics.memory)
        lost = self._sensors.lost
        return (self.settings, *own, *devices, self._mean.memory, lost, self._sequencer.memory, self._free.memory)

    def step(self, estimate: Estimate, inputs: Inputs) -> Decision:
        """One tick. The order of these lines is the precedence: what stands above acts first and forbids what stands below."""
        events: list[Event] = []
        wrench_ok = self._observe(estimate, inputs, events)
        self._feel(estimate, events)
        if self._calls.commands:
            inputs = replace(inputs, commands=inputs.commands + self._calls.commands)
        if inputs.commands:
            self._safety_inputs(estimate, inputs.commands, events)
            self._safety_commands(estimate, inputs.commands, events)
            self._mode_commands(estimate, inputs.commands, events)
        self._watch_reduced(estimate, events)
        self._run_program(estimate, inputs, events)
        self._free_drive(estimate, wrench_ok, events)
        self._equip(estimate, inputs, events)
        wanted = inputs.settings
        if Command.DETECTION in inputs.commands:
            wanted = {**wanted, "contact.on": not self.settings.contact.on}
        if wanted:
            trying = self._free.phase is Phase.SEQUENCE
            self.settings, changed = change(self.settings, wanted, self._mode, trying, estimate.tick)
            events += changed
            self._refresh()
        return self._publish(estimate, events)

    def _observe(self, estimate: Estimate, inputs: Inputs, events: list[Event]) -> bool:
        button = Button.FREE_DRIVE
        if self._button.step(button in inputs.held, button in inputs.released, self._silence):
            values: Values = {"value": (self._silence + 1) * TICK, "limit": self._silence * TICK}
            events.append(Event(Kind.HOLD_SILENT, estimate.tick, values))
        events += self._sensors.step(estimate, self._joints)
        self._enabling.step(inputs, self._silence)
        self._still.step(estimate, self._slow)
        self._static = self._still.count >= self._static_ticks
        events += self._stopping.step(estimate, self._still.count, self._static_ticks)
        wrench = self._mean.step(estimate)
        calls, state = self._calls, self._sequencer.state
        events += calls.step(estimate, inputs, wrench, self._holding, self.settings, state, self._button.held)
        self._free.sense(self._button.held, PROGRAM if self._asks_for_a_hand and not calls.signal.source else calls.signal)
        return wrench

    @property
    def _asks_for_a_hand(self) -> bool:
        """A step of the program wants free-drive, which is off, and the arm stands."""
        return self._sequencer.guiding and self._static and self._mode is Mode.RUN and self._free.phase is Phase.OFF

    def _feel(self, estimate: Estimate, events: list[Event]) -> None:
        """Changes in contact (CD-1): told, and taken by a program step that waits for one."""
        sequencer, use = self._sequencer, self.settings.contact
        on = (use.on or sequencer.until is not None) and not (self._tooling.changing or self._haptics.busy)
        self._contacts = self._monitor.step(estimate, use, self._mode, on)
        for contact in self._contacts:
            until = sequencer.until
            taken = self._mode is Mode.RUN and until is not None and sequencer.touch(contact)
            if taken:
                self._braking = True
            events.append(Event(TOLD[contact.change], estimate.tick, told(contact, until.then if taken and until else "none")))

    def _safety_inputs(self, estimate: Estimate, commands: tuple[Command, ...], events: list[Event]) -> None:
        """Levels of the safety inputs: safeguard and REDUCED."""
        tick = estimate.tick
        # Open and REDUCED win over their opposites in the same tick.
        if Command.SAFEGUARD_OPEN in commands:
            if not self._safeguard:
                self._safeguard = True
                self._happen(Event(Kind.SAFEGUARD_STOP, tick, {"mode": self._mode}), events)
        elif Command.SAFEGUARD_CLOSED in commands and self._safeguard:
            self._safeguard = False
            events.append(Event(Kind.SAFEGUARD_CLOSED, tick))
        reduced = self.settings.reduced
        if Command.REDUCED_ON in commands:
            if self._reduced.switch(True, reduced):
                values: Values = {"tcp": reduced.tcp_speed, "elbow": reduced.elbow_speed, "joint_speed": reduced.joint_speed}
                events.append(Event(Kind.REDUCED_ON, tick, values))
        elif Command.REDUCED_OFF in commands and self._reduced.switch(False, reduced):
            events.append(Event(Kind.REDUCED_OFF, tick))
        if self._safety <= Safety.REDUCED:
            self._safety = self._resting_safety

    def _watch_reduced(self, estimate: Estimate, events: list[Event]) -> None:
        if self._reduced.on and self._mode is not Mode.STOP and motion_ok(estimate):
            excess = self._reduced.step(estimate, self.settings.reduced, self._joints)
            if excess is not None:
                self._happen(Event(Kind.REDUCED_EXCEEDED, estimate.tick, dict(excess._asdict())), events)

    @property
    def _resting_safety(self) -> Safety:
        """The safety mode where nothing has stopped the robot."""
        return Safety.REDUCED if self._reduced.on else Safety.NORMAL

    @property
    def _grip(self) -> Grip | None:
        """Of the enabling device, None where none is needed."""
        return self._enabling.grip if self.settings.enabling.on else None

    def _safety_commands(self, estimate: Estimate, commands: tuple[Command, ...], events: list[Event]) -> None:
        stop = Command.EMERGENCY_STOP in commands
        if stop and self._safety is not Safety.EMERGENCY_STOP:
            self._happen(Event(Kind.EMERGENCY_STOP, estimate.tick, {"mode": self._mode}), events)
        if Command.RESET not in commands:
            return
        if stop:
            self._refuse(Command.RESET, estimate, "the emergency stop was pressed at the same time", events)
        elif self._mode is not Mode.STOP:
            self._refuse(Command.RESET, estimate, "nothing to reset", events)
        elif self._button.held:
            events.append(Event(Kind.RESET_REFUSED_SIGNAL, estimate.tick))
        elif self._safeguard:
            events.append(Event(Kind.RESET_REFUSED_SAFEGUARD, estimate.tick))
        elif not joints_ok(estimate):
            events.append(Event(Kind.RESET_REFUSED_SENSORS, estimate.tick, {"sensor": JOINTS_SENSED}))
        elif not self._static:
            values = self._still.moves(self._joints, self.settings.static)
            events.append(Event(Kind.RESET_REFUSED_MOVING, estimate.tick, values))
        else:
            self._mode = Mode.TEACH
            self._safety = self._resting_safety
            self._braking = False
            self._stopping.end()
            events.append(Event(Kind.RESET, estimate.tick))

    def _mode_commands(self, estimate: Estimate, commands: tuple[Command, ...], events: list[Event]) -> None:
        for command in commands:
            if command is Command.LEAVE_FREE_DRIVE:
                if self._free.phase is not Phase.OFF:
                    self._happen(Event(Kind.DEACTIVATED, estimate.tick), events)
            elif command is Command.RESTART_PERIOD:
                if not self.settings.free_drive.anew:
                    self._refuse(command, estimate, "periods are not begun anew here", events)
                elif not self._free.ask_anew():
                    self._refuse(command, estimate, "no period of free-drive runs", events)
            elif command is Command.REGISTER_WAYPOINT:
                self._free.register()
                events.append(Event(Kind.WAYPOINT, estimate.tick))
            elif command in SWITCHABLE:
                to = SWITCHABLE[command]
                if self._mode not in RESTING:
                    self._refuse(command, estimate, way_out(self._mode), events)
                elif to is not self._mode:
                    events.append(Event(Kind.MODE_CHANGED, estimate.tick, {"from": self._mode, "to": to}))
                    self._mode = to

    def _run_program(self, estimate: Estimate, inputs: Inputs, events: list[Event]) -> None:
        sequencer = self._sequencer
        if inputs.program is not None:
            self._load(inputs.program, estimate, events)
        move = sequencer.move
        for command in inputs.commands:
            if command in PROGRAM_COMMANDS:
                why_not = self._why_not(command, estimate)
                if why_not:
                    self._refuse(command, estimate, why_not, events)
                else:
                    self._steer(command, estimate, events)
        braked = sequencer.braked
        if self._mode is Mode.FREE_DRIVE or (not braked and (move is None or sequencer.move is not move)):
            return
        tool_on = sequencer.tool_on
        if not motion_ok(estimate):
            self._happen(Event(Kind.RUN_SENSORS_LOST, estimate.tick, {"sensor": JOINTS_SENSED}), events)
        elif braked:
            if self._static and sequencer.rest(self._monitor.now()):
                self._finish(estimate.tick, events)
        elif self._grip not in (None, Grip.MIDDLE):
            events.append(Event(Kind.RUN_ENABLING, estimate.tick, {"grip": self._grip or ""}))
            self._stopping.begin(Kind.RUN_ENABLING, TABLE[Kind.RUN_ENABLING].category, self._static)
            self._pause(estimate.tick, events)
        elif estimate.move_refused:
            self._fail(estimate.move_refused, estimate.tick, events)
        elif sequencer.missed(estimate.move_done):
            self._fail("it ended without a contact", estimate.tick, events)
        elif sequencer.step(estimate.move_done, self._monitor.now, self._felt):
            self._finish(estimate.tick, events)
        if sequencer.tool_on is not tool_on:
            events.append(Event(Kind.TOOL_SWITCHED, estimate.tick, {"state": "on" if sequencer.tool_on else "off"}))

    def _felt(self) -> Vector:
        """Mean force of F_user [N]."""
        x, y, z = self._mean.mean()[:3]
        return x, y, z

    def _finish(self, tick: int, events: list[Event]) -> None:
        self._mode = self._origin
        events.append(Event(Kind.PROGRAM_FINISHED, tick, {"name": self._name}))

    def _fail(self, reason: str, tick: int, events: list[Event]) -> None:
        values: Values = {"name": self._name, "step": self._sequencer.index + 1, "reason": reason}
        events.append(Event(Kind.PROGRAM_FAILED, tick, values))
        self._end_program()

    def _load(self, program: Program, estimate: Estimate, events: list[Event]) -> None:
        reason = misfit(program, self._n)
        if self._mode in (Mode.RUN, Mode.FREE_DRIVE):
            reason = way_out(self._mode)
        if reason is not None:
            events.append(Event(Kind.PROGRAM_REFUSED, estimate.tick, {"name": program.name, "reason": reason}))
            return
        self._sequencer.load(program)
        events.append(Event(Kind.PROGRAM_LOADED, estimate.tick, {"name": program.name, "steps": len(program.steps)}))

    def _why_not(self, command: Command, estimate: Estimate) -> str | None:
        """Why a program command is not possible now, or None."""
        state = self._sequencer.state
        if command is Command.START_PROGRAM:
            if self._mode not in (Mode.NORMAL, Mode.TEACH):
                return way_out(self._mode)
            if state is ProgramState.NONE:
                return "no program is loaded"
        elif self._mode is not Mode.RUN:
            return "no program is running"
        if command is Command.PAUSE_PROGRAM:
            return "it is paused already" if state is ProgramState.PAUSED else None
        if command is Command.STOP_PROGRAM:
            return None
        if command is Command.RESUME_PROGRAM and state is ProgramState.RUNNING:
            return "it is running already"
        if self._free.phase is Phase.SEQUENCE:
            return "free-drive is being tried"
        if self._grip not in (None, Grip.MIDDLE):
            return f"enabling device {self._grip}: hold it in its middle position"
        if not joints_ok(estimate):
            return f"check {JOINTS_SENSED}"
        if self._tooling.changing:
            return "the payload is being changed"
        return None if self._static else "the arm still moves"

    def _steer(self, command: Command, estimate: Estimate, events: list[Event]) -> None:
        """Carry out a program command that is possible."""
        sequencer = self._sequencer
        values: Values = {"name": self._name, "step": sequencer.index + 1}
        if command is Command.START_PROGRAM:
            self._origin = self._mode
            self._mode = Mode.RUN
            sequencer.start(self._felt())
            events.append(Event(Kind.PROGRAM_STARTED, estimate.tick, {"name": self._name}))
        elif command is Command.PAUSE_PROGRAM:
            self._pause(estimate.tick, events)
        elif command is Command.RESUME_PROGRAM:
            sequencer.resume()
            events.append(Event(Kind.PROGRAM_RESUMED, estimate.tick, values))
        else:
            self._end_program()
            events.append(Event(Kind.PROGRAM_STOPPED, estimate.tick, values))

    def _end_program(self) -> None:
        self._sequencer.stop()
        self._mode = self._origin
        self._braking = True

    def _pause(self, tick: int, events: list[Event]) -> None:
        self._sequencer.pause()
        self._braking = True
        values: Values = {"name": self._name, "step": self._sequencer.index + 1}
        events.append(Event(Kind.PROGRAM_PAUSED, tick, values))

    def _free_drive(self, estimate: Estimate, wrench_ok: bool, events: list[Event]) -> None:
        calls = self._calls
        changing = self._tooling.fitting.mass if self._tooling.changing else None
        felt, guided, shaken = (calls.hand_off, calls.force), self._sequencer.guiding, self._haptics.busy
        around = Surroundings(
            estimate, self._mode, wrench_ok, self._still, self._mean, self._grip, *felt, changing, guided, shaken
        )
        trying = self._free.phase is not Phase.OFF
        for event in self._free.step(around, self.settings):
            self._take_effect(event, events)
            trying = trying or event.kind not in STILL_OFF
        if trying and self._free.phase is Phase.OFF and self._sequencer.guiding:
            self._fail("free-drive was not entered", estimate.tick, events)

    def _equip(self, estimate: Estimate, inputs: Inputs, events: list[Event]) -> None:
        tooling = self._tooling
        events += tooling.step(estimate, inputs, self._mode, self._free.phase, self._static, self.settings.tools)
        if tooling.changing:
            self._calls.relearn()
            self._free.forget()
            self._turn_tool()

    def _turn_tool(self) -> None:
        """Who needs to know how the tool centre point is turned in the flange."""
        self._containment.R_FT = self._sequencer.R_FT = from_rpy(*self._tooling.fitting.tool.rpy)

    def _happen(self, event: Event, events: list[Event]) -> None:
        """Something outside of free-drive happens that ends it, too."""
        if self._free.phase is not Phase.OFF:
            self._free.stop(event.kind, self.settings)
        self._take_effect(event, events)

    def _take_effect(self, event: Event, events: list[Event]) -> None:
        events.append(event)
        effect = TABLE[event.kind].effect
        if effect in (Effect.TRY, Effect.ENTER):
            if self._sequencer.state is ProgramState.RUNNING and not self._sequencer.guiding:
                self._pause(event.tick, events)
            if effect is Effect.ENTER:
                self._remembered = self._mode
                self._mode = Mode.FREE_DRIVE
        elif effect is Effect.LEAVE:
            if self._mode is Mode.FREE_DRIVE:
                self._mode = self._remembered
            if self._sequencer.guiding and event.kind in DONE_GUIDING:
                self._sequencer.let_go()
            elif self._sequencer.guiding:
                self._pause(event.tick, events)
            if event.kind is Kind.LEFT_ENABLING:
                self._stopping.begin(event.kind, TABLE[event.kind].category, self._static)
        elif effect in STOPPING:
            self._mode = Mode.STOP
            self._safety = max(self._safety, STOPPING[effect])
            self._braking = True
            self._sequencer.stop()
            self._stopping.begin(event.kind, TABLE[event.kind].category, self._static)

    def _refuse(self, command: Command, estimate: Estimate, reason: str, events: list[Event]) -> None:
        values: Values = {"command": command, "mode": self._mode, "reason": reason}
        events.append(Event(Kind.COMMAND_REFUSED, estimate.tick, values))

    def _refresh(self) -> None:
        """What every tick needs of the settings."""
        self._checksum = limits_checksum(self.settings)
        self._locks = axis_locks(self.settings.axes)
        self._calls.refresh(self.settings)
        self._silence = ticks(self.settings.hold.silence)
        self._slow = self.settings.static.speed
        self._static_ticks = ticks(self.settings.static.time)

    @property
    def _name(self) -> str:
        program = self._sequencer.program
        return program.name if program else ""

    def _law(self) -> Law:
        if self._mode is Mode.FREE_DRIVE or self._free.phase is Phase.SEQUENCE:
            self._freed = True
            return Law.HOLD if self._free.caught else Law.FREE
        if self._freed:
            self._freed, self._braking = False, True
        if self._mode is Mode.STOP:
            return Law.OFF if self._stopping.off else Law.BRAKE
        if self._sequencer.move is not None:
            self._braking = False
            return Law.FOLLOW
        if self._static:
            self._braking = False
        return Law.BRAKE if self._braking else Law.HOLD

    def _shake(self, law: Law, events: list[Event]) -> None:
        """What is to be felt in this tick (HF-1)."""
        free = self._free
        near = any(wall.near > 0.0 for wall in free.walls()) if self._mode is Mode.FREE_DRIVE else False
        left = next((period.ticks for period in free.periods() if period.name in ENDING), -1)
        feedback = ticks(self.settings.handshake.feedback)
        self._haptics.step(Moment(self._mode, law, free.phase, events, near, left, feedback), self.settings.haptics)

    def _publish(self, estimate: Estimate, events: list[Event]) -> Decision:
        """The decision; the last one again when nothing is different."""
        free = self._free
        sequencer = self._sequencer
        law = self._law()
        tooling = self._tooling
        haptics = self._haptics
        if self.settings.haptics.on or haptics.busy:
            self._shake(law, events)
        self._holding = law is Law.HOLD and not (free.caught or tooling.changing or haptics.busy)
        grip, speeds = self._grip, self._reduced.limits(self.settings.reduced)
        locks = self._locks if self._mode is Mode.FREE_DRIVE else None
        periods = free.periods() if not free.idle and self.settings.free_drive.remainders else ()
        trying = free.phase is Phase.SEQUENCE
        gain = self.settings.free_drive.gain if free.helping and not (trying and not self.settings.sequence.amplified) else 0.0
        walls = () if free.phase is Phase.OFF else free.walls()
        key: tuple[object, ...] = ()
        if not (events or periods or walls):
            robot = (self._mode, self._safety, free.phase, law, free.helping, grip, speeds)
            guided = (free.damping, free.zones, locks, free.singularity, haptics.shake)
            program = (sequencer.move, sequencer.state, sequencer.index, sequencer.tool_on)
            key = (*robot, *guided, *program, tooling.fitting, tooling.wizard.progress)
            if self._decision is not None and key == self._key:
                return self._decision
        active = sequencer.state in (ProgramState.RUNNING, ProgramState.PAUSED)
        decision = Decision(
            mode=self._mode,
            safety=self._safety,
            phase=free.phase,
            law=law,
            move=sequencer.move,
            gain=gain,
            force_cap=self.settings.free_drive.force_cap,
            baseline=free.baseline,
            periods=periods,
            events=tuple(events),
            program=sequencer.state,
            step=sequencer.index + 1 if active else 0,
            monitored=free.monitored() if trying else (),
            contacts=self._contacts,
            tool_on=sequencer.tool_on,
            walls=walls,
            grip=grip,
            speed_limits=speeds,
            damping=free.damping,
            zones=free.zones,
            fitting=tooling.fitting,
            wizard=tooling.wizard.progress,
            locks=locks,
            singularity=free.singularity,
            shake=haptics.shake,
            limits=self._checksum,
        )
        self._key = key
        self._decision = decision if key else None
        return decision
