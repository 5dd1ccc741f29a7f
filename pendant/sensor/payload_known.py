"""Error of the payload's mass, separated from the flange sensor's bias by the postures in which the arm stood (FD-9, FD-11).

A bias turns with the flange, and a payload pulls along gravity. In one posture the sensor measures their sum; two postures
separate them. A Kalman filter combines all postures, in axes of F:

    -F_user = bias + mass error * a + own,    a = -R_BF^T g

The bias drifts as the sensor's maker says. The mass error may differ from posture to posture, because a gripper may have closed
between them. `own` is the error by the sensor's gain, and a small force that acts in one posture alone, such as that of a hose.
So a force along gravity in one posture is never taken for a bias, be it of a payload or of a hand. A posture in which a hand's
force across gravity begins or ends is not used; if such a force stays, it contradicts the other postures. The first two postures
are used only if one payload error explains both.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.limits.residual import PayloadError
from pendant.limits.validity import WINDOW
from pendant.sensor.hand_model import RARELY, STEADY
from pendant.sensor.sensor_spec import SensorSpec
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import Vector

Array = NDArray[np.float64]

BIAS, RATE, MASS, OWN = slice(0, 3), slice(3, 6), 6, slice(7, 10)
"""Places in the state of bias [N], its rate [N/s], mass error [kg] and `own` [N]."""

SIZE = 10

ANYTHING = 100.0
"""Standard deviation of an unknown payload error [kg]: so large that only measurements count."""

PULLS = 0.2
"""Standard deviation of a force that acts in one posture and not in another, such as that of a hose [N]; the sensor's cross-talk
from torques to forces makes a quarter of it."""

UNSTEADY = 0.1
"""Standard deviation of a window beyond its noise [N]: an arm that came to rest still swings a little on its gears."""

FALSE_ALARM = 16.3
"""Bound that a chi-square of three values exceeds by chance once in a thousand times: more contradicts what is known."""

STOOD = 10
"""Windows for which an arm must have stood in a posture, so that it is used: a short stop of a led arm is no posture."""

STILL = ticks(STEADY) // WINDOW
"""Windows in a row that contradict what is known, after which this is given up: no hand is so steady for so long."""

WITNESSES = 2
"""Postures that must agree on bias and payload, before a further posture that contradicts them counts as one with another
payload. A single posture is not enough: a hand may have touched the arm all the time."""


TURNED = math.cos(math.radians(10.0))
"""Cosine of the least angle by which gravity must have turned in the flange's axes, so that a posture counts as another one."""


class _Belief(NamedTuple):
    """Mean (SIZE,) and covariance (SIZE, SIZE) of the state."""

    x: Array
    P: Array
    tick: int | None = None  # of the last window
    postures: int = 0  # that agree
    a: Array = np.zeros(3)  # specific force in the last of these [m/s²]
    compared: bool = False  # the mass error was found in another posture, and the configured load is still the same


class PayloadKnown:
    """Learns from the windows of a standing arm, one after the other."""

    __slots__ = ("_a", "_before", "_contrary", "_nothing", "_now", "_passed", "_sensor", "_touched", "_windows")

    def __init__(self, sensor: SensorSpec) -> None:
        self._sensor = sensor
        # All biases within the maker's range are equally likely; the payload is unknown.
        P = np.zeros((SIZE, SIZE))
        P[BIAS, BIAS], P[RATE, RATE] = np.eye(3) * sensor.offset_force**2 / 3.0, np.eye(3) * sensor.drift_force**2 / 3.0
        P[MASS, MASS] = ANYTHING**2
        self._nothing = _Belief(np.zeros(SIZE), P)
        self.forget()

    def forget(self) -> None:
        """The sensor failed for a while: its bias may have changed."""
        self._now = self._before = self._nothing
        self._a = self._nothing.a  # specific force in this posture
        self._contrary = 0  # windows that contradicted what is known since one agreed with it
        self._touched, self._windows = False, 0
        self._passed = 0  # windows since one was learned from

    def move(self) -> None:
        """The arm moves: the next window belongs to another posture."""
        if self._windows or self._touched:
            now = self._before
            if self._windows >= STOOD:
                now = self._now
                if self._a @ now.a < TURNED * (self._a @ self._a):
                    now = now._replace(postures=now.postures + 1, a=self._a)
            self._now = self._before = now._replace(compared=True)
            self._touched, self._windows = False, 0

    def change(self) -> None:
        """Another load is configured."""
        self._now, self._before = [_other_mass(each)._replace(compared=False) for each in (self._now, self._before)]

    def learn(self, estimate: Estimate, force: Vector) -> None:
        """A window in which the arm stands.

        Args:
            estimate: of its last tick.
            force: mean of F_user without any zero, axes of F [N].
        """
        if self._touched:
            return
        self._passed += 1
        if self._windows >= STOOD and self._passed < STOOD:  # of a well-known posture one window of so many is enough
            return
        seen, self._passed = self._seen(estimate, force), 0
        if seen is not None:
            self._now, self._contrary, self._windows = seen, 0, self._windows + 1
            self._a = _specific(estimate)
        elif self._windows:  # a hand came or went, and may have been there before
            self._now, self._touched, self._windows = self._before, True, 0
        else:
            self._contrary += 1
            if self._contrary == STILL:
                self.forget()

    def told(self, estimate: Estimate, force: Vector) -> PayloadError | None:
        """The payload's error by this force (arguments as in `learn`) and the other postures; None if these are missing or
        contradict."""
        seen = self._seen(estimate, force) if self._trusted or self._now.compared else None
        return None if seen is None else PayloadError(float(seen.x[MASS]), RARELY * math.sqrt(seen.P[MASS, MASS]))

    @property
    def _trusted(self) -> bool:
        """Enough postures agreed on bias and payload: one that contradicts them has another payload."""
        return self._now.postures >= WITNESSES

    def _predicted(self, tick: int) -> _Belief:
        """The belief of now: the sensor may have drifted since the last window."""
        sensor, now = self._sensor, self._now
        passed = 0.0 if now.tick is None else (tick - now.tick) * TICK
        cools = math.exp(-passed / sensor.warm_up)
        went = sensor.warm_up * (1.0 - cools)
        x, P = now.x.copy(), now.P.copy()
        for of in (x, P, P.T):  # F x, F P, and F P F'
            of[BIAS] += went * of[RATE]
            of[RATE] *= cools
        variances = P.ravel()[:: SIZE + 1]
        variances[BIAS] += sensor.walk_force**2 * (1.0 - math.exp(-2.0 * passed / sensor.walk_time))
        variances[RATE] += sensor.drift_force**2 / 3.0 * (1.0 - cools * cools)
        return now._replace(tick=tick, x=x, P=P)

    def _own(self, estimate: Estimate) -> Array:
        """Variance (3,) of `own`, the force of one posture alone, axes of F [N²]."""
        weight = estimate.load_mass * _specific(estimate)
        return (self._sensor.gain * weight) ** 2 / 3.0 + PULLS**2

    def _seen(self, estimate: Estimate, force: Vector) -> _Belief | None:
        """The belief after this force; None if no bias and no payload explain the force."""
        belief = self._predicted(estimate.tick)
        if not self._windows:
            belief = _renewed(belief, self._own(estimate))
            if not self._trusted and self._corrected(belief, estimate, force)[1] > FALSE_ALARM:
                return None
            belief = _other_mass(belief)
        seen, off = self._corrected(belief, estimate, force)
        if off > FALSE_ALARM and self._windows:  # another payload, or a hand along gravity
            seen, off = self._corrected(_other_mass(belief), estimate, force)
        return None if off > FALSE_ALARM else seen

    def _corrected(self, belief: _Belief, estimate: Estimate, force: Vector) -> tuple[_Belief, float]:
        """A step of the Kalman filter, and the distance of the force from the belief, as a chi-square."""
        sensor, x, P, a = self._sensor, belief.x, belief.P, _specific(estimate)
        noise = math.hypot(sensor.noise_force, sensor.noise_acceleration * estimate.load_mass)
        off = -np.array(force) - x[BIAS] - x[OWN] - x[MASS] * a
        HP = P[BIAS] + P[OWN] + a[:, None] * P[MASS]
        S = HP[:, BIAS] + HP[:, OWN] + HP[:, MASS, None] * a
        S.ravel()[:: len(S) + 1] += noise * noise / WINDOW + UNSTEADY * UNSTEADY
        certain = np.linalg.inv(S)
        K = certain @ HP  # transposed
        P = P - K.T @ HP
        return belief._replace(x=x + off @ K, P=0.5 * (P + P.T)), float(off @ certain @ off)


def _specific(estimate: Estimate) -> Array:
    """Specific force (3,) on a body at rest, axes of F [m/s²]."""
    return -estimate.g_B @ estimate.R_BF


def _other_mass(belief: _Belief) -> _Belief:
    """The belief with an unknown error of the payload."""
    x, P = belief.x.copy(), belief.P.copy()
    x[MASS] = P[MASS] = P[:, MASS] = 0.0
    P[MASS, MASS] = ANYTHING**2
    return belief._replace(x=x, P=P)


def _renewed(belief: _Belief, own: Array) -> _Belief:
    """The belief at the begin of another posture, whose own force has the variance `own` (3,)."""
    x, P = belief.x.copy(), belief.P.copy()
    x[OWN] = P[OWN] = P[:, OWN] = 0.0
    P[OWN, OWN] = np.diag(own)
    return belief._replace(x=x, P=P)
