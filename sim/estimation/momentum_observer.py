"""External torques of joints by the generalised momentum: an observer without accelerations.

The links' momentum p = M(q) q' changes by p' = tau_J - f_out + C^T q' - g - J^T w + tau_ext. The
residual r = K (p - integral(tau_J - f_out + C^T q' - g - J^T w + r) dt) follows tau_ext with a
first-order lag of 1 / K. The torque tau_J is that behind the gear, from its deflection, so the
friction of motor and gear does not enter. The wrench w of the flange sensor contains all of the
load, so the load need not be known. Arms swing on their gears. An acceleration comes out of a
filter later than its torque, but here both go through the same filter.

Source: De Luca, Albu-Schaeffer, Haddadin, Hirzinger, Collision Detection and Safe Reaction with the DLR-III Lightweight
Manipulator Arm, IROS 2006; Haddadin, De Luca, Albu-Schaeffer, Robot Collisions: A Survey on Detection, Isolation, and
Identification, IEEE Transactions on Robotics 33(6), 2017, section IV.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.torque_errors import TorqueErrors, begin, forget, learn, look, touched
from sim.estimation.transmission_torque import SETTLE_TICKS
from sim.rigid_body.dynamics import Dynamics
from sim.rigid_body.newton_euler import about, cross, turned, turned_back

Array = NDArray[np.float64]

BANDWIDTH = 40.0
"""Bandwidth of the observer and of the filter behind it [Hz]: above the swing of an arm on its
gears (10 to 25 Hz), and so low that the twice differentiated noise of the output encoder makes at
most a newton metre."""
GAIN = 1.0 - math.exp(-2.0 * math.pi * BANDWIDTH * TICK)
READY = 25
"""Ticks after which the start of the observer has no effect: a dozen of its time constants."""
FLOOR = 0.004
"""Deviation of the model's error within tenths of a second, relative to the torque limit."""


class Driven(NamedTuple):
    """Inputs of the observer in a tick, besides the rigid model, n joints."""

    q: Array  # (n,) measured [rad]
    deflection: Array  # (n,) torque of the deflection, with the believed stiffness [N·m]
    motor: Array  # (n,) transmission torque by the motor's current [N·m]
    friction: Array  # (n,) of both sides [N·m]
    friction_deviation: Array  # (n,) [N·m]
    stiction: Array  # (n,) torque that a standing joint may hold in addition [N·m]
    use: NDArray[np.bool_]  # (3, n) which of `transmission_torque.WAYS` may be used
    wrench: Array  # (6,) measured at the flange, in F: of the flange on its load [N, N·m]


class MomentumObserver:
    """External torques of n joints, without the learned corrections, and what is known of their error.

    With the flange sensor these are the torques of contacts on the arm's side of the sensor.
    Without the sensor the configured load is a part of the arm, and they are the torques of all
    contacts. For a joint without deflection the motor torque minus friction is used.

    The errors of gears, encoders and the sensor's zero are learned from these torques, in planned
    motion without a contact. An error of the payload is not in them.

    Attributes:
        residual: the torques (n,) [N·m].
        errors: their learned errors.
        doubt: standard deviation of a change of the residual in tenths of a second, by other causes
            (n,) [N·m].
        held: torque that friction may hold in either direction (n,) [N·m], at a joint that stands
            and has no deflection; else 0.

    Args:
        arm: the arm's numbers.
        dynamics: the controller's rigid model; its recursion was run with the tick's angles.
    """

    def __init__(self, arm: Arm, dynamics: Dynamics) -> None:
        self._rigid = dynamics.recursion
        n, body = arm.n, dynamics.bare
        self.record = record(
            bare=(13,),  # last link without load: mass, centre, inertia about it
            output_share=(),  # of the friction
            floor=(n,),
            count="i8",  # ticks in a row, at most `READY`
            q=(n,),  # a tick ago
            p=(n,),  # momentum, a tick ago [N·m·s]
            drive=(n,),  # torques that change the momentum, a tick ago
            load=(n,),  # torque of the gears, a tick ago
            first=(2, n),  # residual and load after the first of both filters
            residual=(n,),
            borne=(n,),  # torque of the gears, with the lag of the residual
            doubt=(n,),
            held=(n,),
            quiet="i8",  # ticks since something was touched, as far as these torques tell
        )
        own = self.record[0]
        self.residual, self.doubt, self.held, self.errors = own["residual"], own["doubt"], own["held"], TorqueErrors(arm)
        own["bare"] = np.concatenate([[body.mass], body.com, body.inertia.ravel()])
        own["output_share"] = arm.frictions.output_share
        own["floor"] = FLOOR * np.array(arm.limits.torque)
        self._count = self.record["count"]
        self._with_sensor = False

    @property
    def ready(self) -> bool:
        """The residual is valid: the observer has followed the arm for `READY` ticks."""
        return self._count.item() == READY

    def forget(self) -> None:
        """Start anew: a tick is missing, or the flange sensor came or went."""
        self._count[0] = 0

    def forget_zero(self) -> None:
        """Start anew: the flange sensor has another zero from now on."""
        self.forget()
        self.errors.forget_zero()

    def update(self, driven: tuple[Array, ...], *, with_sensor: bool, valid: bool, learn: bool) -> None:
        """One tick.

        Args:
            driven: as `Driven`.
            with_sensor: the wrench is valid.
            valid: the joint measurements are valid. A tick without them resets the observer.
            learn: planned motion moves the arm.
        """
        if not valid or with_sensor is not self._with_sensor:
            self.forget()
        self._with_sensor = with_sensor
        if valid:
            _update((self.record, self.errors.record), self._rigid.record, driven, (with_sensor, learn))


@kernel
def _update(records, model, driven, state) -> None:
    driven = Driven(*driven)
    own, errors, rigid = records[0][0], records[1], model[0]
    with_sensor, learns = state
    n = driven.q.size
    speed, p, drive = np.empty(n), np.empty(n), np.empty(n)
    for i in range(n):
        speed[i] = (driven.q[i] - own.q[i]) / TICK if own.count else 0.0
        own.q[i] = driven.q[i]
    _momentum(own, rigid, (speed, with_sensor), (p, drive))
    force, torque = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if with_sensor:
        w = driven.wrench
        force, torque = turned(rigid.R, (w[0], w[1], w[2])), turned(rigid.R, (w[3], w[4], w[5]))
    for i in range(n):
        by_deflection = driven.use[1, i]
        load = driven.deflection[i] if by_deflection else driven.motor[i]
        drive[i] += load - own.output_share * driven.friction[i]
        for k in range(3):
            drive[i] -= rigid.jacobian[k, i] * force[k] + rigid.jacobian[3 + k, i] * torque[k]
        if own.count < 2:
            own.first[0, i], own.residual[i], own.first[1, i], own.borne[i] = 0.0, 0.0, load, load
        else:
            # The speed is that of the middle of a tick: its change belongs to the last tick's
            # drive.
            follow(own.first[0], own.residual, (p[i] - own.p[i]) / TICK - own.drive[i], i)
            follow(own.first[1], own.borne, own.load[i], i)
        own.p[i], own.drive[i], own.load[i] = p[i], drive[i], load
        _doubt(own, driven, by_deflection, i)
    look(errors, rigid, (own.borne, own.residual), (driven.q, driven.use[1], with_sensor))
    if own.count < READY:
        begin(errors, own.residual)
    own.quiet = min(own.quiet + 1, SETTLE_TICKS)
    if touched(errors, own.residual, own.doubt, driven.use[1]):
        own.quiet = 0
        forget(errors)
    if learns and own.quiet == SETTLE_TICKS:
        learn(errors, own.residual, own.doubt, driven.use[1])
    own.count = min(own.count + 1, READY)


@kernel
def follow(first, second, now, i) -> None:
    """A value through two filters like the observer's: `second[i]` is as late as the torques."""
    first[i] += GAIN * (now - first[i])
    second[i] += GAIN * (first[i] - second[i])


@kernel
def _doubt(own, driven, by_deflection, i) -> None:
    """Error of joint i's residual besides the known causes: a deviation, and what friction holds."""
    rubs = driven.friction_deviation[i]
    own.doubt[i] = np.sqrt(own.floor[i] ** 2 + (own.output_share * rubs) ** 2)
    if not by_deflection:
        own.doubt[i] = np.sqrt(own.floor[i] ** 2 + rubs**2)
    own.held[i] = 0.0 if by_deflection else driven.stiction[i]


@kernel
def _momentum(own, rigid, motion, out) -> None:
    """The momentum of each joint, and the part of its change that no torque makes: C^T q' - g.

    Joint i has the axis z and the origin o. All links beyond it have the linear momentum P and the
    angular momentum L about o: p = z·L, and p' = z'·L - z·(o' x P) + z·(moments about o).
    """
    speed, with_sensor = motion
    p, driven = out
    n = speed.size
    linear, angular, weight = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    turning, going = np.empty((n, 3)), np.empty((n, 3))
    masses = np.empty(n)
    w, v, last = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(n):
        R = rigid.turns[i]
        here = (rigid.origins[i, 0], rigid.origins[i, 1], rigid.origins[i, 2])
        whirl = cross(w, (here[0] - last[0], here[1] - last[1], here[2] - last[2]))
        v = (v[0] + whirl[0], v[1] + whirl[1], v[2] + whirl[2])
        w = (w[0] + R[0, 2] * speed[i], w[1] + R[1, 2] * speed[i], w[2] + R[2, 2] * speed[i])
        last = here
        mass, at, inertia = rigid.mass[i], rigid.com[i], rigid.inertia[i]
        if with_sensor and i == n - 1:
            mass, at, inertia = own.bare[0], own.bare[1:4], own.bare[4:13].reshape((3, 3))
        com = turned(R, at)
        moving = cross(w, com)
        spun = turned(R, turned(inertia, turned_back(R, w)))
        P = (mass * (v[0] + moving[0]), mass * (v[1] + moving[1]), mass * (v[2] + moving[2]))
        L = cross(com, P)
        masses[i] = mass
        for k in range(3):
            linear[i, k], angular[i, k] = P[k], L[k] + spun[k]
            weight[i, k], turning[i, k], going[i, k] = mass * com[k], w[k], v[k]
    P, L, S, mass = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0  # of all beyond; S: mass times centre
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            a = rigid.origins[i + 1]
            b = rigid.origins[i]
            ahead = (a[0] - b[0], a[1] - b[1], a[2] - b[2])
            L, S = about(ahead, (P, L), (S, mass))
        P = (P[0] + linear[i, 0], P[1] + linear[i, 1], P[2] + linear[i, 2])
        L = (L[0] + angular[i, 0], L[1] + angular[i, 1], L[2] + angular[i, 2])
        S = (S[0] + weight[i, 0], S[1] + weight[i, 1], S[2] + weight[i, 2])
        mass += masses[i]
        z = (rigid.turns[i, 0, 2], rigid.turns[i, 1, 2], rigid.turns[i, 2, 2])
        z_d = cross(turning[i], z)
        push, heavy = cross(going[i], P), cross(S, rigid.gravity)
        p[i], driven[i] = 0.0, 0.0
        for k in range(3):
            p[i] += z[k] * L[k]
            driven[i] += z_d[k] * L[k] + z[k] * (heavy[k] - push[k])
