"""The one planner: whatever wants the arm to move asks it, and gets a motion, or the reason why there is none."""

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedJoints, ScriptedProcess, ServoJoints, ServoTool, SpeedJoints, SpeedTool
from pendant.program.jog_move import JogMove
from pendant.program.steps import ApplyForce, JointMove, LinearMove, Move
from pendant.tick.modes import TICK
from sim.motion.blend import Blended, Planned, lengthened
from sim.motion.force_move import ForceTrajectory
from sim.motion.jog import JogTrajectory
from sim.motion.moves import Motion, MoveRefused, Reference, Stop, Strength
from sim.motion.pace import Pace
from sim.motion.planned import JointTrajectory
from sim.motion.process import ProcessTrajectory
from sim.motion.streams import JointStream, ServoStream, SpeedStream, ToolStream
from sim.motion.tool_trajectory import ToolTrajectory, planned_line
from sim.paths.tool_point import ToolPoint

Array = NDArray[np.float64]

Streamed = ServoJoints | SpeedJoints | SpeedTool | ServoTool
"""Commands that come again and again."""


def renews(move: Move | None, before: Motion | None) -> bool:
    """Whether a stream goes on with another target."""
    if isinstance(move, ServoJoints):
        return isinstance(before, ServoStream)
    if isinstance(move, SpeedJoints):
        return isinstance(before, SpeedStream)
    return isinstance(move, SpeedTool | ServoTool) and isinstance(before, ToolStream)


class Planner:
    """Plans within what the joints may and can do; makes no motion that it has not looked through to its end, streams aside.

    Args:
        tool: kinematics of the tool centre point.
        R_FT: its orientation in F (3, 3).
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        strength: what the joints can give.
        pace: knows the speeds of tool and elbow.
    """

    def __init__(
        self, tool: ToolPoint, R_FT: Array, *, limits: tuple[Array, Array, Array], strength: Strength, pace: Pace
    ) -> None:
        self._tool, self._R_FT, self._limits, self._strength, self._pace = tool, R_FT, limits, strength, pace

    def plan(self, move: Move, now: Reference, before: Motion, blend: float | None) -> Motion | str:
        """The motion of a move, or the reason why it cannot be done.

        Args:
            move: what is wanted.
            now: where the reference is.
            before: the motion that it comes from, or a stop of that; a stream's may go on itself.
            blend: radius at the end of the scripted motion before, at most; None where that is none [m].
        """
        try:
            return self._motion(move, now, before, blend)
        except MoveRefused as refusal:
            return str(refusal)
        except (ArithmeticError, ValueError) as failure:  # of numbers that no check of ours has foreseen: the arm stays
            return f"{type(move).__name__}: no motion is found ({failure})"

    def _motion(self, move: Move, now: Reference, before: Motion, blend: float | None) -> Motion:
        if isinstance(move, Streamed):
            return self._stream(move, now, before)
        if isinstance(move, JogMove):
            self._check_standing(now, "jogging")
            return JogTrajectory(now.q, move, self._tool, R_FT=self._R_FT, limits=self._limits, pace=self._pace)
        if isinstance(move, ApplyForce):
            self._check_standing(now, "force")
            return ForceTrajectory(now.q, move, self._tool, position=self._limits[2])
        if isinstance(move, JointMove | ScriptedJoints | LinearMove):
            return self._after(move, now, before, blend)
        return before  # to its end: nothing else is asked for

    def _after(
        self, move: JointMove | ScriptedJoints | LinearMove, now: Reference, before: Motion, blend: float | None
    ) -> Planned | Blended:
        """A motion from where the one before ends; that may be a stop of the arm on its way."""
        assert isinstance(before, Planned | Blended | Stop)
        longer = None if blend is None else lengthened(before, move, blend)
        if longer is not None:
            return longer
        if before.done:
            return self._from(now.q, move)
        begin = before.goal
        return Blended(before, self._from(begin, move), begin, self._limits)

    def _from(self, q: Array, move: JointMove | ScriptedJoints | LinearMove) -> JointTrajectory | ToolTrajectory:
        limits, strength = self._limits, self._strength
        if isinstance(move, JointMove | ScriptedJoints):
            return JointTrajectory(q, move, limits, strength)
        if isinstance(move, ScriptedProcess):
            return ProcessTrajectory(q, move, self._tool, R_FT=self._R_FT, limits=limits, strength=strength)
        return planned_line(q, move, self._tool, R_FT=self._R_FT, limits=limits, strength=strength)

    def _stream(self, move: Streamed, now: Reference, before: Motion) -> JointStream:
        """The same stream goes on with another target; any other begins at the reference."""
        limits, pace = self._limits, self._pace
        if isinstance(move, ServoJoints):
            return before.renew(move) if isinstance(before, ServoStream) else ServoStream(now, move, limits, pace)
        if isinstance(move, SpeedJoints):
            return before.renew(move) if isinstance(before, SpeedStream) else SpeedStream(now, move, limits, pace)
        if isinstance(before, ToolStream):
            return before.renew(move)
        return ToolStream(now, move, self._tool, R_FT=self._R_FT, limits=limits, pace=pace)

    def _check_standing(self, now: Reference, move: str) -> None:
        """Raise MoveRefused where a joint cannot be at rest a tick later."""
        if (np.abs(now.qd) > self._limits[1] * TICK).any():
            raise MoveRefused(f"{move}: the arm still moves")
