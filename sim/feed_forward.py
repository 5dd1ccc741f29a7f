"""Feed-forward controller: the torques that the desired motion needs (AF-4, AF-5)."""

import numba
import numpy as np
from numpy.typing import NDArray

from sim.adaptive_friction import AdaptiveFriction
from sim.arm import Arm
from sim.calibration import Calibration
from sim.dynamics import Dynamics
from sim.moves import Reference

Array = NDArray[np.float64]


class FeedForward:
    """Desired transmission torque from model, motion and output friction; motor torque from that, rotor and input friction.

        tau_J = M(q) qdd + h(q, qd) + f_out,    tau_m = J qdd + tau_J + f_in

    Attributes:
        tau_J: desired transmission torque of the last call (n,) [N·m].
    """

    def __init__(self, arm: Arm, calibration: Calibration, dynamics: Dynamics) -> None:
        self._dynamics = dynamics
        self._rotor = np.array(arm.motors.rotor_inertia) * calibration.rotor_inertia
        self._no_friction = np.zeros(arm.n)
        self.tau_J = np.zeros(arm.n)

    def torque(self, reference: Reference, friction: AdaptiveFriction | None, motion: bool, push: Array | None = None) -> Array:
        """Motor torque (n,) [N·m]; puts the desired transmission torque into `tau_J`, a new array each time.

        Args:
            reference: the desired motion.
            friction: its estimate; None counts none.
            motion: count inertia and speed; else gravity alone, as under PD + gravity.
            push: with which the joints push against the outside besides (n,) [N·m].
        """
        torque = np.empty_like(self._rotor)
        if not motion:
            self.tau_J = self._dynamics.gravity(reference.q).copy()
            _add(reference.qdd, self._no_friction, 0.0, self._no_friction, self.tau_J, torque)
            return torque
        self.tau_J = self._dynamics.inverse(reference.q, reference.qd, reference.qdd)
        if push is not None:
            self.tau_J = self.tau_J + push
        total, share = self._no_friction, 0.0
        if friction is not None:
            total, share = friction.at(reference.qd, self.tau_J), friction.output_share
        _add(reference.qdd, total, share, self._rotor, self.tau_J, torque)
        return torque


@numba.njit(cache=True)
def _add(qdd, friction, share, rotor, desired, torque) -> None:
    for i in range(torque.size):
        torque[i] = desired[i] + rotor[i] * qdd[i] + friction[i]
        desired[i] += share * friction[i]
