"""References beside those of a motion: of an arm that pushes along some axes (force_mode), and of one that goes at an offset."""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.motion.script_requests import SIX_WAYS, ForceMode, PathOffset
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.frames import cross, rotation_by, rotation_vector
from sim.motion.moves import Reference
from sim.motion.pace import Pace
from sim.motion.streams import LineStream
from sim.paths.curves import LEVER
from sim.paths.tool_point import ToolPoint

Array = NDArray[np.float64]
Limits = tuple[Array, Array, Array]

STILL = 5e-3
"""Slower the tool's way is lost in noise [m/s]; nearer to a point the way to it says nothing [m]."""

LINE_GAIN = 20.0
"""Pulls the reference back to the motion across the free axes [1/s]."""

DAMPING = 400.0
"""Force that is missing over the speed that it leads to where nothing is touched [N·s/m]."""

BANDWIDTH = 5.0
"""Of the force on what is touched [rad/s]: with more the joints' sticking makes a hard contact rattle."""

FILTER = 15.0
"""Of the force that is felt [Hz]."""

SPAN = 10
"""Ticks over which a stiffness is measured."""

LEAST_WAY = 1e-4
"""Added to the way over which it is: on less, the sensor's noise would pass for one [m]."""

OWN = 2e4
"""Stiffness of the arm itself: with whatever it touches in series there is no more [N/m]."""

USUAL_DAMPING = 0.025
"""With it a script's damping leads to the speed that the arm has without one: a UR's own (ROS driver, SetForceMode)."""

FORGETTING = 0.5
"""Time in which a stiffness that is felt no more fades [s]."""


class Admittance:
    """Along or about one axis: what is missing of a force becomes a speed of the reference (admittance control).

        v = (f_wanted - f_felt) / D        D = max(D_0, K / w)

    Whatever is touched has, with the arm's own give in series, a stiffness K = df/dx against the reference; so the force goes to
    what is wanted at the rate w, on what is hard and what is soft. K is measured all the time. In units of one axis: N, m or
    N·m, rad. Where a script sets a damping d, the speed has inertia: in a tick it loses the share d of itself, and gains d_0 v,
    so that without a force it is kept with 0 and gone at once with 1 (URScript manual, force_mode_set_damping).

    Args:
        lever: that makes an axis' way a tool's [m]; 1 along an axis.
    """

    __slots__ = ("_damping", "_felt", "_least", "_own", "_past", "_speed", "_stiffness", "_way")

    def __init__(self, lever: float) -> None:
        self._damping, self._own, self._least = DAMPING * lever**2, OWN * lever**2, LEAST_WAY / lever
        self._felt: float | None = None
        self._way = self._speed = self._stiffness = 0.0
        self._past: deque[tuple[float, float]] = deque(maxlen=SPAN)  # of force and way

    def feel(self, force: float) -> None:
        """Take this tick's force of the arm on the outside in."""
        if self._felt is None:
            self._felt = force
        self._felt += SMOOTHING * (force - self._felt)
        if len(self._past) == SPAN:
            before, there = self._past[0]
            stiffness = min(abs(self._felt - before) / (abs(self._way - there) + self._least), self._own)
            self._stiffness = max(stiffness, FADING * self._stiffness)
        self._past.append((self._felt, self._way))

    def speed(self, mode: ForceMode, k: int) -> float:
        """Of the reference in the next tick, along or about axis `k` of the mode's."""
        most = mode.limits[k]
        damping = max(self._damping, self._stiffness / BANDWIDTH)
        speed = mode.gain * (mode.wrench[k] - (self._felt or 0.0)) / damping
        if mode.damping is not None:
            speed = (1.0 - mode.damping) * self._speed + USUAL_DAMPING * speed
        self._speed = min(max(speed, -most), most)
        self._way += self._speed * TICK
        return self._speed


SMOOTHING = 1.0 - math.exp(-2.0 * math.pi * FILTER * TICK)
FADING = math.exp(-TICK / FORGETTING)


class Compliance(LineStream):
    """Along and about the free axes the reference goes where the force takes it; else it follows a motion.

    The motion's own way along a free axis does not count: there the force decides where the tool is.

    Args:
        now: where the reference is.
        tool: kinematics of the tool centre point.
        limits: the joints' speed and acceleration (n,), and their smallest and largest angles (2, n).
        pace: knows the speeds of tool and elbow.

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(self, now: Reference, tool: ToolPoint, limits: Limits, pace: Pace) -> None:
        super().__init__(now, tool, limits, pace)
        self._axes = _untouched()
        self._under = now
        self._U = np.eye(3)  # the frame, in B
        self._mode: ForceMode | None = None

    def serves(self, decision: Decision) -> bool:
        """Whether it is still wanted."""
        return decision.force is not None

    def take(self, motion: Reference, estimate: Estimate, decision: Decision) -> None:
        """Take in what the arm would do without the force, this tick's wrench and place, and how it should push."""
        self._under, mode = motion, decision.force
        assert mode is not None
        if mode is not self._mode:
            self._begin(mode)
        if not estimate.wrench_valid:
            self.problem = "force mode: needs the flange force sensor"
            return
        at, gone = estimate.tcp[:3], np.array(decision.reading_zero)
        force = estimate.R_BF @ gone[:3] - estimate.F_user[:3]  # of the arm on the outside
        torque = estimate.R_BF @ gone[3:] - estimate.F_user[3:] - cross(at - estimate.p_BF, force)
        self._turn(mode, estimate)
        felt = np.concatenate((self._U.T @ force, self._U.T @ torque))
        for axis, value in zip(self._axes, felt, strict=True):
            axis.feel(float(value))
        self._check(self._apart(at, estimate.R_BF, self._under.q), mode)

    def _begin(self, mode: ForceMode) -> None:
        if self._mode is None or mode.free != self._mode.free:
            self._axes = _untouched()
        if self._mode is None or mode.turns == "not":
            self._U = np.array(mode.R_BU).reshape(3, 3)
        self._mode = mode

    def _turn(self, mode: ForceMode, estimate: Estimate) -> None:
        """The frame turns with the tool's place or its way; where that says nothing, it stays as it is."""
        if mode.turns == "not":
            return
        U = np.array(mode.R_BU).reshape(3, 3)
        z = U[:, 2]
        if mode.turns == "to_origin":
            y = np.array(mode.origin) - estimate.tcp[:3]
            x = cross(y, z)
        else:
            x = estimate.tcp[3:] - z * float(z @ estimate.tcp[3:])
            y = cross(z, x)
        sizes = float(np.linalg.norm(x)), float(np.linalg.norm(y))
        if min(sizes) > STILL:
            x, y = x / sizes[0], y / sizes[1]
            self._U = np.column_stack((x, y, cross(x, y)))

    def _apart(self, p: Array, R: Array, q: Array) -> Array:
        """From the tool of a reference to a place: (6,) in axes of B [m, rad]."""
        at, turned = self._tool.pose(q)
        return np.concatenate((p - at, turned @ rotation_vector(turned.T @ R)))

    def _check(self, apart: Array, mode: ForceMode) -> None:
        """The tool keeps near its motion along and about the axes that are not free."""
        distance = np.concatenate((self._U.T @ apart[:3], self._U.T @ apart[3:]))
        for k, way in enumerate(SIX_WAYS):
            if not mode.free[k] and abs(distance[k]) > mode.limits[k]:
                size, unit = (1000.0, "mm") if k < 3 else (1.0, "rad")
                found, most = size * abs(distance[k]), size * mode.limits[k]
                self.problem = f"force mode: the tool is {found:.3g} {unit} from its way in {way}, allowed {most:.3g}"

    def _wanted(self) -> Array:
        mode, U = self._mode, self._U
        assert mode is not None
        self._look()
        at, turned = self._tool.pose(self._under.q)
        error = self._apart(at, turned, self._q)
        v, w = self._tool.twist(self._under.q, self._under.qd)
        twist = np.concatenate((U.T @ (v + LINE_GAIN * error[:3]), U.T @ (w + LINE_GAIN * error[3:])))
        for k, axis in enumerate(self._axes):
            if mode.free[k]:
                twist[k] = axis.speed(mode, k)
        return self._tool.speeds(self._q, U @ twist[:3], U @ twist[3:])


def _untouched() -> list[Admittance]:
    """Of six axes that feel nothing yet."""
    return [Admittance(1.0 if k < 3 else LEVER) for k in range(len(SIX_WAYS))]


TRIES = 24
"""Even steps back from a place at an offset to the place of the motion, and as many of Newton's method."""


class Displaced(LineStream):
    """The tool is at an offset from where its motion has it; the joints go there as fast as they can.

    Args:
        now: where the reference is, at this `offset` already; tool, limits, pace: as of Compliance.
        R_FT: orientation of the tool in F (3, 3).

    Attributes:
        under: reference of the motion itself.
    """

    def __init__(self, now: Reference, tool: ToolPoint, limits: Limits, pace: Pace, *, R_FT: Array, offset: PathOffset) -> None:
        super().__init__(now, tool, limits, pace)
        self._R_FT = R_FT
        self._way = (tool.pose(now.q)[1] @ R_FT)[:, 0]  # along it, in B; before the motion has one, the tool's x
        self._offset, self.under, self._goal = offset, now, tool.pose(now.q)
        if any(offset.position) or any(offset.turn):
            self.under = Reference(self._back(), *np.zeros((2, now.q.size)))

    def serves(self, decision: Decision) -> bool:
        """Whether it is still wanted."""
        return decision.offset is not None

    def take(self, motion: Reference, estimate: Estimate, decision: Decision) -> None:
        """Take in what the arm would do on the motion's own way, and the offset."""
        assert decision.offset is not None
        self.under, self._offset = motion, decision.offset

    def _frame(self, at: Array, R: Array) -> tuple[Array, Array]:
        """Origin (3,) and axes (3, 3) of the offset's frame in B, for a motion's tool centre point and orientation of F."""
        kind = self._offset.frame
        if kind == "base":
            return np.zeros(3), np.eye(3)
        axes = R @ self._R_FT
        if kind == "way":
            across = cross(self._way, axes[:, 2])
            size = float(np.linalg.norm(across))
            y = across / size if size > STILL else axes[:, 1]
            axes = np.column_stack((self._way, y, cross(self._way, y)))
        return at, axes

    def _back(self) -> Array:
        """Joint angles (n,) of the motion whose tool, at the offset, is where it is now [rad]."""
        tool, position, turn = self._tool, np.array(self._offset.position), rotation_by(np.array(self._offset.turn))
        start, R = tool.pose(self._q)
        if self._offset.frame == "base":
            R_B, p = turn, turn.T @ (start - position)
        else:  # the frame goes with the tool: back in its axes, which the offset has turned
            _, axes = self._frame(start, R)
            R_B = axes @ turn @ axes.T
            p = start - R_B.T @ axes @ position
        goal, q = R_B.T @ R if self._offset.turns_tool else R, self._q.copy()
        for k in range(2 * TRIES):
            at, now = tool.pose(q)
            share = 1.0 / max(TRIES - k, 1)  # of what is left: even steps, then Newton's
            q = q + share * tool.speeds(q, p - at, now @ rotation_vector(now.T @ goal))
        return q

    def _wanted(self) -> Array:
        self._look()
        tool, under = self._tool, self.under
        at, R = tool.pose(under.q)
        if self._offset.frame == "way":
            v, _ = tool.twist(under.q, under.qd)
            speed = float(np.linalg.norm(v))
            self._way = v / speed if speed > STILL else self._way
        origin, axes = self._frame(at, R)
        turn = axes @ rotation_by(np.array(self._offset.turn)) @ axes.T
        goal = origin + turn @ (at - origin) + axes @ np.array(self._offset.position)
        R_goal = turn @ R if self._offset.turns_tool else R
        (before, R_before), self._goal = self._goal, (goal, R_goal)
        p, R_now = tool.pose(self._q)
        v = (goal - before) / TICK + LINE_GAIN * (before - p)
        w = rotation_vector(R_goal @ R_before.T) / TICK + LINE_GAIN * (R_now @ rotation_vector(R_now.T @ R_before))
        return tool.speeds(self._q, v, w)
