"""Largest error of the flange sensor's mean over a window, beside its bias: by noise, and by its gain when the load turns."""

import math

from pendant.limits.validity import WINDOW
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.pose import Vector, flat, turned_back

FALSE_ALARM = 5.0
"""Standard deviations of a window's mean that count as noise: three axes together exceed them once in 65,000 windows."""

CENTRE = 0.01
"""Largest distance of a load's centre from the configured centre [m], as bench `payload` draws it."""

LEVER = 0.2
"""Largest distance of a load's centre from the flange [m]: an error of the measured weight by the gain makes a torque error with
at most this lever."""


def window_noise(sensor: SensorSpec, estimate: Estimate) -> float:
    """Standard deviation of a window's mean force, each axis [N]."""
    return math.hypot(sensor.noise_force, sensor.noise_acceleration * estimate.load_mass) / math.sqrt(WINDOW)


def noise_error(sensor: SensorSpec, estimate: Estimate) -> float:
    """Largest error of a window's mean force by noise, all axes together [N]."""
    return FALSE_ALARM * window_noise(sensor, estimate)


def load_weight(estimate: Estimate) -> Vector:
    """Weight of the configured load, axes of F [N]."""
    g, mass = estimate.g_B.tolist(), estimate.load_mass
    x, y, z = turned_back(flat(estimate.R_BF), (g[0], g[1], g[2]))
    return mass * x, mass * y, mass * z


def gain_error(sensor: SensorSpec, estimate: Estimate, before: Vector) -> float:
    """Largest error of the force by the gain [N], since the load's weight was `before` (axes of F) [N]."""
    return sensor.gain * math.dist(load_weight(estimate), before)


def window_error(sensor: SensorSpec, estimate: Estimate, before: Vector) -> float:
    """Largest error of a window's mean force [N] since the load's weight was `before` (axes of F) [N]: by gain and by noise."""
    return gain_error(sensor, estimate, before) + noise_error(sensor, estimate)
