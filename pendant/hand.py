"""The user's force on the arm in free-drive, told from a wrong payload's and from a sensor's offset (FD-13, FD-19, VW-5).

What the sensor and the joints felt when free-drive began is nobody's. Of what changed since, a part along gravity that stays may
be a payload's; it stops counting as the user's with a time constant, as in `pendant.maintain`.
"""

import math

from pendant.estimate import Estimate
from pendant.modes import TICK
from pendant.pose import ORIGIN, Vector, dot, flat, norm, turned, turned_back
from pendant.residual import upward

SETTLING = 1.5
"""Time constant with which a change along gravity becomes payload-like [s]: a sensor that drifts by 2 N/s stays below 3 N."""

SWING = 0.05
"""Time constant that takes the arm's own swinging off what the flange sensor feels [s]: a hand's push lasts longer."""

OFFSET = 4.0
"""Largest offset of the flange sensor [N]; what is beyond along gravity is a payload's, which does not turn with the flange."""

DOUBT = 0.5
"""Of the force of a payload that was wrong from the beginning: a smaller change may be its inertia, and is nobody's."""

JOINTS_SWING = 0.1
"""Time constant that takes an arm's own swinging off what the joints feel [s]."""

FELT_BY_JOINTS = 10.0
"""A force that the joints alone feel counts from here on [N]: friction and the model's errors are 3 to 6 N·m, at 0.5 m."""

_SLOW, _SENSOR, _JOINTS = (1.0 - math.exp(-TICK / time) for time in (SETTLING, SWING, JOINTS_SWING))


class Hand:
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
        "change",
        "payload",
        "user",
    )

    def __init__(self, estimate: Estimate, baseline: tuple[float, ...]) -> None:
        """
        Args:
            estimate: of the tick of entry; its joint values are finite.
            baseline: mean of F_user before it, axes of B [N, N·m]; zeros without a sensor.
        """
        self._up = upward(estimate.g_B.tolist())
        force: Vector = (baseline[0], baseline[1], baseline[2])
        self._residual = dot(force, self._up)
        self._payload = self._residual - min(max(self._residual, -OFFSET), OFFSET)
        self._doubt = DOUBT * abs(self._payload)
        offset = _less(force, self._payload, self._up)
        self._baseline = turned_back(flat(estimate.R_BF), offset)  # an offset of the sensor turns with the flange
        self._felt: Vector = _triple(estimate.F_joints.tolist())
        self._slow = self._slow_joints = 0.0  # changes along gravity, smoothed [N]
        self._by_sensor: Vector = ORIGIN
        self._by_joints: Vector = ORIGIN
        self.user: Vector = ORIGIN  # the user's force, axes of B [N]
        self.change: Vector = ORIGIN  # of what the sensor feels, as measured, axes of B [N]
        self.payload: Vector = ORIGIN  # of the payload-like residual, axes of B [N]

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return tuple([getattr(self, name) for name in self.__slots__])

    def step(self, estimate: Estimate, use_wrench: bool) -> None:
        """One tick; its joint values are finite. Without a valid sensor the joints alone tell."""
        up = self._up
        joints = _minus(_triple(estimate.F_joints.tolist()), self._felt)
        along = dot(joints, up)
        self._slow_joints += _SLOW * (along - self._slow_joints)
        self._by_joints = _nearer(self._by_joints, _less(joints, self._slow_joints, up), _JOINTS)
        residual = self._slow_joints
        user = self._by_joints if norm(self._by_joints) >= FELT_BY_JOINTS else ORIGIN
        if use_wrench:
            measured = _triple(estimate.F_user.tolist()[:3])
            change = _minus(_less(measured, self._payload, up), turned(flat(estimate.R_BF), self._baseline))
            self.change = change
            along = dot(change, up)
            self._slow += _SLOW * (along - self._slow)
            self._by_sensor = _nearer(self._by_sensor, _less(change, self._slow, up), _SENSOR)
            residual = self._residual + self._slow
            if user is ORIGIN or norm(self._by_sensor) >= FELT_BY_JOINTS:
                user = self._by_sensor
        self.user = user if norm(user) >= self._doubt else ORIGIN
        self.payload = (residual * up[0], residual * up[1], residual * up[2])


def _triple(values: list[float]) -> Vector:
    x, y, z = values
    return x, y, z


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _less(a: Vector, along: float, up: Vector) -> Vector:
    """`a` without `along` in the direction `up`."""
    return a[0] - along * up[0], a[1] - along * up[1], a[2] - along * up[2]


def _nearer(a: Vector, b: Vector, share: float) -> Vector:
    """From `a` a share of the way to `b`."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])
