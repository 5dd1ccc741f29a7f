"""Reference generator: the posture, stop or move that the tracking laws follow, chosen by the decision."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.motion.script_requests import DirectTorque, GentleStop
from pendant.program.steps import Move, RunScript
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, Law
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.braking.motion_meter import MotionMeter
from sim.braking.workspace_keeper import WorkspaceKeeper
from sim.motion.blend import Blended, Joined, Planned, leaves
from sim.motion.compliance import Compliance, Displaced
from sim.motion.force_move import ForceTrajectory
from sim.motion.jog import JogTrajectory, at_manual_speed
from sim.motion.moves import DELAY, Motion, MoveRefused, Reference, Stop, Strength, led_to, shaken, stop_room, stop_time
from sim.motion.pace import Pace
from sim.motion.planner import Planner, renews
from sim.motion.process import ProcessTrajectory
from sim.motion.streams import JointStream
from sim.paths.tool_point import ToolPoint
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.sensors import LATENCY

Array = NDArray[np.float64]

SETTLE_TICKS = 300  # of the reference after a stop: some swings of the lowest mode
STANDING = 0.02  # [rad/s]
SETTLE_RATE = 0.02  # a tick: a time constant of 0.1 s
PUSH_DECAY = 0.996  # a tick: a time constant of 0.5 s
GONE = 0.01  # [N·m]
HELD = 0.25
"""Share of the largest following error from which on the arm is not at the reference, and a stop begins at the arm."""


class References:
    """One reference a tick under HOLD, BRAKE and FOLLOW; free-drive has none, and what comes after it starts again.

    Attributes:
        now: the last reference, None before the first.
        fresh: in this tick it started again, at the arm's own state.
        before: as it started again, the references that led there, of the last DELAY ticks.
        caught_up: it did so although it was followed: the arm was held, or pushed away.
        driven: it comes from a program, which knows its speed ahead.
        move_done: id of the last move finished.
        refusal: why the move of this tick cannot be done, or "".
        keeper: keeps it in the workspace.
        meter: measures motions against the robot's limits.
        commanding: in this tick the joints had torques that a script commands.
        push: torque (n,) with which the joints push against the outside as well [N·m], None for none.
    """

    def __init__(self, arm: Arm, constants: JointConstants, dynamics: Dynamics, *, tcp: Array, R_FT: Array) -> None:
        limits = arm.limits
        self._dynamics, self._tool, self._R_FT = dynamics, ToolPoint(dynamics, tcp), R_FT
        self._limits = (np.array(limits.speed), np.array(limits.acceleration), np.array(limits.ends).T.copy())
        self._rotor, self._torque = np.array(arm.motors.rotor_inertia) * constants.rotor_inertia, np.array(limits.torque)
        self._strength = Strength(dynamics, self._rotor, self._torque)
        self.meter = MotionMeter(dynamics, tcp, self._strength.braking())
        self._pace = Pace(self.meter)
        self.keeper = WorkspaceKeeper(dynamics, tcp, R_FT, self._strength.stopping())
        self._planner = Planner(self._tool, R_FT, limits=self._limits, strength=self._strength, pace=self._pace)
        self._law: Law | None = None
        self._motion: Motion | None = None
        self._move: Move | None = None
        self._beside: Compliance | Displaced | None = None  # the arm pushes while it moves, or goes beside its motion
        self._leaving = False  # the motion has come to where the next one may begin
        self._settling = 0  # ticks for which a stop's reference still leans towards the arm
        self._standing = np.zeros(arm.n)
        self.now: Reference | None = None
        self._past: deque[Reference] = deque(maxlen=DELAY)
        self.fresh, self.caught_up = True, False
        self.before: list[Reference] = []
        self.driven = False
        self.move_done, self.refusal = 0, ""
        self.push: Array | None = None
        self.commanding = False

    def skip(self) -> None:
        """A tick without a reference: free-drive."""
        self._law, self.refusal, self.commanding = Law.FREE, "", False
        self._past.clear()

    def commanded(self, estimate: Estimate, decision: Decision) -> DirectTorque | None:
        """A script's torques of this tick, refused from the next on where they break a limit; None: a reference is followed."""
        move = decision.move
        if decision.law is not Law.FOLLOW or not isinstance(move, DirectTorque) or move is self._move:
            return None
        self.skip()
        self.now = Reference(estimate.q.copy(), estimate.theta_d.copy(), self._standing)
        begins = not isinstance(self._move, DirectTorque)
        self._move, self._beside, self._leaving, self.push = move, None, False, None
        self.move_done, self.commanding = move.id, True
        self.keeper.take(decision, estimate.q, begins=begins)
        self.refusal = self._strength.broken(self.now, self._limits, estimate.theta_dd) or self.keeper.watch(estimate)
        return move

    @property
    def motion(self) -> Motion | None:
        """What the references come from, None before the first."""
        return self._motion

    @property
    def answered(self) -> Reference | None:
        """The reference that the next tick's measurement answers to; None under free-drive, and where a new one has begun."""
        return None if self.fresh or not self._past else self._past[0]

    def wanted(self) -> Array:
        """Angles (n,) of the last reference [rad]; empty under free-drive and before the first."""
        return np.zeros(0) if self.now is None or self._law is Law.FREE else self.now.q.copy()

    def step(self, estimate: Estimate, decision: Decision) -> Reference:
        """The reference of this tick."""
        law = decision.law
        commanded, self.refusal, self.commanding = self.commanding, "", False
        begins = law is Law.FOLLOW and decision.move is not self._move
        ends = law is not Law.FOLLOW and self._law is Law.FOLLOW
        self.caught_up = self._lost(estimate, law, ends or (begins and isinstance(decision.move, GentleStop | RunScript)))
        self.fresh = self.now is None or self._law is Law.FREE or self.caught_up
        if self.now is None or self.fresh:
            self._restart(estimate, known=self.caught_up or commanded)
        elif ends:
            self._stop(self.now.q, self.now.qd)
        elif self._settling and self._motion is not None and self._motion.done:
            self._motion = self._settle(estimate, self.now)
        self.driven = law is Law.FOLLOW or (self.driven and not self.fresh)
        if self._beside is not None and not (law is Law.FOLLOW and self._beside.serves(decision)):
            self._beside, begins = None, law is Law.FOLLOW  # the motion goes on from where the tool has come to
        if self._beside is None and law is Law.FOLLOW and (decision.force or decision.offset):
            begins = self._go_beside(decision) or begins
        self.keeper.take(decision, estimate.q if self.now is None else self.now.q, begins=begins)
        if begins:
            self._begin(decision.move)
        self._move = decision.move if law is Law.FOLLOW else None
        assert self._motion is not None
        if law is Law.FOLLOW and isinstance(self._motion, ForceTrajectory):
            self._motion.feel(estimate)
            self.refusal = self._motion.problem or self.keeper.watch(estimate)
        motion = self.now = self._advance(self._motion, decision, begins)
        if self._beside is not None:
            self._beside.take(motion, estimate, decision)
            self.now = self._beside.step(1.0, decision.speed_limits, self.keeper)
            self.refusal = self.refusal or self._beside.problem
        self.refusal = self.refusal or self.keeper.problem
        self.push = self._pushing(self._motion, self.now)
        answer = self.now if decision.shake is None else shaken(self.now, decision.shake)
        if self.fresh and not self.before:
            self.before = [answer] * DELAY
        self._past.append(answer)
        if law is Law.FOLLOW and self._move is not None and not self.refusal:
            self._leaving = not self._motion.done and self._near_its_end(self._motion, self._move, motion)
            if self._motion.done or self._leaving:
                self.move_done = self._move.id
        self._law = law
        return answer

    def _lost(self, estimate: Estimate, law: Law, ends: bool) -> bool:
        """Whether the arm is not where the reference is, so that a stop that begins in this tick begins at the arm.

        No stop then goes on from where the arm never came; and an arm that is pushed away while it is stopped is braked from
        where it is, not drawn back (RL-2).

        Args:
            estimate: of this tick.
            law: of this tick.
            ends: a motion ends in this tick.
        """
        if self.now is None or self._law is Law.FREE:
            return False
        share = estimate.following.share
        return share > HELD if ends else law is Law.BRAKE and share > 1.0

    def _restart(self, estimate: Estimate, *, known: bool) -> None:
        """Come to rest from where the arm is, as fast as it is; nothing is left of what was wanted before.

        Args:
            estimate: of this tick.
            known: what drove the arm up to now; so it is known where it has come to since it was measured. An arm that a hand
                led is held where it was measured.
        """
        self._past.clear()
        self._beside, self._leaving, self.push, self.before = None, False, None, []
        q, speed = estimate.q, estimate.qd
        if known:
            speed = estimate.theta_d + LATENCY * TICK * estimate.theta_dd
            q = q + LATENCY * TICK * speed
            self.before = led_to(q, speed, self._standing)
            self._past.extend(self.before)
        self.now = Reference(q, speed, self._standing)
        self._stop(q, speed)
        if self.caught_up:  # the joints still push at what held them: they would push on after an end that leans
            self._settling = 0

    def _advance(self, motion: Motion, decision: Decision, begins: bool) -> Reference:
        """The next reference of a motion, at the speed that is allowed."""
        keeper = self.keeper if self._beside is None else None
        if isinstance(motion, Planned | Blended):
            limits = at_manual_speed(decision.move, decision.speed_limits)
            if begins:
                moving = isinstance(motion, Blended | ProcessTrajectory) and motion.moving
                self._pace.begin(motion, limits, decision.speed, moving=moving)
            rate = self._pace.step(motion, limits, decision.speed)
            self._pace.rate = rate if keeper is None else keeper.rate(motion, rate)
            return motion.step(self._pace.rate)
        if isinstance(motion, JogTrajectory | JointStream):
            reference = motion.step(decision.speed, decision.speed_limits, keeper)
            self.refusal = self.refusal or motion.problem
            return reference
        assert isinstance(motion, Stop | ForceTrajectory)
        return motion.step() if isinstance(motion, Stop) else motion.step(decision.speed_limits)

    def _pushing(self, motion: Motion, now: Reference) -> Array | None:
        """Torque (n,) with which the joints push in this tick [N·m]."""
        if isinstance(motion, ForceTrajectory):
            return motion.push
        if self.fresh or self.push is None:
            return None
        if now.qd.any():  # on the next way the integral of the position takes it over
            return None if float(np.abs(self.push).max()) < GONE else PUSH_DECAY * self.push
        return self.push

    def _go_beside(self, decision: Decision) -> bool:
        """The arm begins to push while it moves, or to go at an offset from its motion; whether that begins elsewhere."""
        assert self.now is not None
        try:
            if decision.force is not None:
                self._beside = Compliance(self.now, self._tool, self._limits, self._pace)
            elif (offset := decision.offset) is not None:
                self._beside = Displaced(self.now, self._tool, self._limits, self._pace, R_FT=self._R_FT, offset=offset)
        except MoveRefused as refusal:
            self.refusal = f"{'force mode' if decision.force else 'path offset'}: {refusal}"
        return self.own is not self.now

    def _near_its_end(self, motion: Motion, move: Move, now: Reference) -> bool:
        """The tool comes to the blend at the end of a script's motion."""
        if not (isinstance(move, Joined) and isinstance(motion, Planned | Blended)) or move.blend == 0.0:
            return False
        return leaves(motion, move.blend, float(np.linalg.norm(self._tool.pose(now.q)[0] - self._tool.pose(motion.goal)[0])))

    def _stop(self, q: Array, qd: Array) -> None:
        """Come to rest from this motion; one that stood already has nothing to settle."""
        self._motion = self._slowed(Reference(q, qd, self._standing))
        self._settling = SETTLE_TICKS if float(np.abs(qd).max()) > STANDING else 0

    def _settle(self, estimate: Estimate, reference: Reference) -> Stop:
        """After a stop has run out, let its end lean towards where the arm swings about, for a while.

        The arm then keeps the posture it came to, instead of creeping back to where the plan ended.
        """
        self._settling -= 1
        return Stop(reference.q + SETTLE_RATE * (estimate.q - reference.q), self._standing)

    @property
    def own(self) -> Reference | None:
        """The last reference of the motion itself, without an offset."""
        return self._beside.under if isinstance(self._beside, Displaced) else self.now

    def _begin(self, move: Move | None) -> None:
        now = self.own
        assert now is not None
        self._settling = 0
        if move is None or isinstance(move, GentleStop | RunScript):
            self._motion = self._slowed(now, move)
            return
        goes_on = self._leaving or renews(move, self._motion)
        before = self._motion if goes_on else self._slowed(now)
        assert before is not None
        answer = self._planner.plan(move, now, before, self._move.blend if isinstance(self._move, Joined) else None)
        if isinstance(answer, str):
            self.refusal, self._motion = answer, self._slowed(now)
        else:
            self._motion = answer

    def _slowed(self, now: Reference, move: Move | None = None) -> Stop:
        """To rest on the way that the arm is on, as hard as it can or as a script says; in any case within the joints' range."""
        length = stop_time(self._dynamics, now.q, now.qd, rotor=self._rotor, torque=self._torque)
        room = stop_room(now, self._limits[2])
        if isinstance(move, GentleStop):
            speed = np.abs(now.qd).max()
            if move.of == "tool":
                speed = np.linalg.norm(self._tool.twist(now.q, now.qd)[0])
            length = max(length, min(0.5 * np.pi * float(speed) / move.deceleration, room))
            length = self.keeper.stop_length(now, length)
        return Stop(now.q, now.qd, length, room)
