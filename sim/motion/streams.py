"""References of commands that come again and again: servoj, servoc, speedj, speedl. Without a new one they come to rest."""

import math
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import ServoJoints, ServoTool, SpeedJoints, SpeedTool
from pendant.robot.reduced import SpeedLimits
from pendant.tick.modes import TICK
from sim.arm.frames import matrix_from_quaternion
from sim.braking.workspace_keeper import WorkspaceKeeper
from sim.motion.curves import LEVER
from sim.motion.line import Line, rotation_vector
from sim.motion.moves import DELAY, MoveRefused, Reference, check_range
from sim.motion.pace import RAMP, SHARE, Pace
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

LOOK_TICKS = 5  # between looks for a singularity
GRACE = 4 * TICK
"""A command's time may be over for so long: a cycle of the older controllers, which a client at 125 Hz may be late by [s]."""
BRAKING_SHARE = 0.5
"""Of a joint's acceleration, with which a stream out of date comes to rest, and with which it keeps off the end of the range."""
NEAR = 1e-4
"""So near to its end a range ends a stream that goes there [rad]."""


class JointStream:
    """Joint angles and speeds from one tick to the next, within all limits of the joints.

    Args:
        now: where the reference is.
        limits: the joints' speed, acceleration and position (±), each (n,).
        pace: knows the speeds of tool and elbow.

    Attributes:
        done: a speed has been reached, for which somebody waits.
        problem: why it cannot go on, or "".
    """

    def __init__(self, now: Reference, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        self._q, self._qd = now.q.copy(), now.qd.copy()
        self._speed, self._acceleration, self._position = limits
        self._pace = pace
        self._left = math.inf  # time that the command still holds [s]
        self._share = 1.0  # of its own speed
        self.done, self.problem = False, ""

    def step(self, share: float, limits: SpeedLimits | None, keeper: WorkspaceKeeper | None = None) -> Reference:
        """The reference of the next tick.

        Args:
            share: of its own speed.
            limits: of REDUCED.
            keeper: of the arm that it leads; None: it leads none.
        """
        self._left -= TICK
        self._share += min(max(share - self._share, -TICK / RAMP), TICK / RAMP)
        change = (self._wanted() if self._left > -GRACE else self._braked()) - self._qd
        most = float((np.abs(change) / self._acceleration).max()) / TICK
        qd = self._qd + (change if most <= 1.0 else change / most)
        allowed = self._allowed(qd, limits)
        qd = qd * (allowed if keeper is None else min(allowed, keeper.share(self._q, qd)))
        qdd = (qd - self._qd) / TICK
        self._q, self._qd = self._q + TICK * qd, qd
        return Reference(self._q, qd, qdd)

    def _wanted(self) -> Array:
        """Joint speeds (n,) that are wanted next, of a command in time [rad/s]."""
        raise NotImplementedError

    def _braked(self) -> Array:
        """Joint speeds (n,) of a stream whose command is out of date [rad/s]: slower along its way."""
        fastest = float(np.abs(self._qd).max())
        most = BRAKING_SHARE * float(self._acceleration.min()) * TICK
        return self._qd * (max(fastest - most, 0.0) / fastest) if fastest > 0.0 else self._qd

    def _allowed(self, qd: Array, limits: SpeedLimits | None) -> float:
        """The share of these joint speeds that the range, REDUCED and the override allow, 1 at most."""
        if not qd.any():
            return 1.0
        left = np.maximum(self._position - np.sign(qd) * self._q, 0.0)
        stopping = np.sqrt(2.0 * BRAKING_SHARE * self._acceleration * left)
        most = np.minimum(self._share * self._speed, stopping)
        fast = np.abs(qd) > 1e-9
        if bool((left[fast] < NEAR).any()):
            joint = int(np.argmin(np.where(fast, left, math.inf)))
            self.problem = f"joint {joint + 1} is at the end of its range, {self._q[joint]:.3f} rad"
            return 0.0
        allowed = float(np.min(most[fast] / np.abs(qd[fast]), initial=1.0))
        if limits is not None:
            allowed = min(allowed, SHARE / max(self._pace.over(self._q, qd, limits), 1e-9))
        return allowed


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
        check_range(self._target, self._position, "servoj")
        self._gain, self._ahead, self._left = move.gain, move.lookahead - DELAY * TICK, move.time
        return self

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
        line: of the tool, from there.
        limits: the joints' speed, acceleration and position (±), each (n,).
        pace: knows the speeds of tool and elbow.

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(self, now: Reference, line: Line, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        super().__init__(now, limits, pace)
        self._line, self._looks = line, 0
        if line.singular(self._q):
            raise MoveRefused("singular here; use a joint motion")

    def _look(self) -> None:
        """Now and then, whether it still can."""
        self._looks += 1
        if self._looks % LOOK_TICKS == 0 and self._line.singular(self._q):
            self.problem = "singular ahead; use a joint motion"


class ToolStream(LineStream):
    """A speed of the tool centre point, and one about it (speedl); or a pose that is approached (servoc).

    Args:
        now: where the reference is.
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        R_FT: its orientation in F (3, 3).
        limits: the joints' speed, acceleration and position (±), each (n,).
        pace: knows the speeds of tool and elbow.

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(
        self,
        now: Reference,
        move: SpeedTool | ServoTool,
        dynamics: Dynamics,
        *,
        tcp: Array,
        R_FT: Array,
        limits: tuple[Array, Array, Array],
        pace: Pace,
    ) -> None:
        super().__init__(now, Line(dynamics, tcp, now.q), limits, pace)
        self._R_FT = R_FT
        self._v, self._w = self._line.twist(self._q, self._qd)
        self.renew(move)

    def renew(self, move: SpeedTool | ServoTool) -> Self:
        """Itself, with another speed or pose."""
        self._move, self.done = move, False
        if isinstance(move, SpeedTool):
            self._change = (move.acceleration * TICK, move.turning_acceleration * TICK)
            self._left = move.time if move.time > 0.0 else math.inf
        else:
            self._change = (move.acceleration * TICK, move.acceleration * TICK / LEVER)
        return self

    def _wanted(self) -> Array:
        v, w = self._course()
        follow = _towards if isinstance(self._move, SpeedTool) else _steered
        self._v, near = follow(self._v, self._share * v, self._change[0])
        self._w, upright = _towards(self._w, self._share * w, self._change[1])
        self.done = self.done or (near and upright)
        self._look()
        return self._line.speeds(self._q, self._v, self._w)

    def _course(self) -> tuple[Array, Array]:
        """Speed of the tool centre point and about it, that are wanted, in B (3,), (3,)."""
        move = self._move
        if isinstance(move, SpeedTool):
            return np.array(move.speed), np.array(move.turning)
        p, R = self._line.pose(self._q)
        way = np.array(move.position) - p
        turn = R @ rotation_vector(R.T @ matrix_from_quaternion(move.quaternion) @ self._R_FT.T)
        left = max(float(np.linalg.norm(way)), LEVER * float(np.linalg.norm(turn)))
        if left < 1e-9:
            return way, turn
        # The tool comes there on a circle that its way touches: the smaller that is, the slower it goes.
        sine = float(np.linalg.norm(np.cross(self._v, way))) / max(float(np.linalg.norm(self._v) * np.linalg.norm(way)), 1e-12)
        round_it = math.sqrt(0.5 * move.acceleration * left / max(sine, 1e-9))
        pace = min(move.speed, round_it, math.sqrt(2.0 * BRAKING_SHARE * move.acceleration * left), left / (2.0 * TICK)) / left
        return pace * way, pace * turn

    def _braked(self) -> Array:
        qd = super()._braked()
        self._v, self._w = self._line.twist(self._q, qd)
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
