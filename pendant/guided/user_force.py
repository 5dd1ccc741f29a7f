"""The user's force on the arm in free-drive, separated from a wrong payload's and from a sensor's offset (FD-13, FD-19, VW-5).

What the sensor and the joints measured when free-drive began is no user force. Of the change since then, a steady part along
gravity may be a payload's; it stops counting as the user's with a time constant, as in `pendant.freedrive.manipulation`. A hand
on a link is felt by the joints alone: beside the sensor the estimator tells which of their torques are more than their errors.
"""

import math
from typing import NamedTuple

from pendant.limits.residual import upward
from pendant.sensor.hand_model import HALF, KEEPS, STEADY
from pendant.tick.estimate import Estimate, JointsFeel
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, dot, flat, norm, turned_back

SWING = 0.05
"""Time constant that takes the arm's own swinging off what the flange sensor feels [s]: a hand's push lasts longer."""

JOINTS_SWING = 2.0 * SWING
"""The same of what the joints feel, and of the force lately [s]: between them and the flange are the gears."""

_SLOW, _SLOWER, _SENSOR, _JOINTS = (1.0 - math.exp(-TICK / time) for time in (KEEPS, STEADY, SWING, JOINTS_SWING))


class Doubts(NamedTuple):
    """What there is to say how far off the force may be that the flange sensor tells."""

    change: Vector  # all that it feels beyond what it felt at entry, axes of B [N]
    fluctuation: float  # mean square of what it felt lately beside its mean, all axes together [N²]
    slack: float  # what it may tell without a hand [N]
    hung: Vector  # upward at entry, axes of F


class TakenForce(NamedTuple):
    """What free-drive takes for the user's force."""

    force: Vector  # axes of B [N]
    doubts: Doubts | None  # None: the joints tell it


class UserForce:
    """Follows the user's force from entry to leaving."""

    __slots__ = (
        "_baseline",
        "_by_joints",
        "_by_sensor",
        "_doubt",
        "_felt",
        "_payload",
        "_residual",
        "_slow",
        "_slow_joints",
        "_up",
        "by_joints",
        "change",
        "fluctuation",
        "payload",
        "user",
        "usual",
    )

    def __init__(self, estimate: Estimate, baseline: tuple[float, ...], offset: float) -> None:
        """
        Args:
            estimate: of the tick of entry; its joint values are finite.
            baseline: mean of F_user before it, axes of B [N, N·m]; zeros without a sensor.
            offset: of the flange sensor at most [N]; what is beyond along gravity is a payload's, which does not turn with it.
        """
        self._up = upward(estimate.g_B.tolist())
        force: Vector = (baseline[0], baseline[1], baseline[2])
        self._residual = dot(force, self._up)
        self._payload = self._residual - min(max(self._residual, -offset), offset)
        self._doubt = HALF * abs(self._payload)  # a smaller change may be its inertia
        beside = _less(force, self._payload, self._up)
        self._baseline = turned_back(flat(estimate.R_BF), beside)  # an offset of the sensor turns with the flange
        self._felt: Vector = _triple(estimate.F_joints.tolist())
        self._slow = self._slow_joints = 0.0  # changes along gravity, smoothed [N]
        self._by_sensor: Vector = ORIGIN
        self._by_joints: Vector = ORIGIN
        self.by_joints = False  # they tell some of the user's force
        self.user: Vector = ORIGIN  # the user's force, axes of B [N]
        self.change: Vector = ORIGIN  # of what the sensor feels, as measured, axes of B [N]
        self.usual: Vector = ORIGIN  # of that the mean lately [N]
        self.fluctuation = 0.0  # mean square of what it lately was off that, all axes together [N²]
        self.payload: Vector = ORIGIN  # of the payload-like residual, axes of B [N]

    @property
    def sensed(self) -> float:
        """Size of the user's force as the flange sensor alone tells it [N]; 0 where it has not been used."""
        return norm(self._by_sensor)

    def surely(self, least: float) -> bool:
        """The flange sensor and the joints tell at least so much [N], whatever of what was steady along gravity is a payload's.

        That may have been a hand's as well: once it has gone, what was subtracted for it seems to pull the other way.
        """
        x, y, z = self.user
        ux, uy, uz = self._up
        given = min(max(-(x * ux + y * uy + z * uz), min(self._slow, 0.0)), max(self._slow, 0.0))
        x, y, z = x + given * ux, y + given * uy, z + given * uz
        return x * x + y * y + z * z >= least * least

    def shift(self, force: Vector) -> None:
        """The sensor's bias has changed by `force`, axes of F [N], which is no user force."""
        x, y, z = force
        ox, oy, oz = self._baseline
        self._baseline = (ox + x, oy + y, oz + z)

    def taken(self, slack: float, hung: Vector, *, use_wrench: bool) -> TakenForce:
        """What is told of this tick; where the flange sensor is used, the joints may still tell more.

        Args:
            slack: what it may tell without a hand [N].
            hung: upward at entry, axes of F.
            use_wrench: it is used.
        """
        doubts = None if self.by_joints or not use_wrench else Doubts(self.change, self.fluctuation, slack, hung)
        return TakenForce(self.user, doubts)

    def step(self, estimate: Estimate, use_wrench: bool, moves: float) -> None:
        """One tick; its joint values are finite. Without a valid sensor the joints alone tell.

        The flange moves from this speed on [m/s].
        """
        ux, uy, uz = self._up
        x, y, z, _, _, _ = estimate.v_F.tolist()
        settle = _SLOWER if x * x + y * y + z * z > moves * moves else _SLOW
        x, y, z = estimate.F_joints.tolist()
        x0, y0, z0 = self._felt
        x, y, z = x - x0, y - y0, z - z0
        self._slow_joints = residual = self._slow_joints + settle * (x * ux + y * uy + z * uz - self._slow_joints)
        bx, by, bz = self._by_joints
        bx += _JOINTS * (x - residual * ux - bx)
        by += _JOINTS * (y - residual * uy - by)
        bz += _JOINTS * (z - residual * uz - bz)
        self._by_joints = (bx, by, bz)
        user = self._by_joints if estimate.whose.joints_feel is _HAND else ORIGIN
        self.by_joints = user is not ORIGIN
        if use_wrench:
            (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = estimate.R_BF.tolist()
            (ox, oy, oz), payload = self._baseline, self._payload
            x, y, z, _, _, _ = estimate.F_user.tolist()
            x -= payload * ux + xx * ox + xy * oy + xz * oz
            y -= payload * uy + yx * ox + yy * oy + yz * oz
            z -= payload * uz + zx * ox + zy * oy + zz * oz
            self.change = (x, y, z)
            bx, by, bz = self.usual
            bx, by, bz = x - bx, y - by, z - bz
            self.fluctuation += _JOINTS * (bx * bx + by * by + bz * bz - self.fluctuation)
            self.usual = (x - (1.0 - _JOINTS) * bx, y - (1.0 - _JOINTS) * by, z - (1.0 - _JOINTS) * bz)
            self._slow = slow = self._slow + settle * (x * ux + y * uy + z * uz - self._slow)
            residual = self._residual + slow
            sx, sy, sz = self._by_sensor
            sx += _SENSOR * (x - slow * ux - sx)
            sy += _SENSOR * (y - slow * uy - sy)
            sz += _SENSOR * (z - slow * uz - sz)
            self._by_sensor = (sx, sy, sz)
            x, y, z = estimate.whose.F_link.tolist()
            self.by_joints = (x, y, z) != ORIGIN
            user = (sx + x, sy + y, sz + z)
        self.user = user if norm(user) >= self._doubt else ORIGIN
        self.payload = (residual * ux, residual * uy, residual * uz)


def upward_in_flange(estimate: Estimate) -> Vector:
    """Upward, in axes of F."""
    return turned_back(flat(estimate.R_BF), upward(estimate.g_B.tolist()))


def _triple(values: list[float]) -> Vector:
    x, y, z = values
    return x, y, z


def _less(a: Vector, along: float, up: Vector) -> Vector:
    """`a` without `along` in the direction `up`."""
    return a[0] - along * up[0], a[1] - along * up[1], a[2] - along * up[2]


_HAND = JointsFeel.HAND  # looked up in every tick
