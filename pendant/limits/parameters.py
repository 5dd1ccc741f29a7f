"""The parameters that limits bound: how each is read from what the controller knows in one tick (FD-9, FD-13, FD-18)."""

import math
from collections.abc import Callable, Iterable, Sequence
from operator import sub, truediv
from typing import NamedTuple

import msgspec

from pendant.limits.dynamic_limits import WHOLE, Shares
from pendant.limits.residual import PayloadError, Split
from pendant.limits.settings import LimitReaction
from pendant.settings.schema import Limit, Section, ticks
from pendant.tick.estimate import Estimate
from pendant.tick.limit_engine import Gauge, Monitored
from pendant.tick.pose import Wrench

ZEROS = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class EntryValues(NamedTuple):
    """What held when a stage or a period began."""

    position: tuple[float, ...]  # of the flange in B [m]
    wrench: tuple[float, ...]  # F_user [N, N·m]
    torques: tuple[float, ...]  # tau_ext [N·m]
    angles: tuple[float, ...]  # q [rad]


class Observed(msgspec.Struct, frozen=True, gc=False):
    """What parameters are read from."""

    estimate: Estimate
    since: EntryValues
    split: Split | None  # of the user's wrench; None: there is no flange sensor to go by (FD-3a)
    joints: tuple[str, ...]
    scale: tuple[float, ...]  # of the joint torque limits, for each joint
    share: float  # of a joint's load torque by which its limit rises
    shares: Shares = WHOLE  # of the limits that are left (FD-12b)
    heavier: float = 0.0  # by how much the load raises the limit on the user's force [N] (FD-13)
    payload: PayloadError | None = None  # None: nothing is known of it


Read = tuple[float, str, float]
"""A parameter's value in one tick, its joint or part, and its upper limit in this tick."""

Reader = Callable[[Observed, float], Read]
"""Reads a parameter from what is observed and from its upper limit as it is set."""


def _flange_displacement(view: Observed, base: float) -> Read:
    x, y, z = view.estimate.p_BF.tolist()
    x0, y0, z0 = view.since.position
    x, y, z = x - x0, y - y0, z - z0
    if view.shares.lowered:
        base = base * view.shares.way * view.shares.along(x, y, z)
    return math.hypot(x, y, z), "flange", base


def _flange_speed(view: Observed, base: float) -> Read:
    x, y, z = view.estimate.v_F.tolist()[:3]
    if view.shares.lowered:
        base = base * view.shares.speed * view.shares.along(x, y, z)
    return math.hypot(x, y, z), "flange", base


def beyond_gravity(estimate: Estimate) -> float:
    """What the flange's accelerometer feels beyond gravity [m/s²]."""
    return math.hypot(*estimate.a_felt.tolist())


def _flange_acceleration(view: Observed, base: float) -> Read:
    x, y, z = view.estimate.a_felt.tolist()
    if view.shares.lowered:
        base = base * view.shares.linear * view.shares.along(x, y, z)
    return math.hypot(x, y, z), "flange", base


def _tcp_speed(view: Observed, base: float) -> Read:
    if view.shares.lowered:
        base = base * view.shares.speed * view.shares.along(*view.estimate.tcp.tolist()[3:])
    return view.estimate.v_tcp, "tcp", base


def _elbow_speed(view: Observed, base: float) -> Read:
    if view.shares.lowered:
        base = base * view.shares.speed * view.shares.along(*view.estimate.elbow.tolist()[3:])
    return view.estimate.v_elbow, "elbow", base


def _joint_displacement(view: Observed, base: float) -> Read:
    size, joint = _largest(list(map(sub, view.estimate.q.tolist(), view.since.angles)), view)
    return size, joint, base * view.shares.way


def _joint_speed(view: Observed, base: float) -> Read:
    size, joint = _largest(view.estimate.qd.tolist(), view)
    return size, joint, base * view.shares.turning


def _joint_acceleration(view: Observed, base: float) -> Read:
    size, joint = _largest(view.estimate.qdd.tolist(), view)
    return size, joint, base * view.shares.angular


def _largest(values: list[float], view: Observed) -> tuple[float, str]:
    """The largest in size, and its joint."""
    most, least = max(values), min(values)
    if most >= -least:
        return most, view.joints[values.index(most)]
    return -least, view.joints[values.index(least)]


def _nearest(torques: list[float], scale: Sequence[float], view: Observed, base: float = 1.0) -> Read:
    """Of torques with limits of `base` times `scale`, the one that is nearest to its limit."""
    _, part = _largest(list(map(truediv, torques, scale)), view)
    joint = view.joints.index(part)
    return abs(torques[joint]), part, base * scale[joint]


def _motor_torque(view: Observed, base: float) -> Read:
    """The motor that comes nearest to its limit; its limit is the parameter's, in N·m."""
    return _nearest(view.estimate.tau_m.tolist(), view.scale, view, base)


def _motor_current(view: Observed, base: float) -> Read:
    """The motor whose current comes nearest to the largest that it may have; a share of that."""
    size, part = _largest(view.estimate.current.tolist(), view)
    return size, part, base


def _joint_torque(view: Observed, base: float) -> Read:
    """The joint that comes nearest to its limit; its limit is the parameter's, in N·m, and rises with the load by a share. Such a
    limit is never less than what the encoders of a joint that nobody touches make of its torque."""
    estimate, share = view.estimate, view.share
    changes = list(map(sub, estimate.tau_ext.tolist(), view.since.torques))
    if share == 0.0:
        return _nearest(changes, view.scale, view, base)
    least = [base * rated for rated in view.scale]
    loads = zip(map(max, least, estimate.tau_blur or least), estimate.tau_J.tolist(), strict=True)
    return _nearest(changes, [limit + share * abs(load) for limit, load in loads], view)


def _payload_force(view: Observed, base: float) -> Read:
    return _of(view).payload_force, "flange", base


def _payload_torque(view: Observed, base: float) -> Read:
    return _of(view).payload_torque, "flange", base


def _payload_error(view: Observed, base: float) -> Read:
    """Its limit is never less than what a right payload may seem to be wrong by."""
    known = view.payload
    return (0.0, "", base) if known is None else (abs(known.mass), "flange", max(base, known.margin))


def _user_force(view: Observed, base: float) -> Read:
    return _of(view).user_force, "flange", base + view.heavier


def _user_torque(view: Observed, base: float) -> Read:
    return _of(view).user_torque, "flange", base


def _of(view: Observed) -> Split:
    assert view.split is not None
    return view.split


class Parameter(NamedTuple):
    """How a parameter is called and read, and what it needs."""

    text: str
    unit: str
    read: Reader
    wrench: bool = False  # needs the flange's force/torque sensor
    acceleration: bool = False  # needs the flange's accelerometer
    signed: bool = False  # its limit is a range around zero


PARAMETERS: dict[str, Parameter] = {
    "flange_displacement": Parameter("flange displacement", "m", _flange_displacement),
    "flange_speed": Parameter("flange speed", "m/s", _flange_speed),
    "flange_acceleration": Parameter("flange acceleration", "m/s²", _flange_acceleration, acceleration=True),
    "tcp_speed": Parameter("tcp speed", "m/s", _tcp_speed),
    "elbow_speed": Parameter("elbow speed", "m/s", _elbow_speed),
    "joint_displacement": Parameter("joint displacement", "rad", _joint_displacement),
    "joint_speed": Parameter("joint speed", "rad/s", _joint_speed),
    "joint_acceleration": Parameter("joint acceleration", "rad/s²", _joint_acceleration),
    "motor_torque": Parameter("motor torque", "N·m", _motor_torque),
    "motor_current": Parameter("motor current", "of largest", _motor_current),
    "joint_torque": Parameter("joint external torque", "N·m", _joint_torque),
    "payload_force": Parameter("payload-like force", "N", _payload_force, wrench=True, signed=True),
    "payload_torque": Parameter("payload-like torque", "N·m", _payload_torque, wrench=True),
    "payload_error": Parameter("payload error", "kg", _payload_error),
    "user_force": Parameter("user force", "N", _user_force, wrench=True),
    "user_torque": Parameter("user torque", "N·m", _user_torque, wrench=True),
}
"""By the name of its limit in the settings."""


class Monitor:
    """All limits of one stage that are switched on."""

    __slots__ = ("_gauges", "_needs")

    def __init__(self, limits: Section, names: Iterable[str] = PARAMETERS, suffix: str = "") -> None:
        """
        Args:
            limits: a section of `pendant.limits.settings.Limits`.
            names: of the parameters that are looked at.
            suffix: of what they are called.
        """
        self._gauges: list[tuple[Reader, Gauge]] = []  # how it is read
        self._needs: list[tuple[bool, bool]] = []  # of each: the flange's force/torque sensor, its accelerometer
        for name in names:
            parameter, limit = PARAMETERS[name], getattr(limits, name, None)
            if isinstance(limit, Limit) and limit.on:
                stop = getattr(limit, "reaction", None) is LimitReaction.STOP
                low = -limit.max if parameter.signed else -math.inf
                text, allowed = parameter.text + suffix, ticks(limit.time)
                gauge = Gauge(text, parameter.unit, low=low, high=limit.max, allowed=allowed, stop=stop)
                self._gauges.append((parameter.read, gauge))
                self._needs.append((parameter.wrench, parameter.acceleration))

    def step(self, view: Observed) -> list[Gauge]:
        """Check one tick; its joint values are finite. Returns what was beyond for longer than allowed."""
        beyond: list[Gauge] = []
        gauges, way = self._gauges, view.shares.way
        no_wrench, no_acceleration = view.split is None, not view.estimate.acceleration_valid
        if no_wrench or no_acceleration:
            needs = zip(gauges, self._needs, strict=True)
            gauges = [each for each, (wrench, felt) in needs if not ((no_wrench and wrench) or (no_acceleration and felt))]
        for read, gauge in gauges:
            value, gauge.part, gauge.high = read(view, gauge.base)
            if not gauge.beyond and gauge.low <= value <= gauge.high:  # as nearly always: without a call
                gauge.value = value
            elif gauge.judge(value, gauge.part, way):
                beyond.append(gauge)
        return beyond

    def monitored(self) -> tuple[Monitored, ...]:
        """The values of the last step against their limits; without those that could not be read."""
        # Written out, for it is asked for in every tick of the sequence: as `Gauge.monitored`.
        return tuple([Monitored(g.name, g.part, g.value, g.low, g.high, g.unit) for _, g in self._gauges if g.part])


def reference(estimate: Estimate, wrench: Wrench | None) -> EntryValues:
    """What is stored when a period begins, with this F_user, axes of B [N, N·m]; None is without it."""
    return EntryValues(
        tuple(estimate.p_BF.tolist()), wrench or ZEROS, tuple(estimate.tau_ext.tolist()), tuple(estimate.q.tolist())
    )
