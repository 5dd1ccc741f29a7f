"""How far off the force may be that free-drive takes for the user's: its covariance, for pictures and recordings (FD-19).

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

from pendant.guided.bias_follower import Slack
from pendant.guided.user_force import SWING, UserForce
from pendant.limits.residual import upward
from pendant.limits.validity import WINDOW
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, flat, norm, turned, turned_back

Array = NDArray[np.float64]

WITHIN_95 = 7.815
"""Square of the distance from the mean, in standard deviations, that 95 % of three Gaussian numbers are within (chi-square)."""

_WEIGHT = 1.0 - math.exp(-TICK / SWING)
_LEFT = _WEIGHT / (2.0 - _WEIGHT) + 1.0 / WINDOW
"""Of a tick's variance: what the filter leaves, and the mean at entry."""


class Doubts(NamedTuple):
    """What there is to say how far off the force may be that the flange sensor tells."""

    change: Vector  # all that it feels beyond what it felt at entry, axes of B [N]
    fluctuation: float  # mean square of what it felt lately beside its mean, all axes together [N²]
    slack: float  # what it may tell without a hand [N]
    hung: Vector  # upward at entry, axes of F


class TakenForce(NamedTuple):
    """What free-drive takes for the user's force."""

    force: Vector  # axes of B [N]
    doubts: Doubts | None  # None: the joints tell it


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


def upward_in_flange(estimate: Estimate) -> Vector:
    """Upward, in axes of F."""
    return turned_back(flat(estimate.R_BF), upward(estimate.g_B.tolist()))


def taken(hand: UserForce, slack: Slack, hung: Vector, *, use_wrench: bool) -> TakenForce:
    """Of a tick in which the flange sensor is used or not; where it is, the joints may still tell more."""
    doubts = None if hand.by_joints or not use_wrench else Doubts(hand.change, hand.fluctuation, slack.force, hung)
    return TakenForce(hand.user, doubts)


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
