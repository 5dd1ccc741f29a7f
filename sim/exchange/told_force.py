"""The user's force with what is known of its error: of the arm's own sensors, for pictures and recordings (FD-19).

The force is what the flange sensor feels beyond what it felt at entry, F = change - rest, where the rest is what free-drive does
not take for the user's: what was steady along gravity for long, the arm's own swing, what is less than a wrong payload's. With g
against gravity, all in axes of B, its covariance is the sum of

    the noise of the sensor and of the accelerometer by which the load is weighed, behind the filter; at entry, a window's mean,
    the swing of load and arm, by which the force fluctuates beside its mean more than by this noise: any part may be the user's,
    what the sensor may tell without a hand since its bias was last known, at most `slack`: its drift, and the gain of a load that
    has turned,
    the sensor's gain: a share of the force, and of what the load needs to be accelerated,
    the load's mass: it makes that change larger or smaller, along one line,
    along gravity: of F there, any part that a payload can make may be one's, which one posture cannot tell from a steady hand,
    the rest, as far as it is more than noise: any part of it may be the user's all the same.

Of what is at most so large, and may be anything below it, a third of the square is the variance (a rectangular distribution:
JCGM 100, Guide to the expression of uncertainty in measurement, 4.3.7). Joints tell a force with an error that is not known well
enough, and of a hand on a link not the force but what it would be at the flange: where they tell it there is no covariance.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.decision import Decision
from pendant.guided.user_force import SWING, TakenForce
from pendant.limits.residual import upward
from pendant.limits.validity import WINDOW
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, flat, norm, turned
from sim.arm.arm_file import Arm
from sim.flange.wrench_hypotheses import SURE
from sim.sensing.sensor_drift import sensor_spec

Array = NDArray[np.float64]

WITHIN_95 = 7.815
"""Square of the distance from the mean, in standard deviations, that 95 % of three Gaussian numbers are within (chi-square)."""

_WEIGHT = 1.0 - math.exp(-TICK / SWING)
_LEFT = _WEIGHT / (2.0 - _WEIGHT) + 1.0 / WINDOW
"""Of a tick's variance: what the filter leaves, and the mean at entry."""


class UncertainForce(NamedTuple):
    """A force and how far off it may be."""

    force: Vector  # axes of B [N]
    covariance: Array | None  # (3, 3), axes of B [N²]; None: that is not known
    at: Vector = ORIGIN  # where it is drawn, in F [m]: the flange's origin would lie in the tool

    def ellipsoid(self) -> tuple[Array, Array] | None:
        """Where the true force is with 95 %: semi-axes (3,), rising [N]; a rotation (3, 3) whose columns are their directions."""
        if self.covariance is None:
            return None
        squares, directions = np.linalg.eigh(self.covariance)
        if np.linalg.det(directions) < 0.0:
            directions[:, 0] = -directions[:, 0]
        return np.sqrt(WITHIN_95 * np.maximum(squares, 0.0)), directions


def told_force(arm: Arm, estimate: Estimate, decision: Decision) -> UncertainForce | None:
    """What free-drive took for the user's force in a tick; None while the arm is not free."""
    taken, fitting = decision.taken, decision.estimator.fitting
    if taken is None:
        return None
    x, y, z = ORIGIN if fitting is None else fitting.tool.tcp
    return UncertainForce(taken.force, covariance(taken, estimate, sensor_spec(arm), SURE), (x, y, z))


def covariance(told: TakenForce, estimate: Estimate, sensor: SensorSpec, mass: float) -> Array | None:
    """Of the force (3, 3), axes of B [N²]; None where the joints tell it.

    Args:
        told: of the same tick as `estimate`.
        estimate: has the flange's orientation and acceleration, and the mass of the load.
        sensor: what is known of it.
        mass: standard deviation of the payload's [kg].
    """
    doubts = told.doubts
    if doubts is None:
        return None
    up = np.array(upward(estimate.g_B.tolist()))
    # What the load needs now and did not need at entry, in the axes of the sensor, for each kilogram.
    swung = estimate.a_felt + GRAVITY * (up - np.array(turned(flat(estimate.R_BF), doubts.hung)))
    noise = sensor.noise_force**2 + (sensor.noise_acceleration * estimate.load_mass) ** 2
    swing = max(doubts.fluctuation / 3.0 - noise, 0.0)
    gain = sensor.gain * (estimate.load_mass * float(np.linalg.norm(estimate.a_felt)) + norm(told.force))
    along = float(up @ told.force)
    payload = min((mass * GRAVITY) ** 2, along**2 / 3.0)
    everywhere = _LEFT * noise + (swing + doubts.slack**2 + gain**2) / 3.0
    rest = np.array(doubts.change) - np.array(told.force)
    size = float(rest @ rest)
    theirs = max(size - 3.0 * noise, 0.0) / (3.0 * size) if size > 0.0 else 0.0  # what is noise is nobody's
    return everywhere * np.eye(3) + mass**2 * np.outer(swung, swung) + payload * np.outer(up, up) + theirs * np.outer(rest, rest)
