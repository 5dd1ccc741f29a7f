"""The robot's limits: what the control law keeps the arm within, and what stops an arm that exceeds it (RL-4, RL-5, RL-6).

What can be kept is kept by moving more slowly. The power on what the tool meets is at most the force that the tool may have times
its speed, P = F v, so the speed of the tool is at most P / F as well.

The arm is stopped where it exceeds a limit by its tolerance. Source of the tolerances: Universal Robots, UR5e user manual (2021),
page 19, table of the safety functions.
"""

from math import degrees, inf, radians
from typing import NamedTuple

from pendant.events.event import Event, Kind, Values
from pendant.safety.settings import FASTEST, FURTHEST, JointPositions, JointSpeeds, RobotLimitSettings
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.limit_engine import Excess
from pendant.tick.modes import Safety

SPEED_TOLERANCE = 0.05  # of tool and elbow [m/s]
JOINT_SPEED_TOLERANCE = radians(1.15)  # [rad/s]
MOMENTUM_TOLERANCE = 3.0  # [kg·m/s]
POWER_TOLERANCE = 10.0  # [W]
TIME_TOLERANCE = 0.05  # [s]
DISTANCE_TOLERANCE = 0.04  # [m]
POSITION_TOLERANCE = radians(5.0)  # [rad]

ABOVE_RATED = 0.2
"""A joint that is so much faster than it is made for is stopped, whatever the limits allow [rad/s]. Source: safety configurations
that the maker publishes, 3.3416 rad/s for joints of 3.1416."""

SWING = radians(0.5)
"""A joint that is outside as it begins to be held or moved may come so much further out [rad]."""


class SpeedLimits(NamedTuple):
    """What the control law keeps the arm within, by moving it more slowly."""

    tcp: float  # [m/s]
    elbow: float  # [m/s]
    joints: tuple[float, ...]  # of each joint, n [rad/s]
    momentum: float = inf  # [kg·m/s]
    stopping_time: float = inf  # [s]
    stopping_distance: float = inf  # of tool or elbow [m]


class JointRange(NamedTuple):
    """Between which angles the arm's own motions keep the joints, n each [rad]."""

    low: tuple[float, ...]
    high: tuple[float, ...]


class RobotLimits(NamedTuple):
    """The limits of one safety mode for one arm."""

    mode: Safety
    speeds: SpeedLimits
    joint_speeds: tuple[float, ...]  # of each joint, from which it is stopped [rad/s]
    power: float  # [W]
    forces: tuple[float, float]  # of tool and link [N]
    joint_range: JointRange | None  # None: the arm's own


class ArmRating(NamedTuple):
    """What the arm's joints are made for, n each."""

    names: tuple[str, ...]
    ranges: tuple[tuple[float, float], ...]  # smallest and largest angle [rad]
    speeds: tuple[float, ...]  # [rad/s]


NO_FORCES = inf, inf
DEGREES = "°"


def robot_limits(settings: RobotLimitSettings, arm: ArmRating, *, reduced: bool) -> RobotLimits:
    """The limits of a safety mode. Those of REDUCED are never wider than those of NORMAL."""
    sets = (settings.normal, settings.reduced) if reduced else (settings.normal,)

    def least(name: str) -> float:
        return min(getattr(each, name) for each in sets)

    tool_force, power = least("tool_force"), least("power")
    speeds = SpeedLimits(
        min(least("tool_speed"), power / tool_force),
        least("elbow_speed"),
        _speeds([each.joint_speeds for each in sets], len(arm.speeds)),
        least("momentum"),
        least("stopping_time"),
        least("stopping_distance"),
    )
    return RobotLimits(
        Safety.REDUCED if reduced else Safety.NORMAL,
        speeds,
        tuple(
            [
                min(most + JOINT_SPEED_TOLERANCE, rated + ABOVE_RATED)
                for most, rated in zip(speeds.joints, arm.speeds, strict=True)
            ]
        ),
        power,
        (tool_force, least("elbow_force")),
        _range([each.positions for each in sets], arm.ranges),
    )


def _speeds(sets: list[JointSpeeds], n: int) -> tuple[float, ...]:
    """What each of n joints may have [rad/s]."""
    return tuple([min(getattr(each, f"j{k + 1}", FASTEST) for each in sets) for k in range(n)])


def _range(positions: list[JointPositions], ranges: tuple[tuple[float, float], ...]) -> JointRange | None:
    """What is left of each joint's own range; None where all of it is."""
    own = [(max(low, -FURTHEST), min(high, FURTHEST)) for low, high in ranges]
    low, high = [ends[0] for ends in own], [ends[1] for ends in own]
    for each in positions:
        for k in range(min(len(ranges), SET_JOINTS)):
            low[k] = max(low[k], getattr(each, f"j{k + 1}_min"))
            high[k] = min(high[k], getattr(each, f"j{k + 1}_max"))
    narrower = any((a, b) != ends for a, b, ends in zip(low, high, own, strict=True))
    return JointRange(tuple(low), tuple(high)) if narrower else None


SET_JOINTS = len(JointPositions.__struct_fields__) // 2
"""Joints whose positions can be limited."""


class LimitWatch:
    """The input of REDUCED with its time of grace, the limits that hold, and the watch over them.

    Args:
        arm: what its joints are made for.

    Attributes:
        reduced: the input's level.
    """

    NOT_STATE = ("_of", "_limits", "_normal")  # they follow from the settings and the level

    def __init__(self, arm: ArmRating) -> None:
        self._arm = arm
        self.reduced = False
        self._grace = 0  # ticks left in which the arm may still be faster
        self._out = [inf] * len(arm.ranges)  # how far outside each joint may be [rad]
        self._range: JointRange | None = None  # of the tick before
        self._mode: Safety | None = None  # of its limits
        self._of: tuple[RobotLimitSettings, bool] | None = None
        self._limits: RobotLimits | None = None
        self._normal: RobotLimits | None = None  # what holds until the arm has slowed down for REDUCED

    def switch(self, on: bool, settings: RobotLimitSettings) -> bool:
        """Take the input's level; returns whether it changed."""
        changed = on is not self.reduced
        if changed:
            self.reduced = on
            self._grace = ticks(settings.transition)
        return changed

    def limits(self, settings: RobotLimitSettings) -> RobotLimits | None:
        """What holds now, None where the limits are switched off."""
        if self._of is None or self._of[0] is not settings or self._of[1] is not self.reduced:
            self._of = settings, self.reduced
            self._normal = robot_limits(settings, self._arm, reduced=False) if settings.on else None
            self._limits = self.reduced_limits(settings) if settings.on and self.reduced else self._normal
        return self._limits

    def reduced_limits(self, settings: RobotLimitSettings) -> RobotLimits:
        """What holds in REDUCED."""
        return robot_limits(settings, self._arm, reduced=True)

    def forces(self, settings: RobotLimitSettings) -> tuple[float, float]:
        """Largest forces of tool and link [N]."""
        limits = self.limits(settings)
        return NO_FORCES if limits is None else limits.forces

    def rest(self, settings: RobotLimitSettings) -> None:
        """The arm is stopped, and braked: what it exceeds meanwhile is no reason for another stop."""
        limits = self.limits(settings)
        self._grace = 0
        self._range, self._mode = (None, None) if limits is None else (limits.joint_range, limits.mode)
        self._out[:] = [inf] * len(self._out)

    def step(self, estimate: Estimate, settings: RobotLimitSettings, *, moves: bool) -> Event | None:
        """The event of an arm that exceeds a limit by its tolerance, None where it does not. What is not a number does.

        Args:
            estimate: of this tick.
            settings: as they are now.
            moves: the arm follows a motion of its own: then it must be able to stop within the limits.
        """
        limits = self.limits(settings)
        if self._grace > 0:
            self._grace -= 1
            limits = self._normal if self.reduced else limits
        if limits is None:
            return None
        speeds, motion = limits.speeds, estimate.motion
        if not estimate.v_tcp <= speeds.tcp + SPEED_TOLERANCE:
            return _told(estimate, limits, Excess("tool speed", "tool", estimate.v_tcp, speeds.tcp, "m/s"))
        if not estimate.v_elbow <= speeds.elbow + SPEED_TOLERANCE:
            return _told(estimate, limits, Excess("elbow speed", "elbow", estimate.v_elbow, speeds.elbow, "m/s"))
        qd = estimate.qd.tolist()
        slow = sum(map(abs, qd)) <= min(limits.joint_speeds)  # in one go, as it mostly is
        for joint, (speed, most) in enumerate(() if slow else zip(qd, limits.joint_speeds, strict=True)):
            if not -most <= speed <= most:
                told = "joint speed", self._arm.names[joint], abs(speed), most - JOINT_SPEED_TOLERANCE, "rad/s"
                return _told(estimate, limits, Excess(*told))
        if not motion.momentum <= speeds.momentum + MOMENTUM_TOLERANCE:
            return _told(estimate, limits, Excess("momentum", "arm", motion.momentum, speeds.momentum, "kg·m/s"))
        if estimate.wrench_valid and not motion.power <= limits.power + POWER_TOLERANCE:
            return _told(estimate, limits, Excess("power", "tool", motion.power, limits.power, "W"))
        if moves and not motion.stopping_time <= speeds.stopping_time + TIME_TOLERANCE:
            return _told(estimate, limits, Excess("stopping time", "arm", motion.stopping_time, speeds.stopping_time, "s"))
        if moves and not motion.stopping_distance <= speeds.stopping_distance + DISTANCE_TOLERANCE:
            return _told(
                estimate, limits, Excess("stopping distance", "arm", motion.stopping_distance, speeds.stopping_distance, "m")
            )
        if limits.joint_range != self._range:
            # Who narrows limits round a standing arm may lead it back; one that REDUCED finds outside is stopped first.
            switched = self._mode is not None and self._mode is not limits.mode
            self._out[:] = [POSITION_TOLERANCE if switched else inf] * len(self._out)
        self._range, self._mode = limits.joint_range, limits.mode
        return None if limits.joint_range is None else self._outside(estimate, limits, limits.joint_range)

    def _outside(self, estimate: Estimate, limits: RobotLimits, joint_range: JointRange) -> Event | None:
        """The event of a joint that is further outside its limits than it may be.

        A joint that is outside as the arm begins to be held or moved may come back, and not go out again (as VW-10).
        """
        for joint, angle in enumerate(estimate.q.tolist()):
            low, high = joint_range.low[joint], joint_range.high[joint]
            out = max(angle - high, low - angle)
            allowed = self._out[joint] = max(POSITION_TOLERANCE, min(self._out[joint], out + SWING))
            if not out <= allowed:
                limit = high if angle > high else low
                return _told(
                    estimate, limits, Excess("joint position", self._arm.names[joint], degrees(angle), degrees(limit), DEGREES)
                )
        return None


def _told(estimate: Estimate, limits: RobotLimits, excess: Excess) -> Event:
    values: Values = {**excess._asdict(), "mode": limits.mode.name, "position": excess.unit == DEGREES}
    return Event(Kind.LIMIT_EXCEEDED, estimate.tick, values)
