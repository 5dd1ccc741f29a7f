"""The control law of each mode: what the decision asks for becomes motor currents."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.all_settings import FedBackTorque, JointControl
from pendant.decision import Decision
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law
from pendant.tick.motion_status import MotionStatus
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.control.feed_forward import FeedForward
from sim.control.feedback import Beginning, Feedback, TorqueFeedback
from sim.control.free_drive_law import FreeDriveLaw
from sim.control.motor_controller import MotorController
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.estimation.transmission_torque import DEFLECTION, DYNAMICS, MOTOR
from sim.motion.moves import Reference
from sim.motion.references import STANDING, References
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]


class Controlled(NamedTuple):
    """What the controller did in a tick."""

    current: Array  # of the motors (n,) [A]
    status: MotionStatus
    answered: Reference | None  # that the next tick's measurement answers to; None in free-drive and where a new one has begun


class Controller:
    """Turns estimates and decisions into motor currents, n joints (AF-5, AF-8).

    Tracking (HOLD, BRAKE, FOLLOW) is feed-forward + torque feedback + feedback of state errors, each a module of its own, fed
    by different references. A program's motion gets the friction estimate as feed-forward on top (AF-7). Torques that a script
    commands are followed without any feedback, as long as there are new ones in every tick. FREE is the free-drive law, without
    any feedback of position. OFF is no current at all.

    Args:
        arm: the arm's numbers.
        constants: those that the controller uses.
        dynamics: the controller's rigid model.
        tcp: tool centre point in F (3,) [m].
        R_FT: its orientation in F (3, 3).
    """

    def __init__(self, arm: Arm, constants: JointConstants, dynamics: Dynamics, *, tcp: Array, R_FT: Array) -> None:
        self.references = References(arm, constants, dynamics, tcp=tcp, R_FT=R_FT)
        self.feed_forward = FeedForward(arm, constants, dynamics)
        self.torque_feedback = TorqueFeedback(arm.n)
        self.feedback = Feedback(arm, constants, dynamics, tcp)
        self.free_drive = FreeDriveLaw(arm, constants, dynamics, tcp=tcp, R_FT=R_FT)
        self.motor = MotorController(arm, constants)
        self._law: Law | None = None
        self._nothing = np.zeros(arm.n)
        self._followed = False  # a motion was followed before the arm was told to brake
        self._commanded = False  # a script's torques drove the joints in the last tick
        self._driven = np.zeros(arm.n, dtype=bool)  # the joints that move by them
        self._blind = False  # some joint had no motor angle in the last tick
        self._fed_back = False  # the torque feedback was on in the last tick
        self._use: JointControl | None = None
        self._lost: tuple[tuple[str, int], ...] = ()
        self._torque: Array | None = None  # of the last tick (n,) [N·m]; None: no power

    def update(
        self,
        estimate: Estimate,
        decision: Decision,
        jacobian: Array,
        *,
        friction: AdaptiveFriction,
        stiffer: Array,
        use: JointControl,
    ) -> Controlled:
        """One tick.

        Args:
            estimate: this tick's estimate.
            decision: this tick's decision.
            jacobian: of the flange (6, n), linear first, axes of B.
            friction: its estimate.
            stiffer: error of the springs' believed stiffness (n,), as learned, relative to it.
            use: which terms are on.
        """
        blind = not (estimate.joints_valid or estimate.degraded)
        if self._blind and not blind:
            self.references.skip()  # the arm is not where the reference went on to
        self._blind = blind
        law = decision.law
        if law is _OFF:
            # No power: the brakes hold. Whatever comes after it starts again, as after free-drive.
            self.references.skip()
            torque = self._nothing
        elif law is _FREE:
            self.references.skip()
            if self._law is not _FREE:
                self.free_drive.start(self._torque)
            torque = self.free_drive.torque(estimate, decision, jacobian, friction=friction, with_friction=use.friction)
        elif (commanded := self.references.commanded(estimate, decision)) is not None:
            torque = self.feed_forward.commanded(commanded, estimate, friction)
        else:
            torque = self._track(estimate, decision, friction=friction, stiffer=stiffer, use=use)
        self._commanded = self.references.commanding
        if blind:
            self._keep_torque_of_blind_joints(estimate, torque)
        self._law, self._torque = law, None if law is _OFF else torque
        if law is not _BRAKE:
            self._followed = law is _FOLLOW
        references = self.references
        refused, singular = references.refusal, self.free_drive.singularity.value if law is _FREE else math.inf
        wall = references.keeper.wall if refused else ""
        status = MotionStatus(references.move_done, refused, wall, references.commanding, singular)
        return Controlled(self.motor.current(torque, estimate.theta_d), status, references.answered)

    def _keep_torque_of_blind_joints(self, estimate: Estimate, torque: Array) -> None:
        """Without its motor angle a joint keeps the torque of the tick before, until its brake holds it.

        A loop that is closed over the spring, or on an old measurement, would drive it; less torque would let go of what it
        holds. Where a joint has lost both angles, no posture is known, and all joints keep theirs.
        """
        lost = set(estimate.lost)
        blind = _without("motor_encoder", estimate)
        everywhere = not blind or any(("output_encoder", joint) in lost for joint in blind)
        which = slice(None) if everywhere else blind
        torque[which] = self.motor.command[which]

    def _track(
        self, estimate: Estimate, decision: Decision, *, friction: AdaptiveFriction, stiffer: Array, use: JointControl
    ) -> Array:
        references = self.references
        reference = references.step(estimate, decision)
        helped = use.friction and use.feed_forward and (references.driven or decision.shake is not None)
        rubbing = friction if helped else None
        torque = self.feed_forward.torque(
            reference, rubbing, motion=use.feed_forward, stiffer=stiffer, push=references.push, fresh=references.fresh
        )
        desired = self.feed_forward.tau_J
        feeding_back = use.torque_feedback
        start = None
        if references.fresh or (feeding_back and not self._fed_back):
            self._driven = self._commanded & (np.abs(estimate.theta_d) > STANDING)
        if references.fresh:
            start = Beginning(self._first(torque, estimate, friction), references.before, self._driven)
        if feeding_back:
            if use is not self._use or estimate.lost != self._lost:
                self._use, self._lost = use, estimate.lost
                self.torque_feedback.take_from_motors(_of_motors_alone(estimate, use))
            measured = _actual_torque(estimate, use)
            if references.fresh or not self._fed_back:
                self.torque_feedback.start(np.where(self._driven, desired, measured), desired)
            self.torque_feedback.add(measured, desired, torque)
        self._fed_back = feeding_back
        sticking = friction.breakaway if helped else self._nothing
        # What stands in the way of a motion that is stopped must not be pushed on: to take that back would need seconds.
        waits = decision.law is _BRAKE and self._followed and estimate.touched
        self.feedback.add(
            reference,
            desired,
            estimate,
            use,
            excess=self._nothing if references.fresh else self.motor.excess,
            waits=waits,
            torque=torque,
            start=start,
            sticking=sticking,
            stiffer=stiffer,
        )
        return torque

    def _first(self, torque: Array, estimate: Estimate, friction: AdaptiveFriction) -> Array:
        """Motor torque (n,) [N·m] with which the posture is held from this tick on.

        What the hand had asked for in free-drive is not kept: it would push on when the arm has come to rest; nor is what a
        script's torques drove a joint with. Where something held the arm, the motors go on with what the gears bear, and with
        what stuck on the motors' side: a motor that let go of what is bent would throw the arm back, and more than that would
        drive it on as soon as nothing holds it (RL-2).

        Args:
            torque: what the reference needs (n,) [N·m].
            estimate: of this tick.
            friction: its estimate.
        """
        if self._law is _FREE:
            return torque + self.free_drive.balancing
        if not (self.references.caught_up or self._commanded):
            return torque.copy()
        last, bears, sticks = self.motor.command, estimate.tau_J, friction.breakaway
        return np.minimum(np.maximum(last, bears - sticks), bears + sticks)


def _actual_torque(estimate: Estimate, use: JointControl) -> Array:
    """Transmission torque (n,) [N·m] that is fed back: the chosen way, or the fused one where that way is off or lost."""
    way = use.fed_back
    if way is _DEFLECTION:
        chosen = DEFLECTION if use.from_deflection else None
    elif way is _MOTOR:
        chosen = MOTOR if use.from_motor else None
    else:
        chosen = DYNAMICS if way is _DYNAMICS and use.from_dynamics else None
    return estimate.tau_J if chosen is None else estimate.tau_ways[chosen]  # of a lost sensor it holds the fused one


def _of_motors_alone(estimate: Estimate, use: JointControl) -> list[int]:
    """Joints whose transmission torque that is fed back is known from the motor's side, without any deflection."""
    if use.fed_back is _DYNAMICS and use.from_dynamics:
        return []
    if (use.fed_back is _MOTOR and use.from_motor) or not use.from_deflection:
        return list(range(estimate.q.size))
    return _without("output_encoder", estimate)


def _without(sensor: str, estimate: Estimate) -> list[int]:
    """Joints that have lost that sensor."""
    return [joint for name, joint in estimate.lost if name == sensor]


_DYNAMICS, _DEFLECTION, _MOTOR = FedBackTorque.DYNAMICS, FedBackTorque.DEFLECTION, FedBackTorque.MOTOR
_OFF, _FREE, _BRAKE, _FOLLOW = Law.OFF, Law.FREE, Law.BRAKE, Law.FOLLOW  # looked up in every tick
