"""What an arm that turns its wrist by itself may have met, while nobody knows what it carries."""

import math
from collections.abc import Sequence

import numpy as np

from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.pose import ORIGIN, Vector
from pendant.tooling.wrist_room import WRIST

SLOW_TOOL, SLOW_ELBOW, SLOW_JOINT = 0.25, 0.25, 0.5
"""Of tool and elbow while the wizard moves the arm: reduced speed of manual control (ISO 10218-1:2011, 5.7.3) [m/s]. Of joints: a
quarter turn in three seconds [rad/s]."""

PUSHED = 25.0
"""Change of the user's force since the wizard began that stops it [N]. The weight of a load that nobody entered stays the same in
B; a sensor whose zero is off by 5 N on each axis changes by 17 N when the wrist is turned over."""

STRUCK = 10.0
"""Change within about `LATELY` that stops it [N]: by 2 N such a zero changes in it at `SLOW_JOINT`; speeding up a load of 10 kg
takes 5 N. Bench `wizard` guards it."""

JOLTED = 10.0
"""Change of a wrist joint's external torque within about `LATELY` that stops it [N·m]: what meets a link before the sensor.

A load of 10 kg that nobody entered made 4 N·m at most. Joints that stand do not count: friction at rest hides their torque.
Bench `wizard` guards it.
"""

LATELY = ticks(0.5)
"""Time constant with which the force is followed."""


class TurnWatch:
    """Follows the force at the flange, and the torques of the joints, from the beginning on."""

    __slots__ = ("_begun", "_lately", "_torques")

    def __init__(self) -> None:
        self._begun: Vector = ORIGIN  # of the user, when the wizard began, axes of B [N]
        self._lately: Vector = ORIGIN
        self._torques = np.zeros(0)

    def begin(self, estimate: Estimate, force: Sequence[float]) -> None:
        """The wizard begins, in a tick in which the mean `force` of the user is felt, axes of B [N]."""
        x, y, z = force
        self._torques = estimate.tau_ext[-WRIST:].copy()
        self._begun = self._lately = (x, y, z)

    def step(self, estimate: Estimate, force: Sequence[float]) -> str:
        """One tick of an arm that turns, or stands between two turns. Returns what speaks against going on, or "".

        Args:
            estimate: of this tick.
            force: mean of the user's, axes of B [N].
        """
        x, y, z = (before + (now - before) / LATELY for before, now in zip(self._lately, force, strict=True))
        self._lately = (x, y, z)
        for before, most in ((self._begun, PUSHED), (self._lately, STRUCK)):
            change = math.dist(before, force)
            if not change <= most:
                return f"the force changed by {change:.0f} N, at most {most:g} N: hands off the arm, and room for its wrist"
        torques = estimate.tau_ext[-WRIST:]
        self._torques += (torques - self._torques) / LATELY
        jolt = float(np.abs(torques - self._torques).max())
        if not jolt <= JOLTED:
            return f"a joint felt {jolt:.0f} N·m, at most {JOLTED:g} N·m: hands off the arm, and room for its wrist"
        fastest = max(map(abs, estimate.qd.tolist()))
        if not (estimate.v_tcp <= SLOW_TOOL and estimate.v_elbow <= SLOW_ELBOW and fastest <= SLOW_JOINT):
            return "faster than the wizard may move the arm"
        return ""
