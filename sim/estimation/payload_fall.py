"""Whether the payload fell, or a hand is there, as the joints alone tell it: for free-drive without a flange sensor (FD-19).

An arm goes on bearing a payload that it has lost. With the wrench p that this payload would need in the flange's motion, and the
flange's Jacobian J, the joints then feel

    tau_ext = tau_ext at entry + J' p.

A hand makes these torques, too, if it pushes upward as hard as the payload weighs, and harder the faster the arm rises. Gears
tell torques as well as their stiffness is known; so the payload fell where all but that share of the change is as J' p says, for
as long as a fall is looked at elsewhere. A swinging link needs a torque that its gear shows at once and its acceleration later:
what gears bear is delayed as much as accelerations are.

Most of the time what is felt is neither, and the question is who may move the arm. What a joint tells since entry is wrong by no
more than the ripple of its encoder, and by the share that its stiffness is not known of what its gear bears more or less:

    |error| <= ripple + STIFFNESS |model - model at entry|.

Where the motor tells it, without the deflection, an error is larger than RARELY standard deviations once in a thousand times.
Three cases follow. Where the change of every joint is within its error, nothing is felt. Where it differs from J' p by no more
than its error and STIFFNESS |J' p|, the payload may have fallen, unless all of J' p is within the errors, too: a payload that no
joint would miss does not move an arm that its friction holds. Else a hand is there.
"""

import math

import numpy as np
from numpy.typing import NDArray

from pendant.sensor.odds import RARELY
from pendant.tick.estimate import JointsFeel
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.joint_tracking import TORQUE_BANDWIDTH, delayed
from sim.estimation.transmission_torque import DYNAMICS, TransmissionTorque
from sim.flange.external_wrench import ExternalWrench
from sim.flange.flange_forces import needed, turn_both
from sim.flange.wrench_hypotheses import LONGEST
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.calibration import STIFFNESS, ripple_torque

Array = NDArray[np.float64]

NOTHING, FALL, HAND = (int(each) for each in JointsFeel)  # as kernels know them
NOT_ASKED = False, JointsFeel.NOTHING


class PayloadFall:
    """One tick at a time, in free-drive alone."""

    def __init__(self, arm: Arm, dynamics: Dynamics, wrench: ExternalWrench) -> None:
        """
        Args:
            arm: the numbers of its gears and encoders.
            dynamics: the controller's rigid model, whose recursion has been run in the tick before `update`.
            wrench: knows the payload that may fall.
        """
        self._dynamics, self._model, self._wrench = dynamics, dynamics.recursion.record, wrench
        self._record = record(
            before=(arm.n,),  # tau_ext at entry [N·m]
            entry=(arm.n,),  # what the model wants the gears to bear there [N·m]
            borne=(3, arm.n),  # by the gears, delayed
            lag=(),
            ripple=(arm.n,),  # what the encoder alone may change a torque by [N·m]
            noise=(),  # sum of its squares [N²·m²]
            lasts="i8",  # ticks
        )
        own = self._own = self._record[0]
        own["ripple"] = ripple = ripple_torque(arm.transmissions)
        own["noise"] = ripple @ ripple
        own["lag"] = 1.0 - math.exp(-2.0 * math.pi * TORQUE_BANDWIDTH * TICK)
        self._begun = self._blind = False

    def update(
        self, q: Array, motion: Array, transmission: TransmissionTorque, *, free: bool, sensed: bool
    ) -> tuple[bool, JointsFeel]:
        """One tick. Returns whether the payload fell, and what explains the torques of this tick.

        Outside free-drive, and while the flange sensor tells that, it did not, and nothing is felt.

        Args:
            q: joint angles (n,) [rad].
            motion: (3, n), of which rows 1 and 2 count: speed [rad/s] and acceleration [rad/s²].
            transmission: updated in the same tick.
            free: free-drive is on.
            sensed: the flange sensor is valid; once it was not, the joints go on to tell.
        """
        if not free:
            self._begun = False
            return NOT_ASKED
        own = self._own
        if not self._begun:
            self._begun, self._blind, own["lasts"] = True, False, 0
            own["before"], own["entry"] = transmission.external, transmission.ways[DYNAMICS]
        if sensed and not self._blind:
            return NOT_ASKED
        model, external = transmission.ways[DYNAMICS], transmission.external
        if not self._blind:
            self._blind = True
            own["borne"] = model - external
        moved = (*self._dynamics.specific_force(q, motion[1], motion[2]), model, external, transmission.by_motor)
        fell, feels = _update(self._record, self._model, self._wrench.record, moved)
        return fell, JointsFeel(feels)


@kernel
def _update(memory, rigid, wrenches, moved) -> tuple[bool, int]:
    own, payload, R, jacobian, v_F = memory[0], wrenches[0], rigid[0].R, rigid[0].jacobian, rigid[0].v_F
    force, turn, model, external, by_motor = moved
    gyro, wrench = np.empty(3), np.empty(6)
    for k in range(3):
        gyro[k] = R[0, k] * v_F[3] + R[1, k] * v_F[4] + R[2, k] * v_F[5]
    needed((payload.mass, payload.com, payload.inertia), (force, gyro, turn), wrench)
    turn_both(R, wrench, wrench)
    change = left = 0.0
    nothing = falls = unmissed = True
    for i in range(external.size):
        wrong = RARELY * by_motor[i] if by_motor[i] > 0.0 else own.ripple[i] + STIFFNESS * abs(model[i] - own.entry[i])
        felt = model[i] - delayed(own.borne, own.lag, model[i] - external[i], i) - own.before[i]
        change += felt * felt
        lost = 0.0
        for k in range(6):
            lost += jacobian[k, i] * wrench[k]
        left += (felt - lost) * (felt - lost)
        nothing = nothing and abs(felt) <= wrong
        falls = falls and abs(felt - lost) <= wrong + STIFFNESS * abs(lost)
        unmissed = unmissed and abs(lost) <= wrong
    own.lasts = own.lasts + 1 if change > own.noise and left < STIFFNESS**2 * change else 0
    return own.lasts >= LONGEST, NOTHING if nothing else FALL if falls and not unmissed else HAND
