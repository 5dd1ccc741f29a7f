"""The numbers and names by which a UR e-Series controller tells its state (RTDE guide; client interfaces 5.23)."""

from enum import IntEnum


class RobotMode(IntEnum):
    """Of the drives and the brakes."""

    NO_CONTROLLER = -1
    DISCONNECTED = 0
    CONFIRM_SAFETY = 1
    BOOTING = 2
    POWER_OFF = 3
    POWER_ON = 4
    IDLE = 5  # drives on, brakes closed
    BACKDRIVE = 6
    RUNNING = 7


class SafetyMode(IntEnum):
    """Of the safety system."""

    NORMAL = 1
    REDUCED = 2
    PROTECTIVE_STOP = 3
    RECOVERY = 4
    SAFEGUARD_STOP = 5
    SYSTEM_EMERGENCY_STOP = 6
    ROBOT_EMERGENCY_STOP = 7
    VIOLATION = 8
    FAULT = 9


class RuntimeState(IntEnum):
    """Of the program."""

    STOPPING = 0
    STOPPED = 1
    PLAYING = 2
    PAUSING = 3
    PAUSED = 4
    RESUMING = 5


class JointMode(IntEnum):
    """Of each joint."""

    POWER_OFF = 239
    RUNNING = 253
    IDLE = 255


class ControlMode(IntEnum):
    """What the joints are controlled by, in the primary interface."""

    POSITION = 0
    TEACH = 1
    FORCE = 2
    TORQUE = 3


class OperationalMode(IntEnum):
    """As the dashboard sets it; NONE until it does."""

    NONE = 0
    MANUAL = 1
    AUTOMATIC = 2


SAFETY_BITS = {
    SafetyMode.NORMAL: 1 << 0,
    SafetyMode.REDUCED: 1 << 1,
    SafetyMode.PROTECTIVE_STOP: 1 << 2 | 1 << 10,
    SafetyMode.RECOVERY: 1 << 3,
    SafetyMode.SAFEGUARD_STOP: 1 << 4 | 1 << 10,
    SafetyMode.SYSTEM_EMERGENCY_STOP: 1 << 5 | 1 << 7 | 1 << 10,
    SafetyMode.ROBOT_EMERGENCY_STOP: 1 << 6 | 1 << 7 | 1 << 10,
    SafetyMode.VIOLATION: 1 << 8 | 1 << 10,
    SafetyMode.FAULT: 1 << 9 | 1 << 10,
}
"""`safety_status_bits` of RTDE; bit 10 says that the robot is stopped because of safety."""

VERSION = (5, 26, 0, 140462)
"""Of the controller that is told: clients choose what they ask for by it."""

SERIAL = "20265500001"
"""Digits alone, and a year first: clients read it as a number."""
