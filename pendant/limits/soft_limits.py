"""Soft limits on speed in free-drive: where motion is resisted before a hard limit ends it, and when it falls (FD-12b)."""

import math
from typing import NamedTuple

from pendant.all_settings import Settings
from pendant.limits.dynamic_limits import WHOLE, DynamicLimits, Shares, in_operation
from pendant.limits.settings import OperationLimits
from pendant.tick.estimate import Estimate

CRAWL = 0.1
"""Share of the speed limits that is left at the end of the way from entry: nobody is held there."""


class Damping(NamedTuple):
    """Where the control law resists motion: not at all below `onset` of a limit, with the whole force or torque at it."""

    tcp: float  # limit now [m/s]
    elbow: float  # limit now [m/s]
    joint: float  # limit now [rad/s]
    onset: float  # share of each limit
    force: float  # at a limit of tcp or elbow [N]
    torque: float  # at the limit of a joint, of its rated torque


class SoftLimits:
    """The limits of one free-drive. They fall with load, acceleration, hand and direction, and on a long way.

    Attributes:
        damping: for the control law, None while soft limits are switched off.
        shares: of the hard limits that are left.
        pushed: the hand's force and torque are looked at.
    """

    __slots__ = (
        "_dynamic",
        "_hard",
        "_last",
        "_origin",
        "_plain",
        "_shares",
        "_soft",
        "_way",
        "damping",
        "pushed",
        "shares",
    )

    def __init__(self, settings: Settings, estimate: Estimate) -> None:
        """
        Args:
            settings: as they are now.
            estimate: of the tick of entry; its joint values are finite.
        """
        self._soft = settings.soft
        self._hard = hard(settings.limits.operation)
        way = settings.limits.operation.flange_displacement
        self._way = way.max if way.on else None  # of the flange from entry [m]; None: without a limit
        self._origin = tuple(estimate.p_BF.tolist())
        self._dynamic = DynamicLimits(in_operation(settings), estimate)
        self._plain = not way.on and self._dynamic.shares.isotropic  # the same all over and in every direction
        self._last: Shares | None = None  # of the tick before
        self._shares: tuple[float, float, float] | None = None  # of tcp, elbow and joints, to which `damping` belongs
        self.damping: Damping | None = None
        self.shares = WHOLE
        self.pushed = self._dynamic.pushed

    def step(self, estimate: Estimate, force: float = 0.0, torque: float = 0.0) -> None:
        """One tick; its joint values are finite.

        Args:
            estimate: of this tick.
            force: the hand's [N]; matters only where it is `pushed`.
            torque: the hand's [N·m].
        """
        shares = self._dynamic.step(estimate, force, torque)
        if self._soft.hard:
            self.shares = shares
        if self._soft.on and not (self._plain and shares is self._last):
            self._last = shares
            tcp = elbow = shares.speed
            joint = shares.turning
            if not shares.isotropic:
                tcp *= shares.along(*estimate.tcp.tolist()[3:])
                elbow *= shares.along(*estimate.elbow.tolist()[3:])
            if self._way is not None:
                rest = self._rest(estimate, shares, self._way)
                tcp, elbow, joint = rest * tcp, rest * elbow, rest * joint
            self._set((tcp, elbow, joint))

    def _rest(self, estimate: Estimate, shares: Shares, way: float) -> float:
        """Share of the speed limits that is left so far on the `way` out [m]; the way back is free."""
        (x, y, z), (x0, y0, z0) = estimate.p_BF.tolist(), self._origin
        x, y, z = x - x0, y - y0, z - z0
        vx, vy, vz = estimate.v_F.tolist()[:3]
        if x * vx + y * vy + z * vz <= 0.0:
            return 1.0
        gone = math.sqrt(x * x + y * y + z * z) / (way * shares.way * shares.along(x, y, z))
        return min(max((1.0 - gone) / (1.0 - self._soft.onset), CRAWL), 1.0)

    def _set(self, shares: tuple[float, float, float]) -> None:
        """`damping` stays the same object as long as the shares are the same."""
        if shares != self._shares:
            soft, (tcp, elbow, joint) = self._soft, self._hard
            self._shares = shares
            self.damping = Damping(shares[0] * tcp, shares[1] * elbow, shares[2] * joint, soft.onset, soft.force, soft.torque)


def hard(limits: OperationLimits) -> tuple[float, float, float]:
    """Speed limits of tcp [m/s], elbow [m/s] and joints [rad/s]; infinite where a limit is switched off."""
    tcp, elbow, joint = limits.tcp_speed, limits.elbow_speed, limits.joint_speed
    return (
        tcp.max if tcp.on else math.inf,
        elbow.max if elbow.on else math.inf,
        joint.max if joint.on else math.inf,
    )
