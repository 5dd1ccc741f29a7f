"""An arm's numbers: the only place that knows them. Parsed from a file of assets/robots/, each value with its source."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from pendant.settings.bounds import (
    MOST_JOINTS,
    Angle,
    Capacity,
    Celsius,
    Count,
    Days,
    Extent,
    HeatCapacity,
    HeatResistance,
    JointAcceleration,
    JointSpeed,
    JointTorque,
    LinkMass,
    Moment,
    Name,
    NotNegative,
    Offset,
    PerKelvin,
    Positive,
    Reach,
    RotorInertia,
    Share,
    Text,
    Thickness,
)

Range = Annotated[float, Meta(ge=0.01, le=100.0)]  # of a joint, each way [rad]
Sides = Annotated[list[Angle], Meta(min_length=2, max_length=2)]  # smallest and largest angle of a joint [rad]
Triple = Annotated[list[Offset], Meta(min_length=3, max_length=3)]
Turn = Annotated[list[Angle], Meta(min_length=3, max_length=3)]  # roll, pitch, yaw about fixed axes [rad]
Quaternion = Annotated[list[Offset], Meta(min_length=4, max_length=4)]  # wxyz, of any length but 0
Joints = Annotated[list[Name], Meta(min_length=2, max_length=MOST_JOINTS)]
Status = Literal["official", "measured", "assumed"]


class Sourced(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Where a group of values comes from. `assumed` names those of its values that are assumed although the rest is not."""

    status: Status
    source: Annotated[str, Meta(min_length=1, max_length=2000)]
    assumed: list[str] = []


class LinkOrigin(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, omit_defaults=True):
    """A frame in the frame of the link before it, at q = 0; of a joint's link also the axis that it turns about, in its own."""

    xyz: Triple  # [m]
    rpy: Turn | None = None
    quaternion: Quaternion | None = None  # in place of rpy; neither: not turned
    axis: Triple | None = None  # of any length but 0; None: z


class ChainParameters(Sourced, frozen=True, omit_defaults=True):
    """Kinematics, in one of two ways: `a`, `d` and `alpha`, or `origins` and `flange`.

    Standard Denavit-Hartenberg: link i's frame sits behind joint i, Rz(q) Tz(d) Tx(a) Rx(alpha), and the last one is the flange.
    Transforms: link i's frame sits at joint i and turns with it, as URDF has it.
    """

    joints: Joints  # names, base to flange
    elbow: int  # index of the joint whose origin is the elbow
    home: list[Angle]  # default posture [rad]
    a: list[Offset] = []  # [m]
    d: list[Offset] = []  # [m]
    alpha: list[Angle] = []  # [rad]
    origins: list[LinkOrigin] = []  # of each link in the one before, of the first in the base
    flange: LinkOrigin | None = None  # in the last link


class Masses(Sourced, frozen=True):
    """Link masses and centres."""

    mass: list[LinkMass]  # [kg]
    com: list[list[Offset]]  # centre of mass in the link frame [m]


class Inertias(Sourced, frozen=True):
    """Link inertia about the centre of mass: ixx iyy izz ixy ixz iyz [kg·m²].

    Axes: with Denavit-Hartenberg those of the joint frame (z = joint axis, q = 0), with transforms those of the link frame.
    """

    tensor: list[list[Moment]]


class ArmLimits(Sourced, frozen=True):
    """Joint limits."""

    position: list[Range | Sides]  # ±, or smallest and largest [rad]
    speed: list[JointSpeed]  # [rad/s]
    acceleration: list[JointAcceleration]  # [rad/s²]
    torque: list[JointTorque]  # at the output [N·m]

    @property
    def ends(self) -> list[tuple[float, float]]:
        """Smallest and largest angle of each joint [rad]."""
        return [(each[0], each[1]) if isinstance(each, list) else (-each, each) for each in self.position]

    @property
    def farthest(self) -> list[float]:
        """Largest angle of each joint, either way [rad]."""
        return [max(-low, high) for low, high in self.ends]


class Motors(Sourced, frozen=True):
    """Motors, with the gear."""

    gear: list[Positive]
    torque_constant: list[Positive]  # motor side [N·m/A]
    current: list[Positive]  # largest [A]
    rotor_inertia: list[RotorInertia]  # reflected to the output [kg·m²]
    ripple: list[NotNegative]  # torque ripple amplitude at the output [N·m], at twice the wave generator's turn

    @property
    def torque_per_current(self) -> list[float]:
        """Torque of each motor for its current, after the gear [N·m/A]."""
        return [gear * constant for gear, constant in zip(self.gear, self.torque_constant, strict=True)]


class Transmissions(Sourced, frozen=True):
    """Transmission of each joint: tau_J(x) = stiffness·x + stiffening·x³ + damping·x' + hysteresis, x = theta - q."""

    stiffness: list[Positive]  # [N·m/rad]
    stiffening: list[NotNegative]  # [N·m/rad³]
    damping: list[NotNegative]  # [N·m·s/rad]
    hysteresis_stiffness: list[NotNegative]  # of a stick-slip element in parallel [N·m/rad]
    hysteresis_yield: list[NotNegative]  # the deflection at which it slips [rad]


class Frictions(Sourced, frozen=True):
    """Joint friction, both sides together, without load at the reference temperature."""

    speed: Annotated[list[NotNegative], Meta(max_length=12)]  # where the curve was measured [rad/s], rising
    torque: list[list[Positive]]  # a row a joint, friction at those speeds [N·m]
    breakaway: list[Positive]  # at rest [N·m]
    output_share: Share  # part of it that acts on the output side (bearings, seals)
    load: list[NotNegative]  # rise with |tau_J| [N·m per N·m]
    temperature: Celsius  # reference [°C]
    per_kelvin: PerKelvin  # relative change a kelvin at the reference
    presliding: list[Positive]  # bristle stiffness [N·m/rad]


class Thermals(Sourced, frozen=True):
    """Joint temperature, one mass a joint."""

    capacity: list[HeatCapacity]  # [J/K]
    resistance: list[HeatResistance]  # to the room [K/W]
    ambient: Celsius  # [°C]


class Encoders(Sourced, frozen=True):
    """Both angle sensors of a joint."""

    motor_counts: Count  # a turn of the motor
    output_counts: Count  # a turn of the output
    ripple: NotNegative  # largest error of the output encoder over a turn [rad]
    noise_counts: NotNegative  # standard deviation, in counts


class Channels(Sourced, frozen=True):
    """A sensor with like channels: range, quantum and noise in the sensor's unit."""

    range: Positive
    quantum: Positive
    noise: NotNegative


class Drift(Sourced, frozen=True):
    """How the zero of the flange sensor moves: from its cold error to its warm one, and about that in a slow walk.

    `sim.sensing.sensor_drift` has the model, and the largest error and the fastest change that these numbers allow.
    """

    warm_up: Days  # time constant [s]; a sensor's own is half to one and a half times as long, by the seed
    force: NotNegative  # largest zero error of an axis when warm [N]; each is drawn evenly within ±
    torque: NotNegative  # the same [N·m]
    walk_force: NotNegative  # standard deviation of the walk [N]
    walk_torque: NotNegative  # the same [N·m]
    walk_time: Days  # time in which the walk forgets where it was (correlation time) [s]


class ForceTorque(Sourced, frozen=True):
    """The flange sensor."""

    force: Channels
    torque: Channels
    stiffness: Positive  # between its two faces [N/m]
    stiffness_soft: Positive  # demonstration setting (CD-17) [N/m]
    damping_ratio: NotNegative
    plate_mass: LinkMass  # of the tool-side face [kg]
    plate_length: Extent  # from the sensing plane to the tool-side face [m]
    drift: Drift | None = None  # None: its zero stays where it is


class SensorNumbers(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All sensors; the flange sensor and the accelerometers are optional (FD-3a)."""

    encoders: Encoders
    current: Channels  # [A]
    temperature: Channels  # [°C]
    force_torque: ForceTorque | None = None
    accelerometer: Channels | None = None  # [m/s²], at both faces of the flange sensor
    gyro: Channels | None = None  # [rad/s], at both faces


Ratio = Annotated[float, Meta(ge=0.0, le=0.3)]  # of an error to what is right: three times it still leaves a positive number


class Accuracy(Sourced, frozen=True):
    """What the arm's constants may be wrong by, at most, each way; beside `sensors.encoders.ripple` all that is told of errors.

    The controller reads it as bounds of errors that it does not know; the simulation draws an arm's errors evenly within them.
    """

    motor_constant: Ratio  # torque of a motor for its current
    stiffness: Ratio  # of a transmission
    rotor_inertia: Ratio
    link_mass: Ratio
    link_centre: NotNegative  # of a link's centre of mass, each axis [m]
    force_offset: NotNegative  # zero of the flange sensor when it is cold, each axis [N]
    torque_offset: NotNegative  # the same [N·m]
    wrench_gain: Ratio  # of the flange sensor, each channel
    wrench_cross_talk: Ratio  # share of its range that a full channel shows in all five others together


ASSUMED_ACCURACY = Accuracy(
    status="assumed",
    source="The arm's file says nothing; as of the UR5e.",
    motor_constant=0.03,
    stiffness=0.20,
    rotor_inertia=0.10,
    link_mass=0.02,
    link_centre=0.003,
    force_offset=4.0,
    torque_offset=0.3,
    wrench_gain=0.01,
    wrench_cross_talk=0.01,
)
"""Of an arm whose file does not state it."""


class Outline(Sourced, frozen=True):
    """The housings, for pictures. Link k starts at the seam of joint k and ends at the seam of joint k + 1."""

    seam: list[Offset]  # where link k meets its predecessor: z in the joint frame of link k [m]
    housing_radius: list[Thickness]  # of the housing of each joint [m]
    tube_offset: list[Offset]  # z of a link's tube in its joint frame [m]; of use only where a is not 0
    tube_radius: list[Thickness]  # of a link's tube in its middle [m]; of use only where a is not 0
    foot_radius: Thickness  # of the base [m]
    flange_radius: Thickness  # of the tool flange [m]


class Capsule(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A collision shape of a link: a segment with a radius [m], in the axes that the tensors have, from the joint's origin."""

    link: int  # -1 the base, 0 the first link, ...
    start: list[Offset]
    end: list[Offset]
    radius: Thickness


class Arm(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """An arm, as its file says. Lists run from base to flange; n joints."""

    name: Name
    title: Text
    reach: Reach  # [m]
    payload: Capacity  # largest [kg]
    rating: Sourced  # of reach and payload
    chain: ChainParameters
    masses: Masses
    inertias: Inertias
    limits: ArmLimits
    motors: Motors
    transmissions: Transmissions
    frictions: Frictions
    thermals: Thermals
    sensors: SensorNumbers
    accuracy: Accuracy = ASSUMED_ACCURACY
    outline: Outline | None = None  # None: pictures show the shapes
    meshes: Text = ""  # folder of the links' pictures, beside the file; "": those that come with an arm of this name, or none
    shapes: Annotated[list[Capsule], Meta(max_length=60)]

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.chain.joints)
