"""Feed-forward controller: the torques that the desired motion needs (AF-4, AF-5)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.motion.moves import Reference
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.calibration import Calibration

Array = NDArray[np.float64]


class FeedForward:
    """Desired transmission torque from model, motion and output friction; motor torque from that, rotor and input friction.

        tau_J = M(q) qdd + h(q, qd) + f_out,    tau_m = J qdd + tau_J + f_in

    Friction is the motor's: a load that changes bends the spring, and near a reversal the motor turns by that more than by the
    output's motion. It turns round within the way over which bristles bend (Dahl's model), not with the sign of the speed: a
    joint that creeps is fed its whole friction, one that has come to rest keeps what its bristles hold.

        df / dx = presliding (1 - sgn(x') f / f_sliding),    x' = qd + d(tau_J)/dt / stiffness

    Source: Dahl, A solid friction model (1968).

    Attributes:
        tau_J: desired transmission torque of the last call (n,) [N·m].
    """

    def __init__(self, arm: Arm, calibration: Calibration, dynamics: Dynamics) -> None:
        self._dynamics = dynamics
        self._rotor = np.array(arm.motors.rotor_inertia) * calibration.rotor_inertia
        spring = arm.transmissions
        stiffness = (np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * calibration.stiffness
        self._bristles = np.stack([stiffness, np.array(arm.frictions.presliding)])
        self._turned = np.zeros((3, arm.n))  # desired load of the last tick, motor speed, direction of friction -1..1
        self._no_friction = np.zeros(arm.n)
        self._fed = False  # friction was fed forward in the last tick
        self.tau_J = np.zeros(arm.n)

    def torque(
        self,
        reference: Reference,
        friction: AdaptiveFriction | None,
        *,
        motion: bool,
        stiffer: Array,
        push: Array | None = None,
        fresh: bool = False,
    ) -> Array:
        """Motor torque (n,) [N·m]; puts the desired transmission torque into `tau_J`, a new array each time.

        Args:
            reference: the desired motion.
            friction: its estimate; None counts none.
            motion: count inertia and speed; else gravity alone, as under PD + gravity.
            stiffer: error of the springs' believed stiffness (n,), as learned, relative to it.
            push: with which the joints push against the outside besides (n,) [N·m].
            fresh: the reference started again, nothing is known of the bristles.
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
            turned = self._turned
            _turn(reference.qd, self.tau_J, self._bristles[0], stiffer, fresh or not self._fed, turned)
            total, share = friction.at(turned[1], self.tau_J), friction.output_share
            _bend(self._bristles[1], turned, total)
        self._fed = friction is not None
        _add(reference.qdd, total, share, self._rotor, self.tau_J, torque)
        return torque


@numba.njit(cache=True)
def _add(qdd, friction, share, rotor, desired, torque) -> None:
    for i in range(torque.size):
        torque[i] = desired[i] + rotor[i] * qdd[i] + friction[i]
        desired[i] += share * friction[i]


@numba.njit(cache=True)
def _turn(qd, load, stiffness, stiffer, fresh, turned) -> None:
    """Desired speed of the motors."""
    for i in range(qd.size):
        if fresh:
            turned[0, i], turned[2, i] = load[i], 0.0
        turned[1, i] = qd[i] + (load[i] - turned[0, i]) / (TICK * stiffness[i] * (1.0 + stiffer[i]))
        turned[0, i] = load[i]


@numba.njit(cache=True)
def _bend(presliding, turned, friction) -> None:
    """Sliding friction becomes what the bristles hold; over one tick the speed is constant."""
    for i in range(friction.size):
        speed, size = turned[1, i], abs(friction[i])
        if speed != 0.0:
            sign = math.copysign(1.0, speed)
            turned[2, i] = sign + (turned[2, i] - sign) * math.exp(-abs(speed) * TICK * presliding[i] / max(size, 1e-6))
        friction[i] = size * turned[2, i]
