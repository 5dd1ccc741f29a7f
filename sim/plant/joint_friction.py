"""True joint friction: a curve through the measured points, with load, temperature and wear. Known to the plant alone."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.compiled.record import record

Array = NDArray[np.float64]


class Sliding(NamedTuple):
    """What friction depends on, n joints."""

    speed: Array  # of the motors (n,) [rad/s]
    tau_J: Array  # transmission torque (n,) [N·m]
    temperature: Array  # (n,) [°C]


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
        n = arm.n
        self.record = record(
            output_coulomb=(n,),
            output_viscous=(n,),
            coefficients=(len(speed), n),  # highest power first
            breakaway=(n,),  # of the input side at rest
            load=(n,),  # rise with |tau_J|
            factor=(n,),
            slowest=(),  # root of the slowest measured speed
            fastest=(),
            temperature=(),  # of reference [°C]
            per_kelvin=(),  # relative change a kelvin
        )
        own = self.record[0]
        own["output_coulomb"], own["output_viscous"] = frictions.output_share * start, frictions.output_share * slope
        self.output_coulomb: Array = own["output_coulomb"]  # (n,) [N·m]
        self.output_viscous: Array = own["output_viscous"]  # (n,) [N·m·s/rad]
        inner = total - self.output_coulomb[:, None] - self.output_viscous[:, None] * speed
        root = np.sqrt(speed)
        own["coefficients"] = np.linalg.solve(np.vander(root), inner.T)
        own["breakaway"], own["load"] = np.array(frictions.breakaway) - self.output_coulomb, frictions.load
        self.breakaway: Array = own["breakaway"]  # (n,) of the input side at rest [N·m]
        self.load: Array = own["load"]  # rise with |tau_J| (n,) [N·m per N·m]
        self.per_kelvin: Array = self.record["per_kelvin"]  # relative change a kelvin at the reference temperature (1,)
        self.factor: Array = own["factor"]
        """Wear or grease, of both sides: a factor a joint, 1 when new. `wear` changes it."""
        self.factor[:] = 1.0
        self._new = self.output_coulomb.copy(), self.output_viscous.copy()
        own["slowest"], own["fastest"] = root[0], root[-1]
        own["temperature"], own["per_kelvin"] = frictions.temperature, frictions.per_kelvin

    def wear(self, joints: slice | int, factor: float) -> None:
        """The friction of some joints, on both sides, becomes `factor` times what it is when new."""
        self.factor[joints] = factor
        self.output_coulomb[:], self.output_viscous[:] = (new * self.factor for new in self._new)


@kernel
def input_side(friction, sliding, out) -> None:
    """Put the friction torque (n,) [N·m], never negative, into `out`.

    Below the slowest measured speed the curve goes straight (in the root of the speed) to the breakaway torque; above
    the fastest it stays level.

    Args:
        friction: `Friction.record`.
        sliding: what it depends on.
        out: (n,).
    """
    own = friction[0]
    speed, tau_J, temperature = sliding
    low, high = own.slowest, own.fastest
    for i in range(out.size):
        root = np.sqrt(abs(speed[i]))
        inside = min(max(root, low), high)
        curve = own.coefficients[0, i]
        for k in range(1, own.coefficients.shape[0]):
            curve = curve * inside + own.coefficients[k, i]
        curve = own.breakaway[i] + min(root / low, 1.0) * (curve - own.breakaway[i])
        heat = max(1.0 + own.per_kelvin * (temperature[i] - own.temperature), 0.2)
        out[i] = (curve * heat + own.load[i] * abs(tau_J[i])) * own.factor[i]
