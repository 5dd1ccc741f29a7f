"""Soft limits on speed in free-drive: where motion is resisted before a hard limit ends it, and when it falls (FD-12b)."""

import math
from typing import NamedTuple

from pendant.estimate import Estimate
from pendant.settings import OperationLimits, Settings, ticks

DRIFTING = 0.02
"""Speed of the flange from which on it has a direction [m/s]."""

ABOUT = math.cos(math.radians(45.0))
"""Cosine of the angle up to which a direction is about the same."""


class Damping(NamedTuple):
    """Where the control law resists motion: not at all below `onset` of a limit, with the whole force or torque at it."""

    tcp: float  # limit now [m/s]
    elbow: float  # limit now [m/s]
    joint: float  # limit now [rad/s]
    onset: float  # share of each limit
    force: float  # at a limit of tcp or elbow [N]
    torque: float  # at the limit of a joint, of its rated torque


class SoftLimits:
    """The limits of one free-drive. They fall with the configured payload, and for what moves on and on the same way.

    Attributes:
        damping: for the control law, None while soft limits are switched off.
        share: of the hard limits on speed that is left.
    """

    __slots__ = ("_after", "_damping", "_heading", "_operation", "_same", "_soft", "damping", "share")

    def __init__(self, settings: Settings) -> None:
        self._soft, self._operation = settings.soft, settings.limits.operation
        self._after = ticks(self._soft.drift_time)
        self._heading = (0.0, 0.0, 0.0)  # direction in which the motion began, axes of B
        self._same = 0  # ticks for which it has been about the same
        self._damping: dict[float, Damping] = {}  # by share
        self.damping: Damping | None = None
        self.share = 1.0

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._heading, self._same, self.damping, self.share)

    def step(self, estimate: Estimate) -> None:
        """One tick; its joint values are finite."""
        soft = self._soft
        share = 1.0
        if soft.payload:
            share /= 1.0 + soft.payload_share * estimate.load_mass
        if soft.drift and self._drifts(estimate):
            share *= soft.drift_share
        self.share = share if soft.hard else 1.0
        if soft.on:
            self.damping = self._at(share)

    def _drifts(self, estimate: Estimate) -> bool:
        """The flange has moved in about the same direction for long."""
        x, y, z = estimate.v_F.tolist()[:3]
        speed = math.sqrt(x * x + y * y + z * z)
        if speed < DRIFTING:
            self._same = 0
            return False
        hx, hy, hz = self._heading
        if self._same and x * hx + y * hy + z * hz >= ABOUT * speed:
            self._same += 1
        else:
            self._heading, self._same = (x / speed, y / speed, z / speed), 1
        return self._same > self._after

    def _at(self, share: float) -> Damping:
        """The same object for the same share: two or three of them are in use."""
        known = self._damping.get(share)
        if known is None:
            soft = self._soft
            tcp, elbow, joint = hard(self._operation)
            known = Damping(share * tcp, share * elbow, share * joint, soft.onset, soft.force, soft.torque)
            self._damping[share] = known
        return known


def hard(limits: OperationLimits) -> tuple[float, float, float]:
    """Speed limits of tcp [m/s], elbow [m/s] and joints [rad/s]; infinite where a limit is switched off."""
    tcp, elbow, joint = limits.tcp_speed, limits.elbow_speed, limits.joint_speed
    return (
        tcp.max if tcp.on else math.inf,
        elbow.max if elbow.on else math.inf,
        joint.max if joint.on else math.inf,
    )
