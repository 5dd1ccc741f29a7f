"""A joint move, which is planned before it begins, and the share of its speed with which a motion takes a time."""

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedJoints
from pendant.program.steps import JointMove
from pendant.tick.modes import TICK
from sim.motion.moves import MoveRefused, Reference, Strength, check_range
from sim.paths.timing_law import Limits, TimingLaw

Array = NDArray[np.float64]

EASINGS = 5  # times that a move is planned with less acceleration
LEAST_EASED = 0.3  # of it, each time
GLANCE = 0.02  # between the times of a move at which its torques are looked at, at most [s]
GLANCES = 60  # of them while its jerk is the same, at most
JERK_TIME = 0.1  # a motion reaches its acceleration in this time [s]


class JointTrajectory:
    """All joints straight to a target at rest, within speed, acceleration and jerk limits.

    A joint that would need more than `strength` gives is accelerated less, and all others with it: at its limit it would fall
    behind, and swing when it catches up.

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
        """`limits`: the joints' speed and acceleration (n,), smallest and largest angle (2, n); no `strength`: any torque.

        Raises:
            MoveRefused: the target is out of range, or the time is too short.
        """
        speed, acceleration, position = limits
        self.goal = np.array(move.q)
        check_range(self.goal, position, "joint move")
        self._start, self._way = q.copy(), self.goal - q
        time = 0.0
        if isinstance(move, JointMove):
            speed, acceleration = move.speed * speed, move.acceleration * acceleration
        elif move.time > 0.0:
            time = move.time
        else:
            speed, acceleration = np.minimum(speed, move.speed), np.minimum(acceleration, move.acceleration)
        size = np.abs(self._way)
        far = size > 0.0
        self._time, self._rate = 0.0, 1.0
        self.done = self.slowing = False
        if not far.any():
            self._law = TimingLaw(0.0, Limits(1.0, 1.0, 1.0))
            return
        along = float((acceleration[far] / size[far]).min())
        most = Limits(float((speed[far] / size[far]).min()), along, along / JERK_TIME)
        self._law = TimingLaw(1.0, most)
        if strength is not None:
            most = self._ease(most, strength)
        if time > 0.0:
            self._law = TimingLaw(1.0, most.slower(slower(self._law.duration, time, "joint move")))

    def _ease(self, most: Limits, strength: Strength) -> Limits:
        """Plan with less acceleration until every joint has torque enough; returns the limits of that."""
        for _ in range(EASINGS):
            share = strength.left(map(self._at, self._law.glances(GLANCE, GLANCES)))
            if share >= 1.0:
                break
            less = max(share, LEAST_EASED)
            most = Limits(most.speed, less * most.acceleration, less * most.jerk)
            self._law = TimingLaw(1.0, most)
        return most

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return self._law.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        self._time += rate * TICK
        self.done = self._time >= self._law.duration
        s, v, a = self._law.at(self._time)
        self.slowing = self.done or a < 0.0
        if rate != 1.0 or self._rate != 1.0:
            a = rate * rate * a + (rate - self._rate) / TICK * v
            v, self._rate = rate * v, rate
        way = self._way
        return Reference(self.goal.copy() if self.done else self._start + s * way, v * way, a * way)

    def _at(self, time: float) -> Reference:
        """The reference so long after its begin, at full rate."""
        s, v, a = self._law.at(time)
        return Reference(self._start + s * self._way, v * self._way, a * self._way)


def slower(needed: float, time: float, move: str) -> float:
    """The share of its speed with which a motion that needs so long takes `time` [s].

    Raises:
        MoveRefused: it cannot be as fast.
    """
    if needed > time:
        raise MoveRefused(f"{move}: it needs {needed:.3f} s, not {time:.3f} s")
    return needed / time
