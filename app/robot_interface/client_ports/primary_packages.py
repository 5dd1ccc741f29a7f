"""The robot state of the primary and secondary interface as bytes (client interfaces 5.23): packages in a package."""

import struct
from collections.abc import Sequence

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.robot_words import RobotMode, RuntimeState, SafetyMode
from sim.arm.arm_file import Arm

ROBOT_STATE = 16

ROBOT_TYPES = {"ur5e": 1, "ur10e": 2, "ur3e": 3, "ur16e": 4}
"""As the configuration names them; another arm is told as a UR5."""

MASTERBOARD, CONTROLLER_BOX = 0, 0


def _vector(value: float | list[float]) -> list[float]:
    return value if isinstance(value, list) else [value]


class RobotState:
    """Builds the package of now.

    Args:
        cabinet: the robot.
        arm: its numbers.
    """

    def __init__(self, cabinet: Cabinet, arm: Arm) -> None:
        self._cabinet = cabinet
        self._configuration = _configuration(arm)
        self._kinematics = _kinematics(arm)

    def primary(self) -> bytes:
        """All that the primary interface tells ten times a second."""
        fixed = [(6, self._configuration), (5, self._kinematics)]
        return _packed([*self._changing(), *fixed])

    def secondary(self) -> bytes:
        """The same without what never changes."""
        return _packed([*self._changing(), (6, self._configuration)])

    def _get(self, name: str) -> list[float]:
        return _vector(self._cabinet.record.get(name))

    def _changing(self) -> list[tuple[int, bytes]]:
        return [
            (0, self._robot_mode()),
            (1, self._joints()),
            (2, self._tool()),
            (3, self._masterboard()),
            (4, struct.pack(">12d", *self._get("actual_TCP_pose"), *self._get("tcp_offset"))),
            (7, struct.pack(">7d", *self._get("actual_TCP_force"), 0.0)),
            (8, struct.pack(">B??B", 0, bool(self._cabinet.state.robot_bits & 4), False, 0)),
            (11, struct.pack(">?3i2f", False, 115200, 0, 1, 1.5, 3.5)),
            (12, bytes(3)),
        ]

    def _robot_mode(self) -> bytes:
        state = self._cabinet.state
        powered = state.robot_mode in (RobotMode.IDLE, RobotMode.RUNNING)
        emergency = state.safety_mode is SafetyMode.ROBOT_EMERGENCY_STOP
        protective = state.safety_mode is SafetyMode.PROTECTIVE_STOP
        program = (state.runtime in (RuntimeState.PLAYING, RuntimeState.PAUSED), state.runtime is RuntimeState.PAUSED)
        flags = (True, True, powered, emergency, protective, *program)
        (share,) = self._get("target_speed_fraction")
        stamp = int(self._cabinet.clock * 1e6)
        return struct.pack(">Q7?bB3dB", stamp, *flags, state.robot_mode, state.control_mode, share, share, 1.0, 0)

    def _joints(self) -> bytes:
        names = ("actual_q", "target_q", "actual_qd", "actual_current", "actual_joint_voltage", "joint_temperatures")
        columns = [self._get(name) for name in names]
        mode = self._cabinet.state.joint_mode
        return b"".join(
            struct.pack(">3d4fB", q, target, qd, current, volts, warm, warm, mode)
            for q, target, qd, current, volts, warm in zip(*columns, strict=True)
        )

    def _tool(self) -> bytes:
        (temperature,) = self._get("tool_temperature")
        return struct.pack(">bb2dfBffB", 1, 1, 0.0, 0.0, 48.0, 0, 0.0, temperature, 253)

    def _masterboard(self) -> bytes:
        state = self._cabinet.state
        (high,), (out,) = self._get("actual_digital_input_bits"), self._get("actual_digital_output_bits")
        (a,), (b,) = self._get("standard_analog_output0"), self._get("standard_analog_output1")
        (kinds,) = self._get("analog_io_types")
        volts = [int(kinds) >> bit & 1 for bit in range(4)]
        first = struct.pack(">II2B2d2b2d", int(high), int(out), *volts[:2], 0.0, 0.0, *volts[2:], a, b)
        reduced = state.safety_mode is SafetyMode.REDUCED
        safety = (state.safety_mode, reduced, 0, 0, state.operational, 0, 0)
        return first + struct.pack(">4f3BI3B", 30.0, 48.0, 0.5, 0.0, *safety)


def _packed(parts: Sequence[tuple[int, bytes]]) -> bytes:
    body = b"".join(struct.pack(">IB", len(part) + 5, kind) + part for kind, part in parts)
    return struct.pack(">iB", len(body) + 5, ROBOT_STATE) + body


def _configuration(arm: Arm) -> bytes:
    limits, chain = arm.limits, arm.chain
    ranges = [value for ends in limits.ends for value in ends]
    speeds = [value for pair in zip(limits.speed, limits.acceleration, strict=True) for value in pair]
    defaults = (1.05, 1.4, 0.25, 1.2, arm.reach)  # speed and acceleration of joints [rad/s, rad/s²], of the tool [m/s, m/s²]
    geometry = [*chain.a, *chain.d, *chain.alpha, *([0.0] * 6)]
    kinds = (MASTERBOARD, CONTROLLER_BOX, ROBOT_TYPES.get(arm.name, 1), 0)
    return struct.pack(">12d12d5d24d4i", *ranges, *speeds, *defaults, *geometry, *kinds)


def _kinematics(arm: Arm) -> bytes:
    chain = arm.chain
    return struct.pack(">6I24dI", *([0] * 6), *([0.0] * 6), *chain.a, *chain.d, *chain.alpha, 1)
