"""The words and colours of the pendant's states."""

from app.web.widgets.svg import Colour
from pendant.events.event_row import Severity
from pendant.guided.pull import PullCauses
from pendant.tick.modes import Mode, Phase, Safety
from pendant.tick.pose import norm
from sim.exchange.told_force import UncertainForce

WORDS = {
    Mode.NORMAL: ("Holding still", Colour.GREEN),
    Mode.TEACH: ("Ready", Colour.GREEN),
    Mode.REMOTE: ("Remote control", Colour.GREY),
    Mode.RUN: ("Program runs", Colour.GREEN),
    Mode.FREE_DRIVE: ("Guide it by hand", Colour.BLUE),
    Mode.STOP: ("Stopped", Colour.RED),
}
MOVES = ("The arm moves", Colour.GREEN)
"""Outside of programs: it is jogged, the payload wizard turns it, or it comes to rest."""

STOPPING = ("Stopping", Colour.RED)
"""A stop in which the arm does not stand yet."""

RESET_NEEDED = "Reset needed"
"""The safety mode beside a STOP that no safety mode has caused."""

ASKED = {
    Phase.ACTIVATION: ("Keep holding", Colour.BLUE),
    Phase.DELAY: ("Let go and wait", Colour.BLUE),
    Phase.FEEDBACK: ("Let go and wait", Colour.BLUE),
    Phase.CONFIRM: ("Confirm now", Colour.AMBER),
    Phase.LET_GO: ("Let go of the arm", Colour.AMBER),
    Phase.SEQUENCE: ("Hands off", Colour.BLUE),
}
"""What the user is to do before free-drive begins."""

SAFETY_WORDS = {
    Safety.NORMAL: "Normal",
    Safety.REDUCED: "Reduced",
    Safety.SAFEGUARD_STOP: "Safeguard stop",
    Safety.PROTECTIVE_STOP: "Protective stop",
    Safety.EMERGENCY_STOP: "Emergency stop",
}
SEVERITY_COLOURS = {
    Severity.INFO: Colour.GREY,
    Severity.NOTICE: Colour.BLUE,
    Severity.WARNING: Colour.AMBER,
    Severity.STOP: Colour.RED,
}
PERIOD_COLOURS = {
    "activation": Colour.BLUE,
    "sequence": Colour.BLUE,
    "confirmation": Colour.AMBER,
    "let go": Colour.AMBER,
    "compensation": Colour.AMBER,
    "feedback": Colour.GREY,
    "delay": Colour.GREY,
    "cool-down": Colour.GREY,
    "safety": Colour.GREY,
}
"""Of countdown rings; a period that is not named here has the colour of the mode light."""

PERIOD_WORDS = {
    "activation": "Keep holding",
    "feedback": "Hands off",
    "delay": "Hands off",
    "confirmation": "Confirm within",
    "let go": "Let go within",
    "sequence": "Checking",
    "free-drive": "Move it within",
    "restart": "Ends in",
    "cool-down": "Free-drive again in",
    "safety": "Recovering",
}
"""What a running period is called beside its countdown."""

LEAVING_PERIODS = ("free-drive", "restart")
"""Periods whose end ends free-drive."""


def pull_row(pull: PullCauses | None) -> list[tuple[str, str]]:
    """What pulls at the free arm, as a row of figures; none while it is not free."""
    return [] if pull is None else [("Detected at the arm", pull.words)]


YOURS = "Estimated hand force"
FIGURES = {
    YOURS: (
        "The force that free-drive takes for your hand's: the green arrow. In 95 of 100 moments the true one ends within the"
        " green ellipsoid, which reaches so far where it is narrowest and where it is widest. It is wide up and down where a"
        " payload cannot be told from a steady hand. On a link the joints alone feel your hand, and there is no ellipsoid."
    )
}
"""What a row of figures means."""


def user_row(user: UncertainForce | None) -> list[tuple[str, str]]:
    """What is taken for the user's force, and how far off it may be, as a row of figures; none while it is not free."""
    if user is None:
        return []
    force, ellipsoid = f"{norm(user.force):.1f} N", user.ellipsoid()
    if ellipsoid is None:
        return [(YOURS, f"{force}, by the joints alone")]
    least, _, most = ellipsoid[0].tolist()
    return [(YOURS, f"{force} (± {least:.1f} to {most:.1f} N)")]
