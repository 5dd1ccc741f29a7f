"""Writes a tick's measurements into the record of RTDE's fields."""

import math

import numpy as np
from numpy.typing import NDArray

from app.robot_interface.controller.field_record import FieldRecord
from pendant.decision import Decision
from pendant.limits.parameters import ZEROS
from pendant.motion.script_requests import DirectTorque
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law
from pendant.tick.pose import Wrench
from pendant.tooling.tool_in_use import Fitting
from sim.arm.chain import load_body, tool_body
from sim.arm.frames import rotation_from_rpy, rotation_vector
from sim.simulation import Simulation

Array = NDArray[np.float64]


class MeasuredFields:
    """What an arm of six joints measures and what is configured, in the frames and signs of RTDE.

    Forces are those on the robot, in axes of the base; a pose is a position and a rotation vector.
    """

    def __init__(self, record: FieldRecord) -> None:
        self._record = record
        self._fitting: Fitting | None = None
        self._simulation: Simulation | None = None
        self._torque = np.ones(6)  # of the motors per current, at the output [N·m/A]
        self._rotor = np.zeros(6)  # inertia at the output [kg·m²]
        self._most_current = np.ones(6)  # of the motors [A]
        self._R_FT, self._tcp = np.eye(3), np.zeros(3)

    def fill(self, simulation: Simulation, decision: Decision) -> None:
        """Write the tick done last."""
        if simulation is not self._simulation:
            self._simulation, motors = simulation, simulation.arm.motors
            self._torque = np.array(motors.torque_per_current)
            self._rotor, self._most_current = np.array(motors.rotor_inertia), np.array(motors.current)
            self._record.put("target_gravity", simulation.estimate.g_B)
        fitting = decision.estimator.fitting
        if fitting is not None and fitting is not self._fitting:
            self._fit(fitting)
        estimate, put = simulation.estimate, self._record.put
        self._fill_joints(simulation, estimate, decision)
        R_BT = estimate.R_BF @ self._R_FT
        self._fill_tool(estimate, R_BT)
        force, torque = reading(estimate, decision.reading_zero)
        arm = estimate.tcp[:3] - estimate.p_BF
        put("actual_TCP_force", np.concatenate((force, torque - _cross(arm, force))))
        put("tcp_force_scalar", math.sqrt(float(force @ force)))
        put("ft_raw_wrench", -estimate.w_sensor)
        put("wrench_calc_from_currents", np.concatenate((estimate.F_joints, (0.0, 0.0, 0.0))))
        put("target_speed_fraction", decision.speed)

    def _fill_joints(self, simulation: Simulation, estimate: Estimate, decision: Decision) -> None:
        put, reference = self._record.put, simulation.controller.references.now
        if reference is None or decision.law in (Law.FREE, Law.OFF):
            target = (estimate.q, estimate.qd, estimate.qdd)
        else:
            target = (reference.q, reference.qd, reference.qdd)
        for name, values in zip(("target_q", "target_qd", "target_qdd"), target, strict=True):
            put(name, values)
        self._fill_wanted_torque(simulation, decision, target)
        put("actual_q", estimate.q)
        put("actual_qd", estimate.qd)
        put("actual_qdd", estimate.qdd)
        put("actual_current", estimate.current * self._most_current)
        put("actual_current_as_torque", estimate.tau_m)
        put("actual_moment", estimate.tau_J)
        put("joint_temperatures", simulation.plant.temperature)
        p, R, v, w = simulation.dynamics.flange_motion(target[0], target[1])
        arm = R @ self._tcp
        put("target_TCP_pose", np.concatenate((p + arm, rotation_vector(R @ self._R_FT))))
        put("target_TCP_speed", np.concatenate((v + _cross(w, arm), w)))

    def _fill_wanted_torque(self, simulation: Simulation, decision: Decision, target: tuple[Array, Array, Array]) -> None:
        """What the motion that is wanted needs by the model: no friction, and nothing that the loop adds.

            tau = M(q) qdd + h(q, qd),    i = (tau + J qdd) / (gear k)

        An arm at rest with a vertical first axis has no torque there, as on a UR, whatever its friction holds.
        """
        q, qd, qdd = target
        if decision.law is Law.OFF:
            torque, rotor = np.zeros(6), np.zeros(6)
        elif isinstance(decision.move, DirectTorque) or decision.law is Law.FREE:
            torque, rotor = simulation.dynamics.gravity(q).copy(), np.zeros(6)
            if isinstance(decision.move, DirectTorque):
                torque += decision.move.torque
        else:
            torque, rotor = simulation.dynamics.inverse(q, qd, qdd), self._rotor * qdd
        self._record.put("target_moment", torque)
        self._record.put("target_current", (torque + rotor) / self._torque)

    def _fill_tool(self, estimate: Estimate, R_BT: Array) -> None:
        put = self._record.put
        put("actual_TCP_pose", np.concatenate((estimate.tcp[:3], rotation_vector(R_BT))))
        put("actual_TCP_speed", np.concatenate((estimate.tcp[3:], estimate.v_F[3:])))
        put("actual_TCP_acceleration", np.concatenate((estimate.a_felt, (0.0, 0.0, 0.0))))
        put("actual_tool_accelerometer", estimate.a_F)
        put("elbow_position", estimate.elbow[:3])
        put("elbow_velocity", estimate.elbow[3:])

    def _fit(self, fitting: Fitting) -> None:
        """Tool and payload are others: a UR counts both as payload."""
        self._fitting, tool = fitting, fitting.tool
        self._tcp, self._R_FT = np.array(tool.tcp), rotation_from_rpy(tool.rpy)
        put = self._record.put
        put("tcp_offset", np.concatenate((self._tcp, rotation_vector(self._R_FT))))
        body = tool_body(tool) + load_body(fitting.load)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia.tolist()
        put("payload", body.mass)
        put("payload_cog", body.com)
        put("payload_inertia", (xx, yy, zz, xy, xz, yz))


def reading(estimate: Estimate, zero: Wrench) -> tuple[Array, Array]:
    """F_user at the flange as it is told, force and torque, axes of B [N, N·m]: without what counts as none, axes of F."""
    if zero is ZEROS:
        return estimate.F_user[:3], estimate.F_user[3:]
    gone = np.array(zero)
    return estimate.F_user[:3] - estimate.R_BF @ gone[:3], estimate.F_user[3:] - estimate.R_BF @ gone[3:]


def _cross(a: Array, b: Array) -> Array:
    """a × b, without the cost of numpy.cross."""
    x, y, z = a.tolist()
    u, v, w = b.tolist()
    return np.array((y * w - z * v, z * u - x * w, x * v - y * u))
