"""The arm of a script, moved by the robot's own programs: each motion is one step, from rest to rest."""

import math
from typing import Any

from app.urscript.functions.motion_asks import ForceEndAsk, FreeDriveAsk, FreeDriveEndAsk, MoveAsk, SpeedAsk, StopAsk
from app.urscript.functions.pose_algebra import quaternion
from app.urscript.language.trouble import Misuse
from app.urscript.machine.values import PoseValue
from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import JointMove, LinearMove, Program, ProgramState
from pendant.settings.schema import ticks
from pendant.tick.modes import Mode, Phase
from sim.arm.arm_file import Arm
from sim.simulation import Simulation

NAME = "script"
"""Of these programs."""

PATIENCE = ticks(2.0)
"""A motion waits so long for the arm to come to rest before it."""

STARTS = {Mode.REMOTE: Command.START_REMOTELY}
GONE_ON = frozenset({Kind.PROGRAM_FINISHED, Kind.PROGRAM_STOPPED})
REFUSED = frozenset({Kind.PROGRAM_REFUSED, Kind.PROGRAM_FAILED})


class StepArm:
    """See `app.urscript.functions.robot_side.ArmSide`.

    Args:
        arm: whose limits a move has.
    """

    def __init__(self, arm: Arm) -> None:
        self._arm = arm
        self._count = 0
        self._ask: Any = None  # that is being done
        self._left = 0  # ticks that it still waits to begin
        self._began = False
        self._stopping = False  # a program is to be stopped first
        self._over = True
        self._refusal = ""
        self.freeing = False  # the arm is to be guided by hand
        self._running = False
        self._still, self._standing = True, 0
        self._mode = Mode.TEACH

    def ask(self, request: Any) -> int:
        """Ask for a motion or a stop, in place of what is done; its number."""
        if isinstance(request, FreeDriveAsk):
            self.freeing = True
        elif isinstance(request, FreeDriveEndAsk):
            self.freeing = False
        elif (isinstance(request, MoveAsk) and request.kind in ("j", "l", "p")) or isinstance(request, StopAsk):
            self._begin(request)
        elif isinstance(request, SpeedAsk) and not any(request.speed):
            self._begin(StopAsk(request.kind, request.acceleration))
        elif not isinstance(request, ForceEndAsk):
            word = type(request).__name__.removesuffix("Ask")
            raise Misuse(f"this robot cannot do it yet ({word})")
        return self._count

    def _begin(self, request: Any) -> None:
        self._count += 1
        self._ask, self._left, self._began, self._over, self._refusal = request, PATIENCE, False, False, ""
        self._stopping = self._running

    def done(self, number: int) -> bool:
        """Whether a request is done, or another took its place."""
        if number == self._count and self._refusal:
            refusal, self._refusal = self._refusal, ""
            self._over = True
            raise Misuse(refusal)
        return number != self._count or self._over

    def drop(self, number: int) -> None:
        """Nobody waits any more."""
        if number == self._count and not self._over:
            self._begin(StopAsk("j", 4.0))

    def steps_back(self, direction: tuple[float, ...]) -> int:
        """Not felt by this arm."""
        return 0

    def free_drive_status(self) -> int:
        """No singularity is told."""
        return 0

    def end(self) -> None:
        """The script is over: the arm comes to rest."""
        self.freeing = False
        self._begin(StopAsk("j", 4.0))

    def inputs(self) -> Inputs:
        """What the pendant gets for the tick that begins."""
        if self._over or self._ask is None:
            return NOTHING
        if self._stopping:
            self._stopping = False
            return Inputs(commands=(Command.STOP_PROGRAM,))
        if isinstance(self._ask, StopAsk) or self._began or self._running:
            return NOTHING
        self._left -= 1
        if not self._still and self._left > 0:
            return NOTHING
        start = STARTS.get(self._mode, Command.START_PROGRAM)
        step = self._step(self._ask)
        return Inputs(program=Program(name=NAME, steps=(step,)), commands=(start,))

    def _step(self, ask: MoveAsk) -> JointMove | LinearMove:
        if ask.kind == "j":
            limits = self._arm.limits
            speed, acceleration = ask.speed / min(limits.speed), ask.acceleration / min(limits.acceleration)
            return JointMove(q=tuple(ask.target), speed=_share(speed), acceleration=_share(acceleration))
        assert isinstance(ask.target, PoseValue)
        x, y, z = ask.target[:3]
        speed, acceleration = min(max(ask.speed, 1e-4), 3.0), min(max(ask.acceleration, 1e-3), 50.0)
        return LinearMove(position=(x, y, z), quaternion=quaternion(ask.target[3:]), speed=speed, acceleration=acceleration)

    def see(self, decision: Decision, simulation: Simulation) -> None:
        """Take in a tick."""
        self._mode = decision.mode
        self._running = decision.program is ProgramState.RUNNING
        if not self._over:
            use = simulation.settings.static
            slow = float(abs(simulation.estimate.qd).max()) < use.speed
            self._standing = self._standing + 1 if slow else 0
            self._still = self._standing > ticks(use.time)
        for event in decision.events:
            if event.kind is Kind.PROGRAM_STARTED:
                self._began = True
            elif event.kind in REFUSED or (event.kind is Kind.COMMAND_REFUSED and not self._began and self._left <= 0):
                self._refusal = str(event.values["reason"])
            elif event.kind in GONE_ON and self._began:
                self._over = True
        if not self._over and isinstance(self._ask, StopAsk) and not self._stopping and not self._running:
            self._over = decision.phase is Phase.OFF


def _share(value: float) -> float:
    return min(max(value, 0.001), 1.0) if math.isfinite(value) else 1.0
