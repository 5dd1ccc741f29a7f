"""A hand on a link, which the flange sensor does not feel: what the joints feel of it in free-drive, beyond their errors (FD-19).

The momentum observer tells the torques of contacts behind the sensor. What gears, encoders and the sensor's zero put into them is
a sum of known causes with shares that are known so well as was learned (`sim.estimation.torque_errors`). Since free-drive began
the torque of a joint has changed by

    change = hand + sum of shares x change of causes + sum of zero's change x its levers + what the model leaves,

so its error has the variance of these shares with the change of their causes, of the zero's walk since entry, and of the rest. A
hand is there where a joint's change is more than `CONTACT` deviations of that. Its force is made of what is beyond alone: that
error stays what it is for as long as the arm is there, and would lead it. What was felt at entry is no hand's.

Far from there little of that force is left. But a hand comes faster than the arm's posture changes: a change against what was
felt lately, while nothing was a hand's, is told in the same way, and makes a force as a whole, of the joints that feel it for
sure. An arm at rest is followed, too, as long as the change since entry may be errors: so a hand that comes too slowly to be seen
is forgotten once it has gone. But what was felt lately may have been a hand that rested on the arm, and would seem to pull the
other way once it has gone. So a change is a hand's only if it is one against what was felt before, too, which follows so slowly
that no hand holds still for as long.

Yet a hand that holds the arm in its pauses, for seconds, is in both. Once it has let go, both tell its torque the other way
round, as that of a new hand, which would be helped as a whole. So the longer a joint may have been held, the less of a change is
certain: at last only what no error explains.

On an arm that stands for longer, gears, friction and posture change nothing: within a second the torques keep within some
hundredths of a newton metre. So whoever touches a link is told by a far smaller change. As soon as a joint moves its friction is
another one, so nothing helps a motion that follows. But a joint whose torque changed by more than what the model leaves on a
moving arm was touched: what it feels is the hand's for a while, and pays for the motion.

What was felt lately tells better than entry. What a joint felt of a hand a moment ago may still be one's that turns round: it is
believed whichever of both says that it leads the arm.
"""

import numpy as np
from numpy.typing import NDArray

from pendant.sensor.hand_model import LASTS, STEADY
from pendant.settings.schema import ticks
from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.joint_tracking import unheld
from sim.estimation.momentum_observer import MomentumObserver
from sim.estimation.torque_errors import CAUSES, FOLLOW, ZERO, beyond, left_over, noise
from sim.estimation.transmission_torque import CONTACT
from sim.flange.flange_forces import best_force
from sim.motion.references import STANDING
from sim.rigid_body.newton_euler import NewtonEuler

Array = NDArray[np.float64]

ENTRY, LATELY, BEFORE = range(3)

LONG = ticks(STEADY)
"""Ticks of the time constant with which what was felt before follows."""

SETTLED = round(1.0 / FOLLOW)
"""Ticks after which an arm has stood for long enough: the time constant of what was felt lately."""


class LinkHand:
    """One tick at a time, in free-drive with the flange sensor.

    Attributes:
        torque: of a hand on a link (n,) [N·m]; zeros where errors may be all that is felt, and was lately.
        certain: what of it a hand makes for certain in this tick (n,) [N·m]: of a change against what was felt lately the whole,
            or what no error explains if a hand may have been felt then; of the change since entry what no error explains.
        force: the force (3,) at the flange, in B, that would make these torques best [N].
        touch: the same of what the joints of a standing arm feel, beside what they felt lately [N].

    Args:
        arm: its number of joints.
        rigid: the controller's rigid model, which has been run in the tick before `update`.
        momentum: updated in the same tick before.
    """

    def __init__(self, arm: Arm, rigid: NewtonEuler, momentum: MomentumObserver) -> None:
        self._rigid, self._momentum = rigid.record, momentum
        self._known = momentum.record, momentum.errors.record
        self._record = record(
            felt=(3, arm.n, 1 + CAUSES),  # torque and causes, smoothed, at entry, lately and before
            bias=(3, ZERO),  # of the flange sensor then, axes of F [N, N·m]
            ticks="3i8",  # since then
            lasts=f"{arm.n}i8",  # ticks for which who was felt by a joint may be there still
            left=(3, arm.n),  # what errors do not explain as far as they are known, against each of these [N·m]
            sure=(3, arm.n),  # what of it they do not explain at all
            held=(arm.n,),  # share of what was felt before in which who is felt by a joint may have been there
            torque=(arm.n,),
            certain=(arm.n,),
            force=(3,),
            stood="i8",  # ticks, at most `SETTLED`
            rest=(arm.n,),  # torque that a standing arm felt lately [N·m]
            touch=(3,),
        )
        own = self._own = self._record[0]
        self.torque, self.force, self.certain, self.touch = own["torque"], own["force"], own["certain"], own["touch"]

    def forget(self) -> None:
        """Free-drive is to begin, or the sensor is out: nothing is felt."""
        self._own["ticks"], self._own["lasts"], self._own["stood"] = 0, 0, 0
        self.torque[:], self.certain[:], self.force[:], self.touch[:], self._own["held"] = 0.0, 0.0, 0.0, 0.0, 0.0

    def update(self, bias: tuple[float, ...], qd: Array, by_deflection: NDArray[np.bool_]) -> None:
        """One tick.

        Args:
            bias: of the flange sensor (6,), axes of F [N, N·m].
            qd: joint speeds (n,) [rad/s].
            by_deflection: whose torque comes from the deflection (n,); else from the motor.
        """
        if self._momentum.ready:
            _update(self._record, self._known, self._rigid, (bias, qd, by_deflection))
        else:
            self.forget()


@kernel
def _update(memory, known, model, told) -> None:
    own, errors, jacobian = memory[0], known[1][0], model[0].jacobian
    bias, qd, by_deflection = told
    if own.ticks[0] == 0:
        own.felt[:] = errors.felt
        for when in range(3):
            _keep(own, bias, when)
    own.ticks += 1
    own.ticks[BEFORE] = min(own.ticks[BEFORE], LONG)
    away = _feel(own, known, (bias, by_deflection), ENTRY)
    changed = _feel(own, known, (bias, by_deflection), LATELY) and _feel(own, known, (bias, by_deflection), BEFORE)
    lately, stands = False, True
    for i in range(qd.size):
        new = changed and own.sure[LATELY, i] != 0.0 and own.sure[BEFORE, i] != 0.0
        own.certain[i] = _certain(own, i) if new else 0.0
        lately = lately or new
        own.lasts[i] = LASTS if new or own.sure[ENTRY, i] != 0.0 else max(own.lasts[i] - 1, 0)
        if own.lasts[i] == 0:
            own.left[ENTRY, i] = own.left[LATELY, i] = 0.0
        stands = stands and abs(qd[i]) < STANDING
    if not away:
        _follow(own.felt[BEFORE], errors.felt, 1.0 / LONG)
        for k in range(ZERO):
            own.bias[BEFORE, k] += (bias[k] - own.bias[BEFORE, k]) / LONG
        for i in range(qd.size):
            own.held[i] += ((1.0 if own.lasts[i] > 0 else 0.0) - own.held[i]) / LONG
        if stands or not lately:
            _follow(own.felt[LATELY], errors.felt, FOLLOW)
            _keep(own, bias, LATELY)
    by_entry = not lately and (away or _power(own.left[ENTRY], qd) > _power(own.left[LATELY], qd))
    own.torque[:] = own.left[ENTRY if by_entry else LATELY]
    if not lately:
        own.certain[:] = own.sure[ENTRY]
    if lately:
        best_force(jacobian, own.torque, own.force)
    elif away:
        best_force(jacobian, own.sure[ENTRY], own.force)
    else:
        own.force[:] = 0.0
    _touch(own, jacobian, (errors.felt, known[0][0].floor), (by_deflection, stands))


@kernel
def _certain(own, i) -> float:
    """What of a joint's change a hand makes for certain [N·m]: the whole; if it may have been held what no error explains."""
    whole = own.left[LATELY, i]
    least = min(abs(own.sure[LATELY, i]), abs(own.sure[BEFORE, i]))
    return np.copysign(abs(whole) - own.held[i] * (abs(whole) - least), whole)


@kernel
def _touch(own, jacobian, known, told) -> None:
    """Who touches an arm that stands; a joint whose torque comes from the motor does not tell, its friction may bear as much."""
    felt, floor = known
    by_deflection, stands = told
    own.stood = min(own.stood + 1, SETTLED) if stands else 0
    change = np.zeros(own.rest.size)
    for i in range(change.size):
        if own.stood < SETTLED or not by_deflection[i]:
            own.rest[i] = felt[i, 0]
        change[i] = felt[i, 0] - own.rest[i]
        own.rest[i] += FOLLOW * change[i]
        if abs(change[i]) > floor[i]:
            own.lasts[i] = LASTS
    best_force(jacobian, change, own.touch)


@kernel
def _keep(own, bias, when) -> None:
    own.ticks[when] = 0
    for k in range(ZERO):
        own.bias[when, k] = bias[k]


@kernel
def _follow(felt, now, share) -> None:
    for i in range(felt.shape[0]):
        for k in range(felt.shape[1]):
            felt[i, k] += share * (now[i, k] - felt[i, k])


@kernel
def powers(qd, tau_hand, tau_certain, friction) -> tuple[float, float, float]:
    """Power of a hand, what of it is certain, and what friction takes [W]: of (n,) [rad/s, N·m]."""
    return _power(tau_hand, qd), _power(tau_certain, qd), _power(friction, qd)


@kernel
def _power(torque, qd):
    power = 0.0
    for i in range(qd.size):
        power += torque[i] * qd[i]
    return power


@kernel
def _feel(own, known, told, when) -> bool:
    """Whether a hand is felt against what was felt then: what is `left` of the change, and what of that is `sure`."""
    momentum, errors, felt = known[0][0], known[1][0], own.felt[when]
    bias, by_deflection = told
    found, change, drifts, walked = False, np.empty(1 + CAUSES), np.empty(ZERO), np.empty(ZERO)
    for k in range(ZERO):
        drifts[k] = bias[k] - own.bias[when, k]  # the sensor tells the opposite of its bias
        walked[k] = min(errors.walk[k] * own.ticks[when], errors.most[k] ** 2 / 3.0)
    for i in range(own.torque.size):
        for k in range(1 + CAUSES):
            change[k] = errors.felt[i, k] - felt[i, k]
        rest = noise(errors, momentum.doubt[i], change[1])
        if not by_deflection[i]:
            rest += (errors.motor_constant * change[1]) ** 2
        for k in range(ZERO):
            lever = errors.felt[i, 2 + k]
            change[0] += drifts[k] * lever
            rest += lever * lever * walked[k]
        own.left[when, i] = left = left_over(errors.shares[i], change[0], change[1:])
        sure = unheld(left, 2.0 * momentum.held[i])  # it may have held as much the other way then
        own.sure[when, i] = beyond(errors, i, (sure, change[1:]), (rest, CONTACT))
        found = found or own.sure[when, i] != 0.0
    return found
