"""One motion going over into the next: the first runs to its end while the second leaves that already."""

import copy

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedArc, ScriptedJoints, ScriptedLine, ScriptedProcess
from pendant.program.steps import JointMove, LinearMove
from pendant.tick.modes import TICK
from sim.motion.moves import Reference, Stop
from sim.motion.planned import JointTrajectory
from sim.motion.process import ProcessTrajectory
from sim.motion.tool_trajectory import ToolTrajectory

Array = NDArray[np.float64]

Planned = JointTrajectory | ToolTrajectory

Joined = ScriptedJoints | ScriptedLine | ScriptedArc | ScriptedProcess
"""Motions of a script that may go over into the next."""

LOOKS = 20
"""Places at which the speeds of both together are looked at."""


def leaves(motion: "Planned | Blended", blend: float, left: float) -> bool:
    """Whether a script's motion has come to where the next one is asked for.

    Args:
        motion: of the script.
        blend: its blend radius, more than 0 [m].
        left: from the tool to the motion's end [m].
    """
    last = _last(motion)
    if isinstance(last, ProcessTrajectory):
        return last.nearing(blend)
    return motion.slowing and left <= blend


def lengthened(
    motion: "Planned | Stop | Blended", move: JointMove | ScriptedJoints | LinearMove, radius: float
) -> "Planned | Blended | None":
    """A motion with a script's next one put at its end, both at one speed; None: it ends where it would have.

    Args:
        motion: that goes on.
        move: the next one.
        radius: of the circle between, at most [m].

    Raises:
        MoveRefused: the next one leads out of reach or range.
    """
    last = _last(motion)
    if isinstance(motion, Stop) or not (isinstance(last, ProcessTrajectory) and isinstance(move, ScriptedProcess)):
        return None
    return motion if last.goes_on(move, radius) else None


def _last(motion: "Planned | Stop | Blended") -> "Planned | Stop | Blended":
    """The only part of a motion that has not come to its end."""
    return motion.second if isinstance(motion, Blended) and motion.first.done else motion


class Blended:
    """The sum of two motions in joint angles: what the first has still to go is taken off the second's way.

    Where the first one only slows down and the second only speeds up, no joint gets faster than in one of them at equal
    accelerations. Where a joint would get faster than it may, be accelerated more, or leave its range, the second waits for the
    end of the first; and always until that slows down.

    Args:
        first: on its way to its end, or to a stop.
        second: planned from there.
        corner: where that is (n,) [rad].
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).

    Attributes:
        goal: where the second ends (n,) [rad].
        done: both are.
        slowing: the second comes to its end.
        moving: it begins while the arm moves.
    """

    moving = True

    def __init__(
        self, first: "Planned | Stop | Blended", second: Planned, corner: Array, limits: tuple[Array, Array, Array]
    ) -> None:
        self.first, self.second, self._corner = first, second, corner
        self.done = self._begun = self._waits = False
        self._waits = self._most(limits) > 1.0

    def __copy__(self) -> "Blended":
        twin = object.__new__(Blended)
        twin.__dict__.update(self.__dict__)
        twin.first, twin.second = copy.copy(self.first), copy.copy(self.second)
        return twin

    @property
    def goal(self) -> Array:
        """Where it ends (n,) [rad]."""
        return self.second.goal

    @property
    def slowing(self) -> bool:
        """It comes to its end."""
        return self.first.done and self.second.slowing

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate, at most [s]."""
        return self.second.remaining + (0.0 if self.first.done else self.first.remaining)

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; `rate`: how fast the motion's own time passes."""
        first = self.first.step(rate)
        self._begun = self.first.done or (not self._waits and (self._begun or self.first.slowing))
        if not self._begun:
            return first
        second = self.second.step(rate)
        self.done = self.first.done and self.second.done
        return Reference(first.q + second.q - self._corner, first.qd + second.qd, first.qdd + second.qdd)

    def _most(self, limits: tuple[Array, Array, Array]) -> float:
        """The largest speed, acceleration or angle of a joint while both run, over what it may have.

        Where the first alone is accelerated more than that, as a stop may be, no more than that is added.
        """
        probe, begun, one, both = copy.copy(self), False, [], []
        stride = max(1.0, self.first.remaining / TICK / LOOKS)
        while not probe.first.done and not probe.done:
            one.append(probe.first.step(stride).q)
            begun = begun or probe.first.slowing
            both.append(one[-1] + probe.second.step(stride).q - self._corner if begun else one[-1])
        if len(both) < 3:
            return 0.0
        step = stride * TICK
        speed = np.abs(np.diff(both, axis=0)) / step / limits[0]
        acceleration = np.abs(np.diff(both, 2, axis=0)) / step**2
        alone = np.abs(np.diff(one, 2, axis=0)) / step**2
        low, high = limits[2]
        outermost = np.abs(both - 0.5 * (low + high)) / (0.5 * (high - low))
        return max(float(speed.max()), float((acceleration / np.maximum(alone, limits[1])).max()), float(outermost.max()))
