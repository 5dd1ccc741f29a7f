"""What the controller tells of itself in words and numbers of the UR e-Series, derived from the pendant's decision."""

import msgspec

from app.robot_interface.controller.question import Question
from app.robot_interface.controller.robot_words import (
    SAFETY_BITS,
    ControlMode,
    JointMode,
    OperationalMode,
    RobotMode,
    RuntimeState,
    SafetyMode,
)
from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.motion.script_requests import DirectTorque
from pendant.program.steps import ApplyForce, Program, ProgramState
from pendant.tick.modes import TICK, Law, Mode, Phase, Safety

UNLOCK_AFTER = 5.0
"""Time after a protective stop in which it cannot be unlocked [s] (dashboard server, e-Series)."""

SAFETY = {
    Safety.NORMAL: SafetyMode.NORMAL,
    Safety.REDUCED: SafetyMode.REDUCED,
    Safety.SAFEGUARD_STOP: SafetyMode.SAFEGUARD_STOP,
    Safety.PROTECTIVE_STOP: SafetyMode.PROTECTIVE_STOP,
    Safety.EMERGENCY_STOP: SafetyMode.ROBOT_EMERGENCY_STOP,
}

RUNTIME = {
    ProgramState.NONE: RuntimeState.STOPPED,
    ProgramState.STOPPED: RuntimeState.STOPPED,
    ProgramState.RUNNING: RuntimeState.PLAYING,
    ProgramState.PAUSED: RuntimeState.PAUSED,
}

SWITCHING_OFF = frozenset({Kind.POWERED_OFF, Kind.EMERGENCY_STOP})
"""After these the drives are off, and are switched on again by a client."""


class ControllerState(msgspec.Struct, frozen=True, gc=False):
    """The controller in one tick: a value, so that whoever reads it sees one tick, whatever the loop does meanwhile."""

    mode: Mode = Mode.TEACH
    safety: Safety = Safety.NORMAL
    phase: Phase = Phase.OFF
    law: Law = Law.HOLD
    program_state: ProgramState = ProgramState.NONE
    loaded: Program | None = None  # that `play` starts
    ready: bool = True  # the robot has it, and no script of a client in its place
    forcing: bool = False  # a step pushes with a force
    torques: bool = False  # a script commands the joints' torques
    stopped_at: int = 0  # tick in which the protective stop began
    tick: int = 0
    idle: bool = False  # drives on, brakes still closed, or will be once the drives were off
    remote: bool = True  # in remote control
    popup: str = ""  # that is shown
    question: Question | None = None  # that waits for an answer
    conveyors: tuple[float, float] = (0.0, 0.0)  # that the laboratory turns: ticks of encoders [1/s]
    operational: OperationalMode = OperationalMode.NONE
    failure: str = ""  # why nothing is simulated
    switched_off: bool = False  # it stands because its drives were switched off, or are after an emergency stop
    script: RuntimeState | None = None  # of a script; None: none runs, and the robot's own programs count
    refusal: str = ""  # why free-drive was refused last; "" once it was entered

    def after(
        self, tick: int, decision: Decision, script: RuntimeState | None = None, idle: bool | None = None
    ) -> "ControllerState":
        """The state after a tick.

        Args:
            tick: its number.
            decision: of it.
            script: state of a script, None where none runs.
            idle: whether a client has asked for drives that are on with brakes that are closed; None: nobody has asked.
        """
        mode, safety, events = decision.mode, decision.safety, decision.events
        switched_off = self.switched_off
        idle = self.idle if idle is None else idle
        if events and any(event.kind in SWITCHING_OFF for event in events):
            switched_off, idle = True, False
        switched_off = switched_off and mode is Mode.STOP
        stopped = _stopped(mode, safety, switched_off)
        powerless = switched_off or _off(decision.law, safety, stopped)
        move = decision.move
        return ControllerState(
            mode,
            safety,
            decision.phase,
            decision.law,
            decision.program,
            self.loaded,
            self.ready,
            isinstance(move, ApplyForce),
            isinstance(move, DirectTorque),
            tick if stopped and not self.stopped else self.stopped_at,
            tick,
            idle and powerless,
            mode is Mode.REMOTE or (self.remote and mode not in (Mode.TEACH, Mode.NORMAL)),
            self.popup,
            self.question,
            self.conveyors,
            self.operational,
            "",
            switched_off,
            script,
            self.refusal,
        )

    @property
    def program(self) -> str:
        """Name of the loaded program, without .urp; "" for none."""
        return "" if self.loaded is None else self.loaded.name

    @property
    def stopped(self) -> bool:
        """A protective stop in a UR's sense: also the pendant's STOP without one, which a UR does not know."""
        return _stopped(self.mode, self.safety, self.switched_off)

    @property
    def off(self) -> bool:
        """The drives have no power, and no stop is there that has to be unlocked first."""
        return _off(self.law, self.safety, self.stopped)

    @property
    def powerless(self) -> bool:
        """The drives are off, or will be once the arm stands."""
        return self.off or self.switched_off

    @property
    def robot_mode(self) -> RobotMode:
        """Of drives and brakes."""
        if self.off:
            return RobotMode.IDLE if self.idle else RobotMode.POWER_OFF
        return RobotMode.RUNNING

    @property
    def safety_mode(self) -> SafetyMode:
        """Of the safety system."""
        if self.failure:
            return SafetyMode.FAULT
        return SafetyMode.PROTECTIVE_STOP if self.stopped else SAFETY[self.safety]

    @property
    def runtime(self) -> RuntimeState:
        """Of the program."""
        return RUNTIME[self.program_state] if self.script is None else self.script

    @property
    def joint_mode(self) -> JointMode:
        """Of every joint."""
        modes = {RobotMode.POWER_OFF: JointMode.POWER_OFF, RobotMode.IDLE: JointMode.IDLE}
        return modes.get(self.robot_mode, JointMode.RUNNING)

    @property
    def control_mode(self) -> ControlMode:
        """What the joints are controlled by."""
        if self.mode is Mode.FREE_DRIVE:
            return ControlMode.TEACH
        if self.torques:
            return ControlMode.TORQUE
        return ControlMode.FORCE if self.forcing else ControlMode.POSITION

    @property
    def robot_bits(self) -> int:
        """`robot_status_bits`: power on, program running, free-drive (a UR's teach button)."""
        power = self.robot_mode in (RobotMode.IDLE, RobotMode.RUNNING)
        return power | (self.runtime is RuntimeState.PLAYING) << 1 | (self.mode is Mode.FREE_DRIVE) << 2

    @property
    def safety_bits(self) -> int:
        """`safety_status_bits`."""
        return SAFETY_BITS[self.safety_mode]

    @property
    def locked_for(self) -> float:
        """Time until a protective stop can be unlocked [s]."""
        return max(0.0, UNLOCK_AFTER - (self.tick - self.stopped_at) * TICK)


def _stopped(mode: Mode, safety: Safety, switched_off: bool) -> bool:
    if safety is Safety.PROTECTIVE_STOP:
        return True
    return mode is Mode.STOP and safety <= Safety.REDUCED and not switched_off


def _off(law: Law, safety: Safety, stopped: bool) -> bool:
    return law is Law.OFF and safety is not Safety.SAFEGUARD_STOP and not stopped
