"""The activation sequence (FD-9 to FD-12): the arm is freed for a while, to see whether it stays and nothing pulls at it."""

import math

from pendant.all_settings import Settings
from pendant.context import Surroundings
from pendant.events.event import Event, Kind, Values
from pendant.freedrive.settings import BeyondLimit
from pendant.limits.dynamic_limits import DynamicLimits, Shares, in_activation
from pendant.limits.parameters import ZEROS, EntryValues, Monitor, Observed
from pendant.limits.residual import PayloadError, Split, Vector, mass_error, split, upward, weight_error
from pendant.limits.validity import JOINTS_SENSED, joints_ok
from pendant.tick.estimate import Estimate
from pendant.tick.limit_engine import Gauge, Monitored
from pendant.tick.modes import TICK

FORCE_SENSED = "flange force sensor"
ACCELERATION_SENSED = "flange accelerometer"

PAYLOAD_LIKE = frozenset({"payload-like force", "payload-like torque", "payload error"})

SHORTEST = 0.25
"""Period that needs neither the handshake nor a stored state (FD-9) [s]."""

COMPARED = (
    "flange_displacement",
    "joint_displacement",
    "joint_torque",
    "payload_force",
    "payload_torque",
    "user_force",
    "user_torque",
)
"""Parameters whose change since a stored state is a parameter of its own, with the same limit."""

AGAINST = ", against stored"
"""Added to the names of these."""


class Sequence:
    """One run of it, from its first tick on."""

    __slots__ = (
        "_acceleration",
        "_against",
        "_dynamic",
        "_force",
        "_joints",
        "_monitor",
        "_payload",
        "_scale",
        "_share",
        "_since",
        "_start",
        "_up",
        "_wrench",
    )

    def __init__(
        self,
        around: Surroundings,
        settings: Settings,
        *,
        joints: tuple[str, ...],
        rated: tuple[float, ...],
        stored: EntryValues | None = None,
    ) -> None:
        """
        Args:
            around: the tick in which it starts; its joint values are finite.
            settings: as they are now; they stay so to the end of the sequence.
            joints: names, base to flange.
            rated: torque of each joint [N·m].
            stored: an earlier state, with the same sensors, that it is compared with as well; None: with none.
        """
        limits = settings.limits.activation
        estimate = around.estimate
        self._monitor = Monitor(limits)
        self._against = None if stored is None else (stored, Monitor(limits, COMPARED, AGAINST))
        self._joints = joints
        self._scale = rated
        self._share = limits.load_share
        # Torques are judged as they are, not as changes: what was wrong before is what is looked for.
        place, angles = tuple(estimate.p_BF.tolist()), tuple(estimate.q.tolist())
        self._since = EntryValues(place, ZEROS, (0.0,) * len(joints), angles)
        self._wrench = around.wrench_ok
        self._acceleration = estimate.acceleration_valid
        self._up: Vector = upward(estimate.g_B.tolist())
        self._payload, self._force = around.payload_error, split(around.mean.mean(), self._up).payload_force  # at the start
        self._start = estimate.tick
        self._dynamic = DynamicLimits(in_activation(settings), estimate)

    def missing(self, around: Surroundings) -> str:
        """The sensor without which no decision is possible (FD-12), or nothing. What was never there is not missed (FD-3a)."""
        if not joints_ok(around.estimate):
            return JOINTS_SENSED
        if self._wrench and not around.wrench_ok:
            return FORCE_SENSED
        if self._acceleration and not around.estimate.acceleration_valid:
            return ACCELERATION_SENSED
        return ""

    def check(self, around: Surroundings) -> list[Gauge]:
        """Check every parameter in a tick in which nothing is missing; those beyond their limits."""
        parts = split(around.mean.mean(), self._up) if self._wrench else None
        shares = self._shares(around.estimate, parts)
        payload = self._payload
        if parts is not None and payload is not None:
            # What the force has changed by since the start, a payload may have as well.
            payload = PayloadError(payload.mass + mass_error(parts.payload_force - self._force), payload.margin)
        view = Observed(around.estimate, self._since, parts, self._joints, self._scale, self._share, shares, payload=payload)
        beyond = self._monitor.step(view)
        if self._against is None:
            return beyond
        stored, changes = self._against
        if self._wrench:
            parts = split([now - then for now, then in zip(around.mean.mean(), stored.wrench, strict=True)], self._up)
        return beyond + changes.step(Observed(around.estimate, stored, parts, self._joints, self._scale, self._share, shares))

    def _shares(self, estimate: Estimate, parts: Split | None) -> Shares:
        """What is left of the limits (FD-12b). Without a sensor no force lowers them."""
        if parts is None or not self._dynamic.pushed:
            return self._dynamic.step(estimate)
        force = math.hypot(parts.payload_force, parts.user_force)
        return self._dynamic.step(estimate, force, math.hypot(parts.payload_torque, parts.user_torque))

    def monitored(self) -> tuple[Monitored, ...]:
        """What was checked last."""
        told = self._monitor.monitored()
        return told if self._against is None else told + self._against[1].monitored()

    def reasons(self, beyond: list[Gauge], around: Surroundings) -> list[Event]:
        """Every parameter that prevented entry (FD-11)."""
        tick = around.estimate.tick
        after = (tick - self._start) * TICK
        return [Event(Kind.ENTRY_PREVENTED, tick, {**gauge.excess._asdict(), "time": after}) for gauge in beyond]

    def refusal(self, beyond: list[Gauge], around: Surroundings, settings: Settings) -> Event:
        """That they refuse free-drive (FD-10). One that a payload may explain comes first."""
        tick = around.estimate.tick
        gauge = next((gauge for gauge in beyond if gauge.name in PAYLOAD_LIKE), beyond[0])
        excess = gauge.excess
        if settings.sequence.beyond_limit is BeyondLimit.PROTECTIVE_STOP:
            return Event(Kind.SEQUENCE_STOPPED, tick, dict(excess._asdict()))
        if gauge.name in PAYLOAD_LIKE:
            force, known = _payload_like(around, self._up, settings)
            values: Values = {"mass": mass_error(force), "force": abs(force), "way": "up" if force > 0.0 else "down"}
            values |= {"zero": around.maybe_zero and not known, "parameter": excess.parameter}
            return Event(Kind.REFUSED_PAYLOAD, tick, values)
        return Event(Kind.REFUSED_LIMIT, tick, dict(excess._asdict()))


class SequenceVerdict:
    """Payload or push: what was refused as either is told apart by what stays when the user lets go (FD-11, FD-22)."""

    __slots__ = ("_bias", "_force", "_known", "_up", "waiting")

    GONE = 0.5  # share of the force below which it counts as gone
    SAME = 1.5  # a force that stayed within so much is the same [N]

    def __init__(self) -> None:
        self.waiting = False
        self._force = self._bias = 0.0
        self._known = False  # the sensor's bias, which is part of what is felt [N]
        self._up: Vector = (0.0, 0.0, 1.0)

    def begin(self, around: Surroundings, settings: Settings) -> None:
        """A refusal that may be payload or push."""
        self._up = upward(around.estimate.g_B.tolist())
        self._force, self._known = _payload_like(around, self._up, settings)
        self._bias = split(around.mean.mean(), self._up).payload_force - self._force
        self.waiting = True

    def step(self, around: Surroundings, last: bool) -> list[Event]:
        """One tick of the cool-down, or its `last`."""
        if not around.wrench_ok:
            self.waiting = False
            return []
        tick = around.estimate.tick
        force = split(around.mean.mean(), self._up).payload_force - self._bias
        if abs(force) < self.GONE * abs(self._force):
            self.waiting = False
            return [Event(Kind.RESIDUAL_GONE, tick, {"force": abs(self._force), "left": abs(force)})]
        if not last:
            return []
        self.waiting = False
        if abs(force - self._force) > self.SAME:
            return []
        zero = around.maybe_zero and not self._known
        return [Event(Kind.RESIDUAL_STAYED, tick, {"force": abs(force), "mass": mass_error(force), "zero": zero})]


def _payload_like(around: Surroundings, up: Vector, settings: Settings) -> tuple[float, bool]:
    """The force as a wrong payload would cause it, without the sensor's bias where that is known, and whether it is [N]."""
    known = around.payload_error
    if known is not None and (not around.wrench_ok or known.margin <= settings.limits.activation.payload_error.max):
        return weight_error(known.mass), True
    return split(around.mean.mean(), up).payload_force, False
