"""What a script asks of the arm: the arguments of its motion functions, checked, in SI units and axes of B."""

from typing import NamedTuple

from app.urscript.machine.values import PoseValue

Joints = tuple[float, ...]


class MoveAsk(NamedTuple):
    """movej, movel, movep, movec: to joint angles or to a pose."""

    kind: str  # "j", "l", "p" or "c"
    target: Joints | PoseValue
    acceleration: float  # [rad/s²], [m/s²] of the tool
    speed: float  # [rad/s], [m/s]
    time: float = 0.0  # [s]; 0: by speed and acceleration
    blend: float = 0.0  # radius [m]
    via: Joints | PoseValue = ()  # of a circle
    fixed: bool = False  # on a circle the tool keeps its orientation to the tangent


class ServoAsk(NamedTuple):
    """servoj: towards joint angles, in the time of one call."""

    q: Joints
    time: float
    lookahead: float
    gain: float


class CircleServoAsk(NamedTuple):
    """servoc: towards a pose, with a blend."""

    target: Joints | PoseValue
    acceleration: float
    speed: float
    blend: float


class SpeedAsk(NamedTuple):
    """speedj, speedl: a speed that is kept."""

    kind: str  # "j" or "l"
    speed: Joints  # [rad/s], or linear and angular of the tool [m/s, rad/s]
    acceleration: float
    time: float  # after which it ends; 0: as soon as the acceleration is over
    turning: float = 0.0  # angular acceleration of speedl [rad/s²]


class StopAsk(NamedTuple):
    """stopj, stopl."""

    kind: str
    deceleration: float


class ForceAsk(NamedTuple):
    """force_mode: compliant along some axes of a frame."""

    frame: PoseValue  # in B
    selection: tuple[bool, ...]
    wrench: Joints  # [N, N·m]
    type: int  # 1, 2 or 3
    limits: Joints  # speeds along compliant axes, deviations along the others
    damping: float = 0.025
    gain_scaling: float = 1.0


class ForceEndAsk(NamedTuple):
    """end_force_mode."""


class FreeDriveAsk(NamedTuple):
    """freedrive_mode: guided by hand along some axes of a frame."""

    axes: tuple[bool, ...] = (True,) * 6
    feature: PoseValue | None = None  # in B; None: the base, "tool" is resolved by then


class FreeDriveEndAsk(NamedTuple):
    """end_freedrive_mode."""
