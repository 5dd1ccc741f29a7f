"""Free-drive law: the arm carries itself and its configured payload, and follows the hand (FD-2, FD-3, AF-7)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.guided.unintended_motion import LEFT
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, Phase
from pendant.tick.pose import ORIGIN, Vector
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.compiled.kernel import kernel
from sim.control.active_damping import ActiveDamping
from sim.control.axis_constraint import AxisConstraint
from sim.control.balancing import Balancing
from sim.control.hand_help import HandHelp
from sim.control.shaker import Shaker
from sim.control.singularity import Singularity
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

COMPENSATED = 1.0 - LEFT  # share of the friction estimate that is compensated
HANDOVER_TIME = 0.05
"""What the motors bore in the hold, beyond what the model says, goes within some 0.05 s: at once, it would shake the arm. That is
slower than the arm's lowest modes, and far shorter than the activation sequence, at whose end nothing of it is left."""
HANDOVER = math.exp(-TICK / HANDOVER_TIME)
HANDED_OVER = ticks(20.0 * HANDOVER_TIME)  # a part in 5e8 is left then


class Pushed(NamedTuple):
    """A force at a point of a part that the first `joints` joints move, axes of B."""

    p_BF: Array  # flange (3,) [m]
    p: Vector  # the point [m]
    force: Vector  # [N]
    joints: int


class FreeDriveLaw:
    """Motor torque = static torque + J^T gain F_user + friction, as far as the hand asks for it.

    Friction is compensated in the direction of what the hand asks of a joint and in proportion to it, never in the
    direction of the motion: without a hand nothing is compensated, the arm's own friction holds it, and even too large an
    estimate neither drives it nor makes it hum. A hand on a link is felt by the joints alone: there a torque counts that the
    flange sensor does not explain, that is larger than its uncertainty, and that has not been there for long.

    Attributes:
        share: of the friction estimate that is compensated at most.
        singularity: how near the arm is to one.
    """

    def __init__(self, arm: Arm, constants: JointConstants, dynamics: Dynamics, *, tcp: Array, R_FT: Array) -> None:
        """
        Args:
            arm: the arm's numbers.
            constants: those that the controller uses.
            dynamics: the controller's rigid model, whose recursion has been run with the tick's angles.
            tcp: tool centre point in F (3,) [m].
            R_FT: its orientation in F (3, 3).
        """
        self._gravity, self._elbow = dynamics.recursion.at_rest, arm.chain.elbow
        n = arm.n
        rotor = np.array(arm.motors.rotor_inertia) * constants.rotor_inertia
        self._damping = ActiveDamping(np.array(arm.limits.torque), rotor, arm.chain.elbow)
        self._balancing = Balancing(np.array(arm.limits.torque), rotor, arm.payload)
        self._constraint = AxisConstraint(arm, constants, tcp, R_FT)
        self.singularity = Singularity(rotor)
        self._shaker = Shaker(rotor[-1], arm.limits.torque[-1])
        self.share = COMPENSATED
        self._n = n
        self._hand = HandHelp(n)
        self._handover = np.zeros(n)  # what is left of the hold's torque beyond the model's [N·m]
        self._handing_over = 0  # ticks until nothing is

    def _moving(self, part: str) -> int:
        """How many joints move a part."""
        return self._elbow if part == "elbow" else self._n

    @property
    def balancing(self) -> Array:
        """Torque (n,) that balances a load nobody told of, as far as it was found since free-drive began [N·m] (FD-10)."""
        return self._balancing.torque

    def start(self, held: Array | None) -> None:
        """Free-drive begins: what the joints feel now is no hand.

        Args:
            held: motor torque (n,) that held the arm until now [N·m]; None: the brakes did.
        """
        self._handing_over = 0 if held is None else HANDED_OVER
        if held is not None:
            self._handover[:] = held - self._gravity
        self._hand.start()
        self._damping.start()
        self._balancing.start()
        self._constraint.release()
        self._shaker.stop()
        self.singularity.forget()

    def torque(
        self, estimate: Estimate, decision: Decision, jacobian: Array, *, friction: AdaptiveFriction, with_friction: bool
    ) -> Array:
        """Motor torque (n,) [N·m].

        Args:
            estimate: this tick's estimate.
            decision: while the arm is only freed to see whether it stays, nothing helps the hand; without `flange_help` hands
                are felt by the joints alone.
            jacobian: of the flange (6, n), linear first, axes of B.
            friction: its estimate.
            with_friction: take friction off the hand.
        """
        torque = self._static(decision)
        for wall in decision.walls:
            if wall.force != ORIGIN:
                _push(jacobian, (estimate.p_BF, wall.p, wall.force, self._moving(wall.part)), torque)
        if decision.zones:
            torque += decision.zones
        if decision.balance is not None:
            self._balancing.add(estimate, decision.balance, jacobian, torque)
            return torque
        if not decision.flange_help and decision.phase is Phase.SEQUENCE:
            return torque
        locks = decision.locks
        constraint, static = self._constraint, torque
        if locks is None:
            constraint.release()
            self.singularity.watch(jacobian, estimate.tick)
        else:
            self.singularity.update(jacobian)
            static = torque.copy()
            constraint.prepare(estimate, locks, jacobian, static)
        help = 1.0
        if decision.damping is not None:
            self._damping.add(estimate, decision.damping, decision.speed_limits, jacobian=jacobian, torque=torque)
            help = self._damping.help
        if estimate.wrench_valid and decision.flange_help:
            gain = help * decision.gain
            slack = decision.slack
            felt = estimate.F_user, decision.baseline, (slack.force, slack.torque)  # a named tuple takes a kernel 0.5 µs more
            self._hand.ask((*felt, estimate.R_BF, jacobian, decision.force_cap, gain), torque)
            if locks is not None:
                constraint.project(self._hand.capped, gain, torque)
        else:
            self._hand.ask_nothing()
        if with_friction:
            # Where nobody may lead the arm it gets no help, and brakes: who leads it pushes then, and is felt.
            share = 0.0 if decision.doubtful else help * self.share
            self._hand.take_off(estimate, friction, share, torque)
        if locks is not None:
            self.singularity.resist(locks.near, locks.too_near, speed=estimate.theta_d, static=static, torque=torque)
            constraint.hold(torque)
        self._shake(estimate, decision, friction, torque)
        return torque

    def _static(self, decision: Decision) -> Array:
        """Torque against gravity (n,) [N·m], with what is left of the hold's."""
        torque = self._gravity.copy()
        if decision.balance is not None:  # balancing begins with all that the motors bear
            self._handing_over = 0
        elif self._handing_over > 0:
            torque += self._handover
            self._handover *= HANDOVER
            self._handing_over -= 1
        return torque

    def _shake(self, estimate: Estimate, decision: Decision, friction: AdaptiveFriction, torque: Array) -> None:
        """Add haptic feedback."""
        if decision.shake is None:
            self._shaker.stop()
        else:
            torque[-1] += self._shaker.torque(decision.shake, estimate, float(friction.breakaway[-1]))


@kernel
def _push(jacobian, pushed, torque) -> None:
    """Add J^T of a force at a point."""
    pushed = Pushed(*pushed)
    p_BF, p, force, moving = pushed
    x, y, z = p[0] - p_BF[0], p[1] - p_BF[1], p[2] - p_BF[2]
    fx, fy, fz = force
    tx, ty, tz = y * fz - z * fy, z * fx - x * fz, x * fy - y * fx
    for i in range(moving):
        torque[i] += jacobian[0, i] * fx + jacobian[1, i] * fy + jacobian[2, i] * fz
        torque[i] += jacobian[3, i] * tx + jacobian[4, i] * ty + jacobian[5, i] * tz
