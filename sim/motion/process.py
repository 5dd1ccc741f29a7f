"""The tool along lines that circles join, at one speed (movep)."""

import math

import numpy as np
import ruckig
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedProcess
from pendant.tick.modes import TICK
from sim.arm.frames import matrix_from_quaternion
from sim.motion.curves import Lines
from sim.motion.line import LINE_GAIN
from sim.motion.moves import MoveRefused, Reference, check_range
from sim.motion.planned import ARRIVALS, JERK_TIME
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

LEAD = 0.016
"""So long before it has to slow down for a blend the next line is asked for: a script answers within some ticks [s]."""


class ProcessTrajectory:
    """The tool centre point along lines to poses, each of which may go over into the next on a circle, at one speed.

    While the tool is on its way, another line can be put at its end. Then the speed along all that is left is planned again from
    what it is: it goes to what the new line wants, or to less where a joint would have to be too fast or be accelerated too much.
    Joint angles follow as for `sim.motion.planned.LinearTrajectory`.

    Attributes:
        goal: where it ends (n,) [rad].
        done: it is there.
        slowing: its speed falls.
    """

    def __init__(
        self,
        q: Array,
        move: ScriptedProcess,
        dynamics: Dynamics,
        *,
        tcp: Array,
        R_FT: Array,
        limits: tuple[Array, Array, Array],
    ) -> None:
        """`limits` are the joints' speed, acceleration and position (±), each (n,).

        Raises:
            MoveRefused: it leads out of reach or range.
        """
        self._q, self._qd, self.goal = q.copy(), np.zeros_like(q), q
        self._tool, self._limits = (tcp, R_FT), limits
        self._planned_tool = (tcp.copy(), R_FT.copy())  # of the path; a tool that is changed on the way counts from the next on
        self._place = (0.0, 0.0, 0.0)  # on the path, speed and acceleration along it, at full rate [m, m/s, m/s²]
        self._time, self._braking = 0.0, move.acceleration
        self.done = self.slowing = False
        self._trajectory = ruckig.Trajectory(1)
        self._path = Lines(dynamics, self._planned_tool[0], q)
        self._path.begin(*self._end(move))
        if self._path.length < 1e-6:
            self.done = self.slowing = True
        else:
            self._plan(self._path, move)

    def goes_on(self, move: ScriptedProcess, radius: float) -> bool:
        """Put another line at the end, with a blend of at most `radius` [m]; False: it cannot, and ends where it would have.

        It cannot where the path has come to its end, or the tool is another by now.

        Raises:
            MoveRefused: the line leads out of reach or range.
        """
        same = all(map(np.array_equal, self._tool, self._planned_tool))
        p, R = self._end(move)
        path = None if self.done or not same else self._path.goes_on(p, R, radius=radius, s=self._place[0])
        return path is not None and self._plan(path, move)

    def nearing(self, radius: float) -> bool:
        """Whether the next line should be known now: soon it is too late to slow down for a blend of `radius` [m]."""
        s, speed, _ = self._place
        before = speed**2 / (2.0 * self._braking) + speed * (0.5 * JERK_TIME + LEAD)
        return self._path.length - s <= radius + before

    @property
    def moving(self) -> bool:
        """It has begun."""
        return self._place[1] > 0.0

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return 0.0 if self.done else self._trajectory.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        if self.done:
            return Reference(self._q, np.zeros_like(self._q), np.zeros_like(self._q))
        self._time += rate * TICK
        self.done = self._time >= self._trajectory.duration
        (s,), (speed,), (change,) = self._trajectory.at_time(min(self._time, self._trajectory.duration))
        self._place, self.slowing = (s, speed, change), self.done or change < 0.0
        qd = self._path.solve(self._q, s, rate * speed)
        qdd = (qd - self._qd) / TICK
        self._q, self._qd = self._q + TICK * qd, qd
        return Reference(self._q, qd, qdd)

    def _end(self, move: ScriptedProcess) -> tuple[Array, Array]:
        """Tool centre point (3,) [m] and orientation of the flange (3, 3) at the end of a line, in B."""
        return np.array(move.position), matrix_from_quaternion(move.quaternion) @ self._tool[1].T

    def _plan(self, path: Lines, move: ScriptedProcess) -> bool:
        """Plan the way from here along a path; False, and nothing is changed: it could not stop at its end."""
        s, speed, change = self._place
        fastest, strongest, goal = self._walked(path, s)
        acceleration = min(move.acceleration, strongest)
        entry = ruckig.InputParameter(1)
        entry.current_position, entry.current_velocity, entry.current_acceleration = [s], [speed], [change]
        entry.target_position = [path.length]
        entry.max_velocity, entry.max_acceleration = [min(move.speed, fastest)], [acceleration]
        entry.max_jerk = [acceleration / JERK_TIME]
        trajectory = ruckig.Trajectory(1)
        ruckig.Ruckig(1).calculate(entry, trajectory)
        if trajectory.position_extrema[0].max > path.length + 1e-6:
            return False
        self._path, self._trajectory, self._time, self._braking, self.goal = path, trajectory, 0.0, acceleration, goal
        return True

    def _walked(self, path: Lines, s: float) -> tuple[float, float, Array]:
        """The speed [m/s] and acceleration [m/s²] that every joint can follow from `s` on, and joint angles (n,) at the end."""
        speed, acceleration, position = self._limits
        q, before, at = self._q.copy(), None, s
        fastest = strongest = math.inf
        for place in path.samples(s):
            if path.singular(q):
                raise MoveRefused(f"process move: out of reach or singular {1000.0 * place:.0f} mm on its way; use a joint move")
            if before is not None:
                q = q + (place - at) * before
            check_range(q, position, "process move")
            rate = path.solve(q, place, 1.0)
            fastest = min(fastest, float(np.min(speed / np.maximum(np.abs(rate), 1e-9))))
            strongest = min(strongest, float(np.min(acceleration / np.maximum(np.abs(rate), 1e-9))))
            if before is not None and place > at:
                bend = np.maximum(np.abs(rate - before) / (place - at), 1e-9)
                fastest = min(fastest, math.sqrt(float(np.min(acceleration / bend))))
            before, at = rate, place
        for _ in range(ARRIVALS):
            q = q + path.solve(q, path.length, 0.0) / LINE_GAIN
        return fastest, strongest, q
