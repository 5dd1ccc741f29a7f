"""The rigid bodies of an arm: where each joint sits and what each link weighs. Both models are built from this one value."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import pendant.equipment.tools
from pendant.tick.pose import Pose, Rotation, Vector, flat
from pendant.tooling.arm_shape import ArmShape, Rod
from sim.arm.arm_file import Arm
from sim.arm.frames import com_in_joint_frame, hulls, inertia_matrix, placements, skew, tensor_in_joint_frame
from sim.arm.scenario import Load, ToolModel

Array = NDArray[np.float64]

WATER = 1000.0
"""Density of a load whose inertia nobody gave [kg/m³]; a UR, too, assumes a sphere of even density."""


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body: mass [kg], centre of mass (3,) [m] and inertia about it (3, 3) [kg·m²], in the frame it hangs on."""

    mass: float
    com: Array
    inertia: Array

    def __sub__(self, part: "Body") -> "Body":
        """What is left of this body without `part`; both must be given in the same frame."""
        return self + Body(-part.mass, part.com, -part.inertia)

    def __add__(self, other: "Body") -> "Body":
        """Both bodies as one; they must be given in the same frame."""
        mass = self.mass + other.mass
        if mass == 0.0:
            return self
        com = (self.mass * self.com + other.mass * other.com) / mass
        inertia = np.zeros((3, 3))
        for body in (self, other):
            shift = skew(body.com - com)
            inertia += body.inertia - body.mass * shift @ shift
        return Body(mass, com, inertia)

    def blend(self, other: "Body", share: float) -> "Body":
        """Part of this body and `share` of the other at once, as one: in between, mass and moments go in a straight line."""
        ours = Body((1.0 - share) * self.mass, self.com, (1.0 - share) * self.inertia)
        return ours + Body(share * other.mass, other.com, share * other.inertia)


NOTHING = Body(0.0, np.zeros(3), np.zeros((3, 3)))


@dataclass(frozen=True, slots=True)
class Chain:
    """Links base to flange. The pose of joint frame i (z is the joint's axis) is given in joint frame i-1 (B for 0) at q = 0."""

    p: Array  # (n, 3) [m]
    R: Array  # (n, 3, 3)
    links: tuple[Body, ...]  # in their joint frames
    p_flange: Array  # (3,) flange in the last joint frame
    R_flange: Array  # (3, 3)


def chain(arm: Arm) -> Chain:
    """The chain that `arm`'s file describes; of the last link the part before the flange sensor's tool-side face."""
    n = arm.n
    poses = placements(arm)
    p, R = poses[:, :3, 3].copy(), poses[:, :3, :3].copy()
    links = [Body(arm.masses.mass[i], com_in_joint_frame(arm, i), tensor_in_joint_frame(arm, i)) for i in range(n)]
    p_flange, R_flange = p[n], R[n]
    plate = plate_body(arm)
    links[-1] -= Body(plate.mass, p_flange + R_flange @ plate.com, R_flange @ plate.inertia @ R_flange.T)
    return Chain(p[:n], R[:n], tuple(links), p_flange, R_flange)


def arm_shape(arm: Arm) -> ArmShape:
    """What the pendant knows of the arm's shape: the same joints and hulls."""
    rigid = chain(arm)
    joints = [Pose(*_plain(p, R)) for p, R in zip(rigid.p, rigid.R, strict=True)]
    rods = tuple([Rod(hull.link, _vector(hull.start), _vector(hull.end), hull.radius) for hull in hulls(arm)])
    flange = Pose(*_plain(rigid.p_flange, rigid.R_flange))
    ranges = tuple(arm.limits.ends)
    return ArmShape(tuple(arm.chain.joints), joints, flange, rods=rods, ranges=ranges, elbow=arm.chain.elbow)


def _plain(p: Array, R: Array) -> tuple[Vector, Rotation]:
    return _vector(p.tolist()), flat(R)


def _vector(values: Sequence[float]) -> Vector:
    x, y, z = values
    return x, y, z


def load_body(load: Load) -> Body:
    """`load` as a body in F; without an inertia a sphere of the density of water."""
    if load.inertia is not None:
        inertia = inertia_matrix(load.inertia)
    else:
        radius = (3.0 * load.mass / (4.0 * math.pi * WATER)) ** (1.0 / 3.0)
        inertia = np.eye(3) * 0.4 * load.mass * radius * radius
    return Body(load.mass, np.array(load.com), inertia)


def tool_body(tool: pendant.equipment.tools.Tool | None) -> Body:
    """`tool` as a body in F: without an inertia a cylinder of its length and radius, or as a load; no tool weighs nothing."""
    if tool is None:
        return NOTHING
    if tool.inertia is not None or not isinstance(tool, ToolModel):
        return load_body(Load(mass=tool.mass, com=tool.com, inertia=tool.inertia))
    across = tool.mass * (3 * tool.radius**2 + tool.length**2) / 12.0
    return Body(tool.mass, np.array(tool.com), np.diag([across, across, tool.mass * tool.radius**2 / 2.0]))


def plate_body(arm: Arm) -> Body:
    """The tool-side face of the flange sensor, a disc in F that moves with whatever it carries; nothing without a sensor."""
    sensor = arm.sensors.force_torque
    if sensor is None:
        return Body(0.0, np.zeros(3), np.zeros((3, 3)))
    radius = 0.0315  # of an ISO 9409-1-50-4-M6 flange
    turn = sensor.plate_mass * radius**2 / 2.0
    return Body(sensor.plate_mass, np.array([0.0, 0.0, sensor.plate_length / 2.0]), np.diag([turn / 2.0, turn / 2.0, turn]))
