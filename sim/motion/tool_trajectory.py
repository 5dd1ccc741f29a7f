"""Moves of the tool, which are planned before they begin: a path, and a timing law along it."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ScriptedArc, ScriptedLine
from pendant.program.steps import LinearMove
from pendant.tick.modes import TICK
from sim.arm.frames import matrix_from_quaternion, rotation_by, rotation_vector
from sim.motion.moves import MoveRefused, Reference, Strength, check_range, turning_points
from sim.motion.planned import JERK_TIME, slower
from sim.paths.curves import LEVER, NO_WAY, Circle, Path, straight_to
from sim.paths.timing_law import HAIR, REST, Limits, TimingLaw, TooShort
from sim.paths.tool_point import Followed, ToolPoint, WalkedWay
from sim.paths.way_following import SPATIAL

Array = NDArray[np.float64]

SPACING = 0.01  # between the places of a path that are looked at beforehand, at most [m]
BEND = 0.03  # by which a joint goes between them, at most: less than across a singularity [rad]
FREE_BEND = 0.01  # the same where a pose leaves a joint free: from place to place its speed changes by the square of this [rad]
FEWEST = 4  # of them on a piece, at least
BENDS = 0.5  # share of the joints' accelerations that a path's own acceleration leaves for its bends, where they need it
FASTEST_LINE = (3.0, 50.0)  # speed and acceleration that a line with a time of its own is planned with [m/s, m/s²]


class ToolTrajectory:
    """The tool centre point along a path, at rest at its end.

    Joint angles are those that have the tool on the path; speeds and accelerations are theirs. Beforehand the path is walked
    through once: a joint that would exceed its speed, its acceleration or its torque slows the whole motion down; a path through
    a singularity or out of reach is refused.

    Args:
        q: joint angles at the begin of the path (n,) [rad].
        path: of the tool centre point.
        tool: its kinematics; a tool that is changed on the way counts from the next motion on.
        what: the kind of move.
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        strength: what the joints can give; None: any torque.

    Attributes:
        goal: where it ends (n,) [rad].
        done: it is there.
        slowing: its speed falls.
    """

    def __init__(
        self,
        q: Array,
        path: Path,
        tool: ToolPoint,
        *,
        what: str,
        limits: tuple[Array, Array, Array],
        strength: Strength | None = None,
    ) -> None:
        self._tool, self._what, self._limits, self._strength = tool.kept(), what, limits, strength
        self._most = Limits(1.0, 1.0, 1.0)
        self._path, self._law = path, TimingLaw(0.0, self._most)
        self._joints, self._place, self.goal = Followed.at(q.copy()), REST, q.copy()
        self._walk = WalkedWay([])
        self._time, self._rate = 0.0, 1.0
        self.done = self.slowing = path.length < NO_WAY

    def plan(self, path: Path, speed: float, acceleration: float, time: float = 0.0) -> None:
        """Plan the way from here along a path; where that raises, nothing is changed.

        Args:
            path: that goes on from here.
            speed: along it, at most [m/s].
            acceleration: along it, at most [m/s²].
            time: that it takes, in place of both; 0: they count [s].

        Raises:
            MoveRefused: it leads out of reach or range, or its time is too short.
            TooShort: it goes too fast to slow down for what comes.
        """
        if time > 0.0:
            speed, acceleration = FASTEST_LINE
        places = list(self._walked(path))
        most = self._allowed(places, speed, acceleration)
        begin = self._place
        law = TimingLaw(path.length, most, begin)
        if begin.v > most.speed:
            # On the way to a lower speed it is still faster than that: the joints must be able to follow there.
            near = [place for place in places if place[0] <= law.level]
            if self._allowed(near, begin.v, most.acceleration).speed < begin.v * (1.0 - HAIR):
                raise TooShort(f"{self._what}: it is too fast for what comes")
        if time > 0.0:
            most = most.slower(slower(law.duration, time, self._what))
            law = TimingLaw(path.length, most, begin)
        self._path, self._law, self._most, self._time, self.goal = path, law, most, 0.0, places[-1][1].q
        self._walk = WalkedWay(places)

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return 0.0 if self.done else self._law.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        if self.done:
            return Reference(self.goal, np.zeros_like(self.goal), np.zeros_like(self.goal))
        self._time += rate * TICK
        self.done = self._time >= self._law.duration
        place = s, v, a = self._law.at(self._time)
        part = self._path.part(s)
        at, step = part.first + s - part.begin, s - self._place.s
        joints = self._tool.go_on(part.piece.record, at, self._joints, step, s=s, walk=self._walk)
        self._joints, self._place, self.slowing = joints, place, self.done or a < 0.0
        if rate != 1.0 or self._rate != 1.0:
            a = rate * rate * a + (rate - self._rate) / TICK * v
            v, self._rate = rate * v, rate
        return Reference(joints.q, v * joints.rate, a * joints.rate + v * v * joints.bend)

    def _walked(self, path: Path) -> Iterator[tuple[float, Followed]]:
        """Places of a path from here to its end, and joint angles there.

        Raises:
            MoveRefused: it leads out of reach or range.
        """
        joints = self._joints
        for part in path.parts:
            place, end, step = max(part.begin, self._place.s), part.end, 0.0
            spacing = min(SPACING, (end - place) / FEWEST)
            while place <= end:
                before = joints
                joints = self._tool.follow(part.piece.record, part.first + place - part.begin, joints, step)
                if joints.singular or not joints.reached:
                    way = 1000.0 * place
                    raise MoveRefused(f"{self._what}: out of reach or singular {way:.0f} mm on its way; use a joint move")
                check_range(joints.q, self._limits[2], self._what)
                check_range(turning_points(before, joints, step)[1], self._limits[2], self._what)
                yield place, joints
                if place == end:
                    break
                step = max(min(spacing, bend_of(joints) / max(float(np.abs(joints.rate).max()), 1e-9)), NO_WAY)
                last = place + 1.01 * step >= end
                step = end - place if last else step
                place = end if last else place + step

    def _allowed(self, places: list[tuple[float, Followed]], speed: float, acceleration: float) -> Limits:
        """Speed and acceleration along a path that every joint can follow at all of its places.

        In a joint's acceleration q' a + q'' v², the path's own part q' a gets what the bends leave at this speed, or a share of
        all, whichever is more; then the bends get what is left. The torque of a motion has the same form.
        """
        most = self._limits[0]
        rate, bend = (np.array([getattr(joints, name) for _, joints in places]) for name in ("rate", "bend"))
        size = np.maximum(np.abs(rate), 1e-9)
        speed = min(speed, float((most / size).min()))
        needs = [(self._limits[1], size, np.abs(bend))]
        if self._strength is not None:
            needs += [self._strength.needed(joints) for _, joints in places]
        for allowed, along, across in needs:
            least, unbent = allowed / np.maximum(along, 1e-9), (allowed - across * speed**2) / np.maximum(along, 1e-9)
            acceleration = min(acceleration, max((1.0 - BENDS) * float(least.min()), float(unbent.min())))
        for allowed, along, across in needs:
            left = np.maximum(allowed - along * acceleration, 0.0)
            speed = min(speed, math.sqrt(float((left / np.maximum(across, 1e-9)).min())))
        return Limits(speed, acceleration, acceleration / JERK_TIME)


def bend_of(joints: Followed) -> float:
    """By how much a joint goes at most from one place of a walk to the next [rad]."""
    return FREE_BEND if joints.q.size > SPATIAL else BEND


def planned_line(
    q: Array,
    move: LinearMove,
    tool: ToolPoint,
    *,
    R_FT: Array,
    limits: tuple[Array, Array, Array],
    strength: Strength | None = None,
) -> ToolTrajectory:
    """The motion of a linear or circular move from joint angles q (n,) [rad]; arguments as of `ToolTrajectory`.

    Raises:
        MoveRefused: it leads out of reach or range, or its time is too short.
    """
    path = _course(move, *tool.pose(q), R_FT)
    what = "circular move" if isinstance(move, ScriptedArc) else "linear move"
    motion = ToolTrajectory(q, path, tool, what=what, limits=limits, strength=strength)
    if not motion.done:
        motion.plan(path, move.speed, move.acceleration, move.time if isinstance(move, ScriptedLine | ScriptedArc) else 0.0)
    return motion


def flange(move: LinearMove, R_FT: Array) -> Array:
    """Orientation of the flange (3, 3) at the end of a move of the tool, whose orientation in F is R_FT (3, 3)."""
    return matrix_from_quaternion(move.quaternion) @ R_FT.T


def _course(move: LinearMove, p: Array, R: Array, R_FT: Array) -> Path:
    """The path of a move from tool centre point p (3,) [m] and orientation R (3, 3) of the flange."""
    end, R_end = np.array(move.position), flange(move, R_FT)
    if not isinstance(move, ScriptedArc):
        return Path.of(straight_to(p, R, end, R_end), end, R_end)
    circle = Circle(p, via=np.array(move.via), end=end)
    if move.fixed:  # it turns with the tangent, whose speed is the tool's
        turn, length = circle.angle * (R.T @ circle.axis), circle.radius * circle.angle
        return Path.of(circle.turning(R, turn, length), end, R @ rotation_by(turn))
    turn = rotation_vector(R.T @ R_end)
    length = max(circle.radius * circle.angle, LEVER * float(np.linalg.norm(turn)))
    return Path.of(circle.turning(R, turn, length), end, R_end)
