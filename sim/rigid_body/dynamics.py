"""The controller's rigid-body model: Pinocchio, with the links as believed and the payload as configured."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.arm.chain import Body, Chain
from sim.arm.frames import rotation_from_rpy
from sim.arm.scenario import Vector
from sim.rigid_body.newton_euler import NewtonEuler

Array = NDArray[np.float64]

GRAVITY = 9.81


class Dynamics:
    """Rigid model of n joints in B. Pinocchio's LOCAL_WORLD_ALIGNED is our "axes of B, at the flange origin".

    Args:
        chain: kinematics.
        links: masses as believed, in their joint frames.
        load: everything beyond the flange, in F.
        mounting: roll, pitch, yaw of B in W [rad].
        elbow: index of the joint whose origin is the elbow.

    Attributes:
        recursion: the same model, compiled for what every tick needs.
        bare: the last link without the load, in its joint's frame.
    """

    def __init__(self, chain: Chain, links: tuple[Body, ...], load: Body, *, mounting: Vector, elbow: int) -> None:
        model = pin.Model()
        parent = 0
        for i, link in enumerate(links):
            placement = pin.SE3(chain.R[i], chain.p[i])
            parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint{i}")
            model.appendBodyToJoint(parent, pin.Inertia(link.mass, link.com, link.inertia), pin.SE3.Identity())
        self._flange_placement = pin.SE3(chain.R_flange, chain.p_flange)
        frame = pin.Frame("flange", parent, self._flange_placement, pin.FrameType.OP_FRAME)
        self._flange = model.addFrame(frame)
        model.gravity = pin.Motion(rotation_from_rpy(mounting).T @ [0.0, 0.0, -GRAVITY], np.zeros(3))
        self.model, self.data = model, model.createData()
        self._last, self._elbow = parent, elbow + 1
        self._bare = model.inertias[parent].copy()
        self.bare = links[-1]
        self.gravity_B = np.array(model.gravity.linear)
        self.recursion = NewtonEuler(model, self._flange_placement, elbow)
        self.set_load(load)

    def set_load(self, load: Body) -> None:
        """Take `load` (in F) as everything beyond the flange."""
        self.load = load
        self.model.inertias[self._last] = self._bare + self._flange_placement.act(pin.Inertia(load.mass, load.com, load.inertia))
        self.recursion.set_load()

    def update(self, q: Array) -> tuple[Array, Array, Array]:
        """Flange position (3,), orientation (3, 3) in B and Jacobian (6, n), linear first, axes of B, at the flange origin."""
        model, data = self.model, self.data
        pin.computeJointJacobians(model, data, q)
        placement = pin.updateFramePlacement(model, data, self._flange)
        jacobian = pin.getFrameJacobian(model, data, self._flange, pin.LOCAL_WORLD_ALIGNED)
        return placement.translation, placement.rotation, jacobian

    def places(self, q: Array) -> tuple[Array, Array, Array]:
        """Flange position (3,) and orientation (3, 3), elbow position (3,), in B."""
        pin.forwardKinematics(self.model, self.data, q)
        placement = pin.updateFramePlacement(self.model, self.data, self._flange)
        return placement.translation.copy(), placement.rotation.copy(), self.data.oMi[self._elbow].translation.copy()

    def levers(self, tool: float) -> Array:
        """From each joint's axis to whatever moves with it, at most (n,) [m].

        Args:
            tool: from the flange to the furthest point beyond it [m].
        """
        lengths = [float(np.linalg.norm(placement.translation)) for placement in self.model.jointPlacements.tolist()[2:]]
        lengths += [float(np.linalg.norm(self._flange_placement.translation)) + tool]
        return np.cumsum(lengths[::-1])[::-1]

    def flange_motion(self, q: Array, qd: Array) -> tuple[Array, Array, Array, Array]:
        """Flange position (3,), orientation (3, 3), velocity (3,) [m/s] and angular velocity (3,) [rad/s], in B."""
        pin.forwardKinematics(self.model, self.data, q, qd)
        placement = pin.updateFramePlacement(self.model, self.data, self._flange)
        velocity = pin.getFrameVelocity(self.model, self.data, self._flange, pin.LOCAL_WORLD_ALIGNED)
        return placement.translation.copy(), placement.rotation.copy(), velocity.linear, velocity.angular

    def gravity(self, q: Array) -> Array:
        """Gravity torque (n,) [N·m]."""
        return pin.computeGeneralizedGravity(self.model, self.data, q)

    def inverse(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Joint torque (n,) [N·m] of the motion, without rotors, friction and external forces."""
        return pin.rnea(self.model, self.data, q, qd, qdd)

    def mass(self, q: Array) -> Array:
        """Mass matrix (n, n) [kg·m²], without rotors."""
        return pin.crba(self.model, self.data, q)

    def specific_force(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array]:
        """Specific force at the flange origin and angular acceleration of the flange, both (3,) in F, from the motion."""
        pin.forwardKinematics(self.model, self.data, q, qd, qdd)
        acceleration = pin.getFrameClassicalAcceleration(self.model, self.data, self._flange, pin.LOCAL)
        R = pin.updateFramePlacement(self.model, self.data, self._flange).rotation
        return acceleration.linear - R.T @ self.gravity_B, acceleration.angular
