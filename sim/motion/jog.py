"""The reference of a jogged arm: one joint, or the tool along or about one axis, at manual speed and no further than it can."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.program.jog_move import TURNS, JogMove, MoveStraight, MoveThere
from pendant.program.steps import Move
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import TICK
from sim.braking.workspace_keeper import WorkspaceKeeper
from sim.motion.moves import MoveRefused, Reference, beyond, turning_points
from sim.motion.pace import Pace
from sim.motion.tool_trajectory import SPACING, bend_of
from sim.paths.curves import LEVER, NO_WAY, Straight
from sim.paths.tool_point import Followed, ToolPoint, WalkedWay

Array = NDArray[np.float64]

MANUAL = 0.25
"""Of tool and elbow at most [m/s]: reduced speed of manual control (ISO 10218-1:2011, 5.7.3)."""

PLANNED_SHARE = 0.85
"""Of manual speed that a planned motion keeps below: what the measurement adds, and swinging, stays below it as well."""

LINE_ACCELERATION, TURN_SPEED, TURN_ACCELERATION = 0.5, 0.5, 1.0
"""Of the tool [m/s²], [rad/s], [rad/s²]."""

JOINT_SHARE = 0.25
"""Of a joint's speed and acceleration."""

LONGEST_WAY = 6.0
"""That is looked at beforehand: further than any arm reaches; for a turn, three times round [m]."""

BRAKES = 2.0
"""Times as hard as it speeds up, it may slow down."""

HALVINGS = 20
"""Of the step beyond the last place that can be gone to, to find that."""


def at_manual_speed(move: Move | None, limits: SpeedLimits | None) -> SpeedLimits | None:
    """The limits for a move: a button that is held allows manual speed at most, whatever the robot's limits are."""
    return _slower(limits, PLANNED_SHARE * MANUAL) if isinstance(move, MoveThere | MoveStraight) else limits


def _slower(limits: SpeedLimits | None, speed: float) -> SpeedLimits:
    """The limits, and a speed for tool and elbow [m/s]."""
    if limits is None:
        return SpeedLimits(speed, speed, ())
    return limits._replace(tcp=min(speed, limits.tcp), elbow=min(speed, limits.elbow))


class Places(NamedTuple):
    """Of a jogged way: how fast it may be gone there, and how hard the tool or the joint may be accelerated."""

    s: Array  # (k,) from 0 to the end [m or rad]
    square: Array  # (k,) of the speed
    acceleration: Array  # (k,)


class JogTrajectory:
    """Speeds up to manual speed, and slows down before its length, the end of a joint's range, and a singularity.

    Its way is looked through to the end at first. At each place the joints' speeds and accelerations allow a speed along it;
    backwards from the end, that is lowered to one from which what the next place allows can be come to.

    Args:
        q: where the reference is, at rest (n,) [rad].
        move: what is jogged.
        tool: kinematics of the tool centre point.
        R_FT: orientation of the tool in F (3, 3).
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        pace: knows the speeds of tool and elbow.

    Attributes:
        done: its length is reached.
        problem: why it cannot go on, or "".

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(
        self, q: Array, move: JogMove, tool: ToolPoint, *, R_FT: Array, limits: tuple[Array, Array, Array], pace: Pace
    ) -> None:
        self._tool, self._limits, self._pace = tool, limits, pace
        self._joints, self._s, self._rate, self._next = Followed.at(q.copy()), 0.0, 0.0, 1
        self._walk = WalkedWay([])
        self._why = ""  # it ends before its length
        self.done, self.problem = False, ""
        length = move.length if move.length > 0.0 else math.inf
        if move.frame == "joint":
            self._line = None
            self._most = JOINT_SHARE * float(limits[0][move.axis])
            self._joints.rate[move.axis] = move.sign
            last = float(limits[2][1 if move.sign > 0 else 0, move.axis])
            end = max(move.sign * (last - float(q[move.axis])), 0.0)
            if end < length:
                self._why = _ended(move.axis, last)
            pair = np.array([1.0, 1.0])
            acceleration = JOINT_SHARE * float(limits[1][move.axis])
            self._places = _slowing(Places(np.array([0.0, min(end, length)]), self._most**2 * pair, acceleration * pair))
            return
        if tool.singular(q):
            raise MoveRefused("jogging: singular here; jog a joint")
        p, R = tool.pose(q)
        axis = np.zeros(3)
        axis[move.axis % TURNS] = move.sign
        along = R @ R_FT @ axis if move.frame == "tool" else axis  # in B
        if move.axis < TURNS:
            self._line, self._most = Straight(p, R, along, np.zeros(3)), MANUAL
            self._places = self._looked(length, LINE_ACCELERATION)
        else:  # the way of a turn is that of a lever
            self._line, self._most = Straight(p, R, np.zeros(3), R.T @ along), LEVER * TURN_SPEED
            self._places = self._looked(LEVER * length, LEVER * TURN_ACCELERATION)

    def step(self, share: float = 1.0, limits: SpeedLimits | None = None, keeper: WorkspaceKeeper | None = None) -> Reference:
        """The reference of the next tick.

        Args:
            share: of manual speed.
            limits: of the robot.
            keeper: of the arm that it leads; None: it leads none.
        """
        joints, s, (places, square, acceleration) = self._joints, self._s, self._places
        while self._next < places.size - 1 and places[self._next] <= s:
            self._next += 1
        k, left = self._next, places[-1].item() - s
        span = (places[k] - places[k - 1]).item()
        beyond = (s - places[k - 1].item()) / span if span > 0.0 else 1.0
        allowed = math.sqrt(max((square[k - 1] + beyond * (square[k] - square[k - 1])).item(), 0.0))
        wanted = min(
            share * self._most, allowed, 1.0 / max(self._pace.meter.over(joints.q, joints.rate, _slower(limits, MANUAL)), 1e-9)
        )
        change = min(acceleration[k - 1].item(), acceleration[k].item()) * TICK
        rate = min(max(wanted, self._rate - BRAKES * change), self._rate + change, left / TICK)
        if keeper is not None:
            rate *= keeper.share(joints.q, rate * joints.rate)
        if left == 0.0:
            self.done, self.problem = not self._why, self._why
        step, changing = rate * TICK, (rate - self._rate) / TICK
        self._s, self._rate = (places[-1].item() if rate == left / TICK else s + step), rate
        if self._line is None:
            q = joints.q + step * joints.rate
            self._joints = joints._replace(q=np.minimum(np.maximum(q, self._limits[2][0]), self._limits[2][1]))
        else:
            self._joints = self._tool.go_on(self._line.record, self._s, joints, step, s=self._s, walk=self._walk)
        q, along, bend, _, _ = self._joints
        return Reference(q, rate * along, changing * along + rate * rate * bend)

    def _looked(self, length: float, acceleration: float) -> Places:
        """The places of a way of the tool of at most `length`, gone with at most `acceleration` [m/s²]."""
        end = min(length, LONGEST_WAY)
        self._why = "" if length <= LONGEST_WAY else f"{LONGEST_WAY:g} m are gone; press again"
        found, s, step = [(0.0, self._follow(0.0, self._joints, 0.0))], 0.0, 0.0
        while s < end:
            joints = found[-1][1]
            step = min(max(min(SPACING, bend_of(joints) / max(float(np.abs(joints.rate).max()), 1e-9)), NO_WAY), end - s)
            ahead = self._follow(s + step, joints, step)
            against, good, bad = self._against(ahead), 0.0, step
            way, turned = turning_points(joints, ahead, step)
            out = beyond(turned, self._limits[2])
            if not against and (out > 0.0).any():
                joint = int(np.argmax(out))
                against, bad = _ended(joint, float(turned[joint])), float(way[joint])
            if against:
                for _ in range(HALVINGS):
                    middle = 0.5 * (good + bad)
                    tried = self._follow(s + middle, joints, middle)
                    why = self._against(tried)
                    good, ahead = (good, ahead) if why else (middle, tried)
                    bad, against = (middle, why) if why else (bad, against)
                self._why = against
                if good > 0.0:
                    found.append((s + good, ahead))
                break
            s = end if step == end - s else s + step
            found.append((s, ahead))
        self._walk = WalkedWay(found)
        return _slowing(self._allowed(found if len(found) > 1 else 2 * found, acceleration))

    def _follow(self, s: float, before: Followed, step: float) -> Followed:
        assert self._line is not None
        return self._tool.follow(self._line.record, s, before, step)

    def _against(self, joints: Followed) -> str:
        """Why the way cannot be gone to there, or ""."""
        if joints.singular or not joints.reached:
            return "singular ahead; jog a joint, or back"
        out = beyond(joints.q, self._limits[2])
        joint = int(np.argmax(out))
        return _ended(joint, float(joints.q[joint])) if out[joint] > 0.0 else ""

    def _allowed(self, found: list[tuple[float, Followed]], acceleration: float) -> Places:
        """What the joints allow at each place. A quarter of their acceleration is for that along the way, or half in braking."""
        speed, most, _ = self._limits
        size = np.maximum([np.abs(joints.rate) for _, joints in found], 1e-9)
        bend = np.maximum([np.abs(joints.bend) for _, joints in found], 1e-9)
        along = np.minimum((0.5 / BRAKES * most / size).min(axis=1), acceleration)
        square = ((most - BRAKES * along[:, None] * size) / bend).min(axis=1)
        square = np.minimum(square, np.minimum((JOINT_SHARE * speed / size).min(axis=1), self._most) ** 2)
        return Places(np.array([s for s, _ in found]), square, along)


def _ended(joint: int, q: float) -> str:
    return f"joint {joint + 1} is at the end of its range, {q:.3f} rad"


def _slowing(places: Places) -> Places:
    """The places with speeds from which each can slow down to what the next one allows, and to none at the end."""
    square = places.square.copy()
    square[-1] = 0.0
    for k in range(square.size - 2, -1, -1):
        change = 2.0 * min(places.acceleration[k], places.acceleration[k + 1]) * (places.s[k + 1] - places.s[k])
        square[k] = min(square[k], square[k + 1] + change)
    return places._replace(square=square)
