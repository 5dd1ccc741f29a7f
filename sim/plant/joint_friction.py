"""True joint friction: a curve through the measured points, with load, temperature and wear. Known to the plant alone."""

import numba
import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm

Array = NDArray[np.float64]


class Friction:
    """Friction torque of each joint's input side [N·m] at a speed, load and temperature (AF-1).

    The whole measured curve is split: a share on the output side (bearings, seals) is a constant plus a viscous part, the
    rest is on the input side and carries every dependence. Through the m measured points goes a polynomial of degree m-1 in
    the root of the speed, for the curves measured on a UR5e are concave like a root (the arm's file names their source).
    """

    def __init__(self, arm: Arm) -> None:
        frictions = arm.frictions
        speed = np.array(frictions.speed)
        total = np.array(frictions.torque)
        slope, start = np.polyfit(speed, total.T, 1)
        self.output_coulomb: Array = frictions.output_share * start  # (n,) [N·m]
        self.output_viscous: Array = frictions.output_share * slope  # (n,) [N·m·s/rad]
        inner = total - self.output_coulomb[:, None] - self.output_viscous[:, None] * speed
        root = np.sqrt(speed)
        coefficients = np.linalg.solve(np.vander(root), inner.T)  # highest power first, (m, n)
        self.breakaway: Array = np.array(frictions.breakaway) - self.output_coulomb  # (n,) of the input side at rest [N·m]
        self.load = np.array(frictions.load)  # rise with |tau_J| (n,) [N·m per N·m]
        self.factor = np.ones(arm.n)
        """Wear or grease: a factor a joint, 1 when new."""
        shape = np.array([root[0], root[-1], frictions.temperature, frictions.per_kelvin])
        self.per_kelvin = shape[3:]  # relative change a kelvin at the reference temperature (1,)
        self.curves = (coefficients, self.breakaway, self.load, self.factor, shape)
        """What `input_side` wants of this arm."""


@numba.njit(cache=True)
def input_side(speed, tau_J, temperature, coefficients, breakaway, load, factor, shape, out) -> None:
    """Put the friction torque (n,) [N·m], never negative, into `out`.

    Below the slowest measured speed the curve goes straight (in the root of the speed) to the breakaway torque; above
    the fastest it stays level.

    Args:
        speed: of the motors (n,) [rad/s].
        tau_J: transmission torque (n,) [N·m].
        temperature: of the joints (n,) [°C].
        coefficients, breakaway, load, factor, shape: `Friction.curves`.
        out: (n,).
    """
    low, high, reference, per_kelvin = shape
    for i in range(out.size):
        root = np.sqrt(abs(speed[i]))
        inside = min(max(root, low), high)
        curve = coefficients[0, i]
        for k in range(1, coefficients.shape[0]):
            curve = curve * inside + coefficients[k, i]
        curve = breakaway[i] + min(root / low, 1.0) * (curve - breakaway[i])
        heat = max(1.0 + per_kelvin * (temperature[i] - reference), 0.2)
        out[i] = (curve * heat + load[i] * abs(tau_J[i])) * factor[i]
