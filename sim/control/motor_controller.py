"""Motor controller: a wanted motor torque becomes a current within the limits of current, torque and speed (AF-6)."""

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.compiled.kernel import kernel
from sim.compiled.record import record

Array = NDArray[np.float64]

OVERSPEED = 0.05
"""Above its speed limit a motor is driven no further; the torque ends linearly over this share of the limit."""


class MotorController:
    """Currents of n motors.

    Attributes:
        command: motor torque that the last current gives, as believed (n,) [N·m].
        excess: what was asked beyond the last command (n,) [N·m], 0 where nothing was cut: it lets nothing wind up behind it.
    """

    def __init__(self, arm: Arm, constants: JointConstants) -> None:
        motors = arm.motors
        per_torque = 1.0 / (np.array(motors.torque_per_current) * constants.motor_constant)
        # The output's torque limit, with room for the friction that the motor has to overcome as well.
        friction = np.array([row[-1] for row in arm.frictions.torque])
        largest = np.minimum(np.array(motors.current) / per_torque, np.array(arm.limits.torque) + friction)
        n = arm.n
        self._record = record(per_torque=(n,), largest=(n,), fastest=(n,), command=(n,), excess=(n,), current=(n,))
        own = self._record[0]
        own["per_torque"], own["largest"], own["fastest"] = per_torque, largest, arm.limits.speed
        self.command, self.excess, self._current = own["command"], own["excess"], own["current"]

    def current(self, torque: Array, speed: Array) -> Array:
        """Motor currents (n,) [A] for a wanted motor torque (n,) [N·m] at motor speeds (n,) [rad/s]; good until the next call."""
        _limit(self._record, torque, speed)
        return self._current


@kernel
def _limit(motors, torque, speed) -> None:
    own = motors[0]
    for i in range(torque.size):
        largest, fastest = own.largest[i], own.fastest[i]
        low, high = -largest, largest
        room = (fastest - abs(speed[i])) / (OVERSPEED * fastest) + 1.0
        if room < 1.0:  # too fast: what drives on fades out, what brakes stays whole
            fade = max(room, 0.0)
            if speed[i] > 0.0:
                high *= fade
            else:
                low *= fade
        value = min(max(torque[i], low), high)
        own.excess[i] = torque[i] - value
        own.command[i] = value
        own.current[i] = value * own.per_torque[i]
