"""Who moves whom at the flange: the arm its load, or the load the arm (CD-0).

The flange exerts the wrench w on its load, so the arm's side of the flange feels -w. If nothing else changes, that side
accelerates by -M^-1 w, where M is the mass matrix of the arm at the flange. M is positive definite. So the product of the change
of w and the change of the acceleration (force times linear, torque times angular) is negative. This holds for every contact of
the load, wherever it acts.

A push on a link accelerates the arm's side, and the load follows. Then w is the mass matrix of the load times that acceleration,
and the product is positive. The product needs all six components at one point, because a torque, too, may move the flange in the
direction of the force.
"""

import numpy as np

from pendant.contact.contact_limits import OLDER
from pendant.contact.contact_rules import LATE
from pendant.tick.modes import TICK
from sim.arm.arm_file import SensorNumbers
from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record

NOISES = 1.0 + 1.0 / OLDER
"""Variance of the difference between a sample and the mean of `OLDER` samples, divided by the variance of a sample."""


def flange_drive(sensors: SensorNumbers, smoothing: float) -> Record:
    """Record of the last samples at the flange, still empty.

    Args:
        sensors: sensors of the arm, with the noise of its file.
        smoothing: share by which the angular acceleration follows in a tick. It is the smoothed change of the mean of two gyros.
    """
    kept = record(kept=(OLDER, 12), noise=(12,), last=(3,), count="i8")
    noise = kept[0]["noise"]
    if sensors.force_torque is not None and sensors.accelerometer is not None and sensors.gyro is not None:
        noise[:3], noise[3:6] = sensors.force_torque.force.noise, sensors.force_torque.torque.noise
        noise[6:9] = sensors.accelerometer.noise
        noise[9:] = sensors.gyro.noise / TICK * smoothing / (2.0 - smoothing) ** 0.5
    return kept


@kernel
def driven(own, wrench, acceleration, turning) -> float:
    """How surely the arm moves its load, in standard deviations of the noise; below zero the load moves the arm.

    Changes are relative to the mean of the last `OLDER` samples. The angular acceleration is known up to `LATE` ticks late. So
    the product is taken twice, with the angular acceleration as known and with the one extrapolated by `LATE` ticks. The smaller
    result counts. It is 0 until `OLDER` samples are known.

    Args:
        own: record of `flange_drive`; this sample is added to it.
        wrench: (6,) of the flange on its load, in F [N, N·m].
        acceleration: (3,) specific force of the arm's side at the flange, in F [m/s²].
        turning: (3,) angular acceleration, in F [rad/s²].
    """
    kept, noise = own.kept, own.noise
    work, variance, late, spread = 0.0, 0.0, 0.0, 0.0
    for k in range(6):
        now = acceleration[k] if k < 3 else turning[k - 3]
        f, a = wrench[k], now
        for j in range(OLDER):
            f -= kept[j, k] / OLDER
            a -= kept[j, 6 + k] / OLDER
        ahead, more = a, 1.0
        if k >= 3:
            ahead += LATE * (now - own.last[k - 3])
            more = (1.0 + LATE) ** 2 + LATE**2
            own.last[k - 3] = now
        of_wrench, of_acceleration = NOISES * noise[k] ** 2, NOISES * noise[6 + k] ** 2
        work += f * a
        variance += of_wrench * a * a + (f * f + of_wrench) * of_acceleration
        late += f * ahead
        spread += of_wrench * ahead * ahead + (f * f + of_wrench) * of_acceleration * more
    known = own.count >= OLDER
    at = own.count % OLDER
    for k in range(6):
        kept[at, k] = wrench[k]
        kept[at, 6 + k] = acceleration[k] if k < 3 else turning[k - 3]
    own.count += 1
    if not known or variance <= 0.0:
        return 0.0
    return min(work / np.sqrt(variance), late / np.sqrt(spread))
