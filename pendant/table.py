"""The one event table: effect on the mode, severity, texts, what clears it, who may override. Interfaces render from it."""

from enum import IntEnum, StrEnum
from typing import NamedTuple

from pendant.events import Event, Kind


class Effect(StrEnum):
    """What an event does to the mode; all that state machines ask of an event."""

    INFO = "INFO"  # nothing
    TRY = "TRY"  # the arm is freed for the activation sequence; a running program pauses
    ENTER = "ENTER"  # free-drive begins
    NO_ENTRY = "NO_ENTRY"  # free-drive is refused, the mode stays
    LEAVE = "LEAVE"  # free-drive ends, back to the remembered mode
    LEAVE_TO_STOP = "LEAVE_TO_STOP"  # free-drive ends in STOP
    SAFEGUARD_STOP = "SAFEGUARD_STOP"  # STOP, safety SAFEGUARD_STOP
    PROTECTIVE_STOP = "PROTECTIVE_STOP"  # STOP, safety PROTECTIVE_STOP
    EMERGENCY_STOP = "EMERGENCY_STOP"  # STOP, safety EMERGENCY_STOP


LEAVING = frozenset({Effect.LEAVE, Effect.LEAVE_TO_STOP, Effect.SAFEGUARD_STOP, Effect.PROTECTIVE_STOP, Effect.EMERGENCY_STOP})
"""Effects that end free-drive."""


class Severity(IntEnum):
    """How loud an interface shows it."""

    INFO = 0
    NOTICE = 1
    WARNING = 2
    STOP = 3


class Clears(StrEnum):
    """What takes a shown event away."""

    NEXT = "next"  # the next event
    COOL_DOWN = "cool-down"  # the end of the cool-down
    RESET = "reset"  # a reset, and nothing else


class Row(NamedTuple):
    """What an event of one kind does and says. Texts name the event's values in braces."""

    effect: Effect
    severity: Severity
    headline: str
    guidance: str
    keys: tuple[str, ...] = ()  # the values that the event carries
    clears: Clears = Clears.NEXT
    override: str = "nobody"  # who may override it
    cool_down: bool = False  # starts the cool-down (FD-12c)
    category: int = 2  # of the stop, where it stops: 0 power off at once, 1 off at standstill, 2 stays on


WALL = ("wall", "part", "distance", "way", "x", "y", "z", "px", "py", "pz")
"""Values of an event of a wall: its name, the part, how far out [mm], the way back in words and as a direction of length 1 (zeros
where it cannot be told), the part's place [m]; both in B."""


def _info(headline: str, guidance: str = "", keys: tuple[str, ...] = ()) -> Row:
    return Row(Effect.INFO, Severity.INFO, headline, guidance, keys)


def _refused(headline: str, guidance: str, keys: tuple[str, ...]) -> Row:
    return Row(Effect.NO_ENTRY, Severity.WARNING, headline, guidance, keys, Clears.COOL_DOWN, cool_down=True)


def _left(headline: str, guidance: str, keys: tuple[str, ...] = (), severity: Severity = Severity.NOTICE) -> Row:
    return Row(Effect.LEAVE, severity, headline, guidance, keys, Clears.COOL_DOWN, cool_down=True)


def _stopped(headline: str, guidance: str, keys: tuple[str, ...]) -> Row:
    return Row(Effect.LEAVE_TO_STOP, Severity.STOP, headline, guidance, keys, Clears.RESET, cool_down=True)


def _denied(headline: str, guidance: str, keys: tuple[str, ...] = ()) -> Row:
    return Row(Effect.INFO, Severity.WARNING, headline, guidance, keys)


def _touched(headline: str) -> Row:
    """A change in contact: force on the object in B, pose of the tool centre point at the first suspicious sample."""
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
        "x",
        "y",
        "z",
        "posture",
        "action",
    )
    return Row(
        Effect.INFO,
        Severity.NOTICE,
        headline,
        "{force:.1f} N more or less; rule {rule}, {steps} ticks after it began. Action: {action}.",
        keys,
    )


TABLE: dict[Kind, Row] = {
    # Activation and entry (FD-7, FD-8a, FD-12)
    Kind.ACTIVATION_STARTED: _info(
        "Free-drive: keep holding", "Hold the button for {period:.1f} s, hands off the arm.", ("period",)
    ),
    Kind.ACTIVATION_CANCELLED: _info(
        "Free-drive not started: let go too early",
        "Held for {value:.2f} s. Hold the button for {limit:.2f} s.",
        ("value", "limit"),
    ),
    Kind.SIGNAL_SEEN: _info("Free-drive: {source}", "Go on for {period:.1f} s.", ("source", "period")),
    Kind.CONFIRM_ASKED: _info(
        "Free-drive: confirm",
        "Let go; after {feedback:.1f} s, push it or press the button within {window:.0f} s.",
        ("source", "feedback", "window"),
    ),
    Kind.REFUSED_UNCONFIRMED: _refused(
        "Free-drive refused: not confirmed", "Nobody confirmed the {source} within {limit:.0f} s.", ("source", "limit")
    ),
    Kind.LET_GO_ASKED: _info(
        "Free-drive: let go",
        "{force:.0f} N; hands off, to below {limit:.0f} N in {within:.1f} s.",
        ("force", "limit", "within"),
    ),
    Kind.REFUSED_STILL_HELD: _refused(
        "Free-drive refused: let go",
        "Still {force:.0f} N after {within:.1f} s, limit {limit:.0f} N. Let go before the check.",
        ("force", "limit", "within"),
    ),
    # In every mode (FD-6a)
    Kind.PUSHED: _info(
        "Push of {force:.0f} N at the {part}", "({x:.2f}, {y:.2f}, {z:.2f}) in the base's axes.", ("part", "force", "x", "y", "z")
    ),
    Kind.ENTERED: Row(
        Effect.ENTER, Severity.NOTICE, "Free-drive", "Move the arm by hand. A short press leaves.", ("from", "gain")
    ),
    Kind.REFUSED_MODE: _refused("Free-drive refused: mode is {mode}", "Allowed in: {allowed}.", ("mode", "allowed")),
    Kind.REFUSED_SENSORS: _refused("Free-drive refused: joint sensors not valid", "Check {sensor}, then try again.", ("sensor",)),
    Kind.REFUSED_MOVING: _refused(
        "Free-drive refused: the arm moves",
        "{joint} at {value:.3f} rad/s, limit {limit:.3f} rad/s for {time:.1f} s. Hands off, then try again.",
        ("joint", "value", "limit", "time"),
    ),
    Kind.REFUSED_CHANGING: _refused(
        "Free-drive refused: the payload is being changed", "{mass:.2f} kg by now. Wait until it is done.", ("mass",)
    ),
    Kind.REFUSED_SHORT: _refused(
        "Free-drive refused: the check is too short",
        "{value:.3f} s; below {limit:.2f} s only with the handshake or a stored state.",
        ("value", "limit"),
    ),
    Kind.REFUSED_NOT_STORED: _refused(
        "Free-drive refused: no stored state",
        "None of {age:.1f} s ago to compare with. Leave the arm untouched for so long, then try again.",
        ("age",),
    ),
    Kind.SEQUENCE_STARTED: Row(
        Effect.TRY, Severity.INFO, "Free-drive: hands off", "Checking for {period:.1f} s that the arm stays.", ("period",)
    ),
    Kind.ENTRY_PREVENTED: _denied(
        "Beyond its limit: {parameter}",
        "{part}: {value:.3f} {unit}, limit {limit:.3f} {unit}, {time:.2f} s into the check.",
        ("parameter", "part", "value", "limit", "unit", "time"),
    ),
    Kind.REFUSED_LIMIT: _refused(
        "Free-drive refused: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Let go; check the payload and mounting.",
        ("parameter", "part", "value", "limit", "unit"),
    ),
    Kind.REFUSED_PAYLOAD: _refused(
        "Free-drive refused: wrong payload or a push",
        "Consistent with {mass:+.1f} kg at the flange, or with a steady {force:.0f} N push {way}; let go to decide.",
        ("mass", "force", "way", "parameter"),
    ),
    Kind.REFUSED_WALL: _refused(
        "Free-drive refused: {part} beyond {wall}",
        "{distance:.1f} mm out; back is {way} of the base. Let go; check the payload.",
        WALL,
    ),
    Kind.SEQUENCE_STOPPED: Row(
        Effect.PROTECTIVE_STOP,
        Severity.STOP,
        "Protective stop: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Let go, check the payload, then reset.",
        ("parameter", "part", "value", "limit", "unit"),
        Clears.RESET,
        cool_down=True,
    ),
    Kind.RESIDUAL_GONE: Row(
        Effect.INFO,
        Severity.NOTICE,
        "It was a push: the force is gone",
        "{force:.0f} N at the refusal, {left:.0f} N now. Hands off while the arm is checked.",
        ("force", "left"),
    ),
    Kind.RESIDUAL_STAYED: Row(
        Effect.INFO,
        Severity.WARNING,
        "The force has stayed: check the payload",
        "{force:.0f} N, as of {mass:+.1f} kg more than configured. Hands off? Correct the payload.",
        ("force", "mass"),
        Clears.NEXT,
    ),
    Kind.NOT_YET: Row(
        Effect.INFO,
        Severity.NOTICE,
        "Free-drive not yet",
        "Let go first; ready in {remaining:.1f} s.",
        ("remaining",),
        Clears.COOL_DOWN,
    ),
    # While it lasts (FD-13, FD-15, FD-23)
    Kind.MANIPULATION: _info(
        "The arm is guided",
        "{parameter}, {part}: {value:.2f} {unit}, limit {limit:.2f} {unit}.",
        ("parameter", "part", "value", "limit", "unit"),
    ),
    Kind.WAYPOINT: _info("Waypoint registered", "In free-drive this counts as guiding the arm."),
    Kind.RESTARTED: _info("The arm stands still", "Free-drive ends in {period:.1f} s unless you move it.", ("period",)),
    Kind.PERIOD_ANEW: _info("The period begins anew", "Free-drive ends in {period:.1f} s unless you move the arm.", ("period",)),
    Kind.WALL_REACHED: Row(
        Effect.INFO,
        Severity.NOTICE,
        "{part} held at {wall}",
        "{distance:.1f} mm out. Push it back, {way} of the base.",
        WALL,
    ),
    Kind.SINGULARITY: Row(
        Effect.INFO,
        Severity.NOTICE,
        "Singularity: {status}",
        "Value {value:.3f} m, near below {limit:.3f} m. Locked axes: turn back, or free them.",
        ("status", "value", "limit"),
    ),
    Kind.WRENCH_LOST: Row(
        Effect.INFO,
        Severity.WARNING,
        "Flange force sensor not valid",
        "The arm is heavier to move: no help from the force sensor.",
    ),
    Kind.SENSOR_STEPPED: Row(
        Effect.INFO,
        Severity.WARNING,
        "The flange force sensor stepped",
        "{force:.1f} N at once that the joints do not feel: no help from it any more. Leave, and check it.",
        ("force",),
    ),
    Kind.HOLD_SILENT: Row(
        Effect.INFO,
        Severity.WARNING,
        "Button counts as released",
        "Nothing heard from it for {value:.2f} s, limit {limit:.2f} s. Check the connection.",
        ("value", "limit"),
    ),
    # Leaving (FD-8a, FD-12, FD-14, FD-15, FD-17)
    Kind.LEFT_PERIOD: _left(
        "Free-drive ended: nobody moved the arm", "No motion for {limit:.1f} s. Hold the button to start again.", ("limit",)
    ),
    Kind.LEFT_RESTART: _left(
        "Free-drive ended: the arm stood still", "Still for {limit:.1f} s. Hold the button to start again.", ("limit",)
    ),
    Kind.LEFT_PRESS: _left(
        "Free-drive ended by a short press", "Pressed for {value:.2f} s, under {limit:.2f} s.", ("value", "limit")
    ),
    Kind.LEFT_RELEASE: _left("Free-drive ended: button let go", "Hold-to-run is on: keep the button held."),
    Kind.LEFT_LIMIT: _left(
        "Free-drive ended: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Guide it more gently.",
        ("parameter", "part", "value", "limit", "unit"),
        Severity.WARNING,
    ),
    Kind.STOPPED_LIMIT: _stopped(
        "Stopped: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. See what happened, then reset.",
        ("parameter", "part", "value", "limit", "unit"),
    ),
    Kind.STOPPED_MOTION: _stopped(
        "Stopped: the arm moved and nobody moved it",
        "{value:.3f} m/s for {time:.2f} s, limit {limit:.3f} m/s. Check payload and mounting, then reset.",
        ("value", "limit", "time"),
    ),
    Kind.STOPPED_PAYLOAD: _stopped(
        "Stopped: the payload dropped or changed",
        "{mass:+.1f} kg, {force:.0f} N at once. Correct the payload, then reset.",
        ("mass", "force"),
    ),
    Kind.WAY_BACK: _info("Back to the posture at activation", "{joints}.", ("joints", "posture")),
    Kind.LEFT_WALL: _left(
        "Free-drive ended: {part} beyond {wall}", "{distance:.1f} mm out. Back is {way} of the base.", WALL, Severity.WARNING
    ),
    Kind.STOPPED_WALL: _stopped(
        "Stopped: {part} beyond {wall}", "{distance:.1f} mm out. Reset; back is {way} of the base.", WALL
    ),
    Kind.DEACTIVATED: Row(Effect.LEAVE, Severity.NOTICE, "Free-drive switched off", "Hold the button to start again."),
    Kind.SENSORS_LOST: Row(
        Effect.LEAVE_TO_STOP,
        Severity.STOP,
        "Stopped: joint sensors not valid",
        "Free-drive needs {sensor}. Check it, then reset.",
        ("sensor",),
        Clears.RESET,
        cool_down=True,
    ),
    # Enabling device: released and fully pressed both stop
    Kind.REFUSED_ENABLING: _refused(
        "Free-drive refused: enabling device {grip}", "Hold the enabling device in its middle position.", ("grip",)
    ),
    Kind.LEFT_ENABLING: _left(
        "Free-drive ended: enabling device {grip}",
        "Let go, then hold the enabling device in its middle position.",
        ("grip",),
        Severity.WARNING,
    ),
    Kind.RUN_ENABLING: Row(
        Effect.INFO,
        Severity.WARNING,
        "Program stopped: enabling device {grip}",
        "Let go, hold the enabling device in its middle position, then resume.",
        ("grip",),
    ),
    # Safety (FD-1)
    Kind.RUN_SENSORS_LOST: Row(
        Effect.PROTECTIVE_STOP,
        Severity.STOP,
        "Protective stop: joint sensors not valid",
        "The program needs {sensor}. Check it, then reset.",
        ("sensor",),
        Clears.RESET,
        cool_down=True,
    ),
    Kind.JOINT_SENSOR_LOST: _denied(
        "Lost: {sensor} of {joint}", "{left}. End the motion and check it; free-drive needs it.", ("sensor", "joint", "left")
    ),
    Kind.JOINT_SENSOR_BACK: _info("Back: {sensor} of {joint}", "", ("sensor", "joint")),
    Kind.EMERGENCY_STOP: Row(
        Effect.EMERGENCY_STOP,
        Severity.STOP,
        "Emergency stop",
        "It was {mode}. Make sure that nobody is in danger, then reset.",
        ("mode",),
        Clears.RESET,
        cool_down=True,
        category=1,
    ),
    Kind.SAFEGUARD_STOP: Row(
        Effect.SAFEGUARD_STOP,
        Severity.STOP,
        "Safeguard stop",
        "It was {mode}. Close the safeguard, then reset.",
        ("mode",),
        Clears.RESET,
        cool_down=True,
    ),
    Kind.SAFEGUARD_CLOSED: _info("Safeguard closed", "Reset to go on."),
    Kind.REDUCED_ON: _info(
        "Reduced speed",
        "Tool {tcp:.2f} m/s, elbow {elbow:.2f} m/s, joints {joint_speed:.2f} rad/s at most.",
        ("tcp", "elbow", "joint_speed"),
    ),
    Kind.REDUCED_OFF: _info("Reduced speed off"),
    Kind.REDUCED_EXCEEDED: Row(
        Effect.PROTECTIVE_STOP,
        Severity.STOP,
        "Protective stop: {parameter} in REDUCED",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Move it more slowly, then reset.",
        ("parameter", "part", "value", "limit", "unit"),
        Clears.RESET,
        cool_down=True,
        category=0,
    ),
    Kind.STOPPED: _info(
        "Stopped in {time:.2f} s",
        "Way of the tool {distance:.3f} m, stop category {category}.",
        ("time", "distance", "category", "cause"),
    ),
    Kind.RESET: _info("Reset to TEACH"),
    Kind.RESET_REFUSED_SAFEGUARD: _denied("Reset refused: safeguard open", "Close it, then reset."),
    Kind.RESET_REFUSED_SIGNAL: _denied("Reset refused: free-drive button held", "Let go of it, then reset."),
    Kind.RESET_REFUSED_MOVING: _denied(
        "Reset refused: the arm moves",
        "{joint} at {value:.3f} rad/s, limit {limit:.3f} rad/s for {time:.1f} s. Wait, then reset.",
        ("joint", "value", "limit", "time"),
    ),
    Kind.RESET_REFUSED_SENSORS: _denied("Reset refused: joint sensors not valid", "Check {sensor}, then reset.", ("sensor",)),
    # Mode and program
    Kind.MODE_CHANGED: _info("Mode {to}", "It was {from}.", ("from", "to")),
    Kind.COMMAND_REFUSED: _denied("Not possible in {mode}: {command}", "{reason}.", ("command", "mode", "reason")),
    Kind.PROGRAM_LOADED: _info("Program {name} loaded", "{steps} steps.", ("name", "steps")),
    Kind.PROGRAM_REFUSED: _denied("Program {name} refused", "{reason}.", ("name", "reason")),
    Kind.PROGRAM_STARTED: _info("Program {name} started", "", ("name",)),
    Kind.PROGRAM_PAUSED: _info("Program {name} paused", "At step {step}. Resume or stop it.", ("name", "step")),
    Kind.PROGRAM_RESUMED: _info("Program {name} resumed", "At step {step}.", ("name", "step")),
    Kind.PROGRAM_STOPPED: _info("Program {name} stopped", "At step {step}.", ("name", "step")),
    Kind.PROGRAM_FINISHED: _info("Program {name} finished", "", ("name",)),
    Kind.PROGRAM_FAILED: _denied("Program {name} cannot go on", "Step {step}: {reason}.", ("name", "step", "reason")),
    Kind.TOOL_SWITCHED: _info("Tool {state}", "", ("state",)),
    # Change in contact (CD-13, CD-16)
    Kind.CONTACT_GAINED: _touched("Contact gained: {part}"),
    Kind.CONTACT_LOST: _touched("Contact lost: {part}"),
    Kind.CONTACT_RESISTANCE: _touched("Resistance changed: {part}"),
    Kind.CONTACT_CLAMPING: _touched("Clamping: {part}"),
    # Tool and payload
    Kind.TOOL_CHANGED: _info(
        "Tool {name}",
        "It was {old}. Tool centre point {x:z.0f}, {y:z.0f}, {z:z.0f} mm, {mass:.2f} kg; no payload beyond it.",
        ("name", "old", "mass", "x", "y", "z"),
    ),
    Kind.TOOLS_CHANGED: _info("Table of tools: {change}", "{count} tools.", ("change", "count")),
    Kind.TOOL_REFUSED: _denied("Not changed: {what}", "{reason}.", ("what", "reason")),
    Kind.PAYLOAD_CHANGED: _info(
        "Payload {mass:.2f} kg",
        "Centre {x:z.0f}, {y:z.0f}, {z:z.0f} mm; with tool {tool} {total:.2f} kg.",
        ("mass", "x", "y", "z", "tool", "total"),
    ),
    Kind.POSTURE_MEASURED: _info(
        "Posture {number} measured",
        "{angle:.0f}° from the nearest other, at least {limit:.1f}°. {missing} more needed.",
        ("number", "angle", "limit", "missing"),
    ),
    Kind.POSTURE_REFUSED: _denied("Posture refused", "{reason}.", ("reason",)),
    Kind.PAYLOAD_FOUND: Row(
        Effect.INFO,
        Severity.NOTICE,
        "Found: {mass:.2f} ± {mass_deviation:.2f} kg",
        "Centre {x:z.0f}, {y:z.0f}, {z:z.0f} ± {centre_deviation:.1f} mm; {postures} postures, fit {fit:.2f} N.",
        ("mass", "mass_deviation", "x", "y", "z", "centre_deviation", "fit", "postures"),
    ),
    # Settings
    Kind.SETTING_CHANGED: _info("{name}: {new}", "It was {old}.", ("name", "old", "new")),
    Kind.SETTING_REFUSED: _denied("{name}: {value} refused", "{reason}.", ("name", "value", "reason")),
    # The loop that runs all of it
    Kind.OVERRUN: _denied(
        "Simulation late {often}, by {late:.0f} ms at worst",
        "The machine is busy; {lost:.1f} s were dropped.",
        ("late", "lost", "often"),
    ),
}


def render(event: Event) -> tuple[str, str]:
    """Headline and guidance of an event, with its numbers."""
    row = TABLE[event.kind]
    return row.headline.format_map(event.values), row.guidance.format_map(event.values)
