"""Friction and transmission torque of the joints, one tick in one order: what one module learns the other needs (AF-2, AF-3).

What they leave of the rigid model's torques on an arm that rests tells the payload's error without a flange sensor (FD-9).
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
"""A payload's error of which nothing is known, and its standard deviation [kg]."""


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
    felt = False  # by a joint whose friction comes from the model, which bears no touch
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
    """What 1 kg at the payload's centre takes of each joint at rest (n,) [N·m]; as `missing_mass`."""
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
    """What the payload weighs beyond what is configured, as the joints of a resting arm tell it, and its standard deviation [kg].

    A mass m at the payload's centre takes of joint i the torque m b_i. What gears and motors bear beyond the rigid model, r_i,
    has the variance s_i² of both, which falls as the gears are learned. Of all m, the likeliest is

        m = sum of b_i r_i / s_i²  /  sum of b_i² / s_i².

    Args:
        transmission: `TransmissionTorque.record`, after the tick's balance.
        model: the rigid model's recursion, run in this tick.
        wrenches: record of `sim.flange.external_wrench`, with the payload as configured.
        use: which of `transmission_torque.WAYS` may be used, of which joint (3, n).
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
