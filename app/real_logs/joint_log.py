"""A log of an arm as one value: times, angles, speeds, currents or torques, and what was mended of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class JointLog:
    """A log of an arm of n joints, k rows in the order of time. SI units; joints base to flange; signs as in the arm's file."""

    name: str  # of the file
    t: Array  # (k,) rising [s]
    q: Array  # (k, n) output angle [rad]
    qd: Array  # (k, n) output speed [rad/s]
    current: Array | None  # (k, n) motor current [A]; None: there is `torque`
    torque: Array | None  # (k, n) motor torque referred to the output [N·m]
    wrench: Array | None  # (k, 6) what the flange exerts on what it carries, in F [N, N·m]
    temperature: Array | None  # (k, n) of the joints [°C]
    theta: Array | None  # (k, n) motor angle referred to the output [rad]
    guided: NDArray[np.bool_] | None  # (k,) a hand may lead the arm
    starts: tuple[int, ...]  # rows at which a stretch without a gap begins, first 0
    told: tuple[str, ...]  # what was mended, and what is not in it, a sentence each

    @property
    def stretches(self) -> list[slice]:
        """Rows without a gap between them."""
        ends = (*self.starts[1:], len(self.t))
        return [slice(a, b) for a, b in zip(self.starts, ends, strict=True)]

    @property
    def rate(self) -> float:
        """Rows a second."""
        return float(1.0 / np.median(np.diff(self.t)))

    @property
    def seconds(self) -> float:
        """Length without its gaps [s]."""
        return float(sum(self.t[part][-1] - self.t[part][0] for part in self.stretches))

    def motor_torque(self, arm: Arm, rows: slice = slice(None)) -> Array:
        """Motor torque referred to the output (k, n) [N·m]: as logged, or of the currents by the arm's constants."""
        if self.torque is not None:
            return self.torque[rows]
        assert self.current is not None  # one of both is there
        return self.current[rows] * np.array(arm.motors.gear) * np.array(arm.motors.torque_constant)


def counted(number: int, what: str) -> str:
    """A number of things in words: 1 row, 2 rows."""
    return f"{number} {what}{'' if number == 1 else 's'}"
