"""Keeps the arm's own motions in the workspace and the joints within their limits: who follows a reference asks here how fast it
may go on (VW-9, VW-10, RL-6).
"""

from collections.abc import Sequence
from math import degrees

import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.safety.robot_limits import JointRange
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, Law
from pendant.tick.pose import Pose, Vector, flat, product
from pendant.walls.workspace import ArmPoints, OutwardLimits, Workspace, told
from sim.braking.look_ahead import AlongPlan, LookAhead
from sim.braking.stopping_distance import StoppingDistance, free_way
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

HELD = 0.02
"""A motion that is slowed down to this share of its speed is at the border: it would creep on, ever more slowly."""


class WorkspaceKeeper:
    """Slows down what leads the arm before a border, and says when it can go on no more.

    A plan is looked at ahead, and stopped on its path where that leads out. Of a stream, and of a jogged motion, only the next
    speed is known: it may be so fast that the arm could still stop inside. A joint is to its limits what a part is to a border,
    with radians for metres. Without a workspace and without limits of the joints nothing is computed.

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        R_FT: its orientation in F (3, 3).
        stopping: what it takes to come to rest.

    Attributes:
        problem: why the motion cannot go on, or "".
        wall: the area that it is about, or "".
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, R_FT: Array, stopping: StoppingDistance) -> None:
        self._dynamics, self._tcp, self._R_FT, self._stopping = dynamics, tcp, R_FT, stopping
        self._workspace: Workspace | None = None
        self._joints: JointRange | None = None
        self._q = np.zeros(0)  # where the arm is led (n,)
        self._follows = False  # a motion was followed in the last tick
        self._limits = OutwardLimits(0)
        self._look: LookAhead | None = None
        self._levers = np.zeros(0)
        self.problem = self.wall = ""

    def take(self, decision: Decision, q: Array, *, begins: bool) -> None:
        """One tick begins, the arm being led at angles (n,); `begins`: so does a motion."""
        space, joints = decision.workspace, decision.joint_range
        if space is None and joints is None and not self._bound:
            return
        follows, same = decision.law is _FOLLOW, space is self._workspace and joints is self._joints
        going_on = self._follows and same and not (q == self._q).all()
        self._q, self._follows = q, follows
        if follows and not begins and same:
            return
        self._look, self.problem, self.wall = None, "", ""
        if not same:
            self._workspace, self._joints = space, joints
            count = (0 if space is None else len(space.areas)) + (0 if joints is None else q.size)
            self._limits = OutwardLimits(count)
        if self._bound and follows and not going_on:  # else it is the same way on which only the command is new
            self._limits.begin(self._distances(q))
            self._levers = self._dynamics.levers(float(np.linalg.norm(self._tcp)))

    def rate(self, motion: AlongPlan, rate: float) -> float:
        """The rate at which a plan's own time passes in the next tick, at most `rate`."""
        if not self._bound:
            return rate
        if self._look is None:
            self._look = LookAhead(motion, self._limits, self._distances, self._stopping)
        rate = self._look.rate(rate)
        if self._look.stopped is not None:
            self._tell(self._look.stopped, self._q)
        return rate

    def share(self, q: Array, qd: Array) -> float:
        """The share of these speeds (n,) that the next tick may have, 1 at most, at angles (n,)."""
        if not self._bound:
            return 1.0
        distances = self._distances(q)
        self._limits.step(distances)
        seconds = self._stopping.seconds(q, qd)
        way = self._stopping.way(seconds, TICK)
        free = self._free(q, qd, way, self._over(distances))
        if free >= way:
            return 1.0
        share = self._stopping.share(free, seconds, TICK)
        if share < HELD:
            self._tell_ahead(q, qd, way)
            return 0.0
        return share

    def watch(self, estimate: Estimate) -> str:
        """Of joints that no reference leads: why they must brake now, when they can only just stop inside, or ""."""
        stopping = self._stopping
        if self._bound:
            q, qd = estimate.q, estimate.theta_d + stopping.reaction * estimate.theta_dd  # as fast as they are by then
            way = stopping.way(stopping.seconds(q, qd), stopping.reaction)
            if self._free(q, qd, way, self._out(q)) < way:
                self._tell_ahead(q, qd, way)
        return self.problem

    def stop_length(self, now: Sequence[Array], length: float) -> float:
        """How long a gentle stop takes [s], at most `length`: as hard as it must be to end inside.

        Args:
            now: the reference, whose first two are angles and speeds (n,).
            length: that is wanted [s].
        """
        q, qd = now[:2]
        if not self._bound or not qd.any():
            return length
        free = self._free(q, qd, 0.5 * length, self._out(q))
        return max(min(length, 2.0 * free), min(length, self._stopping.seconds(q, qd)))

    def _free(self, q: Array, qd: Array, way: float, out: float) -> float:
        """As `free_way`; not looked at where no part can come to a border on it. `out`: as of `_out` at q [m]."""
        size = np.abs(qd)
        reach = way * float(size @ self._levers)
        if self._joints is not None:
            reach = max(reach, way * float(size.max()))
        return way if out < -reach else free_way(self._out, q, qd, way)

    def _out(self, q: Array) -> float:
        """How far the part that is furthest out is beyond what it may [m]."""
        return self._over(self._distances(q))

    def _over(self, distances: list[float]) -> float:
        return max(distance - bound for distance, bound in zip(distances, self._limits.bound, strict=True))

    @property
    def _bound(self) -> bool:
        """Something bounds the arm's motions."""
        return self._workspace is not None or self._joints is not None

    def _distances(self, q: Array) -> list[float]:
        """Of each part to its border [m], then of each joint to its nearer limit [rad]."""
        found = [] if self._workspace is None else self._workspace.distances(self._points(q))
        if self._joints is not None:
            found += [max(x - high, low - x) for x, low, high in zip(q.tolist(), *self._joints, strict=True)]
        return found

    def _points(self, q: Array) -> ArmPoints:
        dynamics = self._dynamics
        p, R, elbow = dynamics.places(q)
        R_BF = flat(R)
        tcp = Pose(_vector(p + R @ self._tcp), product(R_BF, flat(self._R_FT)))
        return ArmPoints(Pose(_vector(p), R_BF), tcp, _vector(elbow), _vector(dynamics.gravity_B), dynamics.load.mass)

    def _tell_ahead(self, q: Array, qd: Array, way: float) -> None:
        """What is in the way."""
        ahead = [a - b for a, b in zip(self._distances(q + way * qd), self._limits.bound, strict=True)]
        self._tell(max(range(len(ahead)), key=ahead.__getitem__), q)

    def _tell(self, bound: int, q: Array) -> None:
        """Why the motion ends at an area, or at a limit of a joint, which are counted after the areas."""
        space = self._workspace
        areas = 0 if space is None else len(space.areas)
        if space is None or bound >= areas:
            assert self._joints is not None
            joint = bound - areas
            angle, low, high = q[joint].item(), self._joints.low[joint], self._joints.high[joint]
            limit, back = (high, "-") if angle - high > low - angle else (low, "+")
            self.problem, self.wall = f"joint {joint + 1} at its limit, {degrees(limit):.1f}°; back is {back}", ""
            return
        near = space.nearby(bound, self._points(q))
        self.problem, self.wall = told(near), near.border.name


def _vector(point: Array) -> Vector:
    x, y, z = point.tolist()
    return x, y, z


_FOLLOW = Law.FOLLOW  # looked up in every tick
