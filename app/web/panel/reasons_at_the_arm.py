"""What the panel's message is about, as marks on the arm: the parts beyond their limits, the force that stays, where it hit."""

from app.web.panel.panel_message import PanelText, Remembered
from app.web.scene.arm_marks import ArmMarks, PartMark
from app.web.scene.hit_mark import HitMark
from app.web.widgets.svg import Colour
from pendant.event_table import TABLE
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect, Severity
from sim.exchange.snapshot import Snapshot

FORCES = frozenset({Kind.REFUSED_PAYLOAD, Kind.RESIDUAL_STAYED, Kind.SEQUENCE_STOPPED})
"""Events that a force explains which may still be there."""

HITS = frozenset({Kind.COLLISION, Kind.PATH_LEFT})
"""Events that tell with which part the arm met something; "" where that is not known."""


def show_reasons(said: PanelText, remembered: Remembered, snapshot: Snapshot, *, marks: ArmMarks, hit: HitMark) -> bool:
    """Bring the marks to what the panel says; True if anything changed."""
    cause = said.cause
    parts: dict[str, str] = {}
    if cause is not None and TABLE[cause.kind].severity >= Severity.WARNING:
        events = [cause, *remembered.prevented] if TABLE[cause.kind].effect is Effect.NO_ENTRY else [cause]
        for event in events:
            if "part" in event.values and "parameter" in event.values:
                parts.setdefault(str(event.values["part"]), _text(event))
    stays = cause is not None and cause.kind in FORCES
    marked = marks.mark([PartMark(part, text) for part, text in parts.items()])
    met = cause if cause is not None and cause.kind in HITS and cause.values["part"] else None
    return any([marked, marks.stays(snapshot if stays else None), hit.show(met, snapshot)])


def _text(event: Event) -> str:
    values = event.values
    name = values.get("parameter", "")
    unit = values.get("unit", "")
    return f"{name}: {float(values['value']):.3g} {unit}, limit {float(values['limit']):.3g}".replace("  ", " ")


def rgb(colour: Colour) -> tuple[int, int, int]:
    """A colour of the page as the picture takes it."""
    code = int(colour.value[1:], 16)
    return code >> 16, code >> 8 & 255, code & 255
