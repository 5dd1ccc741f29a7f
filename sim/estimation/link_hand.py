"""A hand on a link that the flange sensor does not feel, as joints feel it in free-drive (FD-19).

The momentum observer gives the torques of contacts behind the sensor. Gears, encoders and the
sensor's zero add errors to these torques. Each error is a known cause times a share; the share is
learned, with an uncertainty (`sim.estimation.torque_errors`). Since free-drive began the torque of
a joint has changed by

    change = hand + sum of shares x change of causes + sum of zero's change x its levers + rest,

so its error has the variance of these shares times the change of their causes, of the zero's walk
since entry, and of the rest. A joint whose change is more than `CONTACT` deviations of this error
feels a hand. Only the part beyond the error makes the hand's force: the error lasts as long as the
arm stays in that posture, and would push the arm. A torque that was there at entry is not a hand's.

Far from the posture at entry the error is large, and little of the force remains. But a hand comes
faster than the posture changes. So the torque is also compared with a quick reference: the torque
of a short while ago, when no hand was felt. At joints that surely feel such a change, all of the
change counts as force. While the arm rests, and the change since entry may be an error, the quick
reference follows the torque. So a hand that came too slowly to be noticed is forgotten after it has
gone.

But a hand may have rested on the arm. When this hand goes, the change looks like a pull to the
other side. So a change counts as a hand only if there is also a change against a slow reference,
which follows more slowly than any hand can hold still. A hand that holds the arm still for seconds
is nevertheless in both references. When it lets go, both show a torque of the opposite sign, like a
new hand, and the arm would help with all of it. So the longer a joint may have been held, the
smaller is the certain part of a change. In the end it is only the part that no error explains.

On an arm that stands longer, gears, friction and posture do not change: within a second the torques
change by hundredths of a newton metre. So a far smaller change shows a hand on a link. When a joint
begins to move, its friction changes, so this small change gives no help to the motion. But a joint
was touched if its torque changed by more than the model's error on a moving arm. For a while its
torque then counts as the hand's, and explains the motion.

The comparison with the quick reference is more exact than the one with entry. But a hand that was
felt a moment ago may only change its direction. So the comparison is believed in which the hand
drives the arm more.
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

ENTRY, LATELY, BEFORE = range(3)  # references: at entry, quick, slow

LONG = ticks(STEADY)
"""Time constant of the slow reference [ticks]."""

SETTLED = round(1.0 / FOLLOW)
"""Ticks after which an arm has stood long enough: the time constant of the quick reference."""


class LinkHand:
    """One tick at a time, in free-drive with the flange sensor.

    Attributes:
        torque: of a hand on a link (n,) [N·m]; 0 where errors explain all that is felt and was felt
            a moment ago.
        certain: the part of it that is surely a hand's (n,) [N·m]. Of a change against the quick
            reference this is all, or less the longer a hand may have been there before. Of the
            change since entry it is what no error explains.
        force: the force (3,) at the flange, in B, that explains these torques best [N].
        touch: the same for the change of a standing arm's torques from those of a short while ago
            [N].

    Args:
        arm: gives the number of joints.
        rigid: the controller's rigid model, run in the same tick before `update`.
        momentum: its update comes earlier in the same tick.
    """

    def __init__(self, arm: Arm, rigid: NewtonEuler, momentum: MomentumObserver) -> None:
        self._rigid, self._momentum = rigid.record, momentum
        self._known = momentum.record, momentum.errors.record
        self._record = record(
            felt=(3, arm.n, 1 + CAUSES),  # the three references: torque and causes, smoothed
            bias=(3, ZERO),  # of the flange sensor then, axes of F [N, N·m]
            ticks="3i8",  # since each of the references
            lasts=f"{arm.n}i8",  # ticks for which the hand that a joint felt may still be there
            left=(3, arm.n),  # change against each reference, minus the known errors [N·m]
            sure=(3, arm.n),  # the part of it beyond the possible error
            held=(arm.n,),  # share of the slow reference's time in which a hand may have been there
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
        """Free-drive will begin, or the sensor is lost: nothing is felt."""
        self._own["ticks"], self._own["lasts"], self._own["stood"] = 0, 0, 0
        self.torque[:], self.certain[:], self.force[:], self.touch[:], self._own["held"] = 0.0, 0.0, 0.0, 0.0, 0.0

    def update(self, bias: tuple[float, ...], qd: Array, by_deflection: NDArray[np.bool_]) -> None:
        """One tick.

        Args:
            bias: of the flange sensor (6,), axes of F [N, N·m].
            qd: joint speeds (n,) [rad/s].
            by_deflection: joints whose torque comes from the deflection (n,), not from the motor.
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
    """Certain part of a joint's change [N·m]: all; if it may have been held, what no error explains."""
    whole = own.left[LATELY, i]
    least = min(abs(own.sure[LATELY, i]), abs(own.sure[BEFORE, i]))
    return np.copysign(abs(whole) - own.held[i] * (abs(whole) - least), whole)


@kernel
def _touch(own, jacobian, known, told) -> None:
    """Touch of a standing arm. A torque from the motor does not count: friction may be as large."""
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
    """Power [W] of a hand, its certain part, and the power of friction, from (n,) [rad/s, N·m]."""
    return _power(tau_hand, qd), _power(tau_certain, qd), _power(friction, qd)


@kernel
def _power(torque, qd):
    power = 0.0
    for i in range(qd.size):
        power += torque[i] * qd[i]
    return power


@kernel
def _feel(own, known, told, when) -> bool:
    """Compute `left` and `sure` of the change against a reference. Returns whether a hand is felt."""
    momentum, errors, felt = known[0][0], known[1][0], own.felt[when]
    bias, by_deflection = told
    found, change, drifts, walked = False, np.empty(1 + CAUSES), np.empty(ZERO), np.empty(ZERO)
    for k in range(ZERO):
        drifts[k] = bias[k] - own.bias[when, k]  # the torques contain the opposite of the bias
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
        sure = unheld(left, 2.0 * momentum.held[i])  # friction may have held as much the other way
        own.sure[when, i] = beyond(errors, i, (sure, change[1:]), (rest, CONTACT))
        found = found or own.sure[when, i] != 0.0
    return found
