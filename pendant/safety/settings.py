"""Settings of the protective stops, and of the robot's limits."""

from typing import Annotated

from msgspec import Meta

from pendant.settings.schema import Section
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class FollowingSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How far the arm may be from its reference. Source of the tool's limit: ISO 13854, the least gap that crushes no finger."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("RL-1", "an arm that does not follow its reference is stopped")] = True
    joint: Annotated[
        float,
        _number(0.2, 1.0, "", "RL-1", text="largest error of a joint, as a share of that at which it gives its rated torque"),
    ] = 0.6
    tool: Annotated[
        float, _number(0.005, 0.1, "m", "RL-1", text="largest distance of the tool centre point from where it should be")
    ] = 0.025


class CollisionSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """With which force the arm may meet something. Source of the clamping force: the third of a UR's four presets of limits."""

    BASIC = ("on", "force")

    on: Annotated[bool, _switch("RL-3", "an arm that hits something is stopped")] = True
    force: Annotated[
        float, _number(20.0, 250.0, "N", "RL-3", text="force on tool or link at which a moving arm takes it for a collision")
    ] = 50.0
    clamping: Annotated[
        float,
        _number(50.0, 250.0, "N", "RL-3", text="the same of an arm that stands, and where a program asked for contact"),
    ] = 150.0


Speed = Annotated[float, _number(0.05, 5.0, "m/s", "RL-4", text="largest speed of the tool centre point")]
ElbowSpeed = Annotated[float, _number(0.05, 5.0, "m/s", "RL-4", text="largest speed of the elbow")]
ToolForce = Annotated[float, _number(50.0, 250.0, "N", "RL-3", text="largest force of the tool on what it meets")]
ElbowForce = Annotated[float, _number(50.0, 250.0, "N", "RL-3", text="largest force of a link on what it meets")]
Momentum = Annotated[float, _number(1.0, 100.0, "kg·m/s", "RL-4", text="largest momentum of the moving arm with its payload")]
Power = Annotated[float, _number(10.0, 1000.0, "W", "RL-4", text="largest mechanical work a second on what the tool meets")]
StoppingTime = Annotated[float, _number(0.1, 2.0, "s", "RL-4", text="longest time in which a moving arm comes to rest")]
StoppingDistance = Annotated[
    float, _number(0.02, 3.0, "m", "RL-4", text="longest way of tool or elbow on which a moving arm comes to rest")
]
FASTEST = 6.4832
"""Of a joint [rad/s], 371.5°/s: 0.2 more than the fastest joints of the maker's arms are made for."""
FURTHEST = 6.3358
"""Of a joint either way [rad], 363°: the maker's default."""


def _speed(joint: int) -> Meta:
    return _number(0.1, FASTEST, "rad/s", "RL-4", text=f"largest speed of joint {joint}, counted from the base")


def _angle(joint: int, end: str) -> Meta:
    return _number(-FURTHEST, FURTHEST, "rad", "RL-6", text=f"{end} angle of joint {joint}, counted from the base")


class JointSpeeds(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How fast each joint may be. One that is made for less is stopped where `pendant.safety.robot_limits.ABOVE_RATED` says."""

    j1: Annotated[float, _speed(1)] = FASTEST
    j2: Annotated[float, _speed(2)] = FASTEST
    j3: Annotated[float, _speed(3)] = FASTEST
    j4: Annotated[float, _speed(4)] = FASTEST
    j5: Annotated[float, _speed(5)] = FASTEST
    j6: Annotated[float, _speed(6)] = FASTEST


class JointPositions(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Between which angles the arm's own motions keep the joints. An arm whose own range is smaller keeps that."""

    j1_min: Annotated[float, _angle(1, "smallest")] = -FURTHEST
    j1_max: Annotated[float, _angle(1, "largest")] = FURTHEST
    j2_min: Annotated[float, _angle(2, "smallest")] = -FURTHEST
    j2_max: Annotated[float, _angle(2, "largest")] = FURTHEST
    j3_min: Annotated[float, _angle(3, "smallest")] = -FURTHEST
    j3_max: Annotated[float, _angle(3, "largest")] = FURTHEST
    j4_min: Annotated[float, _angle(4, "smallest")] = -FURTHEST
    j4_max: Annotated[float, _angle(4, "largest")] = FURTHEST
    j5_min: Annotated[float, _angle(5, "smallest")] = -FURTHEST
    j5_max: Annotated[float, _angle(5, "largest")] = FURTHEST
    j6_min: Annotated[float, _angle(6, "smallest")] = -FURTHEST
    j6_max: Annotated[float, _angle(6, "largest")] = FURTHEST


class ModeLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The robot's limits in one safety mode; as shipped those of NORMAL of the third of four presets
    (assets/limits/robot-limits.yaml).
    """

    BASIC = ("tool_speed", "elbow_speed", "tool_force", "elbow_force")

    tool_speed: Speed = 1.5
    elbow_speed: ElbowSpeed = 1.5
    tool_force: ToolForce = 150.0
    elbow_force: ElbowForce = 150.0
    momentum: Momentum = 25.0
    power: Power = 300.0
    stopping_time: StoppingTime = 0.4
    stopping_distance: StoppingDistance = 0.5
    joint_speeds: JointSpeeds = JointSpeeds()
    positions: JointPositions = JointPositions()


REDUCED = ModeLimits(
    tool_speed=0.75,
    elbow_speed=0.75,
    tool_force=120.0,
    elbow_force=120.0,
    momentum=10.0,
    power=200.0,
    stopping_time=0.3,
    stopping_distance=0.3,
)
"""As shipped in the safety mode REDUCED, of the same preset. What is larger than in NORMAL counts as equal to that."""


class RobotLimitSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The robot's limits, for both safety modes."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("RL-4", "the robot's limits slow its motions down, and stop what exceeds them")] = True
    transition: Annotated[float, _number(0.1, 1.0, "s", "RL-4", text="time in which the arm slows down when REDUCED begins")] = (
        0.5
    )
    normal: ModeLimits = ModeLimits()
    reduced: ModeLimits = REDUCED
