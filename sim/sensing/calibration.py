"""Honest mismatch: what the controller believes differs from what the arm is, by an error drawn from the seed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.arm.chain import Body, Chain
from sim.arm.joint_constants import JointConstants

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Calibration(JointConstants):
    """Errors of one arm, n joints. Factors are the controller's constant over the arm's; the rest is in the sensors."""

    link_mass: Array  # (n,)
    link_centre: Array  # (n, 3) [m]
    ripple: Array  # (n, 2) amplitude [rad] of the output encoder's first and second harmonic
    ripple_phase: Array  # (n, 2) [rad]
    wrench_gain: Array  # (6, 6) true wrench to measured wrench
    wrench_offset: Array  # (6,) zero error of the cold flange sensor [N, N·m]
    wrench_warm: Array  # (6,) zero error when it is warm [N, N·m]; of use only where the arm's file has a drift


def nominal(arm: Arm) -> Calibration:
    """No error at all."""
    one, zero = np.ones(arm.n), np.zeros(6)
    flat = np.zeros((arm.n, 2))
    return Calibration(one, one, one, one, np.zeros((arm.n, 3)), flat, flat, np.eye(6), zero, zero)


def draw(arm: Arm, rng: np.random.Generator, times: float = 1.0) -> Calibration:
    """An arm's errors, each uniform within so many `times` the bound that the arm's file states."""
    n, stated = arm.n, arm.accuracy

    def factor(bound: float) -> Array:
        return 1.0 + times * bound * rng.uniform(-1.0, 1.0, n)

    scale = times * np.array([stated.force_offset] * 3 + [stated.torque_offset] * 3)
    gain = np.diag(1.0 + times * stated.wrench_gain * rng.uniform(-1.0, 1.0, 6))
    # Cross-talk is relative to the ranges: a full force shows as so much of a full torque.
    force_torque = arm.sensors.force_torque
    drift = None if force_torque is None else force_torque.drift
    warm = np.zeros(6) if drift is None else times * np.array([drift.force] * 3 + [drift.torque] * 3)
    full = np.ones(6) if force_torque is None else np.array([force_torque.force.range] * 3 + [force_torque.torque.range] * 3)
    cross = times * stated.wrench_cross_talk * rng.uniform(-1.0, 1.0, (6, 6)) * full[:, None] / full[None, :] / 5.0
    np.fill_diagonal(cross, 0.0)
    split = rng.uniform(0.0, 1.0, n)
    amplitude = times * arm.sensors.encoders.ripple * np.stack([split, 1.0 - split], axis=1)
    return Calibration(
        motor_constant=factor(stated.motor_constant),
        stiffness=factor(stated.stiffness),
        rotor_inertia=factor(stated.rotor_inertia),
        link_mass=factor(stated.link_mass),
        link_centre=times * rng.uniform(-stated.link_centre, stated.link_centre, (n, 3)),
        ripple=amplitude,
        ripple_phase=rng.uniform(0.0, 2.0 * np.pi, (n, 2)),
        wrench_gain=gain + cross,
        wrench_offset=scale * rng.uniform(-1.0, 1.0, 6),
        wrench_warm=warm * rng.uniform(-1.0, 1.0, 6),
    )


def believed(chain: Chain, calibration: Calibration) -> tuple[Body, ...]:
    """The links as the controller believes them to be."""
    return tuple(
        Body(link.mass * factor, link.com + shift, link.inertia * factor)
        for link, factor, shift in zip(chain.links, calibration.link_mass, calibration.link_centre, strict=True)
    )
