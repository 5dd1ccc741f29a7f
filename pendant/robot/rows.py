"""Rows of the event table: safety inputs, sensors, stops and resets (FD-1)."""

from pendant.events.event import Kind
from pendant.events.event_row import Clears, Effect, EventRow, Severity, denied, info, protected

STAYS = "The robot stays in STOP."
"""Reaction to a reset that is refused."""

SAFETY: dict[Kind, EventRow] = {
    # Safety (FD-1)
    Kind.RUN_SENSORS_LOST: protected(
        "Protective stop: joint sensors not valid",
        "The program needs {sensor}. Check it, then reset.",
        ("sensor",),
        category=0,
    ),
    Kind.MOTOR_ANGLE_LOST: protected(
        "Protective stop: no motor angle of {joint}",
        "Nothing can hold it but its brake. Check its motor encoder, then reset.",
        ("joint",),
        category=0,
    )._replace(way_out="Check its motor encoder, then reset."),
    Kind.JOINT_SENSOR_LOST: denied(
        "Lost: {sensor} of {joint}",
        "{left}. End the motion and check it; free-drive needs it.",
        ("sensor", "joint", "left"),
        reaction="The control goes on with the values that are left. Where nothing is left, a stop follows.",
    ),
    Kind.JOINT_SENSOR_BACK: info("Back: {sensor} of {joint}", "", ("sensor", "joint")),
    Kind.EMERGENCY_STOP: EventRow(
        Effect.EMERGENCY_STOP,
        Severity.STOP,
        "Emergency stop",
        "Stopped while in {mode}. Make sure that nobody is in danger, then reset.",
        ("mode",),
        Clears.RESET,
        cool_down=True,
        category=1,
    ),
    Kind.PROTECTIVE_STOP: protected(
        "Protective stop: asked for", "Stopped while in {mode}. Its program says why; reset to go on.", ("mode",)
    ),
    Kind.EMERGENCY_STOP_RELEASED: info("Emergency stop released", "Reset to go on."),
    Kind.POWERED_OFF: EventRow(
        Effect.LEAVE_TO_STOP,
        Severity.STOP,
        "Power off",
        "Stopped while in {mode}. The brakes hold the arm; reset to switch the drives on.",
        ("mode",),
        Clears.RESET,
        cool_down=True,
        category=1,
        way_out="Reset, to switch the drives on.",
    ),
    Kind.SAFEGUARD_STOP: EventRow(
        Effect.SAFEGUARD_STOP,
        Severity.STOP,
        "Safeguard stop",
        "Stopped while in {mode}. Close the safeguard, then reset.",
        ("mode",),
        Clears.RESET,
        cool_down=True,
    ),
    Kind.SAFEGUARD_CLOSED: info("Safeguard closed", "Reset to go on."),
    Kind.REDUCED_ON: info(
        "Reduced speed",
        "Because of {cause}: tool {tcp:.2f} m/s, elbow {elbow:.2f} m/s, joints {joint_speed:.2f} rad/s at most.",
        ("cause", "tcp", "elbow", "joint_speed"),
    ),
    Kind.REDUCED_OFF: info("Reduced speed off"),
    Kind.STOPPED: info(
        "Stopped in {time:.2f} s",
        "Way of the tool {distance:.3f} m, stop category {category}.",
        ("time", "distance", "category", "cause"),
    ),
    Kind.RESET: info("Reset to TEACH"),
    Kind.RESET_REFUSED_SAFEGUARD: denied("Reset refused: safeguard open", "Close it, then reset.", reaction=STAYS),
    Kind.RESET_REFUSED_SIGNAL: denied("Reset refused: free-drive button held", "Let go of it, then reset.", reaction=STAYS),
    Kind.RESET_REFUSED_MOVING: denied(
        "Reset refused: the arm moves",
        "{joint} at {value:.3f} rad/s, limit {limit:.3f} rad/s for {time:.1f} s. Wait, then reset.",
        ("joint", "value", "limit", "time"),
        reaction=STAYS,
    ),
    Kind.RESET_REFUSED_SENSORS: denied(
        "Reset refused: joint sensors not valid",
        "Check {sensor}, then reset.",
        ("sensor",),
        reaction=STAYS,
        way_out="Check the sensors, then reset.",
    ),
}
