"""The control law of each mode: what the decision asks for becomes motor currents."""

import math
from collections import deque

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.estimate import Estimate
from pendant.modes import TICK, Law
from pendant.program import JointMove, LinearMove, Move
from sim.adaptive_friction import AdaptiveFriction
from sim.arm import Arm
from sim.calibration import Calibration
from sim.dynamics import Dynamics
from sim.moves import JointTrajectory, LinearTrajectory, Motion, MoveRefused, Reference, Stop
from sim.sensors import LATENCY

Array = NDArray[np.float64]

BANDWIDTH = 12.0  # of the position loop round the rotor alone [Hz]
DAMPING_RATIO = 1.25
SUPPORT = 0.6  # share of the transmission's load torque that is fed forward to the motor: it stiffens the hold
SUPPORT_BANDWIDTH = 90.0  # of that path [Hz]
INTEGRAL_TIME = 0.1  # of the output-side integral [s]
SETTLE_TICKS = 300  # of the reference after a stop: some swings of the lowest mode
STANDING = 0.02  # [rad/s]
SETTLE_RATE = 0.02  # a tick: a time constant of 0.1 s
DELAY = LATENCY + 1
"""Ticks between a reference and the measurement of what it led to: each measurement is compared with its own reference."""

DEAD_BAND = 3.0  # of the integral, in counts of the output encoder: below it stiction and integral would hunt


class Controller:
    """Turns estimates and decisions into motor currents, n joints.

    Tracking (HOLD, BRAKE, FOLLOW) is one law, fed by different references:
        tau = M(q) qdd + h + P (theta_ref - theta) + D (theta_d_ref - theta_d) + I ∫(q_ref - q) + S (tau_J - tau_model)
    with theta_ref = q_ref + tau_model / K. A program's motion gets the friction estimate as feed-forward on top (AF-7).
    FREE (FD-2, FD-3) is tau = gravity + J^T gain F_user, no feedback of position.

    Args:
        arm: the arm's numbers.
        calibration: error of the constants that the controller uses.
        dynamics: the controller's rigid model.
        tcp: tool centre point in F (3,) [m].
    """

    def __init__(self, arm: Arm, calibration: Calibration, dynamics: Dynamics, tcp: Array) -> None:
        motors = arm.motors
        self._dynamics, self._tcp = dynamics, tcp
        self._per_torque = 1.0 / (np.array(motors.torque_constant) * np.array(motors.gear) * calibration.motor_constant)
        self._current_limit = np.array(motors.current)
        spring = arm.transmissions
        compliance = 1.0 / ((np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * calibration.stiffness)
        rotor = np.array(motors.rotor_inertia) * calibration.rotor_inertia
        omega = 2.0 * math.pi * BANDWIDTH
        stiffness, damping = rotor * omega**2, 2.0 * DAMPING_RATIO * rotor * omega
        support_rate = 1.0 - math.exp(-2.0 * math.pi * SUPPORT_BANDWIDTH * TICK)
        self._gains = (stiffness, damping, rotor, compliance, support_rate)
        self._I = TICK * stiffness / INTEGRAL_TIME
        self._dead = DEAD_BAND * 2.0 * math.pi / arm.sensors.encoders.output_counts
        limits = arm.limits
        self._speed, self._acceleration = np.array(limits.speed), np.array(limits.acceleration)
        self._position = np.array(limits.position)
        self._integral, self._support = np.zeros(arm.n), np.zeros(arm.n)
        self._command = np.zeros(arm.n)
        self._law: Law | None = None
        self._motion: Motion | None = None
        self._move: Move | None = None
        self._reference: Reference | None = None
        self._taking_over = True  # in this tick the law or its reference begins anew
        self._driven = False  # the reference comes from a program, which knows its speed ahead
        self._past: deque[Reference] = deque()  # references of the last ticks
        self._settling = 0  # ticks for which a stop's reference still leans towards the arm
        self.move_done = 0
        self.refusal = ""

    def update(self, estimate: Estimate, decision: Decision, jacobian: Array, friction: AdaptiveFriction) -> Array:
        """Motor currents (n,) [A] for this tick.

        Args:
            estimate: this tick's estimate.
            decision: this tick's decision.
            jacobian: of the flange (6, n), linear first, axes of B.
            friction: its estimate.
        """
        self.refusal = ""
        if decision.law is Law.FREE:
            torque = self._free(estimate, decision, jacobian)
        else:
            torque = self._track(estimate, decision, friction)
        current = np.empty_like(torque)
        _to_current(torque, self._per_torque, self._current_limit, current, self._command)
        self._law = decision.law
        return current

    def _free(self, estimate: Estimate, decision: Decision, jacobian: Array) -> Array:
        """FD-3, eq. 4: static torque of the configured payload plus J^T times the user's wrench, its force capped."""
        torque = self._dynamics.gravity(estimate.q)
        if decision.gain > 0.0 and estimate.wrench_valid:
            wrench = estimate.F_user - decision.baseline
            fx, fy, fz = wrench[:3].tolist()
            size = math.sqrt(fx * fx + fy * fy + fz * fz)
            gain = decision.gain * min(1.0, decision.force_cap / size) if size > 0.0 else decision.gain
            torque = torque + jacobian.T @ (wrench * gain)
        return torque

    def _track(self, estimate: Estimate, decision: Decision, friction: AdaptiveFriction) -> Array:
        reference = self._next_reference(estimate, decision)
        model = self._dynamics.inverse(reference.q, reference.qd, reference.qdd)
        torque = np.empty_like(model)
        if self._taking_over:
            self._past.clear()
            np.subtract(estimate.tau_J, model, out=self._support)
        self._past.append(reference)
        then = self._past.popleft() if len(self._past) > DELAY else self._past[0]
        state = (estimate.q, estimate.theta, estimate.theta_d, estimate.tau_J)
        _tracking_law(reference, then, state, model, self._gains, self._support, torque)
        if self._driven:
            torque += friction.at(reference.qd, model)
        if self._taking_over:
            # Bumpless: the integral starts where the torque was, so that taking over moves nothing by itself.
            self._integral[:] = (model if self._law is None else self._command) - torque
        _integrate(then.q, estimate.q, self._I, self._dead, self._integral, torque)
        return torque

    def _next_reference(self, estimate: Estimate, decision: Decision) -> Reference:
        law = decision.law
        self._taking_over = self._reference is None or self._law is Law.FREE
        if self._reference is None or self._law is Law.FREE:
            self._stop(estimate.q, estimate.qd)
        elif law is not Law.FOLLOW and self._law is Law.FOLLOW:
            self._stop(self._reference.q, self._reference.qd)
        elif self._settling and self._motion is not None and self._motion.done:
            self._motion = self._settle(estimate, self._reference)
        self._driven = law is Law.FOLLOW or (self._driven and not self._taking_over)
        if law is Law.FOLLOW and decision.move is not self._move:
            self._begin(decision.move)
        self._move = decision.move if law is Law.FOLLOW else None
        assert self._motion is not None
        self._reference = self._motion.step()
        if law is Law.FOLLOW and self._motion.done and self._move is not None and not self.refusal:
            self.move_done = self._move.id
        return self._reference

    def _stop(self, q: Array, qd: Array) -> None:
        """Come to rest from this motion; one that stood already has nothing to settle."""
        self._motion = Stop(q, qd, self._acceleration)
        self._settling = SETTLE_TICKS if float(np.abs(qd).max()) > STANDING else 0

    def _settle(self, estimate: Estimate, reference: Reference) -> Stop:
        """After a stop has run out, let its end lean towards where the arm swings about, for a while.

        The arm then keeps the posture it came to, instead of creeping back to where the plan ended.
        """
        self._settling -= 1
        return Stop(reference.q + SETTLE_RATE * (estimate.q - reference.q), np.zeros_like(estimate.q), self._acceleration)

    def _begin(self, move: Move | None) -> None:
        assert self._reference is not None
        self._settling = 0
        q = self._reference.q
        limits = (self._speed, self._acceleration, self._position)
        try:
            if isinstance(move, JointMove):
                self._motion = JointTrajectory(q, move, limits)
            elif isinstance(move, LinearMove):
                self._motion = LinearTrajectory(q, move, self._dynamics, self._tcp, limits)
            else:
                self._motion = Stop(q, np.zeros_like(q), self._acceleration)
        except MoveRefused as refusal:
            self.refusal = str(refusal)
            self._motion = Stop(q, np.zeros_like(q), self._acceleration)


@numba.njit(cache=True)
def _tracking_law(reference, then, state, model, gains, support, torque) -> None:
    qdd_ref = reference[2]
    q_ref, qd_ref, _ = then
    _, theta, theta_d, tau_J = state
    stiffness, damping, rotor, compliance, support_rate = gains
    for i in range(torque.size):
        support[i] += support_rate * (tau_J[i] - model[i] - support[i])
        error = q_ref[i] + compliance[i] * model[i] - theta[i]
        pull = stiffness[i] * error + damping[i] * (qd_ref[i] - theta_d[i])
        torque[i] = model[i] + rotor[i] * qdd_ref[i] + pull + SUPPORT * support[i]


@numba.njit(cache=True)
def _integrate(q_ref, q, gain, dead_band, integral, torque) -> None:
    for i in range(torque.size):
        error = q_ref[i] - q[i]
        if abs(error) > dead_band:
            integral[i] += gain[i] * error
        torque[i] += integral[i]


@numba.njit(cache=True)
def _to_current(torque, per_torque, limit, current, command) -> None:
    for i in range(torque.size):
        current[i] = min(max(torque[i] * per_torque[i], -limit[i]), limit[i])
        command[i] = current[i] / per_torque[i]
