"""What the panel says: one function of the state and of the few events that still matter in it. Nothing outlives its cause."""

from dataclasses import dataclass, field
from typing import NamedTuple

from app.web.panel.state_words import ASKED, SEVERITY_COLOURS
from app.web.widgets.svg import Colour
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Clears, Effect, Severity
from pendant.program.steps import ProgramState
from pendant.tick.modes import TICK_RATE, Law, Mode, Safety

REASONS = 4
"""Parameters named in a refusal; the log has all of them."""

PASSING = 8 * TICK_RATE
"""What changes no mode, such as a contact, is told for so many ticks."""

ASKING = frozenset({Kind.ACTIVATION_STARTED, Kind.SIGNAL_SEEN, Kind.CONFIRM_ASKED, Kind.LET_GO_ASKED, Kind.SEQUENCE_STARTED})
"""Events that say what the user is to do before free-drive begins; shown while that lasts."""

STOPPING = {
    Effect.LEAVE_TO_STOP: 1,
    Effect.SAFEGUARD_STOP: 2,
    Effect.PROTECTIVE_STOP: 3,
    Effect.EMERGENCY_STOP: 4,
}
"""Effects that end in STOP, the gravest last: its event is the one that is told."""

ENDED = frozenset({Effect.ENTER, Effect.TRY})
"""Effects after which what refused or ended free-drive before is the past."""

CONTACTS = frozenset({Kind.CONTACT_GAINED, Kind.CONTACT_LOST, Kind.CONTACT_RESISTANCE, Kind.CONTACT_CLAMPING})
"""Events that hide no reason why free-drive did not begin: who drags an arm that is not free makes contacts."""

MENDED = frozenset({Kind.PAYLOAD_CHANGED, Kind.SENSOR_ZEROED})
"""Events after which a force that stayed is the past."""


class PanelText(NamedTuple):
    """What the panel says."""

    headline: str
    text: str
    colour: Colour
    reasons: tuple[str, ...] = ()
    cause: Event | None = None  # the event that it comes from


HINTS = {
    Mode.TEACH: PanelText("The arm can be guided by hand", "Hold the button, let go, then drag the arm.", Colour.GREY),
    Mode.NORMAL: PanelText("The arm holds its place", "Choose TEACH to guide it by hand or to teach it.", Colour.GREY),
    Mode.REMOTE: PanelText("A remote controller has the arm", "Choose TEACH to take it back to this pendant.", Colour.GREY),
    Mode.RUN: PanelText("The program runs", "Keep out of its way. Pause and Stop are above.", Colour.GREEN),
    Mode.FREE_DRIVE: PanelText("Guide the arm", "Drag it. A short press of the button, or Leave, ends free-drive.", Colour.BLUE),
    Mode.STOP: PanelText("Stopped", "See what happened, then press Reset.", Colour.RED),
}
PROGRAM_PAUSED = PanelText("The program is paused", "Run goes on with it, Stop ends it.", Colour.AMBER)
MOVING = PanelText("The arm moves", "Keep out of its way until it stands.", Colour.GREEN)
MEASURING = PanelText("The arm measures its payload", "It turns its wrist by itself: hands off. Stop ends it.", Colour.BLUE)
CLOCK_PAUSED = PanelText(
    "The simulation is paused", "Nothing moves. Go on, on the tab Lab, or the key P lets it run again.", Colour.AMBER
)


@dataclass(slots=True)
class Remembered:
    """The events that still matter, taken in one after the other."""

    stop: Event | None = None  # the cause of STOP
    note: Event | None = None  # what refused or ended free-drive last, or wants to be read
    asking: Event | None = None
    prevented: list[Event] = field(default_factory=list)
    tick: int = 0

    def take(self, event: Event) -> None:
        """Take in an event."""
        row = TABLE[event.kind]
        if event.kind is Kind.OVERRUN:
            return  # a busy machine is told by the pace, and hides nothing
        if event.kind is Kind.ENTRY_PREVENTED:
            self.prevented.append(event)
            return
        if event.kind in ASKING:
            self.asking = event
        if event.kind in (Kind.ACTIVATION_STARTED, Kind.SEQUENCE_STARTED):
            self.prevented = []
        if row.effect in STOPPING:
            if self.stop is None or STOPPING[row.effect] > STOPPING[TABLE[self.stop.kind].effect]:
                self.stop = event
            return
        if row.effect in ENDED or event.kind in (Kind.ACTIVATION_STARTED, Kind.PROGRAM_STARTED):
            self.note = None
        if event.kind in MENDED and self.note is not None and self.note.kind is Kind.RESIDUAL_STAYED:
            self.note = None
        if event.kind in CONTACTS and self._refused():
            return
        worth = row.effect is not Effect.INFO or row.severity >= Severity.NOTICE or event.kind is Kind.ACTIVATION_CANCELLED
        if worth and row.effect is not Effect.TRY:
            self.note = event

    def forget(self, event: Event) -> None:
        """It needs no telling any more."""
        if self.note == event:
            self.note = None

    def see(self, decision: Decision, tick: int) -> None:
        """Forget what has no cause any more. A tick before the last one is another beginning.

        A state from before an event, which the page may take in first, says nothing about it.
        """
        if tick < self.tick:
            self.stop = self.note = self.asking = None
            self.prevented = []
        self.tick = tick
        if self.stop is not None and tick >= self.stop.tick and decision.mode is not Mode.STOP:
            self.stop = None
        if self.note is not None and tick >= self.note.tick and self._over(self.note, decision):
            self.note = None

    def _refused(self) -> bool:
        """Whether it is told why free-drive did not begin."""
        if self.note is None:
            return False
        return (
            self.note.kind in (Kind.RESIDUAL_STAYED, Kind.ACTIVATION_CANCELLED) or TABLE[self.note.kind].effect is Effect.NO_ENTRY
        )

    def _over(self, note: Event, decision: Decision) -> bool:
        row = TABLE[note.kind]
        if row.clears is Clears.RESET:
            return decision.mode is not Mode.STOP
        if row.effect is Effect.INFO and note.kind is not Kind.RESIDUAL_STAYED:
            refused_in = note.values["mode"] if note.kind is Kind.COMMAND_REFUSED else decision.mode
            return self.tick - note.tick > PASSING or decision.mode != refused_in
        if decision.mode is Mode.STOP or (decision.mode is Mode.RUN and decision.program is ProgramState.RUNNING):
            return True
        return decision.mode is Mode.FREE_DRIVE and row.effect is not Effect.ENTER


def moves(decision: Decision) -> bool:
    """The arm moves, or is asked to."""
    return decision.law in (Law.FOLLOW, Law.BRAKE) or not decision.static


def how_to_guide(settings: Settings) -> str:
    """What to do to guide the arm, in words."""
    hold = f"Hold the button for {settings.activation.period:g} s"
    return (
        f"{hold}, and keep it held while you drag the arm."
        if settings.button.hold_to_run
        else f"{hold}, let go, then drag the arm."
    )


def said(remembered: Remembered, decision: Decision, settings: Settings, *, paused: bool = False) -> PanelText:
    """What the panel says in a state; `paused` is that of the simulation's clock."""
    if decision.mode is Mode.STOP or decision.safety > Safety.REDUCED:
        return HINTS[Mode.STOP] if remembered.stop is None else _told(remembered.stop)
    if paused:
        return CLOCK_PAUSED
    if decision.wizard.doing:
        return MEASURING
    if remembered.asking is not None and decision.phase in ASKED:
        return _told(remembered.asking)
    if remembered.note is not None:
        no_entry = TABLE[remembered.note.kind].effect is Effect.NO_ENTRY
        return _told(remembered.note, remembered.prevented if no_entry else ())
    if decision.program is ProgramState.PAUSED:
        return PROGRAM_PAUSED
    if decision.mode in (Mode.TEACH, Mode.NORMAL, Mode.REMOTE) and moves(decision):
        return MOVING
    if decision.mode is not Mode.TEACH:
        return HINTS[decision.mode]
    reduced = "Reduced mode: lower speeds. " if decision.safety is Safety.REDUCED else ""
    return HINTS[Mode.TEACH]._replace(text=reduced + how_to_guide(settings))


def _told(event: Event, prevented: list[Event] | tuple[()] = ()) -> PanelText:
    headline, guidance = render(event)
    colour = SEVERITY_COLOURS[TABLE[event.kind].severity]
    return PanelText(headline, guidance, colour, tuple(_reason(reason) for reason in prevented[:REASONS]), event)


def _reason(event: Event) -> str:
    """A parameter that prevented entry, in a line (FD-11)."""
    values = event.values
    return f"{values['part']} {values['parameter']}: {values['value']:.2g} {values['unit']}, limit {values['limit']:.2g}"
