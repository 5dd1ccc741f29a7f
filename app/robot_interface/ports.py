"""The ports of a robot's interfaces, by name."""

from app.robot_interface.gripper.gripper_registers import NUMBER

DASHBOARD, PRIMARY, SECONDARY, REALTIME, RTDE, CONTROL = "dashboard", "primary", "secondary", "real-time", "RTDE", "control"
GRIPPER = "gripper"

READ_ONLY = ", read-only"

PORTS = {
    DASHBOARD: 29999,
    PRIMARY: 30001,
    SECONDARY: 30002,
    REALTIME: 30003,
    RTDE: 30004,
    PRIMARY + READ_ONLY: 30011,
    SECONDARY + READ_ONLY: 30012,
    REALTIME + READ_ONLY: 30013,
    GRIPPER: NUMBER,
    CONTROL: 30090,
}
"""A UR's ports, that of a Robotiq gripper's software on it, and that of the control channel, which a UR does not have."""
