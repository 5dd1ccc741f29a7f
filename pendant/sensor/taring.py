"""Taring: the flange sensor's zero, its force on an untouched arm, and whether something pulls at the arm (FD-10, FD-11).

The sensor's bias drifts slowly. While the arm stands, a reference follows the mean of F_user no faster than the bias can drift.
The force of a hand or a load comes faster, so it shows as a difference. A force that was there in the first window looks like a
bias.
"""

import math
from collections import deque

from pendant.events.event import Event, Kind, Values
from pendant.limits.parameters import ZEROS
from pendant.limits.residual import PayloadError, mass_error, split, upward
from pendant.limits.settings import ActivationLimits
from pendant.limits.validity import WINDOW, WrenchMean, in_flange
from pendant.sensor.payload_known import PayloadKnown
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER, gain_error, load_weight, noise_error, window_noise
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, Wrench, flat, norm, turned

WINDOWS = 10
"""Windows that are kept: one second, in which the force must not tremble."""

AVERAGED = 5
"""Number of the latest windows whose mean becomes the zero: half a second."""

LEAST_PULL, LEAST_TWIST = 1.5, 0.2
"""Least difference from the untouched arm that counts as a hand [N, N·m]: a third of the 5 N that must always be noticed."""

TREMBLE = 2.0
"""Spread of the means of ten windows, over their noise, that noise alone exceeds in less than one of a million seconds: a
chi-square of 27."""

DUE, OVER = 2.0 / 3.0, 0.5
"""Shares of a limit of the activation sequence: zeroing becomes due above the first, and is due until the force is below the
second."""


class Taring:
    """Called in each tick. Only each WINDOW-th call computes something; the others only count.

    Attributes:
        zero: is subtracted from the sensor's values, axes of F [N, N·m].
        reading_zero: the F_user that is subtracted where forces are reported to clients, and in force control, axes of F
            [N, N·m]; nothing else uses it.
        due: the force on an untouched arm may soon be so large that free-drive is refused.
    """

    __slots__ = ("_count", "_known", "_reference", "_sensor", "_tick", "_weight", "_windows", "due", "reading_zero", "zero")

    def __init__(self, sensor: SensorSpec) -> None:
        self.zero: Wrench = ZEROS
        self.reading_zero: Wrench = ZEROS
        self.due = False
        self._sensor = sensor
        self._known = PayloadKnown(sensor)
        self._count = 0  # ticks in the window that is being filled
        self._windows: deque[Wrench] = deque(maxlen=WINDOWS)  # means of F_user since the arm stands, axes of F
        self._reference: Wrench | None = None  # F_user of the untouched arm, axes of F [N, N·m]
        self._tick = 0  # of the last change of the reference
        self._weight: Vector = ORIGIN  # of the load at that tick, axes of F [N]

    def restart(self, lost: bool) -> None:
        """The sensor fails (`lost`), or the configured load changes: the reference of the untouched arm is learned again."""
        self._reference = None
        self._rest()
        if lost:
            self._known.forget()
        else:
            self._known.change()

    def step(self, estimate: Estimate, mean: WrenchMean, stands: bool, limits: ActivationLimits) -> list[Event]:
        """One tick with a valid sensor.

        Args:
            estimate: of this tick.
            mean: of F_user.
            stands: the arm is held, does not move, and nothing shakes it.
            limits: of the activation sequence.
        """
        if not stands:
            self._rest()
            return []
        self._count += 1
        if self._count < WINDOW:
            return []
        self._count = 0
        wrench = mean.mean()
        present = in_flange(estimate, wrench)
        self._windows.append(present)
        self._known.learn(estimate, self._raw(present))
        reference = self._follow(estimate, present)
        return [] if self._pulled(estimate, present, reference) else self._judge(estimate, reference, limits)

    def why_not(self, estimate: Estimate, mean: WrenchMean) -> str:
        """Why the sensor cannot be zeroed in this tick, in a clause, or "". The arm stands, and the sensor is valid."""
        windows, reference = self._windows, self._reference
        if len(windows) < WINDOWS or reference is None:
            return f"the arm must stand untouched for {(WINDOWS + 1) * WINDOW * TICK:.1f} s: wait"
        pulled = self._pulled(estimate, in_flange(estimate, mean.mean()), reference)
        if pulled:
            return f"{pulled} more than on the untouched arm: let go of it"
        spread, noise = self._spread(), window_noise(self._sensor, estimate)
        if spread > TREMBLE * noise:
            return f"the force trembles by {spread:.2f} N, at rest by {noise:.2f} N: hands off the arm"
        return self._beyond(estimate, self._latest())

    def tare(self, estimate: Estimate) -> tuple[Wrench, Event]:
        """Zero the sensor; `why_not` returned "" in this tick.

        Returns:
            The wrench by which F_user is smaller from the next tick on, axes of F [N, N·m]; and the event.
        """
        gone = self._latest()
        self.zero = _less(self.zero, gone)
        assert self._reference is not None
        self._reference = _less(self._reference, gone)
        self._windows = deque([_less(window, gone) for window in self._windows], WINDOWS)
        self.due = False
        x, y, z = (-value for value in gone[:3])  # F_user is minus the error of the sensor
        values: Values = {"force": math.hypot(x, y, z), "torque": math.hypot(*gone[3:]), "x": x, "y": y, "z": z}
        return gone, Event(Kind.SENSOR_ZEROED, estimate.tick, values)

    def shift_reading(self, gone: Wrench) -> None:
        """F_user is smaller by `gone` from this tick on, axes of F: a force that was reported as zero is still reported as
        zero."""
        if self.reading_zero is not ZEROS:
            self.reading_zero = _less(self.reading_zero, gone)

    def zero_reading(self, estimate: Estimate, wrench: Wrench) -> Event:
        """Report forces relative to this F_user from now on, axes of B [N, N·m], whatever its cause. Returns the event."""
        present = self.reading_zero = in_flange(estimate, wrench)
        values: Values = {"force": math.hypot(*present[:3]), "torque": math.hypot(*present[3:])}
        pulled = "" if self._reference is None or not self._windows else self._pulled(estimate, present, self._reference)
        reason = f"{pulled} more than on the untouched arm" if pulled else self._beyond(estimate, present)
        if reason:
            return Event(Kind.READING_ZEROED_PULLED, estimate.tick, {**values, "reason": reason})
        return Event(Kind.READING_ZEROED, estimate.tick, values)

    def explains(self, estimate: Estimate, wrench: Wrench) -> bool:
        """Whether the bias of the sensor alone can make this F_user, axes of B [N, N·m]."""
        return not self._beyond(estimate, in_flange(estimate, wrench))

    def payload_error(self, estimate: Estimate, wrench: Wrench) -> PayloadError | None:
        """The error of the payload's mass by this F_user, axes of B [N, N·m]; None if no other postures are known."""
        return self._known.told(estimate, self._raw(in_flange(estimate, wrench)))

    def _raw(self, present: Wrench) -> Vector:
        """Force of F_user as it would be without any zero, axes of F [N]."""
        x, y, z = _less(present, self.zero)[:3]
        return x, y, z

    def _rest(self) -> None:
        self._count = 0
        self._known.move()
        if self._windows:
            self._windows.clear()

    def _follow(self, estimate: Estimate, present: Wrench) -> Wrench:
        """The reference after a window. Since its last change the load may have turned."""
        sensor, last = self._sensor, self._reference
        if last is None:
            last = present
        time = (estimate.tick - self._tick) * TICK
        wrong = gain_error(sensor, estimate, self._weight)
        force, torque = sensor.drift_force * time + wrong, sensor.drift_torque * time + LEVER * wrong
        self._tick, self._weight = estimate.tick, load_weight(estimate)
        most = (force, force, force, torque, torque, torque)
        reference = tuple([a + min(max(b - a, -way), way) for a, b, way in zip(last, present, most, strict=True)])
        self._reference = reference
        return reference

    def _pulled(self, estimate: Estimate, present: Wrench, reference: Wrench) -> str:
        """The force or torque on the arm beyond noise, in words, or ""."""
        force, torque = math.dist(present[:3], reference[:3]), math.dist(present[3:], reference[3:])
        if force > LEAST_PULL + noise_error(self._sensor, estimate):
            return f"{force:.1f} N"
        noise = math.hypot(self._sensor.noise_torque, LEVER * self._sensor.noise_acceleration * estimate.load_mass)
        return f"{torque:.2f} N·m" if torque > LEAST_TWIST + FALSE_ALARM * noise / math.sqrt(WINDOW) else ""

    def _spread(self) -> float:
        """Standard deviation of the force from window to window, root of the mean square of the axes [N]."""
        count, total = len(self._windows), 0.0
        for axis in range(3):
            values = [window[axis] for window in self._windows]
            middle = sum(values) / count
            total += sum([(value - middle) ** 2 for value in values])
        return math.sqrt(total / (3 * (count - 1)))

    def _latest(self) -> Wrench:
        """Mean of the last half second, axes of F [N, N·m]."""
        windows = list(self._windows)[-AVERAGED:]
        return tuple([sum(values) / AVERAGED for values in zip(*windows, strict=True)])

    def _beyond(self, estimate: Estimate, present: Wrench) -> str:
        """Why this cannot be the sensor's zero (it is larger than a bias can be), in a clause, or ""; `present`: F_user, axes of
        F [N, N·m]."""
        sensor = self._sensor
        total = _less(present, self.zero)  # F_user as it would be without any zero
        wrong = sensor.gain * estimate.load_mass * norm(_three(estimate.g_B.tolist()))
        x, y, z, a, b, c = total
        if max(abs(x), abs(y), abs(z)) > sensor.offset_force + wrong:
            R_BF, up = flat(estimate.R_BF), upward(estimate.g_B.tolist())
            mass = mass_error(split((*turned(R_BF, (x, y, z)), 0.0, 0.0, 0.0), up).payload_force)
            way = "more" if mass >= 0.0 else "less"
            far = f"{math.hypot(x, y, z):.1f} N is more than its zero can be off"
            return f"{far}; the payload may be {abs(mass):.1f} kg {way} than configured"
        if max(abs(a), abs(b), abs(c)) > sensor.offset_torque + LEVER * wrong:
            far = f"{math.hypot(a, b, c):.2f} N·m is more than its zero can be off"
            return f"{far}; the payload's centre may be elsewhere than configured"
        return ""

    def _judge(self, estimate: Estimate, reference: Wrench, limits: ActivationLimits) -> list[Event]:
        """Find out whether zeroing is due; an event says when it becomes due."""
        R_BF = flat(estimate.R_BF)
        wrench = (*turned(R_BF, _three(reference[:3])), *turned(R_BF, _three(reference[3:])))
        felt, share = split(wrench, upward(estimate.g_B.tolist())), 0.0
        for limit, value in (
            (limits.payload_force, abs(felt.payload_force)),
            (limits.payload_torque, felt.payload_torque),
            (limits.user_force, felt.user_force),
            (limits.user_torque, felt.user_torque),
        ):
            if limit.on:
                share = max(share, value / limit.max)
        if self.due:
            self.due = share >= OVER
        elif share > DUE and not self._beyond(estimate, reference):
            self.due = True
            values: Values = {"force": math.hypot(*wrench[:3]), "torque": math.hypot(*wrench[3:])}
            return [Event(Kind.ZERO_DUE, estimate.tick, values)]
        return []


def _three(values: Wrench | list[float]) -> Vector:
    x, y, z = values
    return x, y, z


def _less(a: Wrench, b: Wrench) -> Wrench:
    return tuple([x - y for x, y in zip(a, b, strict=True)])
