"""References of commands that come again and again: servoj, servoc, speedj, speedl. Without a new one they come to rest."""

import math
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ServoJoints, ServoTool, SpeedJoints, SpeedTool
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import TICK
from sim.arm.frames import cross, matrix_from_quaternion, rotation_vector
from sim.braking.workspace_keeper import WorkspaceKeeper
from sim.motion.moves import DELAY, MoveRefused, Reference, check_range
from sim.motion.pace import RAMP, Pace
from sim.paths.curves import LEVER
from sim.paths.joint_speeds import BRAKING_SHARE, SLOWEST, shares, tick_later
from sim.paths.tool_point import ToolPoint

Array = NDArray[np.float64]

GRACE = 4 * TICK
"""A command's time may be over for so long: a cycle of the older controllers, which a client at 125 Hz may be late by [s]."""


class JointStream:
    """Joint angles and speeds from one tick to the next, within all limits of the joints.

    Args:
        now: where the reference is.
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        pace: knows the speeds of tool and elbow.

    Attributes:
        done: a speed has been reached, for which somebody waits.
        problem: why it cannot go on, or "".
    """

    def __init__(self, now: Reference, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        self._q, self._qd = now.q.copy(), now.qd.copy()
        self._limits, self._pace = limits, pace
        self._left = math.inf  # time that the command still holds [s]
        self._share = 1.0  # of its own speed
        self.done, self.problem = False, ""

    def step(self, share: float, limits: SpeedLimits | None, keeper: WorkspaceKeeper | None = None) -> Reference:
        """The reference of the next tick.

        Args:
            share: of its own speed.
            limits: of the robot.
            keeper: of the arm that it leads; None: it leads none.
        """
        self._left -= TICK
        self._share += min(max(share - self._share, -TICK / RAMP), TICK / RAMP)
        wanted = self._wanted() if self._left > -GRACE and not self.problem else self._braked()
        room, fast = shares(self._q, wanted, self._limits)
        allowed = min(room, self._share * fast, 1.0)
        if limits is not None and allowed > 0.0:
            allowed = min(allowed, 1.0 / max(self._pace.meter.over(self._q, wanted, limits), 1.0))
        qd = allowed * wanted
        tick_later(self._q, self._qd, qd, self._limits)
        if keeper is not None:
            qd = qd * keeper.share(self._q, qd)
        if room < 1.0 and self._ended(wanted):
            qd = np.zeros_like(qd)
        qdd = (qd - self._qd) / TICK
        self._q, self._qd = self._q + TICK * qd, qd
        return Reference(self._q, qd, qdd)

    def _wanted(self) -> Array:
        """Joint speeds (n,) that are wanted next, of a command in time [rad/s]."""
        raise NotImplementedError

    def _braked(self) -> Array:
        """Joint speeds (n,) of a stream whose command is out of date [rad/s]: slower along its way."""
        fastest = float(np.abs(self._qd).max())
        most = BRAKING_SHARE * float(self._limits[1].min()) * TICK
        return self._qd * (max(fastest - most, 0.0) / fastest) if fastest > 0.0 else self._qd

    def _ended(self, wanted: Array) -> bool:
        """Whether a joint that is wanted to go on has come to the end of its range; all can stand a tick later."""
        if (np.abs(self._qd) > self._limits[1] * TICK).any():
            return False
        low, high = self._limits[2]
        left = np.where(wanted > 0.0, high - self._q, self._q - low)
        at_end = (np.abs(wanted) > SLOWEST) & (left <= 2.0 * TICK * np.abs(self._qd))
        if not at_end.any():
            return False
        joint = int(np.argmax(at_end))
        self.problem = f"joint {joint + 1} is at the end of its range, {self._q[joint]:.3f} rad"
        return True


class ServoStream(JointStream):
    """Towards joint angles: each joint is a spring with gain K, which sees where the joint will be after the look-ahead T.

        qdd = K (q_wanted - q - T qd)

    An angle that goes on evenly is followed T later, whatever K is. The arm itself is DELAY ticks behind its reference, so T is
    the look-ahead less these, and the arm is the look-ahead behind. K says how fast a step is made up for, and K T² < 4 lets it
    swing over. Source: UR, ServoJ command (gain: "the same way as the P-term", look-ahead: "to project the current position
    forward in time with the current velocity"); the delay by T is measured (UR client library, issue 86).
    """

    def __init__(self, now: Reference, move: ServoJoints, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        super().__init__(now, limits, pace)
        self.renew(move)

    def renew(self, move: ServoJoints) -> Self:
        """Itself, with another target.

        Raises:
            MoveRefused: it is out of range.
        """
        self._target = np.array(move.q)
        check_range(self._target, self._limits[2], "servoj")
        self._gain, self._ahead, self._left = move.gain, move.lookahead - DELAY * TICK, move.time
        return self

    def _ended(self, wanted: Array) -> bool:
        return False  # its target is in range: a joint that would swing over stops there, and comes back

    def _wanted(self) -> Array:
        # Implicit in the speed, so that the largest gain and look-ahead are stable at this tick.
        error = self._target - self._q - TICK * self._qd
        return (self._qd + TICK * self._gain * error) / (1.0 + TICK * self._gain * self._ahead)


class SpeedStream(JointStream):
    """Joint speeds that are reached with one acceleration, all joints at the same time."""

    def __init__(self, now: Reference, move: SpeedJoints, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        super().__init__(now, limits, pace)
        self.renew(move)

    def renew(self, move: SpeedJoints) -> Self:
        """Itself, with another speed."""
        self._target, self._change = np.array(move.qd), move.acceleration * TICK
        self._left = move.time if move.time > 0.0 else math.inf
        self.done = False
        return self

    def _wanted(self) -> Array:
        target = self._share * self._target
        missing = target - self._qd
        most = float(np.abs(missing).max())
        self.done = self.done or most <= self._change
        return target if most <= self._change else self._qd + missing * (self._change / most)


class LineStream(JointStream):
    """A stream whose tool must be able to go everywhere.

    Args:
        now: where the reference is.
        tool: kinematics of the tool centre point.
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        pace: knows the speeds of tool and elbow.

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(self, now: Reference, tool: ToolPoint, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        super().__init__(now, limits, pace)
        self._tool = tool
        if tool.singular(self._q):
            raise MoveRefused("singular here; use a joint motion")

    def _look(self) -> None:
        """Whether it still can."""
        if self._tool.singular(self._q):
            self.problem = "singular ahead; use a joint motion"


class ToolStream(LineStream):
    """A speed of the tool centre point, and one about it (speedl); or a pose that is approached (servoc).

    Args:
        now: where the reference is.
        tool: kinematics of the tool centre point.
        R_FT: its orientation in F (3, 3).
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        pace: knows the speeds of tool and elbow.

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(
        self,
        now: Reference,
        move: SpeedTool | ServoTool,
        tool: ToolPoint,
        *,
        R_FT: Array,
        limits: tuple[Array, Array, Array],
        pace: Pace,
    ) -> None:
        super().__init__(now, tool, limits, pace)
        self._R_FT = R_FT
        self._v, self._w = self._tool.twist(self._q, self._qd)
        self._goal = self._tool.pose(self._q)
        self.renew(move)

    def renew(self, move: SpeedTool | ServoTool) -> Self:
        """Itself, with another speed or pose."""
        self._move, self.done = move, False
        if isinstance(move, SpeedTool):
            self._change = (move.acceleration * TICK, move.turning_acceleration * TICK)
            self._left = move.time if move.time > 0.0 else math.inf
        else:
            self._change = (move.acceleration * TICK, move.acceleration * TICK / LEVER)
            self._goal = np.array(move.position), matrix_from_quaternion(move.quaternion) @ self._R_FT.T
        return self

    def _wanted(self) -> Array:
        v, w = self._course()
        follow = _towards if isinstance(self._move, SpeedTool) else _steered
        self._v, near = follow(self._v, self._share * v, self._change[0])
        self._w, upright = _towards(self._w, self._share * w, self._change[1])
        self.done = self.done or (near and upright)
        self._look()
        return self._tool.speeds(self._q, self._v, self._w)

    def _course(self) -> tuple[Array, Array]:
        """Speed of the tool centre point and about it, that are wanted, in B (3,), (3,)."""
        move = self._move
        if isinstance(move, SpeedTool):
            return np.array(move.speed), np.array(move.turning)
        p, R = self._tool.pose(self._q)
        way, turn = self._goal[0] - p, R @ rotation_vector(R.T @ self._goal[1])
        far = float(np.linalg.norm(way))
        left = max(far, LEVER * float(np.linalg.norm(turn)))
        if left < 1e-9:
            return way, turn
        # The tool comes there on a circle that its way touches: the smaller that is, the slower it goes.
        sine = float(np.linalg.norm(cross(self._v, way))) / max(float(np.linalg.norm(self._v)) * far, 1e-12)
        round_it = math.sqrt(0.5 * move.acceleration * left / max(sine, 1e-9))
        pace = min(move.speed, round_it, math.sqrt(2.0 * BRAKING_SHARE * move.acceleration * left), left / (2.0 * TICK)) / left
        return pace * way, pace * turn

    def _braked(self) -> Array:
        qd = super()._braked()
        self._v, self._w = self._tool.twist(self._q, qd)
        return qd


def _steered(now: Array, wanted: Array, most: float) -> tuple[Array, bool]:
    """As `_towards`, but the direction turns on a circle, and the size changes apart from that."""
    size, goal = float(np.linalg.norm(now)), float(np.linalg.norm(wanted))
    if min(size, goal) <= most:
        return _towards(now, wanted, most)
    along = now / size
    across = wanted / goal - float(along @ wanted) / goal * along
    sine = float(np.linalg.norm(across))
    angle = math.atan2(sine, float(along @ wanted) / goal)
    turn = min(angle, most / size)
    if sine < 1e-9:  # straight on, or straight back
        return _towards(now, wanted, most)
    next_ = size + min(max(goal - size, -most), most)
    direction = math.cos(turn) * along + math.sin(turn) / sine * across
    return next_ * direction, turn == angle and next_ == goal


def _towards(now: Array, wanted: Array, most: float) -> tuple[Array, bool]:
    """The speed of the next tick, and whether it is the wanted one."""
    missing = wanted - now
    size = float(np.linalg.norm(missing))
    return (wanted, True) if size <= most else (now + missing * (most / size), False)
