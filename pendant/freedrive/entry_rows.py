"""Rows of the event table: activation and entry of free-drive (FD-7 to FD-12), and pushes (FD-6a)."""

from pendant.events.event import Kind
from pendant.events.event_row import EXCESS, WALL, Clears, Effect, EventRow, Severity, denied, info, protected, refused

ENTRY: dict[Kind, EventRow] = {
    # The signal (FD-7, FD-8a)
    Kind.ACTIVATION_STARTED: info(
        "Free-drive: keep holding", "Hold the button for {period:.1f} s, hands off the arm.", ("period",)
    ),
    Kind.ACTIVATION_CANCELLED: info(
        "Free-drive not started: let go too early",
        "Held for {value:.2f} s. Hold the button for {limit:.2f} s.",
        ("value", "limit"),
        reaction="The attempt ends. There is no cool-down.",
        way_out="Hold the button until the period has passed.",
    ),
    Kind.SIGNAL_SEEN: info("Free-drive: {source}", "Go on for {period:.1f} s.", ("source", "period")),
    # Its confirmation (FD-8)
    Kind.CONFIRM_ASKED: info(
        "Free-drive: confirm",
        "Let go; after {feedback:.1f} s, push it or press the button within {window:.0f} s.",
        ("source", "feedback", "window"),
    ),
    Kind.REFUSED_UNCONFIRMED: refused(
        "Free-drive refused: not confirmed", "Nobody confirmed the {source} within {limit:.0f} s.", ("source", "limit")
    ),
    # The hand that gave it must leave the arm (FD-8a)
    Kind.LET_GO_ASKED: info(
        "Free-drive: let go",
        "{force:.0f} N; hands off, to below {limit:.0f} N in {within:.1f} s.",
        ("force", "limit", "within"),
    ),
    Kind.REFUSED_STILL_HELD: refused(
        "Free-drive refused: let go",
        "Still {force:.0f} N after {within:.1f} s, limit {limit:.0f} N. Let go before the check.",
        ("force", "limit", "within"),
    ),
    # In every mode (FD-6a)
    Kind.PUSHED: info(
        "Push of {force:.0f} N at the {part}", "({x:.2f}, {y:.2f}, {z:.2f}) in the base's axes.", ("part", "force", "x", "y", "z")
    ),
    # Entry (FD-9)
    Kind.TEACH_FIRST: EventRow(
        Effect.TO_TEACH, Severity.INFO, "Mode TEACH", "The mode before was {from}. Free-drive leads back to TEACH.", ("from",)
    ),
    Kind.ENTERED: EventRow(
        Effect.ENTER, Severity.NOTICE, "Free-drive", "Move the arm by hand. A short press leaves.", ("from", "gain")
    ),
    # Refused before the check (FD-1, FD-12)
    Kind.REFUSED_MODE: refused(
        "Free-drive refused: mode is {mode}",
        "Allowed in: {allowed}.",
        ("mode", "allowed"),
        way_out="Switch to a mode in which it is allowed. From STOP, reset.",
    ),
    Kind.REFUSED_SENSORS: refused("Free-drive refused: joint sensors not valid", "Check {sensor}, then try again.", ("sensor",)),
    Kind.REFUSED_MOVING: refused(
        "Free-drive refused: the arm moves",
        "{joint} at {value:.3f} rad/s, limit {limit:.3f} rad/s for {time:.1f} s. Hands off, then try again.",
        ("joint", "value", "limit", "time"),
    ),
    Kind.REFUSED_CHANGING: refused(
        "Free-drive refused: the payload is being changed", "{mass:.2f} kg by now. Wait until it is done.", ("mass",)
    ),
    # The check (FD-9)
    Kind.REFUSED_SHORT: refused(
        "Free-drive refused: the check is too short",
        "{value:.3f} s; below {limit:.2f} s only with the handshake or a stored state.",
        ("value", "limit"),
        way_out="Set `sequence.period` longer, or switch the handshake or the stored state on.",
    ),
    Kind.REFUSED_NOT_STORED: refused(
        "Free-drive refused: no stored state",
        "None from {age:.1f} s ago. Leave the arm untouched for that time, then try again.",
        ("age",),
    ),
    Kind.SEQUENCE_STARTED: EventRow(
        Effect.TRY, Severity.INFO, "Free-drive: hands off", "Checking for {period:.1f} s that the arm stays.", ("period",)
    ),
    # What it finds (FD-10, FD-11)
    Kind.ENTRY_PREVENTED: denied(
        "Beyond its limit: {parameter}",
        "{part}: {value:.3f} {unit}, limit {limit:.3f} {unit}, {time:.2f} s into the check.",
        (*EXCESS, "time"),
        reaction="The check ends with the event that refuses or stops; each parameter beyond its limit is told besides.",
        way_out="As with that event.",
    ),
    Kind.REFUSED_LIMIT: refused(
        "Free-drive refused: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Let go; check the payload and mounting.",
        EXCESS,
    ),
    Kind.REFUSED_PAYLOAD: refused(
        "Free-drive refused: wrong payload or a push",
        "Consistent with {mass:+.1f} kg, or a steady {force:.0f} N push {way}; let go, or turn the wrist, to decide.",
        ("mass", "force", "way", "zero", "parameter"),
        way_out="Let go, or turn the wrist, to decide. Correct the payload, or zero the sensor.",
    )._replace(
        variant=(
            "zero",
            "{force:.0f} N: {mass:+.1f} kg, the sensor's zero, or a push {way}. Let go; zero it with nothing touching.",
        )
    ),
    # A wall exceeded in it (VW-6)
    Kind.REFUSED_WALL: refused(
        "Free-drive refused: {part} beyond {wall}",
        "{distance:.1f} mm out; back is {way} of the base. Let go; check the payload.",
        WALL,
    ),
    # Instead of holding the arm at once (FD-10)
    Kind.SEQUENCE_STOPPED: protected(
        "Protective stop: {parameter}",
        "{part}: {value:.2f} {unit}, limit {limit:.2f}. Let go, check the payload, then reset.",
        EXCESS,
    ),
    Kind.COMPENSATING: info(
        "Free-drive is refused: the arm is balanced",
        "Hands off. It is held when it stands, within {period:.1f} s.",
        ("period",),
        reaction="The arm stays free, and the motors' torque against gravity adapts to the load, until the arm stands.",
    ),
    Kind.COMPENSATED: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "The arm is balanced, and held",
        "It moved by {moved:.1f} mm, within {time:.1f} s.",
        ("moved", "time"),
    ),
    Kind.NOT_COMPENSATED: denied(
        "The arm did not come to rest: it is held",
        "It moved by {moved:.1f} mm within {time:.1f} s. Check the payload.",
        ("moved", "time"),
        reaction="The arm is held, and free-drive is refused.",
    ),
    Kind.LOAD_FOUND: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Load beyond the configured payload",
        "{mass:+.2f} kg at the flange, or a steady {force:.0f} N push {way}.",
        ("mass", "force", "way"),
    ),
    # Payload or hand: what was felt, after a refusal (FD-11)
    Kind.RESIDUAL_GONE: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "It was a push: the force is gone",
        "{force:.0f} N at the refusal, {left:.0f} N now. Hands off while the arm is checked.",
        ("force", "left"),
    ),
    Kind.RESIDUAL_STAYED: EventRow(
        Effect.INFO,
        Severity.WARNING,
        "Free-drive refused: payload looks wrong ({mass:+.1f} kg)",
        "Still {force:.0f} N: the payload seems to differ by {mass:+.1f} kg from the configured one. Correct or measure it.",
        ("force", "mass", "zero"),
        variant=(
            "zero",
            "Still {force:.0f} N: the payload, by {mass:+.1f} kg, or the sensor's zero is wrong. Zero it, or measure the load.",
        ),
    ),
    # A signal that does not count yet (FD-7, FD-12c)
    Kind.NOT_YET: EventRow(
        Effect.INFO,
        Severity.NOTICE,
        "Free-drive not yet",
        "Let go first; ready in {remaining:.1f} s.",
        ("remaining",),
        Clears.COOL_DOWN,
        reaction="The signal does not count.",
        way_out="Let go. Ask again after the cool-down.",
    ),
}
