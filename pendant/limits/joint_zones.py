"""Zones before the joint limits: in free-drive a joint is damped, then held back by a spring, before its range ends (FD-4).

Motion out of a zone is free. A joint that starts in its stiff zone starts without any force, and what holds it there moves along
with it on its way out (`resistance.LimitGuard`), so that nothing kicks; the spring gives back what was put into it at most.
"""

import math
from collections.abc import Sequence
from operator import sub

import numpy as np

from pendant.limits.resistance import LimitGuard, closeness, resisting
from pendant.limits.settings import JointLimits
from pendant.tick.estimate import Estimate


class JointZones:
    """Resisting torques of all joints, from entry to leaving.

    Attributes:
        torque: on each joint in this tick [N·m]; empty where no joint is in a zone.
        pushing: a spring is bent, and may move its joint.
    """

    __slots__ = ("_begin", "_guards", "_half", "_inner", "_least", "_middle", "_rated", "_settings", "pushing", "torque")

    def __init__(self, rated: tuple[float, ...], ranges: Sequence[tuple[float, float]]) -> None:
        """
        Args:
            rated: torque of each joint [N·m].
            ranges: smallest and largest angle of each joint [rad]; a joint without end has both infinite.
        """
        self._rated = rated
        self._middle = np.array([0.5 * (low + high) if math.isfinite(high - low) else 0.0 for low, high in ranges])
        self._half = tuple([0.5 * (high - low) for low, high in ranges])  # from the middle to both ends [rad]
        self._settings: JointLimits | None = None  # while they hold
        self._inner: tuple[float, ...] = ()  # where each damping zone begins, from the middle [rad]
        self._least = 0.0  # where the first of them does
        self._begin: tuple[float, ...] = ()  # where each stiff zone begins, from the middle [rad]
        self._guards: list[LimitGuard | None] = []
        self.torque: tuple[float, ...] = ()
        self.pushing = False

    def enter(self, settings: JointLimits) -> None:
        """FREE_DRIVE begins."""
        self.leave()
        if not settings.on:
            return
        self._settings = settings
        self._begin = tuple([limit - settings.stiff_zone for limit in self._half])
        self._inner = tuple([begin - settings.damping_zone for begin in self._begin])
        self._least = min(self._inner)
        self._guards = [None] * len(self._half)

    def leave(self) -> None:
        """Nothing is resisted any more."""
        self._settings, self.torque, self.pushing = None, (), False

    def step(self, estimate: Estimate) -> None:
        """One tick; its joint values are finite."""
        settings = self._settings
        if settings is None:
            return
        angles = (estimate.theta - self._middle).tolist()
        near = max(angles) > self._least or min(angles) < -self._least  # seldom, so that the joints need not be looked at
        if not near or max(map(sub, map(abs, angles), self._inner)) <= 0.0:
            if self.torque:
                self._guards = [None] * len(angles)
                self.torque, self.pushing = (), False
            return
        self.pushing = False
        speeds = estimate.theta_d.tolist()
        torques = [0.0] * len(angles)
        for joint, angle in enumerate(angles):
            if abs(angle) > self._inner[joint]:
                torques[joint] = self._resist(joint, angle, speeds[joint], settings)
            else:
                self._guards[joint] = None
        self.torque = tuple(torques)

    def _resist(self, joint: int, angle: float, speed: float, settings: JointLimits) -> float:
        """Torque on one joint [N·m], at an angle from the middle of its range."""
        side, rated = math.copysign(1.0, angle), self._rated[joint]
        distance = abs(angle) - self._begin[joint]
        guard = self._guards[joint]
        if guard is None:
            guard = self._guards[joint] = LimitGuard(distance)
        damping = settings.damping * rated
        beyond = guard.step(distance, 0.0)
        if beyond > 0.0:
            self.pushing = True
            size = guard.resisting(beyond, side * speed, rated / settings.stiff_zone, damping)
        else:
            size = resisting(closeness(distance, settings.damping_zone), side * speed, damping)
        return -side * min(size, rated)
