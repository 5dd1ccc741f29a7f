"""Whether the payload fell or a hand pushes, by the joints: for free-drive without a flange sensor (FD-19).

The motors still carry a payload that the arm has lost. Let p be the wrench that this payload would
need in the flange's motion, and J the Jacobian of the flange. Then the joints feel

    tau_ext = tau_ext at entry + J' p.

A hand makes the same torques if it pushes upward with the payload's weight, and harder the faster
the arm rises. Torques from gears are only as exact as the known stiffness. So the payload fell if
two things hold. The change agrees with J' p up to that error, for `LONGEST` ticks with the mean.
And most of J' p came at once, faster than by a hand (`sim.estimation.sudden_change`).

Both sides come from momenta, because accelerations would be known too late: an arm that has lost
its payload gains 5 mm/s in each millisecond. The momentum observer gives the torques. The payload
has the momentum P, and the angular momentum L about the flange origin. The origin moves with v, and
the payload's centre is at c from it. So

    force = P' - m g,    moment = L' + v x P - c x m g,

with the same lag as the observer's. Encoder noise alternates, so the mean of some ticks is used.

Most of the time nothing falls, and the question is who may move the arm. The error of a joint's
torque since entry has three parts: the ripple of its encoder, a share a (error of the stiffness) of
the change of the gear's load, and a wrong payload:

    |error| <= ripple + a |model - model at entry| + |J' s|.

The last part is for a payload that was configured wrongly but accepted. Its wrong weight was there
at entry; the wrench s to accelerate the wrong mass was not. That mass is the one whose weight
explains tau_ext at entry best, at most what the arm may carry. If a torque comes from the motor,
its error is RARELY standard deviations: one in a thousand is larger.

Three cases follow. If the change at every joint is within its error, nothing is felt. If it equals
J' p within that error plus a |J' p|, the payload may have fallen. But a J' p within the errors at
every joint is too small: friction holds an arm that lost so light a payload. Else a hand is there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.sensor.hand_model import HALF, RARELY, SUSPECTED
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
    """Sources of the joints' torques in a tick."""

    momentum: MomentumObserver  # of all contacts, as there is no flange sensor
    transmission: TransmissionTorque
    deflection: Array  # its torque with the believed stiffness (n,) [N·m]


class PayloadFall:
    """Judges tick by tick, only in free-drive.

    Attributes:
        torque: of a hand (n,) [N·m]; zeros without a hand.
        certain: its part beyond the possible error of each joint (n,) [N·m].
    """

    def __init__(self, arm: Arm, rigid: NewtonEuler, joints: JointTorques, wrench: ExternalWrench) -> None:
        """
        Args:
            arm: gives the numbers of gears and encoders.
            rigid: the controller's rigid model, run with the tick's angles before `update`.
            joints: their update comes earlier in the same tick.
            wrench: has the payload that may fall.
        """
        self._rigid, self._joints, self._wrench, self._most = rigid.record, joints, wrench, arm.payload
        self._record = record(
            stiffness=(),  # largest relative error of the gears' stiffness
            before=(arm.n,),  # tau_ext at entry [N·m]
            entry=(arm.n,),  # load of the gears at entry, by the model [N·m]
            ripple=(arm.n,),  # change of a torque that the encoder's error can make [N·m]
            noise=(),  # sum of its squares [N²·m²]
            q=(arm.n,),  # a tick ago [rad]
            untold=(),  # possible error of the payload's mass [kg]
            momentum=(2, 6),  # P and L of payload, and of 1 kg at its centre, a tick ago, in B
            needed=(2, 6),  # force and moment after the first and the second filter [N, N·m]
            swing=(2, 6),  # the same to accelerate 1 kg at its centre
            hand=(arm.n,),  # part of the change of tau_ext that is a hand's [N·m]
            certain=(arm.n,),  # its part beyond the errors
            latest=(MEAN, 2, arm.n),  # change of tau_ext, and J' p [N·m]
            ticks="i8",  # since the observer and this run
            lasts="i8",  # ticks for which the change has been that of a fall
            fell="?",  # whether the payload fell
            unlike="i8",  # ticks since the change was that of a fall, at most `SEEN`
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

        Outside free-drive, while the flange sensor is used, and while the observer starts, the
        answer
        is: not fallen, nothing felt.

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
    """Whether the payload fell; `comes`: the change looks like a fall that may not be complete yet.

    In the first ticks a step must be far likelier than a hand. As soon as the fall lasts, it must
    only be likelier. Later it is no longer seen how the change came.
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
    """Wrench that the payload needs at the flange, in B, as late as the observer's torques."""
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
    """The change of a momentum, plus the `rest` of the wrench, as late as the torques."""
    before, needed, k = change
    if own.ticks < 2:  # before, there is no speed to compare with
        needed[0, k] = needed[1, k] = rest
    else:
        follow(needed[0], needed[1], (momentum - before[k]) / TICK + rest, k)
    before[k] = momentum
