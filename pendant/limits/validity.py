"""What the supervisor keeps of the estimates: validity, standing still, the mean of the user's wrench."""

import math

import numpy as np

from pendant.events.event import Values
from pendant.limits.parameters import ZEROS
from pendant.limits.settings import Static
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.pose import Wrench, flat, turned_back

WINDOW = ticks(0.1)
"""Ticks over which F_user is averaged before free-drive begins."""

JOINTS_SENSED = "joint encoders and motor currents"

_SHARES = tuple(np.full(count, 1.0 / count) for count in range(1, WINDOW + 1))  # of each tick in the mean of so many


def joints_ok(estimate: Estimate) -> bool:
    """Joint values are valid, and finite as well: validity is not taken on trust (FD-12)."""
    return estimate.joints_valid and _finite(estimate)


def motion_ok(estimate: Estimate) -> bool:
    """Enough of the joint sensors is left to go on with a motion that has begun: all of them, or every motor angle."""
    return (estimate.joints_valid or estimate.degraded) and _finite(estimate)


def _finite(estimate: Estimate) -> bool:
    angles = *estimate.q.tolist(), *estimate.theta.tolist()
    speeds = *estimate.qd.tolist(), *estimate.theta_d.tolist(), *estimate.v_F.tolist()
    return math.isfinite(sum([*angles, *speeds, *estimate.tau_ext.tolist(), *estimate.tau_J.tolist()]))


def wrench_ok(estimate: Estimate) -> bool:
    """The user's wrench is valid and finite."""
    return estimate.wrench_valid and math.isfinite(sum(estimate.F_user.tolist()))


class Stillness:
    """Counts for how long the arm has been static."""

    __slots__ = ("count", "joint", "speed")

    def __init__(self) -> None:
        self.count = 0  # ticks in a row with every joint slower than the limit
        self.joint = 0  # the joint last seen too fast
        self.speed = 0.0  # its |speed| then [rad/s]

    def step(self, estimate: Estimate, limit: float) -> None:
        """One tick; `limit` [rad/s]."""
        if not (estimate.joints_valid or estimate.degraded):
            self.count = 0
            return
        speeds = estimate.qd.tolist()
        if sum(map(abs, speeds)) < limit:  # in one go, as an arm at rest mostly is
            self.count += 1
            return
        for joint, value in enumerate(speeds):
            if not -limit < value < limit:
                self.count = 0
                if math.isfinite(value):
                    self.joint = joint
                    self.speed = abs(value)
                return
        self.count += 1

    def moves(self, joints: tuple[str, ...], static: Static) -> Values:
        """Values of an event that says that the arm moves; `joints` are their names."""
        return {"joint": joints[self.joint], "value": self.speed, "limit": static.speed, "time": static.time}


class WrenchMean:
    """Mean of F_user over the last WINDOW ticks; begins afresh after the sensor was not valid."""

    __slots__ = ("_next", "_ring", "count")

    def __init__(self) -> None:
        self._ring = np.zeros((WINDOW, 6))
        self._next = 0
        self.count = 0  # ticks in the window

    def step(self, estimate: Estimate) -> bool:
        """One tick. Returns whether the wrench is valid in it."""
        if not wrench_ok(estimate):
            self.count = 0
            self._next = 0
            return False
        self._ring[self._next] = estimate.F_user
        self._next = (self._next + 1) % WINDOW
        if self.count < WINDOW:
            self.count += 1
        return True

    def mean(self) -> tuple[float, ...]:
        """The mean [N, N·m]; zeros without a valid value."""
        if self.count == 0:
            return ZEROS
        ring = self._ring if self.count == WINDOW else self._ring[: self.count]
        return tuple(_SHARES[self.count - 1].dot(ring).tolist())

    def shift(self, gone: Wrench) -> None:
        """F_user is less by so much from the next tick on, axes of B [N, N·m]: the sensor was zeroed on an arm that stands."""
        self._ring -= gone


def in_flange(estimate: Estimate, wrench: Wrench) -> Wrench:
    """A wrench in axes of B, in those of the flange now."""
    x, y, z, a, b, c = wrench
    R_BF = flat(estimate.R_BF)
    return (*turned_back(R_BF, (x, y, z)), *turned_back(R_BF, (a, b, c)))
