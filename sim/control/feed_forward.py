"""Feed-forward controller: the torques that the desired motion needs (AF-4, AF-5)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.motion.script_requests import DirectTorque
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.adaptive_friction import AdaptiveFriction, slide
from sim.motion.moves import Reference
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]


class Moved(NamedTuple):
    """The desired motion of a tick, n joints."""

    qd: Array  # (n,) [rad/s]
    qdd: Array  # (n,) [rad/s²]
    desired: Array  # (n,) transmission torque [N·m]; the output's friction is added to it
    stiffer: Array  # (n,) error of the springs' believed stiffness, relative to it
    fresh: bool  # it starts again, nothing is known of the bristles


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

    def __init__(self, arm: Arm, constants: JointConstants, dynamics: Dynamics) -> None:
        self._dynamics = dynamics
        self._rated = np.array(arm.limits.torque)
        spring = arm.transmissions
        self._record = record(
            rotor=(arm.n,),
            stiffness=(arm.n,),
            presliding=(arm.n,),
            load=(arm.n,),  # desired, of the last tick
            speed=(arm.n,),  # of the motors
            direction=(arm.n,),  # of friction, -1..1
            friction=(arm.n,),  # that is fed forward
        )
        own = self._record[0]
        own["rotor"] = np.array(arm.motors.rotor_inertia) * constants.rotor_inertia
        own["stiffness"] = (np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * constants.stiffness
        own["presliding"] = arm.frictions.presliding
        self._speed = own["speed"]
        self._smooth = AdaptiveFriction(arm, 0.0)  # joints without friction: nothing is fed against it
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
        self._commanded = False
        if not motion:
            self.tau_J = self._dynamics.gravity(reference.q).copy()
            return self.tau_J.copy()
        self.tau_J = self._dynamics.inverse(reference.q, reference.qd, reference.qdd)
        if push is not None:
            self.tau_J = self.tau_J + push
        torque = np.empty_like(self.tau_J)
        moved = reference.qd, reference.qdd, self.tau_J, stiffer, fresh or not self._fed
        self._fed = friction is not None
        _feed(self._record, (friction or self._smooth).record, moved, torque)
        return torque

    def commanded(self, move: DirectTorque, estimate: Estimate, friction: AdaptiveFriction) -> Array:
        """Motor torque (n,) [N·m] of torques that a script commands: those, gravity, and its shares of the friction.

        No joint is asked for more than its rated torque, gravity counted.

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
        wanted = np.minimum(np.maximum(gravity + move.torque, -self._rated), self._rated)
        return wanted + total * own["direction"]


@kernel
def _feed(feed_forward, friction, moved, torque) -> None:
    """Motor torque; and to the desired transmission torque the output's friction. One kernel: a call costs as much as a part."""
    moved = Moved(*moved)
    own, desired, share = feed_forward[0], moved.desired, friction[0].output_share
    rotor, qdd, rubs = own.rotor, moved.qdd, own.friction
    _turn(own, moved)
    slide(friction, own.speed, desired, rubs)
    _bend(feed_forward, rubs)
    for i in range(torque.size):
        torque[i] = desired[i] + rotor[i] * qdd[i] + rubs[i]
        desired[i] += share * rubs[i]


@kernel
def _turn(own, moved) -> None:
    """Desired speed of the motors."""
    load = moved.desired
    for i in range(load.size):
        if moved.fresh:
            own.load[i], own.direction[i] = load[i], 0.0
        own.speed[i] = moved.qd[i] + (load[i] - own.load[i]) / (TICK * own.stiffness[i] * (1.0 + moved.stiffer[i]))
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
