"""Whether the payload fell, or a hand is there, as the joints alone tell it: for free-drive without a flange sensor (FD-19).

An arm goes on bearing a payload that it has lost. With the wrench p that this payload would need in the flange's motion, and the
flange's Jacobian J, the joints then feel

    tau_ext = tau_ext at entry + J' p.

A hand makes these torques, too, if it pushes upward as hard as the payload weighs, and harder the faster the arm rises. Gears
tell torques as well as their stiffness is known; so the payload fell where all but that share of the change is as J' p says, for
as long as a fall is looked at elsewhere, and where most of the change, as a share of J' p, came at once, as no hand brings it
about (`sim.estimation.sudden_change`).

Both sides come from momenta, without accelerations, which would be known too late: an arm that has lost its payload gains 5 mm/s
in each millisecond. The momentum observer tells the torques, and with the payload's momentum P and angular momentum L about the
flange origin, which moves with v, and its centre at c from there,

    force = P' - m g,    moment = L' + v x P - c x m g,

with the same lag as the observer's. Encoders' noise alternates, so the mean of some ticks is looked at.

Most of the time what is felt is neither, and the question is who may move the arm. What a joint tells since entry is wrong by no
more than the ripple of its encoder, and by the share a that its stiffness may be wrong by of what its gear bears more or less:

    |error| <= ripple + a |model - model at entry| + |J' s|.

The last term is of a payload that was told wrong and accepted: what it weighs more or less was there at entry, but what it takes
to be accelerated, s, was not. Its mass is that whose weight explains tau_ext at entry best, and no more than the arm may carry.
Where the motor tells a torque, without the deflection, an error is larger than RARELY standard deviations once in a thousand.

Three cases follow. Where the change of every joint is within its error, nothing is felt. Where it differs from J' p by no more
than its error and a |J' p|, the payload may have fallen, unless all of J' p is within the errors, too: a payload that no
joint would miss does not move an arm that its friction holds. Else a hand is there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.sensor.odds import HALF, RARELY, SUSPECTED
from pendant.tick.estimate import JointsFeel
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import ripple_torque
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.momentum_observer import MomentumObserver, follow
from sim.estimation.sudden_change import MEAN, SEEN, add, came, courses, forget
from sim.estimation.torque_balance import payload_levers
from sim.estimation.transmission_torque import DYNAMICS, MOTOR, TransmissionTorque
from sim.flange.external_wrench import ExternalWrench
from sim.flange.wrench_hypotheses import LONGEST
from sim.rigid_body.newton_euler import NewtonEuler, cross, turned, turned_back

Array = NDArray[np.float64]

SURE = HALF * RARELY**2
"""Log of the odds at which an error of `RARELY` deviations is noticed [nats]."""

NOTHING, FALL, HAND = (int(each) for each in JointsFeel)  # as kernels know them
NOT_ASKED = False, JointsFeel.NOTHING


class JointTorques(NamedTuple):
    """What the joints tell of a tick."""

    momentum: MomentumObserver  # of all contacts, as there is no flange sensor
    transmission: TransmissionTorque
    deflection: Array  # torque that it bears as believed (n,) [N·m]


class PayloadFall:
    """One tick at a time, in free-drive alone.

    Attributes:
        torque: of a hand (n,) [N·m]; zeros where there is none.
        certain: what of it is more than each joint may be wrong by (n,) [N·m].
    """

    def __init__(self, arm: Arm, rigid: NewtonEuler, joints: JointTorques, wrench: ExternalWrench) -> None:
        """
        Args:
            arm: the numbers of its gears and encoders.
            rigid: the controller's rigid model, which has been run with the tick's angles before `update`.
            joints: updated in the same tick before.
            wrench: knows the payload that may fall.
        """
        self._rigid, self._joints, self._wrench, self._most = rigid.record, joints, wrench, arm.payload
        self._record = record(
            stiffness=(),  # what the gears' may be wrong by, relative to it
            before=(arm.n,),  # tau_ext at entry [N·m]
            entry=(arm.n,),  # what the model wants the gears to bear there [N·m]
            ripple=(arm.n,),  # what the encoder alone may change a torque by [N·m]
            noise=(),  # sum of its squares [N²·m²]
            q=(arm.n,),  # a tick ago [rad]
            untold=(),  # mass that the payload may be wrong by [kg]
            momentum=(2, 6),  # P and L of the payload a tick ago, and of 1 kg at its centre, in B [N·s, N·m·s]
            needed=(2, 6),  # force and moment behind the first and the second of both filters [N, N·m]
            swing=(2, 6),  # the same to accelerate 1 kg at its centre
            hand=(arm.n,),  # what a hand makes of the change of tau_ext [N·m]
            certain=(arm.n,),  # what of that is beyond the errors
            latest=(MEAN, 2, arm.n),  # change of tau_ext, and J' p [N·m]
            ticks="i8",  # since both run
            lasts="i8",  # ticks
            fell="?",  # the payload did
            unlike="i8",  # ticks for which the change has not been that of a fall, at most `SEEN`
        )
        self._courses = courses()
        own = self._own = self._record[0]
        own["ripple"] = ripple = ripple_torque(arm)
        own["noise"], own["stiffness"] = ripple @ ripple, arm.accuracy.stiffness
        self.torque: Array = own["hand"]
        self.certain: Array = own["certain"]
        self._begun = False

    def update(self, q: Array, *, free: bool, sensed: bool) -> tuple[bool, JointsFeel]:
        """One tick. Returns whether the payload fell, and what explains the torques of this tick.

        Outside free-drive, while the flange sensor tells that, and while the observer begins, it did not, and nothing is felt.

        Args:
            q: joint angles (n,) as measured [rad].
            free: free-drive is on.
            sensed: the flange sensor is used.
        """
        if not free:
            self._begun = False
            self.torque[:] = self.certain[:] = 0.0
            return NOT_ASKED
        if not self._begun:
            self._begin()
        if sensed:
            return NOT_ASKED
        momentum, transmission, _ = self._joints
        if not momentum.ready:
            self._own["ticks"] = 0
            self.torque[:] = self.certain[:] = 0.0
            return NOT_ASKED
        felt = q, transmission.ways[DYNAMICS], momentum.residual, transmission.by_motor
        fell, feels = _update((self._record, self._courses), self._rigid, self._wrench.record, felt)
        return fell, JointsFeel(feels)

    def _begin(self) -> None:
        """Free-drive begins."""
        own, (_, transmission, deflection) = self._own, self._joints
        self._begun, own["ticks"] = True, 0
        own["entry"] = model = transmission.ways[DYNAMICS]
        own["before"] = before = model - np.where(transmission.by_motor > 0.0, transmission.ways[MOTOR], deflection)
        weight = payload_levers(self._rigid, self._wrench.record)
        own["untold"] = min(abs(before @ weight) / max(weight @ weight, 1e-9), self._most)


@kernel
def _update(memory, model, wrenches, felt) -> tuple[bool, int]:
    own, courses, jacobian, place = memory[0][0], memory[1], model[0].jacobian, memory[0][0].ticks % MEAN
    q, bears, external, by_motor = felt
    _need(own, model[0], wrenches[0], q)
    if own.ticks == 0:
        own.latest[:], own.lasts, own.unlike, own.fell = 0.0, 0, SEEN, False
        forget(courses)
    own.ticks += 1
    change = left = along = size = now = whole = 0.0
    nothing = falls = unmissed = True
    for i in range(q.size):
        wrong = RARELY * by_motor[i] if by_motor[i] > 0.0 else own.ripple[i] + own.stiffness * abs(bears[i] - own.entry[i])
        own.latest[place, 0, i], own.latest[place, 1, i], swings = external[i] - own.before[i], 0.0, 0.0
        for k in range(6):
            own.latest[place, 1, i] += jacobian[k, i] * own.needed[1, k]
            swings += jacobian[k, i] * own.swing[1, k]
        wrong += own.untold * abs(swings)
        now += own.latest[place, 0, i] * own.latest[place, 1, i]
        whole += own.latest[place, 1, i] ** 2
        more = lost = 0.0
        for k in range(MEAN):
            more += own.latest[k, 0, i] / MEAN
            lost += own.latest[k, 1, i] / MEAN
        own.hand[i], own.certain[i] = more, math.copysign(max(abs(more) - wrong, 0.0), more)
        change += more * more
        left += (more - lost) * (more - lost)
        along += more * lost
        size += lost * lost
        nothing = nothing and abs(more) <= wrong
        falls = falls and abs(more - lost) <= wrong + own.stiffness * abs(lost)
        unmissed = unmissed and abs(lost) <= wrong
    share = now / whole if whole > 0.0 else 0.0
    add(courses, share)
    enough = change > own.noise
    least = own.stiffness**2 * change
    own.lasts = own.lasts + 1 if enough and left < least else 0
    _judge(own, courses, enough and share > HALF and size > 0.0 and change - along**2 / size < least)
    feels = NOTHING if nothing else FALL if falls and not unmissed else HAND
    if feels != HAND:
        own.hand[:] = own.certain[:] = 0.0
    return own.fell, feels


@kernel
def _judge(own, courses, comes) -> None:
    """Whether the payload fell; `comes`: the change is that of a fall which may not be all there yet.

    It is sure in the first ticks where a step is likelier by far than what a hand does, and as soon as a fall lasts where a step
    is the likelier. Later it is not seen any more how the change came.
    """
    fits, first = own.lasts >= LONGEST - MEAN, own.unlike == SEEN
    if first and (fits or comes):
        by_hand, at_all, size, level = came(courses)
        sure = by_hand <= -SURE and abs(level - 1.0) <= own.stiffness
        own.fell = at_all >= SUSPECTED and size >= HALF and (by_hand < 0.0 if fits else sure)
    if fits or (first and own.fell):
        own.unlike = 0
    elif not first:
        own.unlike += 1
        own.fell = own.fell and own.unlike < SEEN


@kernel
def _need(own, rigid, payload, q) -> None:
    """The wrench that the payload needs at the flange, in B, as late as the momentum observer's torques."""
    v, w = np.zeros(3), np.zeros(3)
    if own.ticks > 0:
        for i in range(q.size):
            speed = (q[i] - own.q[i]) / TICK
            for k in range(3):
                v[k] += rigid.jacobian[k, i] * speed
                w[k] += rigid.jacobian[3 + k, i] * speed
    own.q[:] = q
    m, g, c = payload.mass, rigid.gravity, turned(rigid.R, payload.com)
    around, lever = cross(w, c), cross(c, v)
    spin = turned(rigid.R, turned(payload.inertia, turned_back(rigid.R, w)))
    one = (v[0] + around[0], v[1] + around[1], v[2] + around[2])
    turns, carried, heavy = cross(c, one), cross(v, one), cross(c, g)
    for k in range(3):
        _add(own, (own.momentum[0], own.needed, k), m * one[k], -m * g[k])
        _add(own, (own.momentum[0], own.needed, 3 + k), m * lever[k] + spin[k], m * (carried[k] - heavy[k]))
        _add(own, (own.momentum[1], own.swing, k), one[k], 0.0)
        _add(own, (own.momentum[1], own.swing, 3 + k), turns[k], carried[k])


@kernel
def _add(own, change, momentum, rest) -> None:
    """The change of a momentum, and the `rest` of what it takes, as late as the torques."""
    before, needed, k = change
    if own.ticks < 2:  # before, there is no speed to compare with
        needed[0, k] = needed[1, k] = rest
    else:
        follow(needed[0], needed[1], (momentum - before[k]) / TICK + rest, k)
    before[k] = momentum
