"""What the controller tells of itself in words and numbers of the UR e-Series, derived from the pendant's decision."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

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


@dataclass(slots=True, eq=False)
class Question:
    """What a program asks people for."""

    kind: str  # "boolean", "integer", "float" or "string"
    text: str
    answer: bool | int | float | str | None = None

    def take(self, text: str) -> None:
        """Answer it. Raises ValueError: this is no value of the kind that is asked for."""
        read, expected = ANSWERS[self.kind]
        try:
            self.answer = read(text)
        except (ValueError, KeyError):
            raise ValueError(f"expected {expected}") from None


def _whole(text: str) -> int:
    value = int(text)
    if not -(1 << 31) <= value < 1 << 31:
        raise ValueError
    return value


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError
    return value


def _short(text: str) -> str:
    if len(text) > LONGEST_ANSWER:
        raise ValueError
    return text


LONGEST_ANSWER = 1023
"""Characters of a text, as of a string in a program."""

ANSWERS: dict[str, tuple[Callable[[str], bool | int | float | str], str]] = {
    "boolean": (lambda text: {"true": True, "false": False}[text.lower()], "true or false"),
    "integer": (_whole, "a whole number of 32 bits"),
    "float": (_finite, "a finite number"),
    "string": (_short, f"a text of {LONGEST_ANSWER} characters at most"),
}
"""How an answer to a question of each kind is read, and what is expected."""


@dataclass(slots=True)
class ControllerState:
    """The controller in one tick."""

    mode: Mode = Mode.TEACH
    safety: Safety = Safety.NORMAL
    phase: Phase = Phase.OFF
    law: Law = Law.HOLD
    program_state: ProgramState = ProgramState.NONE
    loaded: Program | None = None  # that `play` starts
    forcing: bool = False  # a step pushes with a force
    torques: bool = False  # a script commands the joints' torques
    stopped_at: int = 0  # tick in which the protective stop began
    tick: int = 0
    idle: bool = False  # drives on, brakes still closed, or will be once the drives were off
    remote: bool = True  # in remote control
    popup: str = ""  # that is shown
    question: Question | None = None  # that waits for an answer
    conveyors: list[float] = field(default_factory=lambda: [0.0, 0.0])  # that the laboratory turns: ticks of encoders [1/s]
    operational: OperationalMode = OperationalMode.NONE
    failure: str = ""  # why nothing is simulated
    switched_off: bool = False  # it stands because its drives were switched off, or are after an emergency stop
    script: RuntimeState | None = None  # of a script; None: none runs, and the robot's own programs count
    refusal: str = ""  # why free-drive was refused last; "" once it was entered

    def see(self, tick: int, decision: Decision) -> None:
        """Take in a tick."""
        before = self.stopped
        self.tick, self.mode, self.safety = tick, decision.mode, decision.safety
        if any(event.kind in SWITCHING_OFF for event in decision.events):
            self.switched_off, self.idle = True, False
        self.switched_off = self.switched_off and decision.mode is Mode.STOP
        if self.stopped and not before:
            self.stopped_at = tick
        self.phase, self.law, self.program_state = decision.phase, decision.law, decision.program
        self.forcing, self.torques = isinstance(decision.move, ApplyForce), isinstance(decision.move, DirectTorque)
        self.idle = self.idle and self.powerless
        if decision.mode in (Mode.TEACH, Mode.NORMAL):
            self.remote = False
        elif decision.mode is Mode.REMOTE:
            self.remote = True

    @property
    def program(self) -> str:
        """Name of the loaded program, without .urp; "" for none."""
        return "" if self.loaded is None else self.loaded.name

    @property
    def stopped(self) -> bool:
        """A protective stop in a UR's sense: also the pendant's STOP without one, which a UR does not know."""
        if self.safety is Safety.PROTECTIVE_STOP:
            return True
        return self.mode is Mode.STOP and self.safety <= Safety.REDUCED and not self.switched_off

    @property
    def off(self) -> bool:
        """The drives have no power, and no stop is there that has to be unlocked first."""
        return self.law is Law.OFF and self.safety is not Safety.SAFEGUARD_STOP and not self.stopped

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
