"""Friction and transmission torque of the joints, one tick in one order: what one module learns the other needs (AF-2, AF-3)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.estimation.adaptive_friction import rub
from sim.estimation.joint_tracking import sides, surplus
from sim.estimation.transmission_torque import SETTLE_TICKS, fuse

Bools = NDArray[np.bool_]


class Known(NamedTuple):
    """What is known in a tick, of n joints."""

    ways: Bools  # (3, n) which of `transmission_torque.WAYS` may be used
    able: Bools  # (3, n) whether motor angle, output angle and current are measured
    by_deflection: Bools  # (n,) whose friction is obtained from the deflection


class Learns(NamedTuple):
    """What may be learned in a tick."""

    gears: bool  # what the deflection is wrong by: planned motion moves the arm
    friction: bool  # the same, and friction is adaptive


@kernel
def balance(records, given, known, learns) -> bool:
    """One kernel: to call four takes longer than all that they do.

    Args:
        records: of `joint_tracking`, after `follow`; of `AdaptiveFriction`; of `TransmissionTorque`.
        given: torques of the rigid model (n,) [N·m], and temperatures as measured (n,) [°C].
        known: as `Known`.
        learns: as `Learns`.

    Returns:
        Whether any joint moves.
    """
    known, learns = Known(*known), Learns(*learns)
    joints, friction, transmission = records
    tau_dyn, temperature = given
    own, gears = joints[0], transmission[0]
    n = tau_dyn.size
    surplus(joints, tau_dyn, friction, transmission)
    spent, borne = np.empty(n), np.empty(n)
    touched = gears.quiet < SETTLE_TICKS
    felt = False  # by a joint whose friction is obtained from the model, which does not bear what touches the arm
    for i in range(n):
        if not (known.able[0, i] and known.able[2, i]):
            own.surplus[i] = np.nan
        spent[i], borne[i] = own.surplus[i], tau_dyn[i]
        if known.by_deflection[i]:
            spent[i], borne[i] = own.rubbing[i], own.bending[i]
        felt = felt or (touched and not known.by_deflection[i])
    rub(friction, (own.theta[1], spent, borne, gears.fused), temperature, learns.friction and not felt)
    gears.ways[1] = own.deflection
    moving = sides(joints, tau_dyn, friction, transmission)
    fuse(transmission, (friction[0].deviation, own.stiction, own.theta[2]), known.ways, moving and learns.gears)
    return moving
