"""Tracking of joint angles: speeds and accelerations, and the torques of motor and spring (AF-3)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Encoders
from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record
from sim.estimation.adaptive_friction import GATE
from sim.motion.moves import Reference

Array = NDArray[np.float64]

SPEED_BANDWIDTH = 100.0  # of the motor angle's tracking filter [Hz]: above the arm's motion, below the encoders' noise
TORQUE_BANDWIDTH = 20.0  # of the output angle's filter; its accelerations enter torque estimates [Hz]
SPEED_NOISE = 0.002
"""Standard deviation of a joint's speed that the noise of its output encoder may make [rad/s]: a fifth of `static.speed`, so that
an arm that stands is seen to stand."""


def tracking_gains(bandwidth: float) -> tuple[float, float, float]:
    """Gains alpha, beta [1/s], gamma [1/s²] of a third-order tracking filter with one triple pole at `bandwidth` [Hz].

    Source: the fading-memory filter of order two (alpha-beta-gamma filter), pole r = exp(-2 pi f T):
    alpha = 1 - r³, beta = 1.5 (1 - r²)(1 - r) / T, gamma = (1 - r)³ / T².
    """
    r = math.exp(-2.0 * math.pi * bandwidth * TICK)
    return 1.0 - r**3, 1.5 * (1.0 - r * r) * (1.0 - r) / TICK, (1.0 - r) ** 3 / (TICK * TICK)


def noise_gains(bandwidth: float) -> tuple[float, float]:
    """Standard deviations of a tracked angle [rad] and of its speed [rad/s] for white noise of 1 rad a tick in the measurement.

    Source: variance reduction of the fading-memory filter of order two (Morrison, Introduction to Sequential Smoothing and
    Prediction, 1969), with the pole r of `tracking_gains`:
    (1 - r)(1 + 6 r + 16 r² + 24 r³ + 19 r⁴) / (1 + r)⁵ and (1 - r)³(13 + 50 r + 49 r²) / (2 T²(1 + r)⁵).
    """
    r = math.exp(-2.0 * math.pi * bandwidth * TICK)
    angle = (1.0 - r) * (1.0 + r * (6.0 + r * (16.0 + r * (24.0 + 19.0 * r)))) / (1.0 + r) ** 5
    speed = (1.0 - r) ** 3 * (13.0 + r * (50.0 + 49.0 * r)) / (2.0 * TICK * TICK * (1.0 + r) ** 5)
    return math.sqrt(angle), math.sqrt(speed)


def angle_noise(encoders: Encoders) -> float:
    """Standard deviation of an output angle as it is read: noise and the rounding to counts [rad]."""
    return 2.0 * math.pi / encoders.output_counts * math.sqrt(encoders.noise_counts**2 + 1.0 / 12.0)


def deflection_rate(encoders: Encoders) -> float:
    """How fast a measured deflection is taken [1/s] where the output encoder is too coarse to tell a speed; 0: it is not.

    Such a joint's speed is that of its motor, whose encoder counts a gear's ratio more in a turn, and the output encoder tells
    what the gear bends. So the angle that is tracked is theta - x, with the deflection theta - q in a low-pass of this rate w:
    the encoder's share in it is its noise, sigma, times w / (s + w), and in its speed sigma·w times the filter's gain for angles.
    """
    sigma = angle_noise(encoders)
    of_angle, of_speed = noise_gains(TORQUE_BANDWIDTH)
    return 0.0 if sigma * of_speed <= SPEED_NOISE else SPEED_NOISE / (sigma * of_angle)


class Angles(NamedTuple):
    """Encoder values and motor currents of a tick, n joints."""

    theta: Array  # referred to the output [rad]
    q: Array  # [rad]
    current: Array  # [A]


def joint_record(n: int) -> Record:
    """Record of n joints: their constants, their state, and the torques of a tick; all still zero."""
    return record(
        torque_constant=(n,),  # of the current, referred to the output [N·m/A]
        stiffness=(n,),
        stiffening=(n,),
        damping=(n,),
        slip_stiffness=(n,),
        slip_yield=(n,),
        rotor=(n,),
        gains=(2, 3),  # of the filters of motor and output angle
        theta=(3, n),  # position, speed, acceleration
        q=(3, n),
        rest=(n,),  # deflection at which the hysteresis spring is relaxed
        most=(n,),  # largest current of a motor [A]
        current=(n,),  # measured current, divided by the largest
        spin=(),  # kinetic energy of the rotors [J]
        tau_m=(n,),
        deflection=(n,),  # torque that the deflection bears
        surplus=(n,),
        bending=(n,),  # torque that the deflection bears, with what was learned of the spring
        rubbing=(n,),  # friction of both sides, found from the deflection
        stiction=(n,),
    )


@kernel
def surplus(joints, tau_dyn, friction, transmission) -> None:
    """Compute `surplus` and `rubbing` of each joint (AF-2).

    `surplus` is the motor torque, minus the rotor's inertia, minus the rigid model. `rubbing` is the friction of both sides,
    found from the deflection: the gear bends under everything behind it, contacts included. So the rest of the motor torque is
    friction of the input side.
    """
    own, rubs, springs = joints[0], friction[0], transmission[0]
    for i in range(own.surplus.size):
        driving = own.tau_m[i] - own.rotor[i] * own.theta[2, i]
        own.surplus[i] = driving - tau_dyn[i]
        own.bending[i] = own.deflection[i] * (1.0 + springs.stiffer[i]) + springs.offset[i]
        own.rubbing[i] = (driving - own.bending[i]) / (1.0 - rubs.output_share)


@kernel
def sides(joints, tau_dyn, friction, transmission) -> bool:
    """Compute the transmission torque from links and from motors, and what stiction may hold. Returns whether a joint moves."""
    own, rubs, ways = joints[0], friction[0], transmission[0].ways
    share, total = rubs.output_share, rubs.total
    moving = False
    for i in range(own.stiction.size):
        ways[0, i] = tau_dyn[i] + share * total[i]
        ways[2, i] = own.surplus[i] + tau_dyn[i] - (1.0 - share) * total[i]
        stands = abs(own.theta[1, i]) < GATE
        own.stiction[i] = rubs.terms[i, 0] * rubs.warmth[i] if stands else 0.0
        moving = moving or not stands
    return moving


@kernel
def plan(joints, before, now) -> None:
    """Add to both states the difference between the plan and constant acceleration in this tick."""
    before = Reference(*before)
    now = Reference(*now)
    theta, q = joints[0].theta, joints[0].q
    for i in range(before.q.size):
        jump = now.qdd[i] - before.qdd[i]
        gain = now.qd[i] - before.qd[i] - TICK * before.qdd[i]
        way = now.q[i] - before.q[i] - TICK * before.qd[i] - 0.5 * TICK * TICK * before.qdd[i]
        # The filters' next prediction must arrive at the plan. It adds the products with TICK itself, so they are taken off here.
        theta[2, i] += jump
        theta[1, i] += gain - TICK * jump
        theta[0, i] += way - TICK * gain + 0.5 * TICK * TICK * jump
        q[2, i] += jump
        q[1, i] += gain - TICK * jump
        q[0, i] += way - TICK * gain + 0.5 * TICK * TICK * jump


@kernel
def _track(measured, gains, state, i) -> None:
    alpha, beta, gamma = gains[0], gains[1], gains[2]
    coasting = state[1, i] + TICK * state[2, i]
    predicted = state[0, i] + TICK * state[1, i] + 0.5 * TICK * TICK * state[2, i]
    error = measured - predicted
    state[0, i] = predicted + alpha * error
    state[1, i] = coasting + beta * error
    state[2, i] += gamma * error


@kernel
def follow(joints, angles) -> None:
    """Track both angles; motor torque from the current, transmission torque from the deflection (AF-3).

    The transmission is a stiffening spring, in parallel with a spring that slips at its yield: the hysteresis.
    """
    angles = Angles(*angles)
    own = joints[0]
    theta, q, rest = own.theta, own.q, own.rest
    own.spin = 0.0
    for i in range(rest.size):
        _track(angles.theta[i], own.gains[0], theta, i)
        own.spin += 0.5 * own.rotor[i] * theta[1, i] * theta[1, i]
        _track(angles.q[i], own.gains[1], q, i)
        own.tau_m[i] = own.torque_constant[i] * angles.current[i]
        own.current[i] = angles.current[i] / own.most[i]
        x = angles.theta[i] - angles.q[i]
        rest[i] = min(max(rest[i], x - own.slip_yield[i]), x + own.slip_yield[i])
        slip = own.slip_stiffness[i] * (x - rest[i])
        main = x * (own.stiffness[i] + own.stiffening[i] * x * x)
        own.deflection[i] = main + own.damping[i] * (theta[1, i] - q[1, i]) + slip


@kernel
def unheld(torque, held):
    """The part of a torque beyond `held`, the most that friction at rest holds in either direction [N·m]."""
    return np.copysign(max(abs(torque) - held, 0.0), torque)
