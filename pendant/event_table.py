"""The one event table: effect on the mode, severity, texts, what clears it. Interfaces render from it."""

from pendant.events.event import Event, Kind
from pendant.events.event_row import EventRow
from pendant.freedrive.entry_rows import ENTRY
from pendant.freedrive.rows import FREE_DRIVE
from pendant.program.rows import PROGRAM
from pendant.robot.rows import SAFETY
from pendant.safety.rows import PROTECTION

TABLE: dict[Kind, EventRow] = {**ENTRY, **FREE_DRIVE, **SAFETY, **PROTECTION, **PROGRAM}


def render(event: Event) -> tuple[str, str]:
    """Headline and guidance of an event, with its numbers."""
    row = TABLE[event.kind]
    guidance = row.guidance
    if row.variant is not None and event.values[row.variant[0]]:
        guidance = row.variant[1]
    values = {name: row.words.get(value, value) if isinstance(value, str) else value for name, value in event.values.items()}
    headline, guidance = row.headline.format_map(values), guidance.format_map(values)
    return headline, guidance[:1].upper() + guidance[1:]
