"""Rows of the event table: mode and program, contacts, tool and payload, settings, and the loop."""

from pendant.events.event import Kind
from pendant.events.event_row import WALL, Effect, EventRow, Severity, denied, info

ACTIONS = {
    "none": "The arm goes on",
    "stop": "The arm stops",
    "contact_pose": "The arm goes to where it touched",
    "retract": "The arm retreats",
    "reverse": "The arm goes back to where the move began",
    "turn": "The tool turns",
    "position": "The arm goes to a position",
}
"""What an arm does at a contact, by `Until.then`; "none" where nothing was asked for."""


def _touched(headline: str) -> EventRow:
    """A change in contact: force on the object in B, the tool's speed [mm/s], its pose at the first suspicious sample."""
    keys = (
        "part",
        "source",
        "rule",
        "force",
        "fx",
        "fy",
        "fz",
        "acceleration",
        "ax",
        "ay",
        "az",
        "ratio",
        "steps",
        "speed",
        "x",
        "y",
        "z",
        "posture",
        "action",
    )
    return EventRow(
        Effect.INFO,
        Severity.NOTICE,
        headline,
        "The force changed by {force:.1f} N, seen by the rule {rule}. {action}.",
        keys,
        words=ACTIONS,
        reaction="In a program, the action that its step asks for; else none.",
        way_out="By itself. The next change is told anew.",
    )


COMMANDS = {
    "emergency_stop": "An emergency stop",
    "emergency_stop_released": "Releasing the emergency stop",
    "protective_stop": "A protective stop",
    "power_off": "Switching the drives off",
    "reset": "A reset",
    "safeguard_open": "Opening the safeguard",
    "safeguard_closed": "Closing the safeguard",
    "reduced_on": "Switching to reduced mode",
    "reduced_off": "Switching out of reduced mode",
    "leave_free_drive": "Leaving free-drive",
    "restart_period": "Restarting the period of free-drive",
    "register_waypoint": "Registering a waypoint",
    "normal": "Switching to NORMAL",
    "teach": "Switching to TEACH",
    "remote": "Switching to REMOTE",
    "start_program": "Starting the program",
    "start_remotely": "Starting the program remotely",
    "pause_program": "Pausing the program",
    "resume_program": "Going on with the program",
    "stop_program": "Stopping the program",
    "wizard_measure": "Measuring this posture",
    "wizard_run": "Measuring the payload",
    "wizard_apply": "Using the measured payload",
    "wizard_clear": "Ending the measurement",
    "zero_sensor": "Zeroing the force sensor",
    "zero_reading": "Zeroing the force reading",
    "detection": "Switching contact detection",
}
"""What each command asks for, in words."""

PROGRAM: dict[Kind, EventRow] = {
    # Mode and program
    Kind.MODE_CHANGED: info("Mode {to}", "The mode before was {from}.", ("from", "to")),
    Kind.COMMAND_REFUSED: denied("{command} is not possible in {mode}", "{reason}.", ("command", "mode", "reason"))._replace(
        words=COMMANDS
    ),
    Kind.PROGRAM_LOADED: info('Program "{name}" loaded', "{steps} steps.", ("name", "steps")),
    Kind.PROGRAM_REFUSED: denied('Program "{name}" refused', "{reason}.", ("name", "reason")),
    Kind.PROGRAM_STARTED: info('Program "{name}" started', "", ("name",)),
    Kind.PROGRAM_PAUSED: info('Program "{name}" paused', "At step {step}. Resume or stop it.", ("name", "step")),
    Kind.PROGRAM_RESUMED: info('Program "{name}" resumed', "At step {step}.", ("name", "step")),
    Kind.PROGRAM_STOPPED: info('Program "{name}" stopped', "At step {step}.", ("name", "step")),
    Kind.PROGRAM_FINISHED: info('Program "{name}" finished', "", ("name",)),
    Kind.PROGRAM_FAILED: denied(
        'Program "{name}" stopped at step {step}',
        "{reason}.",
        ("name", "step", "reason"),
        reaction="The program ends, the arm brakes, and the mode is that in which the program was started.",
    ),
    Kind.PROGRAM_TELLS: EventRow(Effect.INFO, Severity.NOTICE, "{text}", 'Program "{name}".', ("name", "text", "tone")),
    Kind.TOOL_SWITCHED: info("Tool {state}", "", ("state",)),
    Kind.OUTPUT_SWITCHED: info("Output {number} {state}", "", ("number", "state")),
    Kind.MOTION_AT_WALL: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Stopped at {wall}: {part}",
        "At {px:.3f}, {py:.3f}, {pz:.3f} m, {distance:.1f} mm out. Back is {way} of the base.",
        WALL,
        reaction="The arm's own motion ends at the border. The program ends, or the jogging, with an event of its own.",
        way_out="Jog or guide the part back.",
    ),
    Kind.JOG_STARTED: info("Jogging {what}", "", ("what",)),
    Kind.JOG_ENDED: info(
        "Jogging {what} ended after {moved}",
        "{reason}.",
        ("what", "moved", "reason"),
        reaction="The arm brakes.",
        way_out="Jog again. Where the reason is no wish of yours, mend it first.",
    )._replace(words={"no word from the button": "Lost contact with the page"}),
    Kind.JOG_REFUSED: denied("Not jogged: {what}", "{reason}.", ("what", "reason")),
    # Change in contact (CD-13, CD-16)
    Kind.CONTACT_GAINED: _touched("Touched at {force:.0f} N: {part}"),
    Kind.CONTACT_LOST: _touched("Contact lost: {part}"),
    Kind.CONTACT_RESISTANCE: _touched("Resistance changed: {part}"),
    Kind.CONTACT_CLAMPING: _touched("Clamping: {part}"),
    # Tool and payload
    Kind.TOOL_CHANGED: info(
        "Tool {name}",
        "It was {old}. Tool centre point {x:z.0f}, {y:z.0f}, {z:z.0f} mm, {mass:.2f} kg; no payload beyond it.",
        ("name", "old", "mass", "x", "y", "z"),
    ),
    Kind.TOOLS_CHANGED: info("Table of tools: {change}", "{count} tools.", ("change", "count")),
    Kind.TOOL_REFUSED: denied("Not changed: {what}", "{reason}.", ("what", "reason")),
    Kind.WALLS_CHANGED: info("Walls: {change}", "{count} walls and areas.", ("change", "count")),
    Kind.WALLS_REFUSED: denied("Walls not changed", "{reason}.", ("reason",)),
    Kind.PAYLOAD_CHANGED: info(
        "Payload {mass:.2f} kg",
        "Centre {x:z.0f}, {y:z.0f}, {z:z.0f} mm; with tool {tool} {total:.2f} kg.",
        ("mass", "x", "y", "z", "tool", "total"),
    ),
    Kind.POSTURE_MEASURED: info(
        "Posture {number} measured",
        "{angle:.0f}° from the nearest other, at least {limit:.1f}°. {missing} more needed.",
        ("number", "angle", "limit", "missing"),
    ),
    Kind.POSTURE_REFUSED: denied("Posture refused", "{reason}.", ("reason",)),
    Kind.PAYLOAD_FOUND: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Found: {mass:.2f} ± {mass_deviation:.2f} kg",
        "Centre {x:z.0f}, {y:z.0f}, {z:z.0f} ± {centre_deviation:.1f} mm; {postures} postures, fit {fit:.2f} N.",
        ("mass", "mass_deviation", "x", "y", "z", "centre_deviation", "fit", "postures"),
    ),
    Kind.WIZARD_STARTED: info("Measuring the payload", "The arm turns its wrist by itself, slowly. Hands off the arm.", ()),
    Kind.WIZARD_FINISHED: info("Payload measured", "{postures} postures; the arm is back where it began.", ("postures",)),
    Kind.WIZARD_STOPPED: denied(
        "Measuring the payload stopped",
        "{reason}.",
        ("reason",),
        reaction="The wrist comes to rest. What is measured is kept.",
    ),
    Kind.WIZARD_REFUSED: denied("The payload is not measured", "{reason}.", ("reason",)),
    # The flange sensor's zero
    Kind.SENSOR_ZEROED: info(
        "Force sensor zeroed", "{force:.1f} N and {torque:.2f} N·m subtracted.", ("force", "torque", "x", "y", "z")
    ),
    Kind.READING_ZEROED: info(
        "Force reading zeroed", "Forces are told against {force:.1f} N and {torque:.2f} N·m.", ("force", "torque")
    ),
    Kind.READING_ZEROED_PULLED: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Force reading zeroed while something pulls",
        "Forces are told against {force:.1f} N and {torque:.2f} N·m; {reason}.",
        ("force", "torque", "reason"),
    ),
    Kind.ZERO_REFUSED: denied("Force sensor not zeroed", "{reason}.", ("reason",)),
    Kind.ZERO_DUE: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Zero the force sensor",
        "It shows {force:.1f} N, {torque:.2f} N·m too much. Zero it with nothing touching, or check the payload.",
        ("force", "torque"),
    ),
    # Settings
    Kind.SETTING_CHANGED: info("{name}: {new}", "It was {old}.", ("name", "old", "new")),
    Kind.SETTING_REFUSED: denied("{name}: {value} refused", "{reason}.", ("name", "value", "reason")),
    # The loop that runs all of it
    Kind.OVERRUN: denied(
        "Simulation late {often}, by {late:.0f} ms at worst",
        "The machine is busy; {lost:.1f} s were dropped.",
        ("late", "lost", "often"),
        reaction="The simulation drops the time for which it was late, and goes on.",
        way_out="By itself, when the machine has time again.",
    ),
    Kind.BROKEN_DOWN: denied(
        "The simulation broke down",
        "{reason}. Nothing moves any more. Start over, on the tab Lab.",
        ("reason",),
        reaction="The simulation stands still. It does nothing that is asked of it.",
        way_out="Start over, on the tab Lab.",
    ),
    Kind.PART_BROKEN: denied(
        "Does not work: {part}",
        "{reason}. The robot goes on.",
        ("part", "reason"),
        reaction="The part does nothing. The robot goes on.",
        way_out="By itself, when the part works again. What is not tried again works after a new start of the product.",
    ),
    Kind.RECORDING_BROKEN: denied(
        "The recording ended",
        "{reason}. What is in {file} can be replayed.",
        ("file", "reason"),
        reaction="The recording ends. The robot goes on.",
        way_out="Mend what the reason names, then record again.",
    ),
}
