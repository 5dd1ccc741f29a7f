"""Constants of the joints as the controller has them, and what the ripple of the output encoders makes of them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class JointConstants:
    """Factors of n joints: the constant that the controller has, over that of the arm."""

    motor_constant: Array  # (n,)
    stiffness: Array  # (n,)
    rotor_inertia: Array  # (n,)


def ripple_torque(arm: Arm) -> Array:
    """What the ripple of each joint's output encoder makes of a torque that comes from the deflection (n,), at most [N·m]."""
    springs = arm.transmissions
    return arm.sensors.encoders.ripple * (np.array(springs.stiffness) + np.array(springs.hysteresis_stiffness))
