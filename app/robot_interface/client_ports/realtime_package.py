"""The package of the real-time interface: 1,220 bytes, 152 doubles after the size (client interfaces, RealTime 5.10)."""

import struct

import numpy as np

from app.robot_interface.controller.cabinet import Cabinet

SIZE = 1220

FIRST = [
    *("timestamp", "target_q", "target_qd", "target_qdd", "target_current", "target_moment", "actual_q", "actual_qd"),
    *("actual_current", "joint_control_output", "actual_TCP_pose", "actual_TCP_speed", "actual_TCP_force", "target_TCP_pose"),
    "target_TCP_speed",
]
"""Doubles that stand in RTDE's record as they are told here."""

LAST = ["payload", "payload_cog", "payload_inertia"]


class RealtimePackage:
    """Builds the package of a tick."""

    def __init__(self, cabinet: Cabinet) -> None:
        self._cabinet = cabinet
        record = cabinet.record
        self._first, self._last = record.where(FIRST), record.where(LAST)
        self._digital = record.where(["actual_joint_voltage"])
        self._elbow = record.where(["elbow_position", "elbow_velocity"])

    def bytes(self) -> bytes:
        """The package of the tick done last."""
        record, state = self._cabinet.record, self._cabinet.state
        get = record.get
        middle = [
            float(_number(get("actual_digital_input_bits"))),
            *_list(get("joint_temperatures")),
            0.3,  # time that the controller took [ms]
            0.0,  # test value
            float(state.robot_mode),
            *[float(state.joint_mode)] * 6,
            float(state.safety_mode),
            *[0.0] * 6,  # used by UR only
            *_list(get("actual_tool_accelerometer")),
            *[0.0] * 6,
            _number(get("speed_scaling")),
            0.0,  # linear momentum
            *[0.0] * 2,
            48.0,
            48.0,
            0.5,
        ]
        after = [float(_number(get("actual_digital_output_bits"))), float(state.runtime)]
        end = [float(state.safety_mode), 0.0, 0.0, 0.0]
        return b"".join(
            (
                struct.pack(">i", SIZE),
                record.taken(self._first),
                np.array(middle, ">f8").tobytes(),
                record.taken(self._digital),
                np.array(after, ">f8").tobytes(),
                record.taken(self._elbow),
                np.array(end, ">f8").tobytes(),
                record.taken(self._last),
            )
        )


def _number(value: float | list[float]) -> float:
    return value[0] if isinstance(value, list) else value


def _list(value: float | list[float]) -> list[float]:
    return value if isinstance(value, list) else [value]
