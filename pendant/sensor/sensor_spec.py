"""Data of the flange force/torque sensor by its maker: how far and how fast its bias drifts, its noise, its gain."""

from typing import NamedTuple


class SensorSpec(NamedTuple):
    """Each number holds for every axis of the sensor. The defaults are those of the UR5e's file."""

    drift_force: float = 0.0133  # fastest drift of the bias, for minutes [N/s]
    drift_torque: float = 0.001  # [N·m/s]
    offset_force: float = 4.9  # largest bias, so the largest error of a zero [N]
    offset_torque: float = 0.36  # [N·m]
    noise_force: float = 0.15  # standard deviation in a tick [N]
    noise_torque: float = 0.006  # [N·m]
    noise_acceleration: float = 0.1  # of the accelerometer by which the load's force is computed [m/s²]
    gain: float = 0.014  # error as a share of the measured value: 1 % of the axis, and 0.2 % of each of the two others
    warm_up: float = 600.0  # time constant with which the drift decays [s]
    quickest: float = 300.0  # `warm_up` of the sensor that warms up fastest [s]
    walk_force: float = 0.3  # standard deviation of the bias' wandering when it is warm [N]
    walk_time: float = 1800.0  # time constant of this wandering [s]


USUAL = SensorSpec()
"""Sensor of a UR5e."""
