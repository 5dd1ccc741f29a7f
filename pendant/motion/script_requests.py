"""What a script asks of the arm: its motion, guiding by hand. SI units; poses and directions in axes of B.

Each motion takes the place of the one before: from a moving arm the next one begins without a stop where the one before has
a blend radius, else the arm comes to rest on its way while the next begins.
"""

import math
from typing import Literal

import msgspec

from pendant.program.steps import MOST_FORCE, GentleStop, HandGuide, LinearMove, Move
from pendant.tick.pose import UNTURNED, Rotation, Vector

LOOKAHEAD = (0.03, 0.2)
"""Of servoj [s] (URScript manual)."""

GAIN = (100.0, 2000.0)
"""Of servoj [1/s²] (URScript manual)."""

SCALE = (0.0, 1.0)
"""Of direct_torque's friction (URScript manual)."""

MOST_MOMENT = 10.0
"""That a script may twist with [N·m]: within the sensor's range."""

SIX_WAYS = ("x", "y", "z", "rx", "ry", "rz")
"""Along the axes of a frame, then about them."""


class ScriptedJoints(Move, tag="movej", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """To joint angles, straight in joint angles; the joint with the longest way has the speed and the acceleration."""

    q: tuple[float, ...]  # (n,) [rad]
    acceleration: float  # [rad/s²]
    speed: float  # [rad/s]
    time: float = 0.0  # that it takes, in place of speed and acceleration; 0: they count [s]
    blend: float = 0.0  # so near to its end it may go over into the next motion [m]

    def __post_init__(self) -> None:
        _finite(*self.q, self.acceleration, self.speed, self.time, self.blend)


class ScriptedLine(LinearMove, tag="movel", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point along a straight line to a pose."""

    time: float = 0.0  # as of ScriptedJoints [s]
    blend: float = 0.0  # [m]


class ScriptedArc(LinearMove, tag="movec", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point along the circle through where it is, `via` and its end."""

    via: Vector  # [m]
    fixed: bool = False  # the tool keeps its orientation to the tangent; else it turns evenly to that of the end
    time: float = 0.0  # as of ScriptedJoints [s]
    blend: float = 0.0  # [m]


class ScriptedProcess(LinearMove, tag="movep", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point along a straight line to a pose, from the line before on a circle, at one speed."""

    blend: float = 0.0  # so far from its end, and from the begin of the next such line, a circle joins them [m]


class ServoJoints(Move, tag="servoj", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Towards joint angles that are given again and again. Without a new one after its time the arm comes to rest."""

    q: tuple[float, ...]  # (n,) [rad]
    time: float  # for which it holds [s]
    lookahead: float = 0.1  # [s]
    gain: float = 300.0  # [1/s²]

    def __post_init__(self) -> None:
        _finite(*self.q, self.time)
        _within("lookahead", self.lookahead, LOOKAHEAD)
        _within("gain", self.gain, GAIN)


class ServoTool(LinearMove, tag="servoc", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The tool centre point towards a pose that is given again and again, at constant speed."""

    blend: float = 0.0  # [m]


class SpeedJoints(Move, tag="speedj", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Joint speeds."""

    qd: tuple[float, ...]  # (n,) [rad/s]
    acceleration: float  # of the joint whose speed changes most [rad/s²]
    time: float = 0.0  # after which the arm comes to rest; 0: when something else is asked for [s]

    def __post_init__(self) -> None:
        _finite(*self.qd, self.acceleration, self.time)


class SpeedTool(Move, tag="speedl", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A speed of the tool centre point, and one about it."""

    speed: Vector  # [m/s]
    turning: Vector  # [rad/s]
    acceleration: float  # [m/s²]
    turning_acceleration: float  # [rad/s²]
    time: float = 0.0  # as of SpeedJoints [s]

    def __post_init__(self) -> None:
        _finite(*self.speed, *self.turning, self.acceleration, self.turning_acceleration, self.time)


class DirectTorque(Move, tag="direct_torque", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Joint torques for one tick, in addition to those against gravity; without new ones in the next tick the arm comes to rest.

    Source: URScript manual 5.25, direct_torque.
    """

    torque: tuple[float, ...]  # (n,) of the joints on the arm [N·m]
    viscous: tuple[float, ...]  # (n,) share of the friction that grows with the speed which the motors bear
    coulomb: tuple[float, ...]  # (n,) share of the friction that does not

    def __post_init__(self) -> None:
        _finite(*self.torque)
        for share in self.viscous:
            _within("viscous_scale", share, SCALE)
        for share in self.coulomb:
            _within("coulomb_scale", share, SCALE)


class Guided(HandGuide, tag="freedrive_mode", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The arm is guided by hand, after the activation sequence, along and about the free axes of a frame."""

    axes: tuple[bool, ...] = (True,) * 6  # x y z rx ry rz that are free
    R_BU: Rotation = UNTURNED  # the frame


ScriptedMove = (
    ScriptedJoints
    | ScriptedLine
    | ScriptedArc
    | ScriptedProcess
    | ServoJoints
    | ServoTool
    | SpeedJoints
    | SpeedTool
    | DirectTorque
    | GentleStop
    | Guided
)


class ForceMode(msgspec.Struct, frozen=True, kw_only=True, gc=False):
    """The arm pushes along and about some axes of a frame, and gives way there; along and about the others it moves as it should.

    Source: URScript manual, force_mode.
    """

    free: tuple[bool, ...]  # x y z rx ry rz along and about which it pushes
    wrench: tuple[float, ...]  # (6,) of the arm on what it touches, at the tool centre point [N, N·m]
    limits: tuple[float, ...]  # (6,) free: largest speed [m/s, rad/s]; others: largest distance from the motion [m, rad]
    origin: Vector  # of the frame, in B [m]
    R_BU: Rotation  # its orientation
    turns: Literal["not", "to_origin", "with_motion"] = "not"  # its y points from the tool to its origin; its x goes as the tool
    gain: float = 1.0  # of what the missing force changes
    damping: float | None = None  # share of its speed that it loses in a tick; None: it has no inertia

    def __post_init__(self) -> None:
        _finite(*self.wrench, *self.limits, *self.origin, self.gain)
        for k, limit in enumerate(self.limits):
            if limit < 0.0:
                raise ValueError(f"limits: {limit:g} for {SIX_WAYS[k]}, allowed: 0 or more")
        wanted = [value if free else 0.0 for value, free in zip(self.wrench, self.free, strict=True)]
        for what, size, most in (
            ("force", math.hypot(*wanted[:3]), MOST_FORCE),
            ("torque", math.hypot(*wanted[3:]), MOST_MOMENT),
        ):
            if size > most:
                raise ValueError(f"wrench: a {what} of {size:.4g}, allowed: {most:g} at most")


class PathOffset(msgspec.Struct, frozen=True, kw_only=True, gc=False):
    """The tool goes beside the way of its motions: at their pose, turned and moved as a body that is fixed to a frame.

    The frame is the base; or it has its origin in the tool centre point of the motion, and the tool's axes, or those of the way:
    x along it, y = x × the tool's z. Source: URScript manual, path_offset_set and track_conveyor_circular.
    """

    frame: Literal["base", "tool", "way"] = "base"
    position: Vector  # that the frame's origin gets [m]
    turn: Vector  # axis times angle [rad]
    turns_tool: bool = True  # else the tool keeps the orientation of its motion

    def __post_init__(self) -> None:
        _finite(*self.position, *self.turn)


class Scripted(msgspec.Struct, frozen=True, kw_only=True, gc=False):
    """What the running script wants of the arm. It is said in every tick: without it the arm comes to rest (FD-23).

    The motion's `id` is the script's own number of it, greater than that of every motion before: a new number is a new motion.
    `Decision.script_done` is the number of the last motion that is done, or has come to where the next one may begin.
    """

    move: ScriptedMove | None = None  # None: none yet, the arm stands
    force: ForceMode | None = None  # while it moves; None: the arm only moves
    offset: PathOffset | None = None  # beside its motions, in place of a force; None: it is on their way
    feeling: bool = False  # changes in contact are to be looked for
    over: bool = False  # the script has ended; the arm comes to rest
    equips: bool = False  # tool and payload in the inputs of this tick are the script's


def _finite(*values: float) -> None:
    for value in values:
        if not math.isfinite(value):
            raise ValueError(f"{value!r} is not a finite number")


def _within(what: str, value: float, allowed: tuple[float, float]) -> None:
    least, most = allowed
    if not least <= value <= most:
        raise ValueError(f"{what}: {value:g}, allowed: {least:g} .. {most:g}")
