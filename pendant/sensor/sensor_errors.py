"""What the flange sensor's mean over a window may be off by, beside its bias: noise, and gain where the load turns."""

import math

from pendant.limits.validity import WINDOW
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.pose import Vector, flat, turned_back

FALSE_ALARM = 5.0
"""Standard deviations of a window's mean that noise may add: three axes together exceed it once in 65,000 windows."""

CENTRE = 0.01
"""So far at most is a load's centre from where it was told to be [m]: bench `payload` draws it so."""

LEVER = 0.2
"""A load's centre lies within so much of the flange: a gain error of its weight seems a torque of at most so much [m]."""


def window_noise(sensor: SensorSpec, estimate: Estimate) -> float:
    """Standard deviation of a window's mean force, each axis [N]."""
    return math.hypot(sensor.noise_force, sensor.noise_acceleration * estimate.load_mass) / math.sqrt(WINDOW)


def noise_error(sensor: SensorSpec, estimate: Estimate) -> float:
    """Of a window's mean force at most, by noise, in all axes together [N]."""
    return FALSE_ALARM * window_noise(sensor, estimate)


def load_weight(estimate: Estimate) -> Vector:
    """Of the configured load, axes of F [N]."""
    g, mass = estimate.g_B.tolist(), estimate.load_mass
    x, y, z = turned_back(flat(estimate.R_BF), (g[0], g[1], g[2]))
    return mass * x, mass * y, mass * z


def gain_error(sensor: SensorSpec, estimate: Estimate, before: Vector) -> float:
    """Of the load's weight, since it was `before` [N]: in axes of F."""
    return sensor.gain * math.dist(load_weight(estimate), before)


def window_error(sensor: SensorSpec, estimate: Estimate, before: Vector) -> float:
    """Of a window's mean force at most, since the load's weight was `before` [N]: gain, and noise in all axes together."""
    return gain_error(sensor, estimate, before) + noise_error(sensor, estimate)
