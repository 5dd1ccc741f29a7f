"""Force and acceleration for the contact detectors: from the sensors at the flange, and from the joints (CD-2)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.contact.settings import ContactUse
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.source_signal import WIDTH, ContactSignals, Signal
from sim.arm.arm_file import SensorNumbers
from sim.arm.chain import Body
from sim.arm.frames import skew
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.adaptive_friction import GATE
from sim.estimation.flange_drive import driven, flange_drive
from sim.estimation.momentum_observer import MomentumObserver
from sim.estimation.torque_errors import CAUSES, left_over
from sim.rigid_body.cholesky import factor, solve
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.sensors import Sample

Array = NDArray[np.float64]

TURN_BANDWIDTH = 150.0
"""Bandwidth of the angular acceleration that moves a measured acceleration to the load's centre [Hz].

It is so high that the angular acceleration comes at most one tick after the force, and so low that at a load's usual distance its
noise is at most that of the accelerometer.
"""
MASS_TICKS = 50
"""Ticks between two computations of the effective mass, which changes only with the posture."""
LEAST_MASS = 0.3  # of the arm behind the sensor [kg]
MASS, EFFECTIVE_MASS, LEVER, DRIVEN = (Signal._fields.index(name) for name in ("mass", "effective_mass", "lever", "driven"))
LISTED = ("tool side", "arm side", "elbow", "forearm")
"""Sources, in the order of their rows."""
NOT_READ = ContactSignals(np.zeros(len(LISTED) * WIDTH), (False,) * len(LISTED))  # nobody looks for contacts
SINGULAR = 0.2
"""Damping of the least-squares force on a link [m]: levers shorter than this say little about a force."""


class Feeling(NamedTuple):
    """Inputs of the sources in a tick, besides the rigid model's motion."""

    values: Array  # all measurements (3n + 18,)
    qd: Array  # (n,) [rad/s]
    qdd: Array  # (n,) [rad/s²]


class WatchedSources(NamedTuple):
    """Which sources are on."""

    tool: bool
    arm_side: bool
    links: bool
    went_on: bool  # the links were watched in the last tick, too


class ContactSources:
    """Makes the signals of every contact part that is watched: tool, then elbow and forearm.

    Args:
        dynamics: the controller's model, already updated to this tick's posture when `read` is called.
        elbow: index of the elbow joint.
        sensors: sensors of the arm, with their ranges and their noise.
        momentum: gives the external torques of this tick.
    """

    def __init__(self, dynamics: Dynamics, elbow: int, sensors: SensorNumbers, momentum: MomentumObserver) -> None:
        wrench = sensors.force_torque
        reach = (math.inf, math.inf) if wrench is None else (wrench.force.range, wrench.torque.range)
        self._dynamics, self._range, self._momentum = dynamics, np.array(reach), momentum
        n = dynamics.recursion.origins.shape[0]
        self._record = record(
            turn=(3,),  # angular speed, a tick ago
            change=(3,),  # angular acceleration, smoothed
            added=(3,),  # acceleration that the turning added a tick ago
            smoothing=(),
            com=(3,),  # of the load
            gravity=(3,),
            reach=(2,),
            before=(2, 3, n),  # Jacobians of the two points on links, a tick ago
            felt=(n,),  # torques that the joints feel and the flange sensor does not
            joints="2i8",  # the joints at the elbow and at the end of the forearm
            numbers=(len(LISTED) * WIDTH + n * (3 + 3 * CAUSES),),  # all that `ContactSignals` holds
        )
        own = self._own = self._record[0]
        own["smoothing"] = 1.0 - math.exp(-2.0 * math.pi * TURN_BANDWIDTH * TICK)
        own["turn"] = np.nan  # not known yet
        self._drive = flange_drive(sensors, float(own["smoothing"]))
        own["joints"] = elbow, elbow + 1
        own["gravity"], own["reach"] = dynamics.gravity_B, reach
        self._numbers, self._started, self._looked = own["numbers"], False, False
        self._signals = self._numbers[: len(LISTED) * WIDTH]
        self._out = self._signals.reshape((len(LISTED), WIDTH))
        self._joints, self._elbow = n, elbow
        self._out[:, EFFECTIVE_MASS] = 1.4  # until the arm has been weighed
        self.set_load(dynamics.load)

    def set_load(self, load: Body) -> None:
        """Take `load` (in F) as everything beyond the flange."""
        self._load, self._own["com"] = load, load.com
        self._out[:2, MASS], self._out[:2, LEVER] = load.mass, np.linalg.norm(load.com)

    def set_zero(self, zero: Array) -> None:
        """`zero` (6,) is subtracted from the sensor's values, in F [N, N·m].

        So the sensor may saturate although the value shown is within its range.
        """
        self._own["reach"] = self._range - [np.abs(zero[:3]).max(), np.abs(zero[3:]).max()]
        self._momentum.forget_zero()

    def read(self, sample: Sample, estimate: Estimate, jacobian: Array, use: ContactUse, *, looks: bool) -> ContactSignals:
        """This tick's signals.

        Args:
            sample: this tick's measurements.
            estimate: this tick's estimate.
            jacobian: of the flange (6, n), axes of B.
            use: which sources are on; the others give None.
            looks: somebody looks for contacts; else there is a gap, and earlier samples no longer count.
        """
        if not looks:
            if self._looked:
                self._own["turn"], self._drive["count"], self._started, self._looked = np.nan, 0, False, False
            return NOT_READ
        self._looked = True
        if estimate.tick % MASS_TICKS == 1:
            lightest = _effective_mass(self._dynamics.mass(estimate.q), estimate.R_BF, jacobian, self._load)
            self._out[:, EFFECTIVE_MASS] = max(LEAST_MASS, lightest)
        pair = sample.wrench_valid and sample.acceleration_valid
        links = use.links and sample.joints_valid and self._momentum.ready
        flange = pair and use.flange
        watched = (pair, flange, links, self._started)
        models = (self._dynamics.recursion.record, self._momentum.record, self._momentum.errors.record, self._drive)
        stands = _read(self._record, models, (sample.values, estimate.qd, estimate.qdd), watched)
        self._started = links
        valid = (pair, flange, links, links)
        if links:
            return ContactSignals(self._numbers.copy(), valid, self._joints, self._elbow, stands)
        return ContactSignals(self._signals.copy(), valid)


def _effective_mass(mass: Array, R: Array, jacobian: Array, load: Body) -> float:
    """Smallest effective mass of the arm at the flange, its rotors decoupled, without what it carries [kg].

    Not compiled: it is asked for rarely, and a compiled solver of systems costs a fresh installation half a minute.
    """
    linear, angular = jacobian[:3], jacobian[3:]
    at_load = linear - skew(R @ load.com) @ angular
    carried = load.mass * (at_load.T @ at_load) + angular.T @ (R @ load.inertia @ R.T) @ angular
    mobility = linear @ np.linalg.solve(mass - carried, linear.T)
    return 1.0 / float(np.linalg.eigvalsh(mobility)[-1])


@kernel
def _read(sources, models, felt, watched) -> bool:
    """All sources that are on, into the rows of `signals`. One kernel: handing arrays over costs as much as its work.

    Returns:
        Whether no joint moves.
    """
    felt = Feeling(*felt)
    watched = WatchedSources(*watched)
    own, rigid, momentum, errors, drive = sources[0], models[0][0], models[1][0], models[2][0], models[3][0]
    rest, signals = felt.values[3 * felt.qd.size :], len(LISTED) * WIDTH
    wrench, rows = rest[:6], own.numbers[:signals].reshape((len(LISTED), WIDTH))
    if watched.tool:
        moved = _to_load(own, rest[9:12], rest[15:18])
        _transfer(own, rigid.R, (wrench, rest[12:15], moved), rows[0])
        if watched.arm_side:
            _transfer(own, rigid.R, (wrench, rest[6:9], moved), rows[1])
        own.added[:] = moved
        rows[:2, DRIVEN] = driven(drive, wrench, rest[6:9], own.change)
    else:
        own.turn[:] = np.nan
        drive.count = 0
    if watched.links:
        beyond = max(abs(wrench[0]), abs(wrench[1]), abs(wrench[2])) >= own.reach[0]
        beyond = beyond or max(abs(wrench[3]), abs(wrench[4]), abs(wrench[5])) >= own.reach[1]
        _feel_behind(own, momentum, errors)
        _keep(own.numbers[signals:], momentum, errors)
        for which in range(2):
            rows[2 + which, 11] = 1.0 if beyond else 0.0
            _derive(own, rigid, (felt, rows[2 + which]), (which, watched.went_on))
    fastest = 0.0
    for speed in felt.qd:
        fastest = max(fastest, abs(speed))
    return fastest < GATE


@kernel
def _to_load(own, arm_side, tool_side):
    """Acceleration (3,) of the load's centre against the flange [m/s²].

    Both gyros feel the same turning, because the flange sensor gives way along its axes and does not turn. Their mean has so
    little noise that its difference needs little smoothing. More smoothing would delay the load's turning against its force, so
    that an arm which vibrates at 60 Hz looks like a contact.
    """
    before, change, smoothing, com = own.turn, own.change, own.smoothing, own.com
    turn, moved = np.empty(3), np.empty(3)
    for k in range(3):
        turn[k] = 0.5 * (arm_side[k] + tool_side[k])
        if np.isnan(before[k]):
            change[k] = 0.0
        else:
            change[k] += smoothing * ((turn[k] - before[k]) / TICK - change[k])
        before[k] = turn[k]
    # w x (w x c) = w (w·c) - c w²
    along = turn[0] * com[0] + turn[1] * com[1] + turn[2] * com[2]
    square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        moved[k] = change[i] * com[j] - change[j] * com[i] + turn[k] * along - com[k] * square
    return moved


@kernel
def _transfer(own, R, felt, out) -> None:
    """Force, specific force at the load's centre, gravity, and change of the acceleration by turning, each (3,) in F."""
    wrench, acceleration, moved = felt
    before, gravity = own.added, own.gravity
    for k in range(3):
        out[k] = wrench[k]
        out[3 + k] = acceleration[k] + moved[k]
        out[6 + k] = R[0, k] * gravity[0] + R[1, k] * gravity[1] + R[2, k] * gravity[2]
        out[13 + k] = moved[k] - before[k]
    out[11] = 1.0 if max(abs(wrench[0]), abs(wrench[1]), abs(wrench[2])) >= own.reach[0] else 0.0


@kernel
def _feel_behind(own, momentum, errors) -> None:
    """The joints' external torques that the flange sensor does not feel, as known best (n,) [N·m]."""
    for i in range(own.felt.size):
        own.felt[i] = left_over(errors.shares[i], momentum.residual[i], errors.causes[i])


@kernel
def _keep(out, momentum, errors) -> None:
    """Torques of contacts behind the sensor, with causes and errors, in the order of `ContactSignals`."""
    n, m = errors.causes.shape
    for i in range(n):
        out[i], out[n + n * m + i], out[2 * n + n * m + i] = momentum.residual[i], momentum.held[i], momentum.doubt[i]
        for k in range(m):
            at = n + m * i + k
            out[at], out[at + 2 * n + n * m] = errors.causes[i, k], errors.shares[i, k]
            out[at + 2 * n + 2 * n * m] = errors.misfit[i, k]


@kernel
def _derive(own, rigid, made, which) -> None:
    """Force of a link on the outside, specific force at its point, and gravity, each (3,) in B, into a row of signals.

    The force is the smallest that explains the torques of contacts behind the sensor, at the joints that can move the point: with
    J^T F = tau, F = (J J^T + d²)^-1 J tau.
    """
    (felt, out), (link, went_on) = made, which
    joint, before = own.joints[link], own.before[link]
    origins, flange, gravity = rigid.origins, rigid.jacobian, own.gravity
    qd, qdd, behind = felt.qd, felt.qdd, own.felt
    n = qd.size
    jacobian = np.empty((3, n))
    square = np.empty((3, 3))
    right = np.empty(3)
    for i in range(n):
        for k in range(3):
            a, b = (k + 1) % 3, (k + 2) % 3
            jacobian[k, i] = 0.0
            if i < joint:
                jacobian[k, i] = flange[3 + a, i] * (origins[joint, b] - origins[i, b])
                jacobian[k, i] -= flange[3 + b, i] * (origins[joint, a] - origins[i, a])
            if not went_on:
                before[k, i] = jacobian[k, i]
    for r in range(3):
        acceleration, push = 0.0, 0.0
        for i in range(n):
            acceleration += jacobian[r, i] * qdd[i] + (jacobian[r, i] - before[r, i]) / TICK * qd[i]
            push += jacobian[r, i] * behind[i]
            before[r, i] = jacobian[r, i]
        for c in range(3):
            total = SINGULAR * SINGULAR if r == c else 0.0
            for i in range(n):
                total += jacobian[r, i] * jacobian[c, i]
            square[r, c] = total
        out[3 + r] = acceleration - gravity[r]
        out[6 + r] = gravity[r]
        right[r] = -push
    factor(square, 3)
    solve(square, right, 3)
    for k in range(3):
        out[k] = right[k]
