"""Feed-forward controller: the torques that the desired motion needs (AF-4, AF-5)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import DirectTorque
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.motion.moves import Reference
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.calibration import Calibration

Array = NDArray[np.float64]


class Turned(NamedTuple):
    """What turns the motors in a tick, n joints."""

    qd: Array  # (n,) desired speed [rad/s]
    load: Array  # (n,) desired transmission torque [N·m]
    stiffer: Array  # (n,) error of the springs' believed stiffness, relative to it


class Needed(NamedTuple):
    """What a motion needs, n joints [N·m]."""

    qdd: Array  # (n,) its acceleration [rad/s²]
    friction: Array  # (n,) of both sides
    desired: Array  # (n,) transmission torque; the output's friction is added to it


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
        spring = arm.transmissions
        self._record = record(
            rotor=(arm.n,),
            stiffness=(arm.n,),
            presliding=(arm.n,),
            load=(arm.n,),  # desired, of the last tick
            speed=(arm.n,),  # of the motors
            direction=(arm.n,),  # of friction, -1..1
        )
        own = self._record[0]
        own["rotor"] = np.array(arm.motors.rotor_inertia) * calibration.rotor_inertia
        own["stiffness"] = (np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * calibration.stiffness
        own["presliding"] = arm.frictions.presliding
        self._speed = own["speed"]
        self._no_friction = np.zeros(arm.n)
        self._fed = False  # friction was fed forward in the last tick
        self._commanded = False  # torques were commanded in it
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
            push: with which the joints push against the outside as well (n,) [N·m].
            fresh: the reference started again, nothing is known of the bristles.
        """
        torque, self._commanded = np.empty_like(self._no_friction), False
        if not motion:
            self.tau_J = self._dynamics.gravity(reference.q).copy()
            _add(self._record, (reference.qdd, self._no_friction, self.tau_J), (0.0, 0.0), torque)
            return torque
        self.tau_J = self._dynamics.inverse(reference.q, reference.qd, reference.qdd)
        if push is not None:
            self.tau_J = self.tau_J + push
        total, share = self._no_friction, 0.0
        if friction is not None:
            _turn(self._record, (reference.qd, self.tau_J, stiffer), fresh or not self._fed)
            total, share = friction.at(self._speed, self.tau_J), friction.output_share
            _bend(self._record, total)
        self._fed = friction is not None
        _add(self._record, (reference.qdd, total, self.tau_J), (1.0, share), torque)
        return torque

    def commanded(self, move: DirectTorque, estimate: Estimate, friction: AdaptiveFriction) -> Array:
        """Motor torque (n,) [N·m] of torques that a script commands: those, gravity, and its shares of the friction.

        The motors' friction turns round with their measured motion, within the way over which bristles bend: by the sign of the
        speed it would drive a joint at rest to and fro. A share below 1 drives no joint that nobody moves.

        Args:
            move: what is commanded.
            estimate: of this tick.
            friction: its estimate.
        """
        own, gravity = self._record[0], self._dynamics.gravity(estimate.q)
        if not self._commanded:
            own["direction"] = 0.0
        self._speed[:] = estimate.theta_d
        coulomb, viscous = friction.parts(estimate.theta_d, estimate.tau_J)
        total = move.coulomb * coulomb + move.viscous * viscous
        size = coulomb + viscous  # by which the bristles bend, whatever is made up for
        _bend(self._record, size)
        self._fed, self._commanded = False, True
        return gravity + move.torque + total * own["direction"]


@kernel
def _add(feed_forward, needed, shares, torque) -> None:
    """Motor torque; `shares`: of the rotors' inertia that counts, and of the friction that the output has."""
    needed = Needed(*needed)
    rotor = feed_forward[0].rotor
    inertia, share = shares
    for i in range(torque.size):
        torque[i] = needed.desired[i] + inertia * rotor[i] * needed.qdd[i] + needed.friction[i]
        needed.desired[i] += share * needed.friction[i]


@kernel
def _turn(feed_forward, turned, fresh) -> None:
    """Desired speed of the motors."""
    turned = Turned(*turned)
    own, load = feed_forward[0], turned.load
    for i in range(load.size):
        if fresh:
            own.load[i], own.direction[i] = load[i], 0.0
        own.speed[i] = turned.qd[i] + (load[i] - own.load[i]) / (TICK * own.stiffness[i] * (1.0 + turned.stiffer[i]))
        own.load[i] = load[i]


@kernel
def _bend(feed_forward, friction) -> None:
    """Sliding friction becomes what the bristles hold; over one tick the speed is constant."""
    own = feed_forward[0]
    for i in range(friction.size):
        speed, size = own.speed[i], abs(friction[i])
        if speed != 0.0:
            sign = math.copysign(1.0, speed)
            bent = math.exp(-abs(speed) * TICK * own.presliding[i] / max(size, 1e-6))
            own.direction[i] = sign + (own.direction[i] - sign) * bent
        friction[i] = size * own.direction[i]
