"""The tool along lines that circles join, at one speed (movep)."""

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedProcess
from sim.motion.moves import Strength
from sim.motion.planned import JERK_TIME
from sim.motion.tool_trajectory import ToolTrajectory, flange
from sim.paths.curves import Path, straight_to
from sim.paths.timing_law import TooShort
from sim.paths.tool_point import ToolPoint

Array = NDArray[np.float64]

LEAD = 0.016
"""So long before it has to slow down for a blend the next line is asked for: a script answers within some ticks [s]."""


class ProcessTrajectory(ToolTrajectory):
    """The tool centre point along lines to poses, each of which may go over into the next on a circle, at one speed.

    While the tool is on its way, another line can be put at its end. Then the speed along all that is left is planned again from
    what it is: it goes to what the new line wants, or to less where a joint would have to be too fast or be accelerated too much.

    Attributes: as of `sim.motion.tool_trajectory.ToolTrajectory`.
    """

    def __init__(
        self,
        q: Array,
        move: ScriptedProcess,
        tool: ToolPoint,
        *,
        R_FT: Array,
        limits: tuple[Array, Array, Array],
        strength: Strength | None = None,
    ) -> None:
        """Arguments as of `sim.motion.tool_trajectory.planned_line`.

        Raises:
            MoveRefused: it leads out of reach or range.
        """
        end, R_end = np.array(move.position), flange(move, R_FT)
        path = Path.of(straight_to(*tool.pose(q), end, R_end), end, R_end)
        super().__init__(q, path, tool, what="process move", limits=limits, strength=strength)
        self._R_FT = R_FT
        if not self.done:
            self.plan(path, move.speed, move.acceleration)

    def goes_on(self, move: ScriptedProcess, radius: float) -> bool:
        """Put another line at the end, with a blend of at most `radius` [m]; False: it cannot, and ends where it would have.

        Raises:
            MoveRefused: the line leads out of reach or range.
        """
        if self.done:
            return False
        path = self._path.goes_on(np.array(move.position), flange(move, self._R_FT), radius=radius, s=self._place.s)
        if path is None:
            return False
        try:
            self.plan(path, move.speed, move.acceleration)
        except TooShort:
            return False
        return True

    def nearing(self, radius: float) -> bool:
        """Whether the next line should be known now: soon it is too late to slow down for a blend of `radius` [m]."""
        s, speed, change = self._place
        _, braking, jerk = self._most
        rising = max(change, 0.0) / jerk  # until its acceleration is gone [s]
        speed += 0.5 * rising * change
        before = speed * (rising + 0.5 * speed / braking + 0.5 * JERK_TIME + LEAD)
        return self._path.length - s <= radius + before

    @property
    def moving(self) -> bool:
        """It has begun."""
        return self._place.v > 0.0
