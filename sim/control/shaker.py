"""Shakes the last joint in free-drive: there is no reference there that a haptic pattern could be a part of (HF-1)."""

import math

from pendant.haptics import Shake
from pendant.tick.estimate import Estimate

BANDWIDTH = 16.0  # round the rotor alone [Hz]
DAMPING_RATIO = 0.7
INERTIA = 1.3  # of the rotor: with what usually turns beyond the gear
STICKING = 0.6e-3  # error at which friction is compensated in full [rad]
SLIDING = 0.05  # and speed [rad/s]
MOST = 0.5  # of the rated torque
FURTHEST = 0.002  # a hand that turns the joint further takes the pattern along [rad]


class Shaker:
    """A spring and a damper to the pattern, about where the joint was when it began; a hand may take it along.

    Args:
        rotor: inertia of the joint's rotor, referred to the output [kg·m²].
        rated: torque of the joint [N·m].
    """

    def __init__(self, rotor: float, rated: float) -> None:
        omega = 2.0 * math.pi * BANDWIDTH
        self._inertia = INERTIA * rotor
        self._stiffness, self._damping = rotor * omega**2, 2.0 * DAMPING_RATIO * rotor * omega
        self._most = MOST * rated
        self._centre: float | None = None  # where the joint was, without the pattern [rad]

    def stop(self) -> None:
        """No pattern runs."""
        self._centre = None

    def torque(self, shake: Shake, estimate: Estimate, breakaway: float) -> float:
        """Torque on the last joint in addition to all else [N·m]; `breakaway` is its friction at rest [N·m]."""
        angle = float(estimate.theta[-1])
        centre = angle - shake.angle if self._centre is None else self._centre
        error = centre + shake.angle - angle
        within = min(max(error, -FURTHEST), FURTHEST)
        self._centre = centre - (error - within)
        way = math.tanh(within / STICKING + shake.speed / SLIDING)
        torque = self._stiffness * within + self._damping * (shake.speed - float(estimate.theta_d[-1]))
        torque += self._inertia * shake.acceleration + breakaway * way
        return min(max(torque, -self._most), self._most)
