"""Rows of the event table: free-drive while it lasts, and its leaving (FD-8a, FD-12 to FD-23)."""

from pendant.events.event import Kind
from pendant.events.event_row import EXCESS, WALL, Clears, Effect, EventRow, Severity, info, left, refused, stopped

BACK = "Ask again after the cool-down, and guide the part back."
"""Way out of a wall or area."""

FREE_DRIVE: dict[Kind, EventRow] = {
    # While it lasts: the hand (FD-13)
    Kind.MANIPULATION: info(
        "The arm is guided",
        "{parameter}, {part}: {value:.2f} {unit}, limit {limit:.2f} {unit}.",
        EXCESS,
    ),
    Kind.WAYPOINT: info("Waypoint registered", "In free-drive this counts as guiding the arm."),
    # Its periods (FD-15, FD-16)
    Kind.RESTARTED: info("The arm stands still", "Free-drive ends in {period:.1f} s unless you move it.", ("period",)),
    Kind.PERIOD_ANEW: info("The period starts again", "Free-drive ends in {period:.1f} s unless you move the arm.", ("period",)),
    # Walls and areas (VW-6, VW-9)
    Kind.WALL_REACHED: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "{part} held at {wall}",
        "{distance:.1f} mm out. Push it back, {way} of the base.",
        WALL,
    ),
    # Locked axes (FD-4)
    Kind.SINGULARITY: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Singularity: {status}",
        "Value {value:.3f} m, near below {limit:.3f} m. Locked axes: turn back, or free them.",
        ("status", "value", "limit"),
    ),
    # The flange sensor (FD-3a, FD-19)
    Kind.WRENCH_LOST: stopped(
        "Stopped: flange force sensor not valid",
        "Check the sensor, then reset. Without it free-drive goes by the joints alone.",
    ),
    Kind.SENSOR_STEPPED: stopped(
        "Stopped: the flange force sensor stepped",
        "A step of {force:.1f} N without joint torque. Check the sensor and zero it, then reset.",
        ("force",),
    ),
    Kind.SENSOR_DRIFTED: stopped(
        "Stopped: the flange force sensor drifts",
        "Its bias moved by {force:.1f} N, {torque:.1f} N·m. Check the sensor and zero it, then reset.",
        ("force", "torque"),
    ),
    # The button (FD-23)
    Kind.HOLD_SILENT: EventRow(
        Effect.INFO,
        Severity.WARNING,
        "Connection slow: button treated as released",
        "Nothing heard from it for {value:.2f} s, limit {limit:.2f} s.",
        ("value", "limit"),
        reaction="The same follows as when the button is let go.",
    ),
    # Leaving: nobody moves the arm (FD-14, FD-15)
    Kind.LEFT_PERIOD: left(
        "Free-drive ended: nobody moved the arm", "No motion for {limit:.1f} s. Hold the button to start again.", ("limit",)
    ),
    Kind.LEFT_RESTART: left(
        "Free-drive ended: the arm stood still", "Still for {limit:.1f} s. Hold the button to start again.", ("limit",)
    ),
    # By the button (FD-8a)
    Kind.LEFT_PRESS: left(
        "Free-drive ended by a short press", "Pressed for {value:.2f} s, under {limit:.2f} s.", ("value", "limit")
    ),
    Kind.LEFT_RELEASE: left("Free-drive ended: button let go", "Hold-to-run is on: keep the button held."),
    # A limit (FD-18)
    Kind.LEFT_LIMIT: left(
        "Free-drive ended: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Guide it more gently.",
        EXCESS,
        Severity.WARNING,
    ),
    Kind.STOPPED_LIMIT: stopped(
        "Stopped: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. See what happened, then reset.",
        EXCESS,
    ),
    # Unintended motion (FD-19)
    Kind.STOPPED_MOTION: stopped(
        "Stopped: unintended motion",
        "{distance:.0f} mm without a hand, {time:.2f} s above {limit:.3f} m/s. Check payload and mounting, then reset.",
        ("distance", "time", "limit"),
    ),
    Kind.STOPPED_PAYLOAD: stopped(
        "Stopped: the payload dropped or changed",
        "{mass:+.1f} kg, a step of {force:.0f} N. Correct the payload, then reset.",
        ("mass", "force"),
    ),
    # The way back (FD-22)
    Kind.WAY_BACK: info("Way back to the posture at activation", "{joints}.", ("joints", "posture")),
    # A wall or area (VW-6, VW-9)
    Kind.LEFT_WALL: left(
        "Free-drive ended: {part} beyond {wall}", "{distance:.1f} mm out. Back is {way} of the base.", WALL, Severity.WARNING
    )._replace(way_out=BACK),
    Kind.STOPPED_WALL: stopped(
        "Stopped: {part} beyond {wall}", "{distance:.1f} mm out. Reset; back is {way} of the base.", WALL
    )._replace(way_out=f"Reset. {BACK}"),
    # Asked for (FD-17)
    Kind.DEACTIVATED: EventRow(Effect.LEAVE, Severity.NOTICE, "Free-drive switched off", "Hold the button to start again."),
    # Without joint sensors nothing can be decided (FD-12)
    Kind.SENSORS_LOST: EventRow(
        Effect.LEAVE_TO_STOP,
        Severity.STOP,
        "Stopped: joint sensors not valid",
        "Free-drive needs {sensor}. Check it, then reset.",
        ("sensor",),
        Clears.RESET,
        cool_down=True,
    ),
    # Enabling device: released and fully pressed both stop (FD-23)
    Kind.REFUSED_ENABLING: refused(
        "Free-drive refused: enabling device {grip}", "Hold the enabling device in its middle position.", ("grip",)
    ),
    Kind.LEFT_ENABLING: left(
        "Free-drive ended: enabling device {grip}",
        "Let go, then hold the enabling device in its middle position.",
        ("grip",),
        Severity.WARNING,
    )._replace(reaction="The arm brakes in a stop of category 2."),
    Kind.RUN_ENABLING: EventRow(
        Effect.INFO,
        Severity.WARNING,
        "Program stopped: enabling device {grip}",
        "Let go, hold the enabling device in its middle position, then resume.",
        ("grip",),
        reaction="The program pauses, and the arm brakes in a stop of category 2.",
    ),
}
