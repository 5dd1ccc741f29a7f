"""What to simulate: mounting, tool, true and configured payload, world, seed."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

import pendant.equipment.tools
from pendant.equipment.load import Angles, Load, Vector
from pendant.settings.bounds import (
    Extent,
    Force,
    Friction,
    Line,
    Name,
    PartMass,
    Pressure,
    Share,
    Size,
    Span,
    Speed,
    Stiffness,
    Thickness,
)
from pendant.walls.definitions import AnyBorder

__all__ = ["BARE", "AnyObject", "AnyPart", "Load", "Scenario", "ToolModel", "Vector", "table"]


Sizes = Annotated[list[Size], Meta(min_length=3, max_length=3)]  # full lengths [m]


class Wired(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """A gripper as it is wired to the robot: 0 to 7 standard, 8 to 15 configurable, 16 and 17 the tool's."""

    close_output: Line = 0  # digital output that closes it
    open_output: Line = 1  # digital output that opens it
    detected_input: Line = 7  # digital input that is high while it holds a part


class Fingers(Wired, tag="fingers", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Two fingers that close along x of the tool, their pads on both sides of the tool centre point. Numbers of a Robotiq 2F-85
    (its instruction manual, specifications).
    """

    stroke: Thickness = 0.085  # distance of the pads when it is open [m]
    finger: Thickness = 0.06  # length of a finger, the last part of the tool's length [m]
    pad: Thickness = 0.022  # side of a pad, which is square [m]
    least_force: Force = 20.0  # of one finger [N]
    most_force: Force = 235.0  # [N]
    least_speed: Speed = 0.02  # of one finger against the other [m/s]
    most_speed: Speed = 0.15  # [m/s]


class Cup(Wired, tag="cup", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A vacuum cup that looks along z of the tool, its rim round the tool centre point."""

    radius: Thickness = 0.02  # of the rim [m]
    vacuum: Pressure = 60e3  # below the pressure of the air: that of a common ejector [Pa]


class ToolModel(pendant.equipment.tools.Tool, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A tool as it is: told to the controller, and with the shape of a capsule along z of F. Without an inertia a cylinder."""

    length: Extent = 0.0  # of its shape; 0 for none [m]
    radius: Thickness = 0.03  # [m]
    gripper: Fingers | Cup | None = None  # what it grips with


BARE = ToolModel(name="flange", mass=0.0, com=[0.0, 0.0, 0.0], tcp=[0.0, 0.0, 0.0])
"""No tool: the tool centre point is the middle of the flange."""


class WorldObject(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """A thing the arm can touch. Pose in W."""

    name: Name
    position: Vector  # [m]
    rpy: Angles = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.0])  # roll, pitch, yaw [rad]
    stiffness: Stiffness = 1e5  # true contact stiffness [N/m]
    friction: Friction = 0.5  # Coulomb coefficient


class BoxObject(WorldObject, tag="box", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A box (table, wall, block); `position` is its centre."""

    size: Sizes  # full lengths [m]


class Plane(WorldObject, tag="plane", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A half-space (floor, wall); its surface passes through `position`, its z axis points out."""


class Pad(WorldObject, tag="pad", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A soft pad: a box of its own, low stiffness."""

    size: Sizes
    stiffness: Stiffness = 1e3


class SnapFit(WorldObject, tag="snap-fit", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A box whose resistance breaks at `force` and gives way by `travel` along its -z axis, then resists again."""

    size: Sizes
    force: Force = 30.0  # [N]
    travel: Size = 0.004  # [m]
    rest: Share = 0.2  # of its force that it still resists with while it gives way


class TwoFrictions(WorldObject, tag="two-frictions", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A box whose top has `friction` where its x < 0 and `friction_beyond` where its x > 0."""

    size: Sizes
    friction_beyond: Friction = 1.0


class Moving(WorldObject, tag="moving", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A box that moves to and fro: position + amplitude·sin(2 pi t / period)."""

    size: Sizes
    amplitude: Vector  # [m]
    period: Span = 4.0  # [s]


class FreeBox(WorldObject, tag="free-box", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A box that lies where it is put until something moves it; `position` is its centre."""

    size: Sizes
    mass: PartMass  # [kg]


class FreeCylinder(WorldObject, tag="free-cylinder", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A cylinder along its z axis that lies where it is put until something moves it; `position` is its centre."""

    radius: Thickness  # [m]
    height: Size  # [m]
    mass: PartMass  # [kg]

    @property
    def size(self) -> list[float]:
        """Full lengths of the box around it [m]."""
        return [2.0 * self.radius, 2.0 * self.radius, self.height]


AnyPart = FreeBox | FreeCylinder
AnyObject = BoxObject | Plane | Pad | SnapFit | TwoFrictions | Moving | FreeBox | FreeCylinder


Mismatch = Literal["on", "nominal"] | Annotated[float, Meta(gt=0.0, le=3.0)]
"""Errors of the controller's constants and of the sensors: as large as the arm's file states, none, or so many times as large."""


class Scenario(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All that a simulation starts from, apart from the arm and the settings."""

    mounting: Angles = msgspec.field(default_factory=lambda: [0.0, 0.0, 0.0])  # roll, pitch, yaw of B in W [rad]
    posture: list[float] | None = None  # joint angles at the start; None: the arm's home [rad]
    tool: ToolModel | None = None  # mounted, and the one in use at the start
    tools: list[ToolModel] = []  # to choose from on the pendant, beside that one
    payload_true: Load = msgspec.field(default_factory=lambda: Load(mass=0.0))
    payload_configured: Load = msgspec.field(default_factory=lambda: Load(mass=0.0))
    world: list[AnyObject] = []
    walls: list[AnyBorder] = []  # virtual walls and areas, beside the tether
    soft_sensor: bool = False  # the flange sensor has its soft stiffness, for demonstration (CD-17)
    self_contact: bool = False  # the tool can touch the arm's own links (CD-2)
    seed: int = 0
    mismatch: Mismatch = "on"


def table(scenario: Scenario) -> list[ToolModel]:
    """The table of tools: first the one in use at the start, which wins over another of its name."""
    used = scenario.tool or next((tool for tool in scenario.tools if tool.name == BARE.name), BARE)
    return [used, *(tool for tool in scenario.tools if tool.name != used.name)]
