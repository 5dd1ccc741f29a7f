"""Functions of measured values and of kinematics (URScript manual, module internals)."""

import math
from collections import deque
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from app.urscript.calculation.pose_algebra import quaternion, rotation
from app.urscript.language.trouble import Misuse
from app.urscript.machine.operators import effort
from app.urscript.machine.signature import (
    Builtin,
    Taken,
    any_value,
    boolean,
    builtin,
    integer,
    number,
    numbers,
    optional,
    pose,
    vector,
    within,
)
from app.urscript.machine.values import PoseValue, Value
from app.urscript.robot.robot_side import RobotSide
from pendant.motion.script_requests import ScriptedArc, ScriptedJoints, ScriptedLine, ScriptedProcess
from sim.arm.frames import matrix_from_quaternion, rotation_vector
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

SEARCH = 300
"""Cost of one step of the search for joint angles, in evaluator steps."""

OF_MODEL = 100
"""Cost of one use of the arm's model, in evaluator steps."""

OF_ARRAY = 12
"""Cost of one use of an array of values, in evaluator steps."""

STEADY = 0.01
"""Joint speed below which the arm counts as steady [rad/s]."""
HISTORY = 500
"""Ticks that get_actual_joint_positions_history() remembers."""
FLANGE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Kinematics:
    """Forward and inverse kinematics of the controller's model of the arm."""

    def __init__(self, robot: RobotSide) -> None:
        self._robot = robot

    @property
    def tcp(self) -> PoseValue:
        """The tool centre point in use, in F."""
        simulation = self._robot.simulation
        return PoseValue((*simulation.tcp.tolist(), *rotation_vector(simulation.R_FT).tolist()))

    def forward(self, q: tuple[float, ...], tcp: tuple[float, ...] | None) -> PoseValue:
        """Pose of a tool centre point in B."""
        p, R, _ = self._robot.simulation.dynamics.places(np.array(q))
        at, R_FT = _placed(self.tcp if tcp is None else tcp)
        return PoseValue((*(p + R @ at).tolist(), *rotation_vector(R @ R_FT).tolist()))

    def inverse(self, x: PoseValue, near: tuple[float, ...], tcp: tuple[float, ...] | None) -> tuple[float, ...] | None:
        """Joint angles for a pose of the tool centre point, found by steps from `near` first; None: no angles are found."""
        simulation = self._robot.simulation
        at, R_FT = _placed(self.tcp if tcp is None else tcp)
        p, R = _placed(x)
        R_F = R @ R_FT.T
        target = (p - R_F @ at, R_F)
        low, high = np.array(simulation.arm.limits.ends).T
        for start in (np.array(near), *_guesses(near)):
            q = _newton(simulation.dynamics, target, start)
            if q is not None and bool(np.all((low <= q) & (q <= high))):
                return tuple(q.tolist())
        return None


def _placed(x: tuple[float, ...]) -> tuple[Array, Array]:
    return np.array(x[:3]), matrix_from_quaternion(quaternion(tuple(x[3:])))


def _guesses(near: tuple[float, ...]) -> Iterator[Array]:
    """Other postures to start from: elbow up or down, wrist turned, shoulder on the other side."""
    a, b, c, d, e, f = near
    for elbow in (1.2, -1.2):
        for wrist in (1.57, -1.57):
            yield np.array((a, -1.2 if elbow > 0 else -1.9, elbow, -1.57, wrist, f))
    yield np.array((a, b, c + 0.3, d, e + 0.3, f))


def _newton(dynamics: Dynamics, target: tuple[Array, Array], q: Array) -> Array | None:
    p_wanted, R_wanted = target
    q = q.copy()
    for _ in range(20):
        effort[0] += SEARCH
        p, R, jacobian = dynamics.update(q)
        error = np.concatenate((p_wanted - p, rotation_vector(R_wanted @ R.T)))
        size = math.sqrt(float(error @ error))
        if size < 1e-10:
            return q
        damping = 1e-4 * min(size, 1.0) ** 2
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping * np.eye(6), error)
        longest = float(np.abs(step).max())
        q += step * min(1.0, 0.5 / longest) if longest > 0.0 else step
    return None


def of_measurement(robot: RobotSide) -> Iterator[Builtin]:
    """Measured values of the arm, and its targets."""
    record = robot.record
    read = record.get

    def field(name: str, posed: bool = False) -> Callable[[], Value]:
        return (lambda: PoseValue(vector(_tuple(read(name))))) if posed else (lambda: _tuple(read(name)))

    plain = {
        "get_actual_joint_positions": "actual_q",
        "get_joint_positions": "actual_q",
        "get_target_joint_positions": "target_q",
        "get_actual_joint_speeds": "actual_qd",
        "get_joint_speeds": "actual_qd",
        "get_target_joint_speeds": "target_qd",
        "get_target_joint_accelerations": "target_qdd",
        "get_actual_tcp_speed": "actual_TCP_speed",
        "get_target_tcp_speed": "target_TCP_speed",
        "get_tcp_force": "actual_TCP_force",
        "get_target_payload": "payload",
        "get_target_payload_mass": "payload",
        "get_target_payload_cog": "payload_cog",
        "get_target_payload_inertia": "payload_inertia",
        "get_tool_accelerometer_reading": "actual_tool_accelerometer",
        "get_target_speed_fraction": "target_speed_fraction",
        "get_target_gravity": "target_gravity",
    }
    for name, source in plain.items():
        yield builtin(name, field(source))
    yield builtin("get_joint_torques", lambda: _tuple(robot.simulation.estimate.tau_ext))
    for name, source in {
        "get_actual_tcp_pose": "actual_TCP_pose",
        "get_target_tcp_pose": "target_TCP_pose",
        "get_tcp_offset": "tcp_offset",
    }.items():
        yield builtin(name, field(source, posed=True), cost=OF_ARRAY)
    yield builtin("force", field("tcp_force_scalar"))
    joint = Taken("j", within(integer, 0, 5))
    yield builtin("get_joint_temp", lambda j: read("joint_temperatures")[j], joint)  # pyright: ignore[reportIndexIssue]
    yield builtin("get_controller_temp", lambda: 30.0)
    yield builtin("is_steady", lambda: bool(np.abs(robot.simulation.estimate.qd).max() < STEADY), cost=OF_ARRAY)
    yield builtin("get_gravity", lambda: tuple((-robot.simulation.estimate.g_B).tolist()))
    yield builtin("powerdown", lambda: robot.command("power_off"))


def of_history(robot: RobotSide, history: deque[tuple[float, ...]]) -> Iterator[Builtin]:
    """Earlier joint angles; `history` has the newest first."""

    def before(steps: int) -> Value:
        if steps < len(history):
            return history[steps]
        return history[-1] if history else _tuple(robot.record.get("actual_q"))

    steps = Taken("steps", within(integer, 0, HISTORY), 0)
    yield builtin("get_actual_joint_positions_history", before, steps)


def of_kinematics(robot: RobotSide) -> Iterator[Builtin]:
    """Forward, inverse, limits, and the matrices of the model."""
    arm = Kinematics(robot)
    joints = Taken("q", optional(numbers(6)), None)
    tcp = Taken("tcp", _tool_point, None)

    def forward(q: tuple[float, ...] | None, point: tuple[float, ...] | None) -> PoseValue:
        return arm.forward(_tuple(robot.record.get("actual_q")) if q is None else q, point)

    def flange() -> PoseValue:
        return arm.forward(_tuple(robot.record.get("actual_q")), FLANGE)

    def found(*given: Value) -> Value:
        x, near, _, _, point = given
        return arm.inverse(x, _tuple(robot.record.get("target_q")) if near is None else near, point)

    def waypoint() -> PoseValue:
        move = robot.arm.aim()
        if isinstance(move, ScriptedJoints):
            return arm.forward(move.q, None)
        if isinstance(move, ScriptedLine | ScriptedArc | ScriptedProcess):
            return PoseValue((*move.position, *rotation(move.quaternion)))
        return PoseValue(vector(_tuple(robot.record.get("target_TCP_pose"))))

    def inverse(*given: Value) -> Value:
        q = found(*given)
        if q is None:
            raise Misuse("no joint angles reach this pose")
        return q

    given = (
        Taken("qnear", optional(numbers(6)), None),
        Taken("maxPositionError", number, 1e-10),
        Taken("maxOrientationError", number, 1e-10),
        tcp,
    )
    yield builtin("get_target_waypoint", waypoint, cost=OF_MODEL)
    yield builtin("get_forward_kin", forward, joints, tcp, cost=OF_MODEL)
    yield builtin("get_actual_tool_flange_pose", flange, cost=OF_MODEL)
    yield builtin("get_inverse_kin", inverse, Taken("x", pose), *given)
    yield builtin("get_inverse_kin_has_solution", lambda *all_: found(*all_) is not None, Taken("pose", pose), *given)
    yield builtin("is_within_safety_limits", lambda x: _within(robot, arm, x), Taken("pose", any_value), cost=OF_MODEL)

    def q_now(q: Value) -> Array:
        return np.array(robot.record.get("actual_q") if q is None else q)

    def matrix(values: Array) -> Value:
        return tuple(map(tuple, values.tolist()))

    def jacobian(q: Value, point: Value) -> Value:
        _, R, J = robot.simulation.dynamics.update(q_now(q))
        lever = R @ np.array((arm.tcp if point is None else point)[:3])
        moved = J.copy()
        moved[:3] += np.cross(J[3:].T, lever).T
        return matrix(moved)

    def mass(q: Value, rotors: bool) -> Value:
        found = np.array(robot.simulation.dynamics.mass(q_now(q)))
        found = np.triu(found) + np.triu(found, 1).T
        return matrix(found + np.diag(robot.simulation.arm.motors.rotor_inertia) if rotors else found)

    def coriolis(q: Value, qd: Value) -> Value:
        angles = q_now(q)
        speeds = np.array(robot.record.get("actual_qd") if qd is None else qd)
        dynamics = robot.simulation.dynamics
        return _tuple(dynamics.inverse(angles, speeds, np.zeros(6)) - dynamics.gravity(angles))

    def jacobian_rate(q: Value, qd: Value, point: Value) -> Value:
        angles = q_now(q)
        speeds = np.array(robot.record.get("actual_qd") if qd is None else qd)
        step = 1e-5
        ahead = np.array(jacobian(tuple((angles + step * speeds).tolist()), point))
        behind = np.array(jacobian(tuple((angles - step * speeds).tolist()), point))
        return matrix((ahead - behind) / (2.0 * step))

    speeds = Taken("qd", optional(numbers(6)), None)
    yield builtin("get_jacobian", jacobian, joints, tcp, cost=OF_MODEL)
    yield builtin("get_jacobian_time_derivative", jacobian_rate, joints, speeds, tcp, cost=OF_MODEL)
    yield builtin("get_mass_matrix", mass, joints, Taken("include_rotors_inertia", boolean, False), cost=OF_MODEL)
    yield builtin("get_coriolis_and_centrifugal_torques", coriolis, joints, speeds, cost=OF_MODEL)


def _tool_point(value: Value) -> tuple[float, ...] | None:
    """A pose in F as numbers; for a name or None, None: the tool centre point in use."""
    return None if value is None or type(value) is str else pose(value)


def _tuple(value: Value) -> Value:
    found = value.tolist() if isinstance(value, np.ndarray) else value
    return tuple(found) if isinstance(found, list) else found


def _within(robot: RobotSide, arm: Kinematics, x: Value) -> bool:
    """Whether a posture, or a pose, is in reach. Walls do not count here: they are for hand guiding."""
    q = arm.inverse(pose(x), _tuple(robot.record.get("target_q")), None) if type(x) is PoseValue else numbers(6)(x)
    ends = robot.simulation.arm.limits.ends
    return q is not None and all(low <= angle <= high for angle, (low, high) in zip(q, ends, strict=True))
