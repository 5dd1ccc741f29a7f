"""The reference of an arm that pushes along some axes of a frame, and goes along the others as it should (force_mode)."""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import SIX_WAYS, ForceMode
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.frames import cross, rotation_vector
from sim.motion.moves import Reference
from sim.motion.pace import Pace
from sim.motion.streams import LineStream
from sim.paths.curves import LEVER
from sim.paths.tool_point import ToolPoint

Array = NDArray[np.float64]

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
        limits: the joints' speed, acceleration and position (±), each (n,).
        pace: knows the speeds of tool and elbow.

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(self, now: Reference, tool: ToolPoint, limits: tuple[Array, Array, Array], pace: Pace) -> None:
        super().__init__(now, tool, limits, pace)
        self._axes = _untouched()
        self._under = now
        self._U = np.eye(3)  # the frame, in B
        self._mode: ForceMode | None = None

    def feel(self, estimate: Estimate, mode: ForceMode) -> None:
        """Take this tick's wrench and place in, and how it should push."""
        if mode is not self._mode:
            self._begin(mode)
        if not estimate.wrench_valid:
            self.problem = "force mode: needs the flange force sensor"
            return
        at, force = estimate.tcp[:3], -estimate.F_user[:3]  # of the arm on the outside
        torque = -estimate.F_user[3:] - cross(at - estimate.p_BF, force)
        self._turn(mode, estimate)
        felt = np.concatenate((self._U.T @ force, self._U.T @ torque))
        for axis, value in zip(self._axes, felt, strict=True):
            axis.feel(float(value))
        self._check(self._apart(at, estimate.R_BF, self._under.q), mode)

    def follow(self, motion: Reference) -> None:
        """What the arm would do without the force."""
        self._under = motion

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
