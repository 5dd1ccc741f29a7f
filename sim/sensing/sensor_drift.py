"""The zero of the flange sensor as time goes on: it warms up, and then wanders slowly within bounds."""

import math

import numpy as np
from numpy.typing import NDArray

from pendant.sensor.sensor_spec import SensorSpec
from sim.arm.arm_file import Accuracy, Arm, Drift
from sim.sensing.calibration import Calibration

Array = NDArray[np.float64]

SPREAD = (0.5, 1.5)
"""A sensor's own time constant, times that of the arm's file: least and most."""

BOUND = 3.0
"""Standard deviations that the walk is from its middle at most, and that it is kicked by in a second at most."""


class SensorDrift:
    """Zero error of one flange sensor, a value a second. The same arguments give the same values, bit for bit.

    error(t) = warm + (cold - warm)·exp(-t / time_constant) + walk(t). The walk is an Ornstein-Uhlenbeck process that starts at
    zero (exact in its steps: Gillespie, Phys. Rev. E 54, 2084, 1996), clipped at `BOUND`.

    Attributes:
        time_constant: of this sensor's warm-up [s].
        second: seconds passed since the sensor was switched on.
        error: zero error (6,) at that time [N, N·m].

    Args:
        drift: the numbers of the arm's file.
        calibration: has the zero errors of the cold and of the warm sensor.
        rng: of this sensor's drift alone.
    """

    def __init__(self, drift: Drift, calibration: Calibration, rng: np.random.Generator) -> None:
        self._rng = rng
        self.time_constant = drift.warm_up * float(rng.uniform(*SPREAD))
        self._warm = calibration.wrench_warm
        self._way = calibration.wrench_offset - self._warm
        self._keep = math.exp(-1.0 / drift.walk_time)
        sigma = axes(drift.walk_force, drift.walk_torque)
        self._kick, self._most = sigma * math.sqrt(1.0 - self._keep**2), BOUND * sigma
        self._walk = np.zeros(6)
        self.second = 0
        self.error = calibration.wrench_offset.copy()

    def step(self) -> Array:
        """Go on by a second; returns how fast (6,) the zero moves in it [N/s, N·m/s]."""
        self.second += 1
        kick = self._kick * np.clip(self._rng.standard_normal(6), -BOUND, BOUND)
        self._walk = np.clip(self._keep * self._walk + kick, -self._most, self._most)
        before = self.error
        self.error = self._warm + self._way * math.exp(-self.second / self.time_constant) + self._walk
        return self.error - before


def axes(force: float, torque: float) -> Array:
    """A number (6,) an axis: `force` for the forces, `torque` for the torques."""
    return np.array([force] * 3 + [torque] * 3)


def most(accuracy: Accuracy, drift: Drift | None) -> tuple[float, float]:
    """Largest zero error of an axis at any time, without faults: of the forces [N], of the torques [N·m].

    Args:
        accuracy: what the arm's file says of it.
        drift: the numbers of the arm's file; None for a sensor that does not drift.
    """
    cold = accuracy.force_offset, accuracy.torque_offset
    if drift is None:
        return cold
    # Between cold and warm the error is never larger than at both ends.
    force = max(cold[0], drift.force) + BOUND * drift.walk_force
    return force, max(cold[1], drift.torque) + BOUND * drift.walk_torque


def fastest(accuracy: Accuracy, drift: Drift | None) -> tuple[float, float]:
    """Largest change of an axis' zero error within a second, without faults: of the forces [N/s], of the torques [N·m/s].

    No sensor keeps it up: the walk's part is a kick of a single second. See `lasting`.

    Args:
        accuracy: what the arm's file says of it.
        drift: the numbers of the arm's file; None for a sensor that does not drift.
    """
    if drift is None:
        return 0.0, 0.0
    keep = math.exp(-1.0 / drift.walk_time)
    walking = BOUND * (1.0 - keep) + BOUND * math.sqrt(1.0 - keep**2)  # back to the middle from the bound, and kicked
    force, torque = lasting(accuracy, drift)
    return force / SPREAD[0] + drift.walk_force * walking, torque / SPREAD[0] + drift.walk_torque * walking


def lasting(accuracy: Accuracy, drift: Drift | None) -> tuple[float, float]:
    """Rate that an axis' zero error keeps up for minutes, at most: of the forces [N/s], of the torques [N·m/s].

    It is that of a sensor with the file's time constant that warms up from one bound to the other: for the UR5e the 4 N in
    5 minutes that a user saw (Universal_Robots_ROS_Driver issue 633).

    Args:
        accuracy: what the arm's file says of it.
        drift: the numbers of the arm's file; None for a sensor that does not drift.
    """
    if drift is None:
        return 0.0, 0.0
    return (accuracy.force_offset + drift.force) / drift.warm_up, (accuracy.torque_offset + drift.torque) / drift.warm_up


def sensor_spec(arm: Arm) -> SensorSpec:
    """What is known of the arm's flange sensor."""
    force_torque, accelerometer = arm.sensors.force_torque, arm.sensors.accelerometer
    if force_torque is None:
        return SensorSpec()
    drift, offset = lasting(arm.accuracy, force_torque.drift), most(arm.accuracy, force_torque.drift)
    noise = (force_torque.force.noise, force_torque.torque.noise)
    shaken = SensorSpec().noise_acceleration if accelerometer is None else accelerometer.noise
    # Each of the two other axes of its kind gives at most a fifth of the cross-talk (sim/sensing/calibration.py).
    gain = arm.accuracy.wrench_gain + 2.0 * arm.accuracy.wrench_cross_talk / 5.0
    spec, wander = SensorSpec(*drift, *offset, *noise, shaken, gain=gain), force_torque.drift
    if wander is None:
        return spec._replace(walk_force=0.0, quickest=math.inf)
    quickest = SPREAD[0] * wander.warm_up
    return spec._replace(warm_up=wander.warm_up, quickest=quickest, walk_force=wander.walk_force, walk_time=wander.walk_time)
