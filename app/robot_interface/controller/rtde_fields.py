"""Every field of RTDE that UR documents for the e-Series: name and type, outputs and inputs (RTDE guide; URCL data_package)."""

SIZES = {
    "BOOL": 1,
    "UINT8": 1,
    "UINT32": 4,
    "UINT64": 8,
    "INT32": 4,
    "DOUBLE": 8,
    "VECTOR3D": 24,
    "VECTOR6D": 48,
    "VECTOR6INT32": 24,
    "VECTOR6UINT32": 24,
}
"""Bytes of a value of each type; all of them big-endian."""

FORMATS = {
    "BOOL": "u1",
    "UINT8": "u1",
    "UINT32": ">u4",
    "UINT64": ">u8",
    "INT32": ">i4",
    "DOUBLE": ">f8",
    "VECTOR3D": "3>f8",
    "VECTOR6D": "6>f8",
    "VECTOR6INT32": "6>i4",
    "VECTOR6UINT32": "6>u4",
}
"""The same for NumPy."""

REGISTERS = 48
"""Of whole numbers and of doubles, each way."""

FIRST_BIT, BITS = 64, 128
"""Bits from 64 to 127 have names of their own; those below come in words of 32."""


def _each(kind: str, *names: str) -> dict[str, str]:
    return dict.fromkeys(names, kind)


def _registers(way: str) -> dict[str, str]:
    words = _each("UINT32", f"{way}_bit_registers0_to_31", f"{way}_bit_registers32_to_63")
    bits = _each("BOOL", *(f"{way}_bit_register_{i}" for i in range(FIRST_BIT, BITS)))
    whole = _each("INT32", *(f"{way}_int_register_{i}" for i in range(REGISTERS)))
    return words | bits | whole | _each("DOUBLE", *(f"{way}_double_register_{i}" for i in range(REGISTERS)))


OUTPUTS: dict[str, str] = {
    **_each("DOUBLE", "timestamp", "actual_execution_time", "target_execution_time"),
    **_each("VECTOR6D", "target_q", "target_qd", "target_qdd", "target_current", "target_moment"),
    **_each("VECTOR6D", "actual_q", "actual_qd", "actual_qdd", "actual_current", "actual_moment", "actual_current_window"),
    **_each("VECTOR6D", "actual_current_as_torque", "joint_control_output"),
    **_each("VECTOR6D", "actual_TCP_pose", "actual_TCP_speed", "actual_TCP_force", "target_TCP_pose", "target_TCP_speed"),
    **_each("VECTOR6D", "tcp_offset", "actual_TCP_acceleration", "target_TCP_acceleration"),
    **_each("VECTOR6D", "ft_raw_wrench", "wrench_calc_from_currents", "payload_inertia"),
    **_each("VECTOR6D", "target_base_acceleration", "target_base_wrench"),
    **_each("VECTOR6D", "joint_temperatures", "actual_joint_voltage"),
    **_each("VECTOR3D", "actual_tool_accelerometer", "elbow_position", "elbow_velocity", "payload_cog", "target_gravity"),
    **_each("VECTOR6INT32", "joint_mode"),
    **_each("INT32", "robot_mode", "safety_mode", "safety_status", "encoder0_raw", "encoder1_raw"),
    **_each("INT32", "tool_output_voltage", "time_scale_source"),
    **_each("UINT32", "runtime_state", "robot_status_bits", "safety_status_bits", "analog_io_types"),
    **_each("UINT32", "euromap67_input_bits", "euromap67_output_bits"),
    **_each("UINT32", "tool_mode", "tool_analog_input_types", "script_control_line"),
    **_each("UINT64", "actual_digital_input_bits", "actual_configurable_digital_input_bits"),
    **_each("UINT64", "actual_digital_output_bits", "actual_configurable_digital_output_bits", "control_step"),
    **_each("DOUBLE", "speed_scaling", "target_speed_fraction", "actual_momentum", "actual_main_voltage"),
    **_each("DOUBLE", "actual_robot_voltage", "actual_robot_current", "io_current"),
    **_each("DOUBLE", "standard_analog_input0", "standard_analog_input1", "standard_analog_output0", "standard_analog_output1"),
    **_each("DOUBLE", "actual_robot_energy_consumed", "actual_robot_braking_energy_dissipated"),
    **_each("DOUBLE", "euromap67_24V_voltage", "euromap67_24V_current", "tool_analog_input0", "tool_analog_input1"),
    **_each("DOUBLE", "tool_output_current", "tool_temperature", "tcp_force_scalar"),
    **_each("DOUBLE", "joint_position_deviation_ratio", "collision_detection_ratio", "payload"),
    **_each("UINT8", "tool_output_mode", "tool_digital_output0_mode", "tool_digital_output1_mode"),
    **_registers("output"),
    **_registers("input"),
}
"""What the robot tells."""

INPUTS: dict[str, str] = {
    **_each("UINT32", "speed_slider_mask"),
    **_each("DOUBLE", "speed_slider_fraction"),
    **_each("UINT8", "standard_digital_output_mask", "standard_digital_output"),
    **_each("UINT8", "configurable_digital_output_mask", "configurable_digital_output"),
    **_each("UINT8", "tool_digital_output_mask", "tool_digital_output"),
    **_each("UINT8", "standard_analog_output_mask", "standard_analog_output_type"),
    **_each("DOUBLE", "standard_analog_output_0", "standard_analog_output_1"),
    **_each("VECTOR6D", "external_force_torque"),
    **_registers("input"),
}
"""What a client may set. Registers that are read back have the same name in both tables."""

CONSTANTS: dict[str, float | tuple[float, ...]] = {
    "speed_scaling": 1.0,  # of a UR's trajectory limiter; the slider is target_speed_fraction
    "actual_execution_time": 0.3,  # [ms]
    "target_execution_time": 0.3,
    "actual_current_window": (0.0,) * 6,
    "joint_control_output": (0.0,) * 6,
    "target_TCP_acceleration": (0.0,) * 6,
    "target_base_acceleration": (0.0,) * 6,
    "target_base_wrench": (0.0,) * 6,
    "actual_joint_voltage": (48.0,) * 6,  # [V]
    "actual_momentum": 0.0,
    "actual_main_voltage": 48.0,
    "actual_robot_voltage": 48.0,
    "actual_robot_current": 0.5,  # [A]
    "io_current": 0.0,
    "actual_robot_energy_consumed": 0.0,
    "actual_robot_braking_energy_dissipated": 0.0,
    "euromap67_24V_voltage": 0.0,
    "euromap67_24V_current": 0.0,
    "euromap67_input_bits": 0,
    "euromap67_output_bits": 0,
    "standard_analog_input0": 0.0,
    "standard_analog_input1": 0.0,
    "tool_analog_input0": 0.0,
    "tool_analog_input1": 0.0,
    "tool_output_current": 0.0,
    "tool_temperature": 25.0,  # [°C]
    "joint_position_deviation_ratio": 0.0,
    "collision_detection_ratio": 0.0,
    "encoder0_raw": 0,
    "encoder1_raw": 0,
    "tool_output_voltage": 0,
    "time_scale_source": 0,
    "tool_analog_input_types": 0b11,
    "tool_mode": 253,  # running
    "tool_output_mode": 0,
    "tool_digital_output0_mode": 0,
    "tool_digital_output1_mode": 0,
    "script_control_line": 0,
}
"""What this arm does not have, and answers with all the same."""
