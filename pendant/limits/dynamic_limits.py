"""Limits that fall: with acceleration, load, direction and hand, and for what moves on and on the same way (FD-12b)."""

import math
from typing import NamedTuple

from pendant.all_settings import Settings
from pendant.limits.residual import upward
from pendant.limits.settings import Soft
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.pose import Vector

DRIFTING = 0.02
"""Speed of the flange in free-drive from which on it has a direction [m/s]."""

CREEPING = 0.002
"""The same in the activation sequence, where it hardly moves [m/s]."""

ABOUT = math.cos(math.radians(45.0))
"""Cosine of the angle up to which a direction is about the same."""


class Shares(NamedTuple):
    """What is left of limits, each 1 where nothing lowers it."""

    way: float = 1.0  # of displacements and of the time beyond a limit
    speed: float = 1.0  # of linear speeds
    turning: float = 1.0  # of angular speeds
    linear: float = 1.0  # of linear accelerations
    angular: float = 1.0  # of angular accelerations
    vertical: float = 1.0  # of linear quantities along gravity, beside the others
    up: Vector = (0.0, 0.0, 1.0)  # axes of B
    lowered: bool = True  # a rule may lower them; else all are 1 and stay so

    @property
    def isotropic(self) -> bool:
        """The limits are the same in every direction."""
        return self.vertical == 1.0

    def along(self, x: float, y: float, z: float) -> float:
        """What is left of the limit of a linear quantity in the direction of (x, y, z), axes of B.

        The limits of all directions are an ellipsoid of revolution: 1 across gravity, `vertical` along it.
        """
        least = self.vertical
        if least == 1.0:
            return 1.0
        square = x * x + y * y + z * z
        if square == 0.0:
            return 1.0
        ux, uy, uz = self.up
        along = x * ux + y * uy + z * uz
        return 1.0 / math.sqrt(1.0 + along * along / square * (1.0 / (least * least) - 1.0))


WHOLE = Shares(lowered=False)
"""Nothing is lowered."""


class Rules(NamedTuple):
    """What lowers limits; a rule that is off has the value that changes nothing."""

    acceleration: float  # way is divided by 1 plus this for each m/s² [s²/m]
    payload: float  # speeds and accelerations are divided by 1 plus this for each kg [1/kg]
    drift: bool
    drift_ticks: int  # for which a direction may be about the same
    drift_share: float  # of speeds that is left then
    drift_speed: float  # from which on there is a direction [m/s]
    force: float  # linear speeds and accelerations are divided by 1 plus this for each newton [1/N]
    torque: float  # angular ones for each newton metre [1/(N·m)]
    vertical: float  # share that is left along gravity


def in_operation(settings: Settings) -> Rules:
    """The rules in free-drive."""
    on = settings.soft
    return _rules(
        on,
        acceleration=on.acceleration,
        payload=on.payload,
        drift=on.drift,
        pushed=on.pushed,
        vertical=on.vertical,
        drift_speed=DRIFTING,
    )


def in_activation(settings: Settings) -> Rules:
    """The rules in the activation sequence."""
    on = settings.sequence.dynamic
    return _rules(
        settings.soft,
        acceleration=on.acceleration,
        payload=on.payload,
        drift=on.drift,
        pushed=on.pushed,
        vertical=on.vertical,
        drift_speed=CREEPING,
    )


def _rules(
    soft: Soft, *, acceleration: bool, payload: bool, drift: bool, pushed: bool, vertical: bool, drift_speed: float
) -> Rules:
    return Rules(
        acceleration=soft.acceleration_share if acceleration else 0.0,
        payload=soft.payload_share if payload else 0.0,
        drift=drift,
        drift_ticks=ticks(soft.drift_time),
        drift_share=soft.drift_share,
        drift_speed=drift_speed,
        force=soft.force_share if pushed else 0.0,
        torque=soft.torque_share if pushed else 0.0,
        vertical=soft.vertical_share if vertical else 1.0,
    )


class DynamicLimits:
    """What is left of the limits of one stage, tick by tick.

    Attributes:
        pushed: the rules look at the hand's force and torque.
        shares: of this tick; the same object as long as nothing changes.
    """

    __slots__ = ("_asked", "_heading", "_idle", "_rules", "_same", "_up", "pushed", "shares")

    def __init__(self, rules: Rules, estimate: Estimate) -> None:
        """
        Args:
            rules: of the stage.
            estimate: of any tick, for the direction of gravity.
        """
        self._rules = rules
        self._idle = not (rules.acceleration or rules.payload or rules.drift or rules.force or rules.torque)
        self._up = upward(estimate.g_B.tolist())
        self._heading = (0.0, 0.0, 0.0)  # direction in which the motion began, axes of B
        self._same = 0  # ticks for which it has been about the same
        self._asked = (0.0, 0.0, 0.0, 0.0, False)  # acceleration, load, force, torque, drifting
        self.pushed = bool(rules.force or rules.torque)
        self.shares = WHOLE if rules.vertical == 1.0 else Shares(vertical=rules.vertical, up=self._up)

    def step(self, estimate: Estimate, force: float = 0.0, torque: float = 0.0) -> Shares:
        """One tick; its joint values are finite. Without an accelerometer, acceleration lowers nothing.

        Args:
            estimate: of this tick.
            force: the hand's [N].
            torque: the hand's [N·m].
        """
        if self._idle:
            return self.shares
        rules = self._rules
        acceleration = 0.0
        if rules.acceleration and estimate.acceleration_valid:
            x, y, z = estimate.a_felt.tolist()
            acceleration = math.sqrt(x * x + y * y + z * z)
        way = 1.0 / (1.0 + rules.acceleration * acceleration)
        drifts = rules.drift and self._drifts(estimate, rules, way)
        asked = (acceleration, estimate.load_mass, force, torque, drifts)
        if asked != self._asked:
            self._asked = asked
            loaded = 1.0 / (1.0 + rules.payload * estimate.load_mass)
            linear, angular = loaded / (1.0 + rules.force * force), loaded / (1.0 + rules.torque * torque)
            still = rules.drift_share if drifts else 1.0
            self.shares = Shares(way, still * linear, still * angular, linear, angular, rules.vertical, self._up)
        return self.shares

    def _drifts(self, estimate: Estimate, rules: Rules, way: float) -> bool:
        """The flange has moved in about the same direction for long."""
        x, y, z = estimate.v_F.tolist()[:3]
        speed = math.sqrt(x * x + y * y + z * z)
        if speed < rules.drift_speed:
            self._same = 0
            return False
        hx, hy, hz = self._heading
        if self._same and x * hx + y * hy + z * hz >= ABOUT * speed:
            self._same += 1
        else:
            self._heading, self._same = (x / speed, y / speed, z / speed), 1
        return self._same > rules.drift_ticks * way
