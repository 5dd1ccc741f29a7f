"""Who moves whom at the flange: the arm its load, or the load the arm (CD-0).

The flange exerts the wrench w on what it carries, so the arm's side of the flange feels -w. Where nothing else has changed, that
side accelerates by -M^-1 w, with the mass matrix M of the arm at the flange, which is positive definite: the product of the
changes of w and of the acceleration, force with linear and torque with angular, is negative. So it is for every contact of what
is carried, wherever it acts. A push on a link accelerates the arm's side, and the load follows: w is then the mass matrix of the
load times that acceleration, and the product is positive. It takes all six components, for one point: a torque may move the
flange along the force.
"""

import numpy as np

from pendant.contact.contact_limits import OLDER
from pendant.contact.contact_rules import LATE
from pendant.tick.modes import TICK
from sim.arm.arm_file import SensorNumbers
from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record

NOISES = 1.0 + 1.0 / OLDER
"""Variance of a difference from the mean of `OLDER` samples, over that of a sample."""


def flange_drive(sensors: SensorNumbers, smoothing: float) -> Record:
    """What is kept of the last samples at the flange, none at first.

    Args:
        sensors: of the arm; their noise is that of its file.
        smoothing: share by which the angular acceleration, a difference of the mean of two gyros, follows in a tick.
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
    """How far the arm moves its load, in standard deviations of the noise; below zero the load moves the arm.

    The changes are those from the mean of the `OLDER` samples before. The angular acceleration is known up to `LATE` ticks late:
    what counts is the lesser of both, as it is known and as it would be if it went on changing. 0 as long as not enough is known.

    Args:
        own: record of `flange_drive`; takes this sample, too.
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
