"""The reference that pushes with a force: it goes on along it until that is felt, and gives way to more (CD-15)."""

import math

import numpy as np
from numpy.typing import NDArray

from pendant.program.steps import ApplyForce
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.motion.moves import MoveRefused, Reference, check_range
from sim.paths.curves import Straight
from sim.paths.tool_point import Followed, ToolPoint

Array = NDArray[np.float64]

INTEGRAL = 4.0  # of the force that is missing, into the force that the joints push with [1/s]
BANDWIDTH = 15.0  # of the force that is looked at [Hz]
FOLLOWING = 0.05  # time in which the line's reference comes after the tool [s]
STANDS = 2e-5  # slower it does not move: friction fed forward would change its sign with the noise [m/s]


class ForceTrajectory:
    """The joints push along the force with what is missing of it, while the line's reference follows the tool.

    A position cannot be told to push: joints stick, and give way by half a millimetre, a force of 15 N. Torque can, on whatever
    it meets. Across the force and in its orientation the tool is held as on a line; along it, the reference goes no faster than
    the move says, and so the tool does not, either.

    Attributes:
        done: the force has lasted.
        problem: why it cannot go on, or "".
        push: torque (n,) with which the joints push [N·m].

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(self, q: Array, move: ApplyForce, tool: ToolPoint, *, position: Array) -> None:
        """`position` are the joints' smallest and largest angles (2, n) [rad]."""
        if tool.singular(q):
            raise MoveRefused("force: singular here; use another posture")
        self._wanted = math.hypot(*move.force)
        self._along = np.array(move.force) / self._wanted
        self._tool, self._line = tool, Straight(*tool.pose(q), self._along, np.zeros(3))
        self._move, self._position = move, position
        self._untouched = np.array(move.untouched)
        self._smoothing = 1.0 - math.exp(-2.0 * math.pi * BANDWIDTH * TICK)
        self._felt: float | None = None  # force [N]
        self._size = 0.0  # of the joints' push [N]
        self.push = np.zeros_like(q)
        self._s, self._ahead = 0.0, 0.0  # of the reference, of the tool against it [m]
        self._joints, self._qd = Followed.at(q.copy()), np.zeros_like(q)
        self._lasted = 0.0  # [s]
        self.done, self.problem = False, ""

    def feel(self, estimate: Estimate) -> None:
        """Take this tick's force and place in."""
        if not estimate.wrench_valid:
            self.problem = "force: needs the flange force sensor"
            return
        # F_user is what the outside does to the arm.
        force = float((self._untouched - estimate.F_user[:3]) @ self._along)
        place = float((estimate.tcp[:3] - self._line.p) @ self._along)
        if self._felt is None:
            self._felt = force
        self._felt += self._smoothing * (force - self._felt)
        self._ahead = place - self._s

    def step(self, limits: SpeedLimits | None = None) -> Reference:
        """The reference of the next tick; `limits` are the robot's."""
        most = self._move.speed if limits is None else min(self._move.speed, limits.tcp)
        missing = self._wanted - (self._felt or 0.0)
        self._lasted = self._lasted + TICK if abs(missing) <= self._move.tolerance else 0.0
        self.done = self.done or self._lasted > self._move.duration
        rate = self._ahead / FOLLOWING
        fast = abs(rate) > most
        if not fast:  # else the way is free, and nothing is to be made up for later
            self._size += INTEGRAL * missing * TICK
        rate = 0.0 if abs(rate) < STANDS else math.copysign(min(abs(rate), most), rate)
        self._s += rate * TICK
        if abs(self._s) > self._move.distance:
            self.problem = f"force: {self._felt or 0.0:.1f} N after {1000.0 * self._move.distance:.0f} mm"
        joints = self._joints = self._tool.follow(self._line.record, self._s, self._joints, rate * TICK)
        qd = rate * joints.rate
        qdd, self._qd = (qd - self._qd) / TICK, qd
        if joints.singular or not joints.reached:
            self.problem = "force: singular ahead; use another posture"
        try:
            check_range(joints.q, self._position, "force")
        except MoveRefused as refusal:
            self.problem = str(refusal)
        self.push = self._tool.torque(joints.q, self._size * self._along)
        return Reference(joints.q, qd, qdd)
