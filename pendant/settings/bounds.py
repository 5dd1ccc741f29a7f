"""How much of a quantity anything that is simulated may have: bounds from physics, in one place.

What a file says is within these bounds or is refused. They are far beyond every cobot and everything that one touches, and within
what the physics can compute: no product of a few of them overflows, no quotient of two is lost in rounding.
"""

from typing import Annotated

from msgspec import Meta

Positive = Annotated[float, Meta(ge=1e-9, le=1e9)]  # of any unit, where nothing below is nearer
NotNegative = Annotated[float, Meta(ge=0, le=1e9)]
Signed = Annotated[float, Meta(ge=-1e9, le=1e9)]
Count = Annotated[int, Meta(ge=1, le=2**32)]
Share = Annotated[float, Meta(ge=0, le=1)]

Time = Annotated[float, Meta(ge=0, le=3600)]  # a session lasts an hour at most [s]
Span = Annotated[float, Meta(ge=0.001, le=3600)]  # [s]
Days = Annotated[float, Meta(ge=1.0, le=1e6)]  # time constants of what takes minutes to days [s]

Size = Annotated[float, Meta(ge=0.001, le=20.0)]  # from a millimetre to a hall [m]
Thickness = Annotated[float, Meta(ge=0.001, le=2.0)]  # radius of a part of an arm or a tool [m]
Extent = Annotated[float, Meta(ge=0.0, le=2.0)]  # length of a tool, which may have no shape [m]
Coordinate = Annotated[float, Meta(ge=-20.0, le=20.0)]  # in a cell [m]
Offset = Annotated[float, Meta(ge=-5.0, le=5.0)]  # within an arm [m]
Reach = Annotated[float, Meta(ge=0.05, le=10.0)]  # of an arm [m]
Angle = Annotated[float, Meta(ge=-100.0, le=100.0)]  # sixteen turns; of an orientation, where a turn is as none [rad]

Mass = Annotated[float, Meta(ge=0.0, le=1000.0)]  # of a load, which may be none [kg]
PartMass = Annotated[float, Meta(ge=0.05, le=200.0)]  # of a part that lies about [kg]
LinkMass = Annotated[float, Meta(ge=0.001, le=2000.0)]  # a gram to two tonnes [kg]
Capacity = Annotated[float, Meta(ge=0.01, le=1000.0)]  # what an arm may carry [kg]
Moment = Annotated[float, Meta(ge=-1e4, le=1e4)]  # of inertia [kg·m²]
RotorInertia = Annotated[float, Meta(ge=1e-4, le=1e3)]  # at the output [kg·m²]

JointSpeed = Annotated[float, Meta(ge=0.01, le=100.0)]  # [rad/s]
JointAcceleration = Annotated[float, Meta(ge=0.1, le=1e4)]  # [rad/s²]
JointTorque = Annotated[float, Meta(ge=0.1, le=1e5)]  # [N·m]
Force = Annotated[float, Meta(ge=0.01, le=1e4)]  # [N]
Speed = Annotated[float, Meta(ge=0.001, le=5.0)]  # of the fingers of a gripper [m/s]
Pressure = Annotated[float, Meta(ge=1e3, le=101e3)]  # below that of the air [Pa]
Line = Annotated[int, Meta(ge=0, le=17)]  # number of a digital input or output
Stiffness = Annotated[float, Meta(ge=10.0, le=1e7)]  # of a contact: foam to hardened steel [N/m]
Friction = Annotated[float, Meta(ge=0.0, le=10.0)]  # coefficient
Gain = Annotated[float, Meta(ge=-10.0, le=10.0)]  # a factor with a sign
Factor = Annotated[float, Meta(ge=0.0, le=1000.0)]
HeatCapacity = Annotated[float, Meta(ge=1.0, le=1e7)]  # of a joint [J/K]
HeatResistance = Annotated[float, Meta(ge=0.001, le=1000.0)]  # [K/W]
PerKelvin = Annotated[float, Meta(ge=-0.1, le=0.1)]  # relative change [1/K]
Celsius = Annotated[float, Meta(ge=-60.0, le=150.0)]  # [°C]

Text = Annotated[str, Meta(max_length=2000)]
Name = Annotated[str, Meta(min_length=1, max_length=60, pattern=r"^[^\x00-\x1f\x7f/\\]+$")]  # also of a folder and of a body

MOST_JOINTS = 12
"""Joints of an arm."""

MOST_OBJECTS = 40
"""Objects in a world, each against every shape of the arm."""

MOST_WALLS = 40
"""Virtual walls and areas: all are looked at in every tick."""

MOST_STEPS = 2000
"""Steps of a program, entries of a time line, expectations, points of a profile."""

FARTHEST = 1.0
"""Largest distance of a load's centre, and of a tool centre point, from the flange along each axis [m]."""

THINNEST, WIDEST = 1e-4, 1.0
"""Smallest and largest radius of gyration of a body [m]: its moment of inertia is its mass times the square of it."""
