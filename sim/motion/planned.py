"""Motions that are planned from rest to rest before they begin: joint moves, lines, circles."""

import math
from operator import mul

import numpy as np
import ruckig
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedArc, ScriptedJoints, ScriptedLine
from pendant.program.steps import JointMove, LinearMove
from pendant.tick.modes import TICK
from sim.arm.frames import matrix_from_quaternion
from sim.motion.curves import LEVER, SPACING, Arc
from sim.motion.line import LINE_GAIN, Line, rotation_vector
from sim.motion.moves import MoveRefused, Reference, Strength, check_range
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

EASINGS = 5  # times that a move is planned with less acceleration
LEAST_EASED = 0.3  # of it, each time
JERK_TIME = 0.1  # a joint reaches its acceleration in this time [s]
SAMPLES = (24, 200)  # fewest and most of them
ARRIVALS = 6  # steps of Newton's method to the joint angles at the end of a line
FASTEST_LINE = (3.0, 50.0)  # speed and acceleration that a line with a time of its own is planned with [m/s, m/s²]


class JointTrajectory:
    """All joints to a target at rest, at the same time, within speed, acceleration and jerk limits (ruckig).

    A joint that would need more than `strength` gives is accelerated less, and all others with it: at its limit it would fall
    behind, and swing when it catches up. A script's move is straight in joint angles.

    Attributes:
        goal: where it ends (n,) [rad].
        slowing: it comes to its end.
    """

    def __init__(
        self,
        q: Array,
        move: JointMove | ScriptedJoints,
        limits: tuple[Array, Array, Array],
        strength: Strength | None = None,
    ) -> None:
        """`limits` are the joints' speed, acceleration and position (±), each (n,); without `strength` they have any torque.

        Raises:
            MoveRefused: the target is out of range, or the time is too short.
        """
        speed, acceleration, position = limits
        self.goal = np.array(move.q)
        check_range(self.goal, position, "joint move")
        n = q.size
        entry = ruckig.InputParameter(n)
        entry.current_position, entry.target_position = q.tolist(), list(move.q)
        time = 0.0
        if isinstance(move, JointMove):
            speed, acceleration = move.speed * speed, move.acceleration * acceleration
        else:
            time = move.time
            entry.synchronization = ruckig.Synchronization.Phase
            if time == 0.0:
                speed, acceleration = np.minimum(speed, move.speed), np.minimum(acceleration, move.acceleration)
        entry.max_velocity = speed.tolist()
        eased = 1.0
        for _ in range(EASINGS if strength else 1):
            entry.max_acceleration = (eased * acceleration).tolist()
            entry.max_jerk = (eased * acceleration / JERK_TIME).tolist()
            self._trajectory = _planned(entry, n)
            share = 1.0 if strength is None else strength.left(self._trajectory)
            if share >= 1.0:
                break
            eased *= max(share, LEAST_EASED)
        if time > 0.0:
            slower = _slower(self._trajectory.duration, time, "joint move")
            entry.max_velocity = (slower * speed).tolist()
            entry.max_acceleration = (slower**2 * eased * acceleration).tolist()
            entry.max_jerk = (slower**3 * eased * acceleration / JERK_TIME).tolist()
            self._trajectory = _planned(entry, n)
        self._time, self._rate = 0.0, 1.0
        self.done = self.slowing = False

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return self._trajectory.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        self._time += rate * TICK
        self.done = self._time >= self._trajectory.duration
        position, velocity, acceleration = self._trajectory.at_time(min(self._time, self._trajectory.duration))
        speed, change = np.array(velocity), np.array(acceleration)
        self.slowing = self.done or sum(map(mul, velocity, acceleration)) < 0.0
        if rate == 1.0 == self._rate:
            return Reference(np.array(position), speed, change)
        changing = (rate - self._rate) / TICK
        self._rate = rate
        return Reference(np.array(position), rate * speed, rate * rate * change + changing * speed)


def _slower(needed: float, time: float, move: str) -> float:
    """The share of its speed with which a motion that needs so long takes `time` [s].

    Raises:
        MoveRefused: it cannot be as fast.
    """
    if needed > time:
        raise MoveRefused(f"{move}: it needs {needed:.3f} s, not {time:.3f} s")
    return needed / time


def _planned(entry: ruckig.InputParameter, n: int) -> ruckig.Trajectory:
    """The trajectory of `entry`.

    Ruckig's root search fails for some way that lies within rounding of a profile's border; a hair less jerk is a profile
    next to it, which it finds.

    Raises:
        MoveRefused: none is found with a few hairs less, either.
    """
    jerk = np.array(entry.max_jerk)
    for less in (1.0, 0.999, 0.99, 0.9):
        entry.max_jerk = (less * jerk).tolist()
        trajectory = ruckig.Trajectory(n)
        try:
            result = ruckig.Ruckig(n).calculate(entry, trajectory)
        except ruckig.RuckigError:
            continue
        if result in (ruckig.Result.Working, ruckig.Result.Finished):
            return trajectory
    raise MoveRefused(f"joint move: no trajectory to {list(entry.target_position)}")


class LinearTrajectory:
    """The tool centre point along a straight line or a circle, turning about one axis, at rest at both ends.

    Path speed and acceleration follow ruckig in one dimension; joint angles follow from resolved motion rates
    (qd = J^-1 (v + k e)) against the model's own kinematics. Beforehand the line is walked through once: a joint that would
    exceed its speed slows the whole move down, a line through a singularity or out of reach is refused.

    Attributes:
        goal: where it ends (n,) [rad].
        slowing: it comes to its end.
    """

    def __init__(
        self,
        q: Array,
        move: LinearMove,
        dynamics: Dynamics,
        *,
        tcp: Array,
        R_FT: Array,
        limits: tuple[Array, Array, Array],
    ) -> None:
        """`limits` are the joints' speed, acceleration and position (±), each (n,).

        Raises:
            MoveRefused: it leads out of reach or range, or its time is too short.
        """
        self._what = "circular move" if isinstance(move, ScriptedArc) else "linear move"
        self._line, span = self._course(q, move, dynamics, tcp=tcp, R_FT=R_FT)
        self._q, self._qd, self.goal = q.copy(), np.zeros_like(q), q
        self._time, self.done, self.slowing = 0.0, span < 1e-6, False
        self._trajectory = ruckig.Trajectory(1)
        if self.done:
            return
        time = move.time if isinstance(move, ScriptedLine | ScriptedArc) else 0.0
        speed, acceleration = (move.speed, move.acceleration) if time == 0.0 else FASTEST_LINE
        fraction = min(1.0, self._slowest(q, limits, (speed, acceleration), span))
        self._plan(fraction, speed / span, acceleration / span)
        if time > 0.0:
            self._plan(fraction * _slower(self._trajectory.duration, time, self._what), speed / span, acceleration / span)

    def _course(self, q: Array, move: LinearMove, dynamics: Dynamics, *, tcp: Array, R_FT: Array) -> tuple[Line, float]:
        """The line, and its length, or the turn's [m]."""
        end, tcp = np.array(move.position), tcp.copy()  # a tool that is changed on the way counts from the next motion on
        if isinstance(move, ScriptedArc):
            line = Arc(dynamics, tcp, q, via=np.array(move.via), end=end)
            length = line.radius * line.angle
        else:
            line = Line(dynamics, tcp, q)
            line.way = end - line.start
            length = float(np.linalg.norm(line.way))
        if isinstance(line, Arc) and isinstance(move, ScriptedArc) and move.fixed:
            line.turn = line.angle * (line.R.T @ line.axis)
            return line, length  # it turns with the tangent, whose speed is the tool's
        line.turn = rotation_vector(line.R.T @ matrix_from_quaternion(move.quaternion) @ R_FT.T)
        return line, max(length, LEVER * float(np.linalg.norm(line.turn)))

    def _plan(self, fraction: float, pace: float, change: float) -> None:
        """Along the share of the line from 0 to 1, with a fraction of this speed [1/s] and acceleration [1/s²]."""
        entry = ruckig.InputParameter(1)
        entry.current_position, entry.target_position = [0.0], [1.0]
        entry.max_velocity = [fraction * pace]
        entry.max_acceleration = [fraction**2 * change]
        entry.max_jerk = [fraction**3 * change / JERK_TIME]
        ruckig.Ruckig(1).calculate(entry, self._trajectory)

    def _slowest(self, q: Array, limits: tuple[Array, Array, Array], most: tuple[float, float], span: float) -> float:
        """Factor on the path's speed that keeps every joint within its speed and acceleration, and the line in reach."""
        speed, acceleration, position = limits
        count = min(max(SAMPLES[0], math.ceil(span / SPACING)), SAMPLES[1])
        pace = most[0] / span
        q, worst, previous = q.copy(), 1e-9, None
        for k in range(count + 1):
            if self._line.singular(q):
                way = 1000.0 * k / count * span
                raise MoveRefused(f"{self._what}: out of reach or singular {way:.0f} mm on its way; use a joint move")
            rate = self._line.solve(q, k / count, 1.0)
            worst = max(worst, float((np.abs(rate) * pace / speed).max()))
            if previous is not None:
                worst = max(worst, math.sqrt(float((np.abs(rate - previous) * count * pace**2 / acceleration).max())))
            previous = rate
            check_range(q, position, self._what)
            q = q + rate / count
        for _ in range(ARRIVALS):
            q = q + self._line.solve(q, 1.0, 0.0) / LINE_GAIN
        self.goal = q
        return 1.0 / worst

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return 0.0 if self.done else self._trajectory.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        if not self.done:
            self._time += rate * TICK
            self.done = self._time >= self._trajectory.duration
            position, velocity, change = self._trajectory.at_time(min(self._time, self._trajectory.duration))
            self.slowing = self.done or change[0] < 0.0
            qd = self._line.solve(self._q, position[0], rate * velocity[0])
            qdd = (qd - self._qd) / TICK
            self._q, self._qd = self._q + TICK * qd, qd
            return Reference(self._q, qd, qdd)
        return Reference(self._q, np.zeros_like(self._q), np.zeros_like(self._q))
