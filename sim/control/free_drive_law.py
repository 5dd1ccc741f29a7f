"""Free-drive law: the arm carries itself and its configured payload, and follows the hand (FD-2, FD-3, AF-7)."""

import math

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.guided.work import LEFT
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, Phase
from pendant.tick.pose import ORIGIN
from sim.arm.arm_file import Arm
from sim.control.active_damping import ActiveDamping
from sim.control.axis_constraint import AxisConstraint
from sim.control.balancing import Balancing
from sim.control.shaker import Shaker
from sim.control.singularity import Singularity
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.estimation.estimator import TORQUE_BANDWIDTH
from sim.estimation.transmission_torque import DYNAMICS
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.calibration import Calibration

Array = NDArray[np.float64]

COMPENSATED = 1.0 - LEFT  # share of the friction estimate that is compensated
INTENT = 0.12  # of the breakaway torque: a hand that asks for this much is helped in full
DEAD_ZONE = 0.05  # of the breakaway torque: less than this is sensor drift, no hand
HELP_BANDWIDTH = 12.0  # of that help [Hz]: a hand is slower, the wrists' own modes and the flange sensor's noise are faster
BRAKE, BRAKE_SPEED = 1.5, 0.15  # of the breakaway torque, added to the friction of a joint of which nothing is asked; [rad/s]
FELT = 0.25  # of the breakaway torque: a push felt by the joints alone must exceed this beyond the estimate's own uncertainty
HERE = 0.25  # share of that uncertainty in the posture of entry, where nobody touched the arm
APART = 0.25 * math.pi  # all of it so far away [rad]: gears err once and twice a turn
USUAL = 2.0  # times the estimate's uncertainty: a felt torque of this size may be an error of the estimate
FORGET, KEEP = 1.0, 8.0  # time constants in which a felt torque becomes usual: below that size, and above it [s]
HANDOVER = math.exp(-TICK / 0.05)
"""What the motors bore in the hold, beyond what the model says, goes within some 0.05 s: at once, it would shake the arm. That is
slower than the arm's lowest modes, and far shorter than the activation sequence, at whose end nothing of it is left."""
LATE, BEGAN = 3, 6  # rows of the memory: the first of three, and that after them


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

    def __init__(self, arm: Arm, calibration: Calibration, dynamics: Dynamics, *, tcp: Array, R_FT: Array) -> None:
        """
        Args:
            arm: the arm's numbers.
            calibration: error of the constants that the controller uses.
            dynamics: the controller's rigid model.
            tcp: tool centre point in F (3,) [m].
            R_FT: its orientation in F (3, 3).
        """
        self._dynamics, self._elbow = dynamics, arm.chain.elbow
        n = arm.n
        rotor = np.array(arm.motors.rotor_inertia) * calibration.rotor_inertia
        self._damping = ActiveDamping(np.array(arm.limits.torque), rotor, arm.chain.elbow)
        self._balancing = Balancing(np.array(arm.limits.torque), rotor, arm.payload)
        self._constraint = AxisConstraint(arm, calibration, tcp, R_FT)
        self.singularity = Singularity(rotor)
        self._shaker = Shaker(rotor[-1], arm.limits.torque[-1])
        self.share = COMPENSATED
        poles = (2.0 * math.pi * HELP_BANDWIDTH, 2.0 * math.pi * TORQUE_BANDWIDTH, 1.0 / FORGET, 1.0 / KEEP)
        self._rates = tuple(1.0 - math.exp(-pole * TICK) for pole in poles)
        self._hand = np.zeros((2, n))  # what the flange sensor explains of each joint's torque, and that with its force capped
        # Asked and felt, filtered; what is usual; transmission torque, `_late`; angles in which free-drive began.
        self._memory = np.zeros((7, n))
        self._handover = np.zeros(n)  # what is left of the hold's torque beyond the model's [N·m]

    def _moving(self, part: str) -> int:
        """How many joints move a part."""
        return self._elbow if part == "elbow" else self._hand.shape[1]

    @property
    def balancing(self) -> Array:
        """Torque (n,) that balances a load nobody told of, as far as it was found since free-drive began [N·m] (FD-10)."""
        return self._balancing.torque

    def start(self, estimate: Estimate, held: Array | None) -> None:
        """Free-drive begins: what the joints feel now is no hand.

        Args:
            estimate: this tick's estimate.
            held: motor torque (n,) that held the arm until now [N·m]; None: the brakes did.
        """
        self._handover[:] = 0.0 if held is None else held - self._dynamics.gravity(estimate.q)
        self._memory[:] = 0.0
        self._memory[2] = estimate.tau_ext
        self._memory[LATE:BEGAN] = estimate.tau_ways[DYNAMICS] - estimate.tau_ext
        self._memory[BEGAN] = estimate.q
        self._damping.start()
        self._balancing.start()
        self._constraint.release()
        self._shaker.stop()

    def torque(
        self, estimate: Estimate, decision: Decision, jacobian: Array, *, friction: AdaptiveFriction, with_friction: bool
    ) -> Array:
        """Motor torque (n,) [N·m].

        Args:
            estimate: this tick's estimate.
            decision: while the arm is only freed to see whether it stays, nothing helps the hand; else gain 0 means that the
                flange sensor is not to be used, and hands are felt by the joints alone.
            jacobian: of the flange (6, n), linear first, axes of B.
            friction: its estimate.
            with_friction: take friction off the hand.
        """
        torque = self._static(estimate, decision)
        for wall in decision.walls:
            if wall.force != ORIGIN:
                _push(jacobian, estimate.p_BF, wall.p, wall.force, self._moving(wall.part), torque)
        if decision.zones:
            torque += decision.zones
        if decision.balance is not None:
            self._balancing.add(estimate, decision.balance, jacobian, torque)
            return torque
        if not decision.amplified and decision.phase is Phase.SEQUENCE:
            return torque
        self.singularity.update(jacobian)
        locks = decision.locks
        constraint, static = self._constraint, torque
        if locks is None:
            constraint.release()
        else:
            static = torque.copy()
            constraint.prepare(estimate, locks, jacobian, static)
        help = 1.0
        if decision.damping is not None:
            self._damping.add(estimate, decision.damping, decision.speed_limits, jacobian=jacobian, torque=torque)
            help = self._damping.help
        hand = self._hand
        if estimate.wrench_valid and decision.amplified:
            cap, gain = decision.force_cap, help * decision.gain
            _ask(estimate.F_user, decision.baseline, estimate.R_BF, jacobian, cap, gain, hand, torque)
            if locks is not None:
                constraint.project(hand[1], gain, torque)
        else:
            hand[:] = 0.0
        if with_friction:
            # Where nobody may lead the arm it gets no help, and brakes: who leads it pushes then, and is felt.
            self._help(estimate, friction, 0.0 if decision.doubtful else help * self.share, torque)
        if locks is not None:
            self.singularity.resist(locks.near, locks.too_near, speed=estimate.theta_d, static=static, torque=torque)
            constraint.hold(torque)
        self._shake(estimate, decision, friction, torque)
        return torque

    def _static(self, estimate: Estimate, decision: Decision) -> Array:
        """Torque against gravity (n,) [N·m], with what is left of the hold's."""
        torque = self._dynamics.gravity(estimate.q)
        if decision.balance is None:
            torque += self._handover
            self._handover *= HANDOVER
        else:  # balancing begins with all that the motors bear
            self._handover[:] = 0.0
        return torque

    def _shake(self, estimate: Estimate, decision: Decision, friction: AdaptiveFriction, torque: Array) -> None:
        """Add haptic feedback."""
        if decision.shake is None:
            self._shaker.stop()
        else:
            torque[-1] += self._shaker.torque(decision.shake, estimate, float(friction.breakaway[-1]))

    def _help(self, estimate: Estimate, friction: AdaptiveFriction, share: float, torque: Array) -> None:
        """Take at most this share of the friction off the hand."""
        torques = (estimate.tau_ways, estimate.tau_ext, estimate.tau_ext_deviation)
        rubs = (estimate.friction, estimate.theta_d, friction.terms, friction.warmth)
        _take_off(self._hand, *torques, estimate.q, self._memory, self._rates, *rubs, share, torque)


@numba.njit(cache=True)
def _push(jacobian, p_BF, p, force, moving, torque) -> None:
    """Add J^T of a force at the point p of a part that the first `moving` joints move."""
    x, y, z = p[0] - p_BF[0], p[1] - p_BF[1], p[2] - p_BF[2]
    fx, fy, fz = force
    tx, ty, tz = y * fz - z * fy, z * fx - x * fz, x * fy - y * fx
    for i in range(moving):
        torque[i] += jacobian[0, i] * fx + jacobian[1, i] * fy + jacobian[2, i] * fz
        torque[i] += jacobian[3, i] * tx + jacobian[4, i] * ty + jacobian[5, i] * tz


@numba.njit(cache=True)
def _ask(F_user, baseline, R, jacobian, cap, gain, hand, torque) -> None:
    """What the hand asks of each joint. The baseline is an offset of the sensor: it turns with the flange."""
    wrench = np.empty(6)
    for k in range(3):
        wrench[k], wrench[3 + k] = F_user[k], F_user[3 + k]
        for m in range(3):
            wrench[k] -= R[k, m] * baseline[m]
            wrench[3 + k] -= R[k, m] * baseline[3 + m]
    size = math.sqrt(wrench[0] * wrench[0] + wrench[1] * wrench[1] + wrench[2] * wrench[2])
    share = cap / size if size > cap else 1.0
    for i in range(torque.size):
        asked = 0.0
        for j in range(6):
            asked += jacobian[j, i] * wrench[j]
        hand[0, i], hand[1, i] = asked, share * asked
        torque[i] += gain * hand[1, i]


@numba.njit(cache=True)
def _take_off(hand, ways, tau_ext, uncertain, q, memory, rates, sliding, speed, terms, warmth, most, torque) -> None:
    smooth, lag, forget, keep = rates
    away = 0.0
    for i in range(q.size):
        away = max(away, abs(q[i] - memory[BEGAN, i]))
    doubt = min(HERE + (1.0 - HERE) * away / APART, 1.0)
    for i in range(torque.size):
        breakaway = terms[i, 0] * warmth[i]
        model = ways[DYNAMICS, i]
        unexplained = model - _late(model - tau_ext[i], lag, memory, i) - hand[0, i] - memory[2, i]
        memory[0, i] += smooth * (hand[1, i] - memory[0, i])
        memory[1, i] += smooth * (unexplained - memory[1, i])
        ask, felt = memory[0, i], memory[1, i]
        least = FELT * breakaway + doubt * uncertain[i]
        over = abs(felt) - least
        usual = memory[2, i] + (keep if over > 0.0 else forget) * unexplained
        # As the gears' errors are learned, what seemed usual must go as well.
        memory[2, i] = min(max(usual, -USUAL * uncertain[i]), USUAL * uncertain[i])
        if over > abs(ask):
            ask = math.copysign(over, felt)
        size = max(abs(ask) - DEAD_ZONE * breakaway, 0.0)
        share = min(size / (INTENT * breakaway), 1.0) if breakaway > 0.0 else 1.0
        torque[i] += math.copysign(most * share * max(abs(sliding[i]), breakaway), ask)
        # A joint of which nothing is asked comes to rest sooner than by its friction alone, unless something pushes it on.
        along = felt if speed[i] > 0.0 else -felt
        pushed = min(max(along / least, 0.0), 1.0) if least > 0.0 else 0.0
        if most == 0.0:
            share = 0.0
        torque[i] -= (1.0 - share) * (1.0 - pushed) * BRAKE * breakaway * math.tanh(speed[i] / BRAKE_SPEED)


@numba.njit(cache=True)
def _late(measured, lag, memory, i) -> float:
    """What a joint's gear bears, as late as the rigid model, which sees accelerations through the filter of the output angle.

    Without that, links that swing on their springs pass for a hand, and the help for it keeps them swinging.
    """
    for k in range(LATE, LATE + 3):
        memory[k, i] += lag * (measured - memory[k, i])
        measured = memory[k, i]
    return measured
