"""Honest mismatch: what the controller believes differs from what the arm is, by an error drawn from the seed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm, Transmissions
from sim.arm.chain import Body, Chain

Array = NDArray[np.float64]

MOTOR_CONSTANT = 0.03
STIFFNESS = 0.20
ROTOR_INERTIA = 0.10
LINK_MASS = 0.02
LINK_CENTRE = 0.003  # each axis [m]
ENCODER_RIPPLE = 1e-4  # [rad]
WRENCH_GAIN = 0.01
WRENCH_CROSS_TALK = 0.01  # of a channel's range, into every other channel
FORCE_OFFSET, TORQUE_OFFSET = 4.0, 0.3  # [N], [N·m]


@dataclass(frozen=True, slots=True)
class Calibration:
    """Errors of one arm, n joints. Factors are the controller's constant over the arm's; the rest is in the sensors."""

    motor_constant: Array  # (n,)
    stiffness: Array  # (n,)
    rotor_inertia: Array  # (n,)
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


def draw(arm: Arm, rng: np.random.Generator) -> Calibration:
    """An arm's errors, each uniform within its bound."""
    n = arm.n

    def factor(bound: float) -> Array:
        return 1.0 + bound * rng.uniform(-1.0, 1.0, n)

    scale = np.array([FORCE_OFFSET] * 3 + [TORQUE_OFFSET] * 3)
    gain = np.diag(1.0 + WRENCH_GAIN * rng.uniform(-1.0, 1.0, 6))
    # Cross-talk is relative to the ranges: a full force shows as so much of a full torque.
    force_torque = arm.sensors.force_torque
    drift = None if force_torque is None else force_torque.drift
    warm = np.zeros(6) if drift is None else np.array([drift.force] * 3 + [drift.torque] * 3)
    full = np.ones(6) if force_torque is None else np.array([force_torque.force.range] * 3 + [force_torque.torque.range] * 3)
    cross = WRENCH_CROSS_TALK * rng.uniform(-1.0, 1.0, (6, 6)) * full[:, None] / full[None, :] / 5.0
    np.fill_diagonal(cross, 0.0)
    split = rng.uniform(0.0, 1.0, n)
    amplitude = ENCODER_RIPPLE * np.stack([split, 1.0 - split], axis=1)
    return Calibration(
        motor_constant=factor(MOTOR_CONSTANT),
        stiffness=factor(STIFFNESS),
        rotor_inertia=factor(ROTOR_INERTIA),
        link_mass=factor(LINK_MASS),
        link_centre=rng.uniform(-LINK_CENTRE, LINK_CENTRE, (n, 3)),
        ripple=amplitude,
        ripple_phase=rng.uniform(0.0, 2.0 * np.pi, (n, 2)),
        wrench_gain=gain + cross,
        wrench_offset=scale * rng.uniform(-1.0, 1.0, 6),
        wrench_warm=warm * rng.uniform(-1.0, 1.0, 6),
    )


def ripple_torque(springs: Transmissions) -> Array:
    """What the ripple of each joint's output encoder makes of a torque that comes from the deflection (n,), at most [N·m]."""
    return ENCODER_RIPPLE * (np.array(springs.stiffness) + np.array(springs.hysteresis_stiffness))


def believed(chain: Chain, calibration: Calibration) -> tuple[Body, ...]:
    """The links as the controller believes them to be."""
    return tuple(
        Body(link.mass * factor, link.com + shift, link.inertia * factor)
        for link, factor, shift in zip(chain.links, calibration.link_mass, calibration.link_centre, strict=True)
    )
