"""Feedback controller: corrections of state errors, each with its switch (AF-5)."""

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.all_settings import JointControl
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import JointConstants
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.motion.moves import DELAY, Reference
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

BANDWIDTH = 12.0  # of the position loop round the rotor alone [Hz]
DAMPING_RATIO = 1.25
INTEGRAL_TIME = 0.1  # of the output-side integral, at least [s]
"""With `torque_feedback.SUPPORT` these keep every mode above 6 Hz inside a circle of 0.993 a tick, for link inertias from
bare wrists to a stretched arm with its payload, stiffness wrong by a fifth and two ticks of delay, sticking or sliding."""

SLOWER = 10.8
"""Of that integral, times a joint's own frequency [rad]. The integral of an angle that swings lags by a quarter of a turn: it
drives the swing on, the more the slower it is. A heavy arm on soft springs swung by itself at 4 Hz."""

PRESLIDING = 0.4e-3
"""Way over which friction at rest turns into sliding friction [rad]; twice the way to breakaway, for the spring bends too."""

INTEGRAL_SHARE = 0.3
"""Of a joint's rated torque, up to which the integral grows: the largest payload, not told, asks 0.26 of the wrists and the
shoulder of a stretched UR5e. What asks more holds the arm, and the integral must not push at it ever harder (AF-6)."""

BACK = 0.02  # of the torque beyond the motor's limits, a tick: as fast as the integral itself
DEAD_BAND = 3.0  # of the integral, in counts of the output encoder: below it stiction and integral would hunt
# The optional terms are gentle: they show their effect without touching the loop's margins.
OUTPUT_SPEED = 0.05  # of the motor-speed gain
ACCELERATION = 0.1  # of the rotor's inertia
MOTOR_TORQUE = 0.1
TCP_STIFFNESS, TCP_DAMPING = 500.0, 20.0  # [N/m], [N·s/m]

OPTIONAL = ("theta_acceleration", "q_speed", "q_acceleration", "motor_torque", "tcp_pose", "tcp_speed")
"""Terms that are off as shipped."""


SUPPORT = 0.6
"""Share of a load that the desired torque does not know and that the motor takes over at once. It stiffens the hold by
1 / (1 - SUPPORT); more than that and the motor-side mode of a light arm loses its damping."""

TORQUE_BANDWIDTH = 90.0  # [Hz]
MOTOR_SIDE_BANDWIDTH = BANDWIDTH
"""Where the torque is known from the motor's own torque, less what accelerates its rotor. That acceleration comes late, so the
motor would be fed with its own torque: no faster than the position loop it does no harm, at 90 Hz a following arm hums with
20 N·m (benchmarks/torque_ways.py)."""


class Wanted(NamedTuple):
    """What shall be, and what is, n joints."""

    q: Array  # (n,) output angle that shall be now [rad]
    qd: Array  # (n,) and its speed [rad/s]
    load: Array  # (n,) transmission torque that this needs [N·m]
    qd_next: Array  # (n,) speed that is wanted next [rad/s]
    sticking: Array  # (n,) friction that is fed forward as soon as a joint moves [N·m]
    stiffer: Array  # (n,) error of the springs' believed stiffness, relative to it
    theta: Array  # (n,) motor angle [rad]
    theta_d: Array  # (n,) motor speed [rad/s]
    q_now: Array  # (n,) output angle [rad]
    excess: Array  # (n,) torque that was asked beyond what the motor gave [N·m]
    begin: Array  # (n,) torque that a law begins with [N·m]
    driven: NDArray[np.bool_]  # (n,): this joint was driven by torques, so that it begins with no integral


class Beginning(NamedTuple):
    """How a law takes over, n joints."""

    torque: Array  # (n,) motor torque that it begins with [N·m]: the integral cancels what all corrections would do at once
    before: Sequence[Reference]  # references of the last DELAY ticks
    driven: NDArray[np.bool_]  # (n,): joints that a script's torques drove: they begin with what all corrections do at once


class Terms(NamedTuple):
    """Which corrections are made in a tick."""

    theta: bool
    theta_speed: bool
    q: bool
    waits: bool  # the integral keeps its value, but for what goes back
    fresh: bool  # a law begins


class Feedback:
    """Motor torque from the errors of theta, q, their speeds and accelerations, motor torque, and the tool centre point.

    The integral acts on the output angle: where the arm shall be. It waits inside the dead band, and while it is told to. Where
    the motor's limits are reached it goes back until no more is asked than they allow (AF-6; back-calculation: Fertik, Ross,
    1967): an integral that merely waited would wind up in every tick in which the limit is just not reached, and not unwind in
    the others.

    At rest a joint's friction may hold anything up to its breakaway torque, and the integral grows against it. That part is let
    go while the joint slides its first tenths of a milliradian, for there the friction that is fed forward takes its place.
    """

    def __init__(
        self, arm: Arm, constants: JointConstants, dynamics: Dynamics, tcp: Array, *, bandwidth: float = BANDWIDTH
    ) -> None:
        spring = arm.transmissions
        rotor = np.array(arm.motors.rotor_inertia) * constants.rotor_inertia
        omega = 2.0 * math.pi * bandwidth
        stiffness = rotor * omega**2
        compliance = 1.0 / ((np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)) * constants.stiffness)
        swing = np.sqrt(1.0 / (compliance * _heaviest(arm, dynamics)))
        integral_gain = TICK * stiffness / np.maximum(INTEGRAL_TIME, SLOWER / swing)
        damping = 2.0 * DAMPING_RATIO * rotor * omega
        n = arm.n
        self._record = record(
            stiffness=(n,),
            damping=(n,),
            compliance=(n,),
            integral_gain=(n,),
            dead_band=(),  # of the integral [rad]
            most=(n,),  # of the integral, up to which it grows [N·m]
            integral=(n,),
            at_rest=(n,),  # its part won at rest
            load=(n,),  # of the last tick
        )
        own = self._own = self._record[0]
        own["stiffness"], own["damping"], own["compliance"], own["integral_gain"] = stiffness, damping, compliance, integral_gain
        self._rotor, self._damping = rotor, damping
        own["most"] = INTEGRAL_SHARE * np.array(arm.limits.torque)
        own["dead_band"] = DEAD_BAND * 2.0 * math.pi / arm.sensors.encoders.output_counts
        self._dynamics, self._tcp = dynamics, tcp
        self._past: deque[tuple[Reference, Array]] = deque()
        self._use: JointControl | None = None
        self._on, self._optional = (True, True, True), False
        self._none = np.zeros(n, dtype=bool)

    def add(
        self,
        reference: Reference,
        desired: Array,
        estimate: Estimate,
        use: JointControl,
        *,
        excess: Array,
        waits: bool,
        torque: Array,
        start: Beginning | None,
        sticking: Array,
        stiffer: Array,
    ) -> None:
        """Add all corrections to `torque` (n,) [N·m].

        Args:
            reference: of this tick.
            desired: transmission torque (n,) [N·m] that it needs; it bends the spring.
            estimate: of this tick.
            use: which terms are on.
            excess: (n,) [N·m] what was asked of the motor beyond what it gave, 0 where it gave all.
            waits: whether the integral shall keep its value, but for what goes back.
            torque: (n,) what the other controllers ask for.
            start: None, or how the law begins, so that taking over moves nothing by itself.
            sticking: (n,) [N·m] the friction that is fed forward as soon as a joint moves, and that it may have at rest.
            stiffer: (n,) error of the springs' believed stiffness, as learned, relative to it.
        """
        if use is not self._use:
            self._use = use
            self._on = (use.theta, use.theta_speed, use.q)
            self._optional = any(getattr(use, name) for name in OPTIONAL)
        past = self._past
        if start is not None:
            past.clear()
            past.extend((each, desired) for each in start.before)
            self._own["load"] = desired
        past.append((reference, desired))
        then, load = past.popleft() if len(past) > DELAY else past[0]
        if self._optional:
            self._add_optional(then, estimate, use, torque)
        begin, driven = (torque, self._none) if start is None else (start.torque, start.driven)
        wanted = (
            then.q,
            then.qd,
            load,
            reference.qd,
            sticking,
            stiffer,
            estimate.theta,
            estimate.theta_d,
            estimate.q,
            excess,
            begin,
            driven,
        )
        _correct(self._record, wanted, (*self._on, waits, start is not None), torque)

    def _add_optional(self, then: Reference, estimate: Estimate, use: JointControl, torque: Array) -> None:
        wanted = torque.copy()
        if use.theta_acceleration:
            torque += ACCELERATION * self._rotor * (then.qdd - estimate.theta_dd)
        if use.q_speed:
            torque += OUTPUT_SPEED * self._damping * (then.qd - estimate.qd)
        if use.q_acceleration:
            torque += ACCELERATION * self._rotor * (then.qdd - estimate.qdd)
        if use.motor_torque:
            torque += MOTOR_TORQUE * (wanted - estimate.tau_m)
        if use.tcp_pose or use.tcp_speed:
            self._add_tcp(then, estimate, use, torque)

    def _add_tcp(self, then: Reference, estimate: Estimate, use: JointControl, torque: Array) -> None:
        p, R, jacobian = self._dynamics.update(then.q)
        at_tcp = jacobian[:3] + np.cross(jacobian[3:].T, R @ self._tcp).T
        force = np.zeros(3)
        if use.tcp_pose:
            force += TCP_STIFFNESS * (p + R @ self._tcp - estimate.p_BF - estimate.R_BF @ self._tcp)
        if use.tcp_speed:
            force += TCP_DAMPING * (at_tcp @ (then.qd - estimate.qd))
        torque += at_tcp.T @ force


def following_limit(arm: Arm) -> Array:
    """Error of each joint at which this control asks its rated torque of it (n,) [rad]; beyond it, it has nothing to add.

        e = tau_rated ((1 - SUPPORT) / K + 1 / k)

    K is the stiffness of the position loop, which `SUPPORT` raises by 1 / (1 - SUPPORT), and k that of the gear, for the load
    bends it as well. An integral makes the error of the same load smaller.
    """
    spring = arm.transmissions
    loop = np.array(arm.motors.rotor_inertia) * (2.0 * math.pi * BANDWIDTH) ** 2
    gear = np.array(spring.stiffness) + np.array(spring.hysteresis_stiffness)
    return np.array(arm.limits.torque) * ((1.0 - SUPPORT) / loop + 1.0 / gear)


class TorqueFeedback:
    """Filtered error of the transmission torque of n joints, times `SUPPORT`."""

    def __init__(self, n: int) -> None:
        self._record = record(rate=(n,), error=(n,))
        self._rate, self._error = self._record["rate"][0], self._record["error"][0]
        self.take_from_motors([])

    def take_from_motors(self, joints: Sequence[int]) -> None:
        """The torque of these joints is known from their motors' torque alone; the others' from the angles."""
        self._rate[:] = 1.0 - math.exp(-2.0 * math.pi * TORQUE_BANDWIDTH * TICK)
        self._rate[list(joints)] = 1.0 - math.exp(-2.0 * math.pi * MOTOR_SIDE_BANDWIDTH * TICK)

    def start(self, measured: Array, desired: Array) -> None:
        """Begin with this error as if it had always been there."""
        np.subtract(measured, desired, out=self._error)

    def add(self, measured: Array, desired: Array, torque: Array) -> None:
        """Add the correction for measured against desired transmission torque (n,) to `torque` (n,) [N·m]."""
        _support(self._record, measured, desired, torque)


def _heaviest(arm: Arm, dynamics: Dynamics) -> Array:
    """Inertia (n,) that a joint moves at home with the largest payload, whatever is configured now [kg·m²]."""
    home = np.array(arm.chain.home)
    ways = dynamics.update(home)[2][:3].copy()
    missing = max(arm.payload - dynamics.load.mass, 0.0)
    return dynamics.mass(home).diagonal() + missing * np.sum(ways**2, axis=0)


@kernel
def _correct(feedback, wanted, terms, torque) -> None:
    wanted = Wanted(*wanted)
    terms = Terms(*terms)
    own = feedback[0]
    integral, at_rest = own.integral, own.at_rest
    load, excess, qd_next, sticking = wanted.load, wanted.excess, wanted.qd_next, wanted.sticking
    for i in range(torque.size):
        total = torque[i]
        compliance = own.compliance[i] / (1.0 + wanted.stiffer[i])
        if terms.theta:
            total += own.stiffness[i] * (wanted.q[i] + compliance * load[i] - wanted.theta[i])
        if terms.theta_speed:
            bending = compliance * (load[i] - own.load[i]) / TICK
            total += own.damping[i] * (wanted.qd[i] + bending - wanted.theta_d[i])
        own.load[i] = load[i]
        if terms.q:
            if terms.fresh:
                integral[i], at_rest[i] = 0.0 if wanted.driven[i] else wanted.begin[i] - total, 0.0
            error = wanted.q[i] - wanted.q_now[i]
            step = -BACK * excess[i]
            if not terms.waits and excess[i] * error <= 0.0 and abs(error) > own.dead_band:
                grown = integral[i] + at_rest[i]
                if abs(grown) < own.most[i] or grown * error < 0.0:
                    step += own.integral_gain[i] * error
            if qd_next[i] == 0.0:
                at_rest[i] += step
            else:
                held = min(max(at_rest[i], -sticking[i]), sticking[i])
                integral[i] += at_rest[i] - held + step
                at_rest[i] = held * math.exp(-abs(qd_next[i]) * TICK / PRESLIDING)
            total += integral[i] + at_rest[i]
        torque[i] = total


@kernel
def _support(feedback, measured, desired, torque) -> None:
    own = feedback[0]
    for i in range(torque.size):
        own.error[i] += own.rate[i] * (measured[i] - desired[i] - own.error[i])
        torque[i] += SUPPORT * own.error[i]
