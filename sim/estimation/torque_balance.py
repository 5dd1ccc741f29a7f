"""Friction and transmission torque of the joints, a tick in the order in which they need each other (AF-2, AF-3).

At rest the difference between these torques and the rigid model's gives the payload's error,
without a flange sensor (FD-9).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.estimation.adaptive_friction import rub
from sim.estimation.joint_tracking import sides, surplus
from sim.estimation.transmission_torque import SETTLE_TICKS, fuse, weighed
from sim.rigid_body.newton_euler import cross, turned

Bools = NDArray[np.bool_]


NOT_TOLD = (0.0, math.inf)
"""Error of a payload if nothing is known of it, and its standard deviation [kg]."""


class Known(NamedTuple):
    """What is known in a tick, of n joints."""

    ways: Bools  # (3, n) which of `transmission_torque.WAYS` may be used
    able: Bools  # (3, n) whether motor angle, output angle and current are measured
    by_deflection: Bools  # (n,) joints whose friction comes from the deflection


class Learns(NamedTuple):
    """What may be learned in a tick."""

    gears: bool  # errors of the deflection: planned motion moves the arm
    friction: bool  # friction: the same, and friction is adaptive


@kernel
def balance(records, given, known, learns) -> bool:
    """One kernel, because calling four takes longer than their work.

    Args:
        records: of `joint_tracking` after `follow`, `AdaptiveFriction`, `TransmissionTorque`.
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
    touched = gears.free < SETTLE_TICKS
    felt = False  # some joint is touched, and its friction comes from the model, which has no touch
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
    rubbing = friction[0].deviation, own.stiction, friction[0].total, own.theta[2]
    fuse(transmission, rubbing, known.ways, moving and learns.gears)
    return moving


@kernel
def payload_levers(model, wrenches) -> NDArray[np.float64]:
    """Joint torques at rest (n,) [N·m] that carry 1 kg at the payload's centre; args: `missing_mass`."""
    rigid = model[0]
    weight = (-rigid.gravity[0], -rigid.gravity[1], -rigid.gravity[2])
    turn = cross(turned(rigid.R, wrenches[0].com), weight)
    levers = np.zeros(rigid.jacobian.shape[1])
    for i in range(levers.size):
        for k in range(3):
            levers[i] += rigid.jacobian[k, i] * weight[k] + rigid.jacobian[3 + k, i] * turn[k]
    return levers


@kernel
def missing_mass(transmission, model, wrenches, use) -> tuple[float, float]:
    """Payload's mass minus the configured one, by the joints at rest, and its deviation [kg].

    A mass m at the payload's centre needs the torque m b_i of joint i. Gears and motors bear r_i
    more than the rigid model. The variance s_i² of r_i is that of both; it falls as the gears are
    learned. The likeliest m is

        m = sum of b_i r_i / s_i²  /  sum of b_i² / s_i².

    Args:
        transmission: `TransmissionTorque.record`, after the tick's balance.
        model: the rigid model's recursion, run in this tick.
        wrenches: record of `sim.flange.external_wrench`, with the payload as configured.
        use: which of `transmission_torque.WAYS` may be used, for each joint (3, n).
    """
    own, levers = transmission[0], payload_levers(model, wrenches)
    told = certain = 0.0
    for i in range(levers.size):
        weight, bears = weighed(own, use, i, 1)
        if use[0, i] and weight > 0.0:
            variance = 1.0 / weight + own.model[i] ** 2
            told += levers[i] * (bears / weight - own.ways[0, i]) / variance
            certain += levers[i] ** 2 / variance
    return (told / certain, 1.0 / math.sqrt(certain)) if certain > 0.0 else NOT_TOLD
